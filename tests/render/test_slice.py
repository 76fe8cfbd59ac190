"""Slices drawn with OpenGL against the float64 resampling: every interpolation, slab and colouring, at any angle."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import volviz
from tests.render.scenes import LEFT_HANDED, OBLIQUE, camera, function, volume
from volviz.compare.convergence import oracle_scene
from volviz.custom_gl.arguments import spec_of
from volviz.custom_gl.picking import Sight
from volviz.custom_gl.registry import technique
from volviz.custom_gl.settings import common_settings
from volviz.model.render_spec import View
from volviz.reference.surface_pick import PixelRay

SIZE = (72, 64)
MAX_ERROR = 1 / 255
FACES = (-0.5, 34.5, -0.5, 31.5, -0.5, 26.5)


def both(of: volviz.Volume, view: volviz.Camera, **values: Any) -> tuple[Any, Any]:
    """Our image and the oracle's, premultiplied, and without pixels that lie on an edge in either."""
    spec = spec_of(of, "slice", transfer_function=function(of), **values)
    ours = volviz.render(
        of, "slice", transfer_function=function(of), size=SIZE, camera=view, dtype="float32", **values
    ).astype(float)
    ours[..., :3] *= ours[..., 3:]
    info = technique("slice")
    assert info.oracle is not None
    exact = info.oracle(oracle_scene(spec, View(view, SIZE), spec.settings.step), spec.settings)
    return ours, exact


def assert_like_the_oracle(of: volviz.Volume, view: volviz.Camera, **values: Any) -> None:
    ours, exact = both(of, view, **values)
    assert (exact[..., 3] > 0).mean() > 0.05, "the scene is empty and proves nothing"
    wrong = np.abs(ours - exact).max(axis=2) > MAX_ERROR
    # edges of polygons, and lines where two planes meet, may fall on either side of a pixel's centre
    edges = np.zeros_like(wrong)
    for axis in (0, 1):
        step = np.abs(np.diff(exact, axis=axis)).max(axis=2) > 0.05
        edges |= np.pad(step, [(0, 1 - axis), (0, axis)]) | np.pad(step, [(1 - axis, 0), (axis, 0)])
    assert not np.any(wrong & ~edges)
    assert wrong.mean() < 0.01


@pytest.mark.parametrize("plane", ["axial", "coronal", "sagittal", "orthogonal", "oblique"])
def test_planes_lie_where_the_oracle_has_them(plane: str) -> None:
    of = volume(np.int16, spacing=(1.0, 1.3, 0.8), origin=(5.0, -20.0, 40.0), direction=OBLIQUE)
    assert_like_the_oracle(of, camera(of), plane=plane, normal=(0.3, -1.0, 0.5), point=(12.0, 6.0, 51.0))


@pytest.mark.parametrize("interpolation", ["nearest", "linear", "cubic"])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_every_interpolation_is_that_of_the_oracle(interpolation: str, dtype: Any) -> None:
    of = volume(dtype, spacing=(1.0, 1.1, 2.0), direction=LEFT_HANDED)
    assert_like_the_oracle(
        of, camera(of), plane="oblique", normal=(0.2, -1.0, 0.7), interpolation=interpolation
    )


@pytest.mark.parametrize("mode", ["mean", "maximum", "minimum", "composite"])
@pytest.mark.parametrize("coloring", ["window", "function"])
def test_every_slab_is_that_of_the_oracle(mode: str, coloring: str) -> None:
    of = volume(spacing=(1.0, 1.2, 0.9))
    values = {"plane": "coronal", "slab": 7.3, "slab_mode": mode, "coloring": coloring}
    assert_like_the_oracle(of, camera(of), **values)
    # seen from behind, what was in front is behind
    assert_like_the_oracle(of, camera(of, azimuth=170.0), **values)


def test_crop_box_and_clip_planes_cut_slices() -> None:
    of = volume(np.int16, spacing=(1.0, 1.1, 0.9))
    x, y, z = of.center
    assert_like_the_oracle(
        of,
        camera(of),
        crop=(4, 30, 0, 31, 3.5, 20),
        clip_planes=[((x + 3, y, z), (-1.0, 0.2, 0.1))],
        slab=3.0,
    )


def test_a_single_plane_is_faced_and_shows_its_outermost_voxels_whole() -> None:
    of = volume(spacing=(1.0, 1.0, 1.0))
    image = volviz.render(of, "slice", plane="axial", size=(100, 80), interpolation="nearest")
    seen = image[..., 3] > 0
    rows, columns = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
    assert seen[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1].all(), "a rectangle, not a slanted view"
    # 35 x 32 voxels, square
    assert len(columns) / len(rows) == pytest.approx(35 / 32, abs=0.03)
    # patient's left, +x, is on the right, and the front, -y, is at the top
    middle = of.array[13, :, :].astype(float)
    across = image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1, 0].astype(float)
    coarse = across[
        np.linspace(0, len(rows) - 1, 16).round().astype(int)[:, None],
        np.linspace(0, len(columns) - 1, 16).astype(int),
    ]
    expected = middle[np.linspace(0, 31, 16).round().astype(int)[:, None], np.linspace(0, 34, 16).astype(int)]
    assert np.corrcoef(coarse.ravel(), expected.ravel())[0, 1] > 0.98


def test_a_slice_is_picked_where_it_is_seen() -> None:
    of = volume(np.int16, spacing=(1.0, 1.1, 0.9))
    info = technique("slice")
    assert info.pick is not None
    settings = info.settings(plane="axial")
    x, y, z = of.center
    ray = PixelRay(np.array([x + 2, y - 3, z + 50.0]), np.array([0.0, 0.0, -1.0]), 200.0)
    sight = Sight(of, function(of), settings, common_settings(settings), ray, (0, 34, 0, 31, 0, 26))
    picked = info.pick(sight)
    assert picked is not None
    assert picked.position == pytest.approx((x + 2, y - 3, z))
    assert picked.value == pytest.approx(of.value_at(picked.position), abs=2000)
    behind = ((x, y, z - 1), (0.0, 0.0, -1.0))
    assert (
        info.pick(Sight(of, function(of), settings, common_settings(settings), ray, FACES, [behind])) is None
    )
