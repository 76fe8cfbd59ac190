"""Images of presets on the user's own data."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from volviz.model.transfer.presets import preset, preset_for
from volviz.volume_data.orientation import direction_of
from volviz.volume_data.volume import Volume
from volviz_ui.transfer_editor.thumbnails import ASPECT, SIDE, coarse_copy, drawn, drawn_with, framed


@pytest.fixture(scope="module")
def shells() -> Volume:
    """A dense ball in a thin one, off the middle, in anisotropic voxels."""
    z, y, x = np.indices((20, 40, 40), float)
    r = np.sqrt((2 * (z - 9)) ** 2 + (y - 19) ** 2 + (x - 14) ** 2)
    return Volume(np.where(r < 6, 220, np.where(r < 13, 90, 0)).astype(np.uint8), spacing=(1.0, 1.0, 2.0))


def test_a_preset_with_ray_casting_looks_like_the_plain_picture(shells: Volume) -> None:
    chosen = replace(preset("mri"), technique="raycast", settings={})
    function, coarse = preset_for(chosen, shells), coarse_copy(shells)
    plain, cast = drawn(coarse, function, shells), drawn_with(chosen, coarse, function, shells)
    assert cast.shape == plain.shape == (coarse.shape[0], coarse.shape[2], 3)
    assert max(cast.shape) == pytest.approx(SIDE, abs=2)
    # the plain image blends whole cells, the oracle's interpolates between them
    assert np.abs(cast - plain).mean() < 0.03
    assert plain.std() > 0.05


@pytest.mark.parametrize(
    ("technique", "settings"),
    [
        ("raycast", {"mode": "maximum"}),
        ("slicing", {"shading": True}),
        ("two_pass_raycast", {"preintegrated": True, "gradient_opacity": 0.8}),
        ("isosurface", {"isovalues": (60.0,)}),
        ("marching_cubes", {}),
        ("half_angle", {}),
    ],
)
def test_techniques_and_their_settings_change_the_picture(
    shells: Volume, technique: str, settings: dict[str, object]
) -> None:
    chosen = replace(preset("mri"), technique=technique, settings=settings)
    function, coarse = preset_for(chosen, shells), coarse_copy(shells)
    image = drawn_with(chosen, coarse, function, shells)
    assert image.min() >= 0
    assert image.max() <= 1
    # the ball is there, left of the middle, and the corners show the background
    weight = np.abs(image - image[0, 0]).sum(axis=-1)
    assert np.average(np.arange(weight.shape[1]), weights=weight.sum(axis=0)) < 0.47 * weight.shape[1]
    assert np.abs(image - drawn(coarse, function, shells)).mean() > 0.003


def test_the_copy_faces_as_the_first_view_does_however_the_voxels_lie() -> None:
    # as many voxels as there are cells
    values = np.arange(50 * 60 * (SIDE + 1), dtype=np.float32).reshape(50, 60, SIDE + 1)
    straight = coarse_copy(Volume(values))
    for code in ("RPS", "LIA", "ASL"):
        # the same voxels in another order
        to_index = direction_of(code).T.astype(int)
        order = [2 - int(np.flatnonzero(to_index[2 - axis])[0]) for axis in range(3)]
        stored = values.transpose(order)
        stored = np.flip(stored, [axis for axis in range(3) if to_index[2 - axis].sum() < 0])
        assert np.array_equal(coarse_copy(Volume(stored, direction=direction_of(code))), straight)


def test_an_unknown_technique_has_no_picture_of_its_own(shells: Volume) -> None:
    chosen = replace(preset("mri"), technique="nowhere")
    assert drawn_with(chosen, coarse_copy(shells), preset_for(chosen, shells), shells) is None


def test_a_stack_of_few_slices_is_seen_from_the_front() -> None:
    data = np.zeros((4, 60, 60), np.uint8)
    data[:, 5:15, 40:50] = 200
    stack = Volume(data)
    for technique in (None, "raycast"):
        chosen = replace(preset("mri"), technique=technique)
        function, coarse = preset_for(chosen, stack), coarse_copy(stack)
        image = (
            drawn(coarse, function, stack)
            if technique is None
            else drawn_with(chosen, coarse, function, stack)
        )
        rows, columns = np.nonzero(np.abs(image - image[-1, 0]).sum(axis=-1) > 0.1)
        # the first rows of a slice are at the top, as microscopes and scanners show them
        assert rows.mean() < 0.3 * image.shape[0]
        assert columns.mean() > 0.6 * image.shape[1]
        frame = framed(image)
        assert frame.shape[1] / frame.shape[0] == pytest.approx(ASPECT, rel=0.03)
        assert frame.sum() == pytest.approx(
            image.sum() + (frame.size - image.size) / 3 * sum(frame[0, 0]), rel=1e-6
        )
