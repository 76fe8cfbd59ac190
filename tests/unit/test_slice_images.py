"""Slices as arrays: values against SimpleITK and NumPy, positions, windows, layers, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK

import volviz
from volviz.cli import main
from volviz.errors import InputError
from volviz.model.slice_plane import slice_plane

RANDOM = np.random.default_rng(11)
ARRAY = RANDOM.normal(size=(9, 11, 13)).astype(np.float32)
ANGLE = np.radians(20.0)
OBLIQUE = np.array([[np.cos(ANGLE), -np.sin(ANGLE), 0], [np.sin(ANGLE), np.cos(ANGLE), 0], [0, 0, 1.0]])
SHEARED = np.array([[1.0, 0.05, 0.0], [0.0, np.sqrt(1 - 0.05**2), 0.0], [0.0, 0.0, 1.0]])
LATTICES = {
    "oblique": {"spacing": (0.7, 1.3, 2.0), "origin": (-4.0, 30.0, 100.0), "direction": OBLIQUE},
    "left-handed": {"spacing": (1.0, 0.5, 1.5), "direction": np.diag([1.0, 1.0, -1.0])},
    "sheared": {"spacing": (1.0, 1.0, 1.0), "origin": (3.0, 2.0, 1.0), "direction": SHEARED},
}


def as_sitk(volume: volviz.Volume) -> Any:
    image = SimpleITK.GetImageFromArray(volume.array.astype(np.float64))
    image.SetSpacing(volume.spacing)
    image.SetOrigin(volume.origin)
    image.SetDirection(volume.direction.ravel())
    return image


@pytest.mark.parametrize("lattice", [name for name in LATTICES if name != "sheared"])
@pytest.mark.parametrize("plane", ["axial", "coronal", "sagittal", ((0.3, -1.0, 0.4), (0.1, 0.2, 1.0))])
@pytest.mark.parametrize("interpolation", ["nearest", "linear"])
def test_values_are_those_that_simpleitk_finds_at_the_pixels(
    lattice: str, plane: Any, interpolation: str
) -> None:
    volume = volviz.Volume(ARRAY, **LATTICES[lattice])
    image = volviz.slice_image(volume, plane, size=(24, 20), interpolation=interpolation, dtype="float32")
    points = volviz.plane_points(volume, plane, size=(24, 20))
    assert image.shape == (20, 24)
    assert points.shape == (20, 24, 3)
    other = as_sitk(volume)
    kind = SimpleITK.sitkNearestNeighbor if interpolation == "nearest" else SimpleITK.sitkLinear
    compared = 0
    for value, point in zip(image.ravel(), points.reshape(-1, 3), strict=True):
        index = np.array(other.TransformPhysicalPointToContinuousIndex(point.tolist()))
        if np.isfinite(value):
            if np.abs(index - np.floor(index) - 0.5).min() > 1e-3:
                expected = other.EvaluateAtContinuousIndex(index.tolist(), kind)
                assert value == pytest.approx(expected, abs=1e-5)
                compared += 1
        else:
            assert np.any(index < -0.5 + 1e-6) or np.any(index > np.array(volume.dimensions) - 0.5 - 1e-6)
    assert compared > 100


def test_a_sheared_lattice_is_sampled_where_its_voxels_lie() -> None:
    volume = volviz.Volume(ARRAY, **LATTICES["sheared"])
    for voxel in ((4, 5, 6), (0, 0, 0), (12, 10, 8)):
        at = (volume.index_to_world @ [*voxel, 1.0])[:3]
        value = volviz.slice_image(volume, "coronal", at=at, size=(1, 1), extent=0.01, dtype="float32")
        assert value[0, 0] == pytest.approx(ARRAY[voxel[::-1]], abs=1e-3)


def test_cubic_interpolation_passes_through_the_voxels_and_is_smooth() -> None:
    z, y, x = np.meshgrid(*(np.arange(n, dtype=float) for n in (16, 17, 18)), indexing="ij")
    volume = volviz.Volume(np.sin(0.5 * x) * np.cos(0.4 * y) + 0.3 * np.sin(0.6 * z))
    size = (4 * 18 - 4, 4 * 17 - 4)

    def error(interpolation: Any) -> float:
        asked = {"at": (8.3, 8.1, 7.4), "size": size, "extent": (8.0, 8.0)}
        got = volviz.slice_image(volume, "axial", interpolation=interpolation, dtype="float32", **asked)
        px, py, pz = np.moveaxis(volviz.plane_points(volume, "axial", **asked), -1, 0)
        return float(np.abs(got - (np.sin(0.5 * px) * np.cos(0.4 * py) + 0.3 * np.sin(0.6 * pz))).max())

    assert error("cubic") < 0.1 * error("linear") < error("nearest")
    same = volviz.slice_image(
        volume, at=7.0, extent=(18, 17), size=(18, 17), interpolation="cubic", dtype="float32"
    )
    assert np.abs(same - volume.array[7]).max() < 1e-6


@pytest.mark.parametrize("mode", ["mean", "maximum", "minimum"])
def test_slabs_are_what_numpy_makes_of_their_planes(mode: Any) -> None:
    volume = volviz.Volume(ARRAY)
    slab = volviz.slice_image(
        volume, "axial", at=4.0, slab=4.0, mode=mode, size=(13, 11), extent=(13, 11), dtype="float32"
    )
    weights = np.arange(8) * 0.5 + 2.25
    planes = [ARRAY[int(k)] * (1 - k % 1) + ARRAY[int(k) + 1] * (k % 1) for k in weights.astype(np.float64)]
    expected = {"mean": np.mean, "maximum": np.max, "minimum": np.min}[mode](planes, axis=0)
    assert np.abs(slab - expected).max() < 1e-5
    # beyond the volume nothing counts
    edge = volviz.slice_image(
        volume, "axial", at=8.0, slab=6.0, mode=mode, size=(13, 11), extent=(13, 11), dtype="float32"
    )
    assert np.isfinite(edge).all()


def test_numbers_place_planes_by_the_world_axis_and_points_by_themselves() -> None:
    volume = volviz.Volume(ARRAY, spacing=(1.0, 2.0, 3.0), origin=(100.0, -50.0, 7.0))
    for name, axis in (("axial", 2), ("coronal", 1), ("sagittal", 0)):
        at = volume.center[axis] + 1.0
        assert np.allclose(volviz.plane_points(volume, name, at=at)[..., axis], at)
    plane = ((1.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    points = volviz.plane_points(volume, plane, at=30.0)
    assert np.allclose(points @ np.array([1.0, 1.0, 0.0]) / np.sqrt(2), 30.0)
    around = volviz.plane_points(volume, "axial", at=(103.0, -44.0, 10.0), extent=4.0, size=(41, 21))
    assert np.allclose(around[10, 20], (103.0, -44.0, 10.0))
    assert np.allclose(around[10, -1] - around[10, 0], (4.0 * 40 / 41, 0.0, 0.0))
    # the front is at the top of an axial slice, the head at the top of the others
    assert around[0, 0, 1] < around[-1, 0, 1]
    assert (
        volviz.plane_points(volume, "sagittal")[0, 0, 2] > volviz.plane_points(volume, "sagittal")[-1, 0, 2]
    )


def test_windows_functions_and_layers_colour_slices() -> None:
    volume = volviz.Volume(np.broadcast_to(np.arange(13.0), (9, 11, 13)))
    asked = {"size": (13, 11), "extent": (13, 11), "at": 4.0}
    grey = volviz.slice_image(volume, window=(2, 10), **asked)
    assert grey.dtype == np.uint8
    assert grey[5, :, 0].tolist() == [round(255 * min(max((v - 2) / 8, 0), 1)) for v in range(13)]
    assert (grey[..., 3] == 255).all()
    function = volviz.TransferFunction.from_points(
        [(0.0, (1.0, 0.0, 0.0, 0.1)), (12.0, (0.0, 0.0, 1.0, 0.1))]
    )
    colors = volviz.slice_image(volume, transfer_function=function, dtype="float32", **asked)
    assert np.allclose(colors[5, 6], (0.5, 0.0, 0.5, 1.0))
    labels = np.zeros((9, 11, 13), np.uint8)
    labels[:, :, 6:] = 3
    layers = [
        volviz.ImageLayer(volume, window=(0, 12)),
        volviz.LabelLayer(volviz.Volume(labels), {3: (0.0, 1.0, 0.0)}, opacity=0.25),
    ]
    both = volviz.slice_image(layers, dtype="float32", **asked)
    assert np.allclose(both[5, 3, :3], 3 / 12, atol=1e-6)
    assert np.allclose(both[5, 9, :3], (0.75 * 9 / 12, 0.25 + 0.75 * 9 / 12, 0.75 * 9 / 12), atol=1e-6)
    moved = np.eye(4)
    moved[0, 3] = 100.0
    shifted = volviz.slice_image(volviz.ImageLayer(volume, transform=moved), dtype="float32", **asked)
    assert np.array_equal(shifted, volviz.slice_image(volume, dtype="float32", **asked))


def test_what_cannot_be_cut_is_refused_in_words() -> None:
    volume = volviz.Volume(ARRAY)
    for arguments, words in (
        ({"plane": "lateral"}, "there is no plane 'lateral'"),
        ({"plane": ((0, 0, 1), (0, 0, 2))}, "two directions that differ"),
        ({"plane": ((0, 0, 0), (0, 0, 2))}, "two directions that differ"),
        ({"at": "middle"}, "at must be a number"),
        ({"extent": 0.0}, "extent must be a width"),
        ({"slab": -1.0}, "slab must be a thickness"),
        ({"mode": "median"}, "mode of a slab"),
        ({"interpolation": "sinc"}, "interpolation must be"),
        ({"window": (3, 3)}, "window must be two numbers"),
    ):
        with pytest.raises(InputError, match=words):
            volviz.slice_image(volume, **arguments)
    with pytest.raises(InputError, match="compositing needs colours"):
        volviz.slice_image(volume, mode="composite", dtype="float32")


def test_a_voxel_that_is_no_number_is_not_shown_and_spares_its_neighbours() -> None:
    array = np.ones((4, 4, 4), np.float32)
    array[1, 2, 2] = np.nan
    asked: dict[str, Any] = {"size": (4, 4), "extent": (4, 4), "dtype": "float32"}
    here = volviz.slice_image(volviz.Volume(array), at=1.0, **asked)
    assert np.isnan(here[2, 2])
    assert np.isnan(here).sum() == 1
    assert np.isfinite(volviz.slice_image(volviz.Volume(array), at=0.0, **asked)).all()


def test_planes_have_perpendicular_directions() -> None:
    plane = slice_plane(((0, -2, 0), (0, 5, 3)), None, (1.0, 2.0, 3.0))
    assert plane.normal == (0.0, -1.0, 0.0)
    assert plane.up == (0.0, 0.0, 1.0)
    assert plane.right == (1.0, 0.0, 0.0)
    assert plane.point == (1.0, 2.0, 3.0)


def test_the_command_line_places_slices(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "a.npy"
    command = ["render", "sample:sphere", "-o", str(out), "--size", "40x40"]
    for words, message in (
        (["--plane", "lateral"], "--plane takes axial"),
        (["--at", "4 parsec"], "knows the units"),
        (["--slab", "3:median"], "max, min, mean or composite"),
        (["-t", "raycast", "--at", "3"], "go with -t slice"),
    ):
        assert main([*command, *words]) == 2
        assert message in capsys.readouterr().err
