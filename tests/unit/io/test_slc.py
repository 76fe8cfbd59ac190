"""SLC volumes, against VTK's reader of them."""

from __future__ import annotations

import numpy as np
import pytest

from tests.unit.io.writers import scalars
from volviz.errors import LoadError
from volviz.io import load

ARRAY = scalars((4, 9, 11), "uint8")
ARRAY[1] = 7
ARRAY[2, :4] = 0


def packed(plane):
    """Runs of equal bytes and single ones, each of 127 at most."""
    parts, values = [], plane.ravel().tolist()
    while values:
        same = 1
        while same < min(len(values), 127) and values[same] == values[0]:
            same += 1
        if same > 1:
            parts.append(bytes([same, values[0]]))
        else:
            same = min(len(values), 50)
            parts.append(bytes([0x80 | same, *values[:same]]))
        values = values[same:]
    return b"".join(parts) + b"\0"


def write(path, *, runs=True, bits=8, packing=None, across=3):
    z, y, x = ARRAY.shape
    head = f"11111 {x} {y} {z} {bits}\n0.5 0.25 2.0\n1 1 1 {int(runs) if packing is None else packing}\n{across} 2 X"
    planes = [packed(p) for p in ARRAY]
    body = b"".join(b"%d X" % len(p) + p for p in planes) if runs else ARRAY.tobytes()
    path.write_bytes(head.encode() + bytes(range(3 * across * 2)) + body)
    return path


@pytest.mark.parametrize("runs", [True, False])
def test_values_and_spacing_are_those_that_vtk_reads(tmp_path, runs):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkSLCReader

    path = write(tmp_path / "v.slc", runs=runs)
    reader = vtkSLCReader()
    reader.SetFileName(str(path))
    reader.Update()
    volume = load(path)
    np.testing.assert_array_equal(volume.array, ARRAY)
    theirs = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(ARRAY.shape)
    np.testing.assert_array_equal(volume.array, theirs)
    assert volume.spacing == reader.GetOutput().GetSpacing() == (0.5, 0.25, 2.0)
    part = load(path, box=(2, 9, 1, 8, 1, 3))
    np.testing.assert_array_equal(part.array, ARRAY[1:3, 1:8, 2:9])
    bare = path.rename(tmp_path / "download")
    assert load(bare).metadata["format"] == "SLC"


def test_what_is_damaged_cut_off_or_of_another_kind_is_said(tmp_path):
    path = tmp_path / "v.slc"
    for runs in (True, False):
        content = write(path, runs=runs).read_bytes()
        path.write_bytes(content[:-20])
        with pytest.raises(LoadError, match="cut off"):
            load(path)
    with pytest.raises(LoadError, match="values of 16 bits cannot be read"):
        load(write(path, bits=16))
    with pytest.raises(LoadError, match="way to pack"):
        load(write(path, packing=4))
    path.write_bytes(b"11111 0 4 4")
    with pytest.raises(LoadError, match="no SLC volume"):
        load(path)
    path.write_bytes(write(path).read_bytes().replace(b"11111 11 9 4", b"11111 99999 99999 99999"))
    with pytest.raises(LoadError, match="promises"):
        load(path)


def test_damage_ends_in_a_volume_or_a_sentence(tmp_path):
    path = write(tmp_path / "v.slc")
    content = path.read_bytes()
    rng = np.random.default_rng(3)
    told = []
    for _ in range(150):
        damaged = bytearray(content)
        for place in rng.integers(0, len(content), 3):
            damaged[place] = rng.integers(0, 256)
        path.write_bytes(damaged)
        try:
            load(path)
        except LoadError as error:
            told.append(str(error))
    assert len(told) > 20
    assert not any("\n" in sentence for sentence in told)
