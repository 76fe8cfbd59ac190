"""The isovalue of data nobody has seen."""

from __future__ import annotations

import gc
import weakref

import numpy as np
import pytest

from volviz.model.auto_isovalue import auto_isovalue
from volviz.volume_data.volume import Volume


def ball(inside, outside, noise=0.0, radius=9.0):
    """A ball in the middle of 40 voxels an axis, its border three voxels wide."""
    distance = np.sqrt(((np.indices((40, 40, 40)) - 19.5) ** 2).sum(axis=0))
    field = outside + (inside - outside) * np.clip((radius + 1.5 - distance) / 3.0, 0.0, 1.0)
    return field + np.random.default_rng(2).normal(0.0, noise, field.shape)


@pytest.mark.parametrize("radius", [3.0, 9.0, 19.0])
@pytest.mark.parametrize("noise", [0.0, 20.0])
def test_it_lies_well_between_object_and_surroundings(radius, noise):
    found = auto_isovalue(Volume(ball(900.0, 100.0, noise, radius)))
    assert 250.0 < found < 750.0


def test_dark_objects_on_a_bright_background_are_found_as_well():
    assert 60.0 < auto_isovalue(Volume(ball(20, 230, 5.0).clip(0, 255).astype(np.uint8))) < 190.0


def test_air_and_outliers_do_not_decide():
    field = ball(400.0, 0.0, 5.0)
    field[0, 0, 0] = 1e6
    assert 100.0 < auto_isovalue(Volume(field)) < 300.0


def test_a_mask_is_cut_in_its_middle():
    assert auto_isovalue(Volume(ball(1.0, 0.0) > 0.5)) == pytest.approx(0.5, abs=0.01)


def test_a_constant_volume_gives_its_value():
    assert auto_isovalue(Volume(np.full((4, 5, 6), 7.0))) == 7.0


def test_volumes_without_finite_values_give_a_number():
    assert auto_isovalue(Volume(np.full((4, 5, 6), np.nan))) == 0.0


def test_a_volume_is_not_kept_alive_by_what_is_known_of_it():
    volume = Volume(ball(1.0, 0.0))
    known = weakref.ref(volume)
    assert auto_isovalue(volume) == auto_isovalue(volume)
    del volume
    gc.collect()
    assert known() is None
