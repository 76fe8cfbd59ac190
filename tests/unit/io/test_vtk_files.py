"""VTK images: several arrays, bits, and headers that promise too much."""

from __future__ import annotations

import base64
import re

import numpy as np
import pytest
import pyvista

import volviz
from tests.unit.io.writers import scalars
from volviz.errors import InputError, LoadError
from volviz.io import load
from volviz.io.vtk_files import PACKING

SHAPE = (4, 5, 6)


def grid(**arrays):
    """An image whose arrays at points have the shape (z, y, x, ...)."""
    image = pyvista.ImageData(dimensions=SHAPE[::-1], spacing=(1, 2, 3), origin=(10, 20, 30))
    for name, array in arrays.items():
        image.point_data[name] = array.reshape(-1, *array.shape[3:])
    return image


@pytest.mark.parametrize("suffix", [".vti", ".vtk"])
def test_every_component_of_every_array_is_a_channel(tmp_path, suffix):
    density, velocity = scalars(SHAPE), scalars((*SHAPE, 3), "float32")
    image = grid(density=density, velocity=velocity)
    image.set_active_scalars("density")
    image.save(tmp_path / f"v{suffix}")
    source = volviz.open(tmp_path / f"v{suffix}")
    wanted = {"density": density} | {f"velocity [{n}]": velocity[..., n] for n in range(3)}
    names = [channel.name for channel in source.channels]
    assert sorted(names) == sorted(wanted)
    for number, name in enumerate(names):
        np.testing.assert_array_equal(source.read(channel=number).array, wanted[name], err_msg=name)
    np.testing.assert_array_equal(source.read().array, density)
    assert any("density is shown" in note for note in source.read().metadata["notes"])
    with pytest.raises(InputError, match=r"0\.\.3"):
        source.read(channel=4)


@pytest.mark.parametrize("suffix", [".vti", ".vtk"])
def test_arrays_at_cells_beside_those_at_points_are_chosen_by_series(tmp_path, suffix):
    image = grid(density=scalars(SHAPE))
    cells = scalars((3, 4, 5), seed=2)
    image.cell_data["pressure"] = cells.ravel()
    image.save(tmp_path / f"v{suffix}")
    at_points, at_cells = load(tmp_path / f"v{suffix}"), load(tmp_path / f"v{suffix}", series=1)
    np.testing.assert_array_equal(at_points.array, scalars(SHAPE))
    assert any("pressure" in note and "series=1" in note for note in at_points.metadata["notes"])
    np.testing.assert_array_equal(at_cells.array, cells)
    np.testing.assert_allclose(at_cells.origin, (10.5, 21, 31.5))
    np.testing.assert_array_equal(load(tmp_path / f"v{suffix}", series=0).array, at_points.array)
    with pytest.raises(InputError, match=r"series must lie in 0\.\.1"):
        load(tmp_path / f"v{suffix}", series=2)


@pytest.mark.parametrize("shape", [SHAPE, (24, 24, 24)])
def test_bits_of_a_legacy_file_are_unpacked(tmp_path, shape):
    bits = scalars(shape, "uint8") > 100
    z, y, x = shape
    head = (
        f"# vtk DataFile Version 3.0\nbits\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS {x} {y} {z}\n"
        f"SPACING 1 1 1\nORIGIN 0 0 0\nPOINT_DATA {bits.size}\nSCALARS b bit\nLOOKUP_TABLE default\n"
    )
    (tmp_path / "v.vtk").write_bytes(head.encode() + np.packbits(bits).tobytes() + b"\n")
    np.testing.assert_array_equal(load(tmp_path / "v.vtk").array, bits)
    (tmp_path / "v.vtk").write_bytes(head.encode())
    with pytest.raises(LoadError, match="cut off"):
        load(tmp_path / "v.vtk")


