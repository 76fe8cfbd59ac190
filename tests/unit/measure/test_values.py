"""What is measured where the answer is known exactly."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import nibabel
import numpy as np
import pytest

import volviz
from volviz import measure
from volviz.errors import InputError
from volviz.measure.readings import value_at
from volviz.volume_data.volume import Volume


@pytest.fixture
def volume() -> Volume:
    """Values 100 x + 10 y + z by index, spacings 1, 2 and 3, as a file in micrometres gives them."""
    k, j, i = np.meshgrid(*(np.arange(n) for n in (7, 8, 9)), indexing="ij")
    array = (100 * i + 10 * j + k).astype(np.int16)
    return Volume(array, (1.0, 2.0, 3.0), unit="HU", name="ramp", metadata={"length_unit": "µm"})


def test_exact_points_give_exact_numbers() -> None:
    assert volviz.measure.distance((0, 0, 0), (3, 4, 12)) == measure.Measured(13.0, "mm", 0.0)
    assert measure.polyline([(0, 0, 0), (3, 0, 0), (3, 4, 0)]).value == 7.0
    assert measure.angle((1, 0, 0), (0, 0, 0), (0, 2, 0)).value == pytest.approx(90.0)
    square = measure.area([(0, 0, 5), (2, 0, 5), (2, 3, 5), (0, 3, 5)])
    assert (square.value, square.unit, square.perimeter.value) == (pytest.approx(6.0), "mm²", 10.0)
    round_one = measure.ellipse((0, 0, 0), (2, 0, 0), (0.5, 1, 0))
    assert round_one.value == pytest.approx(2 * np.pi)
    # Ramanujan's second approximation, right to nine digits here
    assert round_one.perimeter.value == pytest.approx(9.688448220, rel=1e-7)


def test_the_unit_is_that_of_the_file_and_a_voxel_the_doubt_of_a_placed_point(volume: Volume) -> None:
    along_z = measure.distance((1, 2, 3), (1, 2, 9), volume)
    assert along_z.unit == "µm"
    assert along_z.error == pytest.approx(1.96 * 3.0 * np.sqrt(2 / 12))
    assert str(along_z) == "6.0 ± 2.4 µm"


def test_statistics_are_those_of_the_voxels_whose_centres_lie_inside(volume: Volume) -> None:
    corners = [(1.5, 1.0, 6.0), (4.5, 1.0, 6.0), (4.5, 7.0, 6.0), (1.5, 7.0, 6.0)]
    (found,) = measure.area(corners, volume).statistics
    inside = volume.array[2, 1:4, 2:5]
    assert (found.voxels, found.minimum, found.maximum) == (9, inside.min(), inside.max())
    assert (found.mean.value, found.mean.unit, found.median) == (inside.mean(), "HU", np.median(inside))
    assert found.deviation == pytest.approx(inside.std(ddof=1))


def test_a_profile_of_a_ramp_is_a_ramp_and_its_table_says_so(volume: Volume) -> None:
    found = measure.profile((0, 2, 3), (8, 2, 3), volume, samples=17)
    np.testing.assert_allclose(found.values[0], 100 * found.distance + 11)
    rows = list(csv.reader(io.StringIO(found.to_csv())))
    assert rows[0] == ["distance (µm)", "x (µm)", "y (µm)", "z (µm)", "ramp (HU)", "error of ramp (HU)"]
    assert [float(v) for v in rows[2][:5]] == [0.5, 0.5, 2.0, 3.0, 61.0]


def test_a_crop_box_counts_voxels_by_their_part(volume: Volume) -> None:
    assert measure.threshold_volume(volume, -np.inf).value == 9 * 8 * 7 * 6.0
    cut = measure.threshold_volume(volume, -np.inf, crop=(2.0, 4.0, 0.0, 7.0, 0.0, 6.0))
    assert cut.value == pytest.approx(2 * 8 * 7 * 6.0)


def test_rules_in_three_dimensions_say_what_they_found() -> None:
    array = np.zeros((12, 12, 12), np.uint8)
    array[4:8, 4:8, 4:8] = 3
    array[5, 5, 6] = 9
    labels = Volume(array)
    ray = ((-5.0, 5.0, 5.0), (1.0, 0.0, 0.0))
    label = measure.label_point(labels, *ray)
    assert (label.rule, label.number, label.position) == ("label", 3, pytest.approx((3.5, 5.0, 5.0)))
    highest = measure.maximum_point(labels, *ray)
    assert (highest.rule, highest.number, highest.position) == ("maximum", 9, pytest.approx((6.0, 5.0, 5.0)))
    opaque = volviz.TransferFunction.from_points([(1.0, (1, 1, 1, 0.0)), (2.0, (1, 1, 1, 1.0))])
    arrived = measure.opacity_point(labels, *ray, opaque)
    assert (arrived.rule, arrived.position[0]) == ("opacity", pytest.approx(3.5, abs=arrived.error))
    assert measure.isovalue_point(labels, (-5.0, 0.0, 0.0), (1.0, 0.0, 0.0), 1.5) is None


def test_parts_of_a_surface_are_measured_one_by_one() -> None:
    z, y, x = np.mgrid[:24, :24, :40].astype(float)
    balls = [np.hypot(np.hypot(x - at, y - 12), z - 12) - r for at, r in ((10, 7), (29, 5))]
    volume = Volume(np.clip(-np.minimum(*balls), -2, 2).astype(np.float32))
    large, small = (4 / 3 * np.pi * r**3 for r in (7, 5))
    for part, true in (("all", large + small), ("largest", large), ((29.0, 12.0, 17.0), small)):
        found = measure.isosurface_volume(volume, 0.0, part=part)
        assert abs(found.value - true) < found.error < 0.25 * true
    wider = measure.isosurface_volume(volume, 0.0, isovalue_error=0.5)
    assert wider.error > measure.isosurface_volume(volume, 0.0).error


@pytest.mark.parametrize(
    "affine",
    [
        [[-2.0, 0.0, 0.0, 90.0], [0.0, 0.5, 0.0, -40.0], [0.0, 0.0, 3.0, 7.0]],
        [[1.2, 0.3, 0.0, 5.0], [-0.4, 0.9, 0.0, 2.0], [0.0, 0.0, -2.5, 60.0]],
        [[1.0, 0.08, 0.0, -3.0], [0.0, 1.0, 0.05, 8.0], [0.0, 0.0, 1.5, 1.0]],
    ],
    ids=["anisotropic, left-handed", "oblique", "sheared"],
)
def test_places_and_lengths_are_those_of_nibabel(affine: list[list[float]], tmp_path: Path) -> None:
    matrix = np.array([*affine, [0.0, 0.0, 0.0, 1.0]])
    values = np.random.default_rng(2).integers(0, 1000, (11, 12, 13)).astype(np.int16)
    path = tmp_path / "lattice.nii"
    nibabel.Nifti1Image(values, matrix).to_filename(path)
    volume = volviz.load(path)
    voxels = np.array([[2, 3, 4], [9, 8, 1]])
    places = nibabel.affines.apply_affine(nibabel.load(path).affine, voxels)
    # from the axes of NIfTI (right, front) to those of the world here (left, back)
    world = places * (-1.0, -1.0, 1.0)
    for place, (i, j, k) in zip(world, voxels, strict=True):
        assert value_at(measure.Point(tuple(place)), volume).value == pytest.approx(values[i, j, k])
    found = measure.distance(*world, volume)
    assert found.value == pytest.approx(np.linalg.norm(places[1] - places[0]), rel=1e-6)
    (labelled,) = measure.label_volumes(
        Volume((volume.array > 500).astype(np.uint8), volume.spacing, volume.origin, volume.direction)
    ).values()
    assert labelled.value == pytest.approx(
        (values > 500).sum() * abs(np.linalg.det(matrix[:3, :3])), rel=1e-6
    )


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda v: measure.angle((0, 0, 0), (0, 0, 0), (1, 0, 0)), "not its vertex"),
        (lambda v: measure.area([(0, 0, 0), (3, 3, 0), (3, 0, 0), (0, 1, 0)]), "cross each other"),
        (lambda v: measure.area([(0, 0, 0), (1, 1, 0), (2, 2, 0)]), "on one line"),
        (lambda v: measure.isosurface_volume(v, 5000.0), "no surface"),
        (lambda v: measure.threshold_volume(v, 2.0, 1.0), "low <= high"),
        (lambda v: measure.profile((1, 1, 1), (1, 1, 1), v), "one point"),
        (lambda v: measure.label_volumes(Volume(np.full((2, 2, 2), 0.5))), "whole numbers"),
    ],
)
def test_what_cannot_be_measured_is_said(volume: Volume, wrong, words: str) -> None:
    with pytest.raises(InputError, match=words):
        wrong(volume)
