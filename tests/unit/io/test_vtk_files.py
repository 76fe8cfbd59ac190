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
from volviz.io.vtk_kinds import PACKING

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


def rectilinear(points, cells=None, *, x=None):
    z, y, _ = SHAPE
    x = np.arange(6) * 0.1 + 4 if x is None else x
    image = pyvista.RectilinearGrid(x, np.arange(y) * 2.0 - 3, np.arange(z) * 0.5)
    image.point_data["density"] = points.ravel()
    if cells is not None:
        image.cell_data["pressure"] = cells.ravel()
    return image


@pytest.mark.parametrize("suffix", [".vtr", ".vtk"])
def test_an_even_rectilinear_grid_is_a_volume(tmp_path, suffix):
    rectilinear(scalars(SHAPE), scalars((3, 4, 5), seed=2)).save(tmp_path / f"v{suffix}")
    volume = load(tmp_path / f"v{suffix}")
    np.testing.assert_array_equal(volume.array, scalars(SHAPE))
    np.testing.assert_allclose(volume.spacing, (0.1, 2, 0.5))
    np.testing.assert_allclose(volume.origin, (4, -3, 0))
    at_cells = load(tmp_path / f"v{suffix}", series=1)
    np.testing.assert_array_equal(at_cells.array, scalars((3, 4, 5), seed=2))
    np.testing.assert_allclose(at_cells.origin, (4.05, -2, 0.25))


@pytest.mark.parametrize("suffix", [".vtr", ".vtk"])
def test_an_uneven_rectilinear_grid_is_refused_with_its_distances(tmp_path, suffix):
    rectilinear(scalars(SHAPE), x=np.array([0, 1, 2, 4, 5, 6.0])).save(tmp_path / f"v{suffix}")
    with pytest.raises(LoadError, match="x coordinates lie 1 to 2 apart"):
        load(tmp_path / f"v{suffix}")


def test_a_falling_axis_of_a_rectilinear_grid_is_turned_and_not_mirrored(tmp_path):
    rectilinear(scalars(SHAPE), x=10.0 - np.arange(6)).save(tmp_path / "v.vtr")
    volume = load(tmp_path / "v.vtr")
    np.testing.assert_allclose(volume.index_to_world @ (5, 0, 0, 1), (5, -3, 0, 1))
    np.testing.assert_array_equal(volume.array, scalars(SHAPE))


@pytest.mark.parametrize("kind", ["PImageData", "PRectilinearGrid"])
def test_pieces_are_one_volume_and_a_missing_one_is_named(tmp_path, kind):
    from vtkmodules.vtkIOParallelXML import vtkXMLPImageDataWriter, vtkXMLPRectilinearGridWriter

    is_image = kind == "PImageData"
    writer = vtkXMLPImageDataWriter() if is_image else vtkXMLPRectilinearGridWriter()
    path = tmp_path / ("v.pvti" if is_image else "v.pvtr")
    writer.SetFileName(str(path))
    writer.SetInputData(grid(density=scalars(SHAPE)) if is_image else rectilinear(scalars(SHAPE)))
    writer.SetNumberOfPieces(3)
    writer.SetStartPiece(0)
    writer.SetEndPiece(2)
    writer.Write()
    pieces = [p for p in tmp_path.rglob("*") if p.is_file() and p != path]
    assert len(pieces) == 3
    volume = load(path)
    np.testing.assert_array_equal(volume.array, scalars(SHAPE))
    np.testing.assert_allclose(volume.spacing, (1, 2, 3) if is_image else (0.1, 2, 0.5))
    pieces[1].unlink()
    with pytest.raises(LoadError, match=rf"piece {pieces[1].name} is not there"):
        load(path)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('WholeExtent="0 5 0 4 0 3"', 'WholeExtent="0 5 0 4-0 3"', "no size that a volume can have"),
        ('Direction="1 0 0 0 1 0 0 0 1"', 'Direction="1 0 0 99999999999 1 0 0 0 1"', "times as large"),
    ],
)
def test_numbers_of_a_damaged_header_end_in_a_sentence(tmp_path, old, new, words):
    path = tmp_path / "v.vti"
    grid(density=scalars(SHAPE)).save(path)
    content = path.read_bytes()
    assert old.encode() in content
    path.write_bytes(content.replace(old.encode(), new.encode()))
    with pytest.raises(LoadError, match=words):
        load(path)