@pytest.mark.parametrize(
    "lines",
    [
        "SCALARS a double 4\nLOOKUP_TABLE default\n",
        "TENSORS a double\n",
        "FIELD f 1\na 1000000 1000000000 double\n",
    ],
)
@pytest.mark.parametrize("encoding", ["BINARY", "ASCII"])
def test_a_legacy_file_that_promises_too_much_is_refused_before_vtk_asks_for_memory(
    tmp_path, lines, encoding
):
    head = (
        f"# vtk DataFile Version 3.0\nv\n{encoding}\nDATASET STRUCTURED_POINTS\nDIMENSIONS 8 8 8\n"
        f"SPACING 1 1 1\nORIGIN 0 0 0\nPOINT_DATA 512\n{lines}"
    )
    (tmp_path / "v.vtk").write_bytes(head.encode() + b"1 " * 300)
    with pytest.raises(LoadError, match="cut off"):
        load(tmp_path / "v.vtk")


@pytest.mark.parametrize("place", ["PointData", "CellData"])
def test_an_xml_file_that_promises_too_much_is_refused_before_vtk_asks_for_memory(tmp_path, place):
    n = 500
    head = (
        '<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">'
        f'<ImageData WholeExtent="0 {n} 0 {n} 0 {n}" Origin="0 0 0" Spacing="1 1 1">'
        f'<Piece Extent="0 {n} 0 {n} 0 {n}"><{place}><DataArray type="Float64" Name="v" '
        f'NumberOfComponents="{PACKING * 9}" format="appended" offset="0"/></{place}></Piece></ImageData>'
        '<AppendedData encoding="raw">_'
    )
    (tmp_path / "v.vti").write_bytes(head.encode() + bytes(1 << 20))
    with pytest.raises(LoadError, match="cut off"):
        load(tmp_path / "v.vti")


def test_an_xml_file_that_does_not_fit_into_memory_is_refused(tmp_path, monkeypatch):
    grid(density=scalars(SHAPE)).save(tmp_path / "v.vti")
    monkeypatch.setattr("volviz.io.memory.free_bytes", lambda: 100)
    with pytest.raises(LoadError, match="of memory"):
        load(tmp_path / "v.vti")
    grid(density=scalars(SHAPE)).save(tmp_path / "v.vtk")
    with pytest.raises(LoadError, match="of memory"):
        load(tmp_path / "v.vtk")


@pytest.mark.parametrize("mode", ["Appended", "Binary"])
@pytest.mark.parametrize("is_text", [False, True])
@pytest.mark.parametrize("header", ["UInt32", "UInt64"])
def test_damaged_lists_of_packed_blocks_do_not_reach_vtk(tmp_path, mode, is_text, header):
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

    array = scalars((40, 40, 40))
    image = pyvista.ImageData(dimensions=(40, 40, 40))
    image["v"] = array.ravel()
    path = tmp_path / "v.vti"
    writer = vtkXMLImageDataWriter()
    writer.SetInputData(image)
    writer.SetFileName(str(path))
    getattr(writer, f"SetDataModeTo{mode}")()
    getattr(writer, f"SetHeaderTypeTo{header}")()
    writer.SetCompressorTypeToZLib()
    writer.SetEncodeAppendedData(is_text)
    writer.Write()
    np.testing.assert_array_equal(load(path).array, array)
    raw, size = path.read_bytes(), 4 if header == "UInt32" else 8
    is_raw = mode == "Appended" and not is_text
    if is_raw:
        at = raw.index(b"_", raw.index(b"<AppendedData")) + 1
        count = 4 * size
    else:
        at = re.search(rb"(?:_|>)\s*([A-Za-z0-9+/]{30,})", raw).start(1)
        count = -(-4 * size // 3) * 4
    piece = raw[at : at + count]
    numbers = piece if is_raw else base64.b64decode(piece)
    for place in range(4):
        for value in (0, 2**31 - 1) if place != 2 else (2**31 - 1,):
            if place == 3 and value == 0:
                continue
            bad = bytearray(numbers)
            bad[place * size : (place + 1) * size] = value.to_bytes(size, "little")
            text = bytes(bad) if is_raw else base64.b64encode(bytes(bad))
            path.write_bytes(raw[:at] + text[:count] + raw[at + count :])
            with pytest.raises(LoadError, match="damaged"):
                load(path)
