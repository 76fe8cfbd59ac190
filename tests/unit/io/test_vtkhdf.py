"""VTKHDF images: arrays at points and cells, places, time steps; against VTK's reader."""

import os

import h5py
import numpy as np
import pytest

import volviz
from tests.unit.io.writers import scalars
from volviz.errors import LoadError

SHAPE = (4, 5, 6)
EXTENT = [1, 6, 0, 4, -1, 2]
TURN = [0.0, -1, 0, 1, 0, 0, 0, 0, 1]


def written(path, arrays, *, kind="ImageData", active=None, steps=None, offsets=None):
    """`arrays` by their names, "PointData/density" say."""
    with h5py.File(path, "w") as file:
        group = file.create_group("VTKHDF")
        group.attrs["Version"] = [2, 1]
        group.attrs["Type"] = np.bytes_(kind)
        group.attrs["WholeExtent"] = EXTENT
        group.attrs["Origin"] = [10.0, 20, 30]
        group.attrs["Spacing"] = [1.0, 2, 3]
        group.attrs["Direction"] = TURN
        for name, array in arrays.items():
            group[name] = array
        if active:
            group["PointData"].attrs["Scalars"] = np.bytes_(active)
        if steps is not None:
            group.create_group("Steps").attrs["NSteps"] = len(steps)
            group["Steps/Values"] = steps
            if offsets is not None:
                group["Steps/PointDataOffsets/density"] = offsets
    return path


def test_values_and_place_are_those_that_vtk_reads(tmp_path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader

    path = written(tmp_path / "v.vtkhdf", {"PointData/density": scalars(SHAPE)})
    reader = vtkHDFReader()
    reader.SetFileName(os.fspath(path))
    reader.Update()
    image = reader.GetOutput()
    volume = volviz.load(path)
    np.testing.assert_array_equal(volume.array, scalars(SHAPE))
    np.testing.assert_array_equal(
        vtk_to_numpy(image.GetPointData().GetArray("density")).reshape(SHAPE), scalars(SHAPE)
    )
    for index in np.ndindex(2, 2, 2):
        corner = np.array(index) * (np.array(SHAPE[::-1]) - 1)
        theirs = [0.0] * 3
        image.TransformIndexToPhysicalPoint((corner + EXTENT[::2]).tolist(), theirs)
        np.testing.assert_allclose((volume.index_to_world @ (*corner, 1))[:3], theirs, atol=1e-9)


def test_the_active_array_is_shown_and_others_are_chosen_by_name(tmp_path):
    cells = scalars((3, 4, 5), seed=3)
    arrays = {
        "PointData/a": scalars(SHAPE), "PointData/b": scalars((*SHAPE, 2), "float32"), "CellData/c": cells,
    }  # fmt: skip
    path = written(tmp_path / "v.vtkhdf", arrays, active="a")
    assert [entry.name for entry in volviz.open(path).entries] == ["PointData/a", "PointData/b", "CellData/c"]
    np.testing.assert_array_equal(volviz.load(path).array, arrays["PointData/a"])
    second = volviz.load(path, series="PointData/b", channel=1)
    np.testing.assert_array_equal(second.array, arrays["PointData/b"][..., 1])
    at_cells = volviz.load(path, series="CellData/c")
    np.testing.assert_array_equal(at_cells.array, cells)
    middle = np.reshape(TURN, (3, 3)) @ ((np.array([1, 0, -1]) + 0.5) * (1, 2, 3)) + (10, 20, 30)
    np.testing.assert_allclose(at_cells.origin, middle)


def test_time_steps_may_share_what_is_stored(tmp_path):
    frames = scalars((2, *SHAPE))
    path = written(
        tmp_path / "v.vtkhdf", {"PointData/density": frames}, steps=[0.0, 0.5, 2.0], offsets=[0, 1, 0]
    )
    source = volviz.open(path)
    assert source.times == (0.0, 0.5, 2.0)
    for time, stored in enumerate([0, 1, 0]):
        np.testing.assert_array_equal(source.read(time=time).array, frames[stored])
    np.testing.assert_array_equal(source.read(time=1, box=(1, 4, 0, 3, 1, 3)).array, frames[1, 1:3, :3, 1:4])


def test_what_is_no_image_or_does_not_fit_is_said(tmp_path):
    array = {"PointData/density": scalars(SHAPE)}
    with pytest.raises(LoadError, match="it holds PolyData, no image"):
        volviz.open(written(tmp_path / "v.vtkhdf", array, kind="PolyData"))
    with pytest.raises(LoadError, match="do not fit its dimensions"):
        volviz.open(written(tmp_path / "w.vtkhdf", {"PointData/density": scalars((5, 5, 5))}))
    with pytest.raises(LoadError, match="holds no numbers"):
        volviz.open(written(tmp_path / "x.vtkhdf", {"FieldData/density": scalars(SHAPE)}))
