"""Looks: each kind of data gets the ones that show what it is looked at for."""

from __future__ import annotations

import numpy as np
import pytest

from tests.unit.transfer.unseen import FEATURELESS, UNSEEN, ct, microscopy, radius
from volviz.custom_gl.registry import technique
from volviz.errors import InputError
from volviz.model.looks.choice import best_look, look_named, looks
from volviz.model.parameters import make_settings
from volviz.volume_data.volume import Volume


@pytest.mark.parametrize("name", [*UNSEEN, *FEATURELESS])
def test_every_volume_has_looks_that_its_techniques_take(name: str) -> None:
    volume = {**UNSEEN, **FEATURELESS}[name]()
    found = looks(volume)
    low, high = volume.data_range
    assert len(found) in ((1,) if low == high else (4, 5, 6))
    for ident, look in found.items():
        assert look.id == ident
        assert look.label
        assert look.description.endswith(".")
        info = technique(look.technique)
        make_settings(info.settings, look.settings, owner=info.id)
        assert max(point.opacity for point in look.transfer_function.points) > 0


def test_ct_shows_bone_at_once_with_or_without_its_rescale_intercept() -> None:
    for volume, offset in ((ct(), 0.0), (ct("int16", 1024.0, "", 0.0), 1024.0)):
        found = looks(volume)
        assert {"bone", "tissue", "skin", "x-ray"} <= found.keys()
        bone = best_look(volume)
        assert bone.id == "bone"
        values = np.array([-1000.0, 40.0, 900.0]) + offset
        air, muscle, skull = bone.transfer_function.evaluate(values, volume.range)[:, 3]
        assert air == muscle == 0.0
        assert skull > 0.5


def test_ct_without_bone_shows_tissue() -> None:
    values = np.where(radius() < 0.8, 40.0, -1000.0).astype(np.int16)
    found = looks(Volume(values, unit="HU"))
    assert next(iter(found)) == "tissue"
    assert "bone" not in found


def test_a_distance_field_shows_its_surface_at_zero() -> None:
    for sign in (1, -1):
        found = looks(Volume((sign * (radius() - 0.6)).astype(np.float32)))
        first = next(iter(found.values()))
        assert first.technique == "isosurface"
        assert first.settings["isovalues"] == (0.0,)
        assert 0.0 in found["shells"].settings["isovalues"]


def test_a_field_without_borders_shows_nested_surfaces() -> None:
    first = best_look(Volume(np.exp(-4 * radius() ** 2).astype(np.float32)))
    assert first.id == "shells"
    values = first.settings["isovalues"]
    assert len(values) == 4
    assert list(values) == sorted(values)


def test_a_steep_field_shows_one_surface_and_grain_is_no_field() -> None:
    z, y, x = np.indices((40, 40, 40)) / 39.0
    ripples = (z + 0.25 * np.sin(40 * x) * np.sin(40 * y)).astype(np.float32)
    first = best_look(Volume(ripples))
    assert (first.id, first.technique) == ("surface", "isosurface")
    grain = np.random.default_rng(0).uniform(-0.2, 0.2, ripples.shape)
    assert "cloud" not in looks(Volume(ripples + grain))


def test_a_mask_shows_its_surface_halfway() -> None:
    first = best_look(Volume(np.where(radius() < 0.5, 7, 0).astype(np.uint8)))
    assert (first.id, first.settings["isovalues"]) == ("surface", (3.5,))


def test_labels_keep_colours_of_their_own() -> None:
    values = np.digitize(radius(), (0.2, 0.4, 0.6, 0.8))
    first = best_look(Volume(np.array([1, 2, 3, 4, 0], np.uint8)[values]))
    assert first.id == "labels"
    assert first.settings["interpolation"] == "nearest"


def head(litres: float, *, lopsided: bool = False) -> Volume:
    """A noisy ellipsoid of so much tissue in the frame of a patient."""
    spacing = 4.0
    axis = (np.arange(N) - N / 2) * spacing
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    size = (litres * 1e6 / (4 / 3 * np.pi * 0.8)) ** (1 / 3)
    r = np.sqrt((x / (0.8 * size)) ** 2 + (y / size) ** 2 + (z / size) ** 2)
    values = np.where(r < 1, 120 - 40 * (r > 0.9), 0) + np.random.default_rng(0).normal(0, 2, r.shape)
    if lopsided:
        values[:, :, : N // 2] = 0
    return Volume(values.clip(0).astype(np.uint8), (spacing,) * 3, metadata={"length_unit": "mm"})


N = 60


def test_size_and_symmetry_tell_a_head_from_a_brain_and_both_from_things() -> None:
    assert best_look(head(1.4)).id == "brain"
    assert best_look(head(3.6)).id == "skin"
    assert best_look(head(1.4, lopsided=True)).id == "surface"
    small = head(3.6)
    assert best_look(Volume(small.array, (0.1,) * 3, metadata={"length_unit": "mm"})).id == "surface"


def test_dark_things_on_a_bright_ground_show_their_surface() -> None:
    volume = UNSEEN["bright background"]()
    first = best_look(volume)
    middle = volume.array[N // 2, N // 2, N // 2]
    corner = volume.array[0, 0, 0]
    inside, outside = first.transfer_function.evaluate(np.array([middle, corner], float), volume.range)[:, 3]
    assert inside > 0.3
    assert outside == 0.0


def test_matter_that_fills_the_box_shows_its_inside_and_few_slices_a_picture() -> None:
    # cells with dark walls, from face to face
    i, j, k = np.indices((40, 40, 40))
    walls = (np.minimum(np.minimum(i % 8, j % 8), k % 8) == 0) & (i > 1)
    grain = np.random.default_rng(1).normal(0, 12, walls.shape)
    assert best_look(Volume((np.where(walls, 60, 180) + grain).astype(np.uint8))).id == "inside"
    assert best_look(Volume(microscopy(100, 8, 0.02).array[25:31])).id == "brightest"


def test_a_look_that_is_not_there_is_refused_with_those_that_are() -> None:
    with pytest.raises(InputError, match=r"no look 'vein'; there are best, bone"):
        look_named(ct(), "vein")
    assert look_named(ct(), "best").id == "bone"
