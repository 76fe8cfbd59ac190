"""One ray of the oracle against the oracle's whole image, and why rays begin and end."""

from __future__ import annotations

import numpy as np
import pytest

from tests.unit.kernels.cameras import look_at, orthographic
from tests.unit.kernels.scenes import colorful_table, scene, smooth_field
from tests.unit.kernels.test_reference import OPTIONS, in_scene_units
from volviz.kernels.preintegration import extinction_sums
from volviz.reference.image import Shading, reference_render
from volviz.reference.ray_profile import (
    Lattice,
    Optics,
    RayProfile,
    RaySpan,
    pixel_noise,
    ray_pieces,
    ray_profile,
    ray_span,
    slice_pieces,
)

RANGE = (-150.0, 650.0)


def by_table(table, value_range):
    places = np.linspace(*value_range, len(table))
    return lambda values, _gradients: np.column_stack(
        [np.interp(values, places, table[:, c]) for c in range(4)]
    )


def profile_of(array, matrix, camera, pixel, table, options) -> RayProfile:
    """The profile for the arguments that `reference_render` takes."""
    o = dict(options)
    span = ray_span(
        array.shape,
        matrix,
        **camera,
        pixel=pixel,
        crop=o.pop("crop", None),
        clip_planes=o.pop("clip_planes", ()),
    )
    shading = o.get("shading")
    first = o.pop("first_sample", 0.5)
    extinction = extinction_sums(table) if o.pop("preintegrated", False) else None
    nearest = o.pop("interpolation", "linear") == "nearest"
    delta = shading.gradient_delta if shading is not None else 1.0
    optics = Optics(
        by_table(table, RANGE), unit_distance=o.pop("unit_distance", 1.3), extinction=extinction,
        extinction_range=RANGE, **o,
    )  # fmt: skip
    lattice = Lattice(array, matrix, *RANGE, nearest, delta)
    return ray_profile(lattice, span, ray_pieces(span, 0.73, first), optics)


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize(
    "options",
    [
        *OPTIONS,
        {"preintegrated": True},
        {"preintegrated": True, "gradient_opacity": 0.7, "gradient_reference": 0.2, "shading": Shading()},
    ],
    ids=lambda o: "-".join(f"{k}={v}" for k, v in o.items())[:50] if isinstance(o, dict) else None,
)
def test_the_last_accumulated_colour_is_the_pixel_of_the_oracle(options, parallel):
    array, table = smooth_field() * 900 - 200, colorful_table()
    geometry, camera, matrix = scene(parallel=parallel)
    o = in_scene_units(options, matrix)
    image = reference_render(
        array, **geometry, **camera, table=table, value_range=RANGE, step_world=0.73, **o
    )
    assert (image[..., 3] > 0.02).sum() > 10
    width, height = camera["size"]
    for row in range(height):
        for column in range(width):
            profile = profile_of(array, matrix, camera, (column, row), table, o)
            np.testing.assert_allclose(profile.color, image[row, column], atol=1e-9)


def test_integers_and_broken_floats_are_read_in_place():
    geometry, camera, matrix = scene()
    integers = np.rint(smooth_field() * 800 - 150).astype(np.int16)
    broken = integers.astype(np.float32)
    broken[7, 8, 6] = np.nan
    for array in (integers, broken):
        image = reference_render(
            array, **geometry, **camera, table=colorful_table(), value_range=RANGE, step_world=0.73
        )
        low = float(np.nanmin(array))
        span = ray_span(array.shape, matrix, **camera, pixel=(4, 3))
        optics = Optics(by_table(colorful_table(), RANGE), unit_distance=1.3)
        profile = ray_profile(
            Lattice(array, matrix, low, RANGE[1]), span, ray_pieces(span, 0.73, 0.5), optics
        )
        np.testing.assert_allclose(profile.color, image[3, 4], atol=1e-9)
        assert np.isfinite(profile.values).all()


BOX = np.zeros((21, 21, 21))
VIEW = {
    "view": look_at((10.0, -40.0, 10.0), (10.0, 10.0, 10.0)),
    "projection": orthographic(12.0),
    "size": (24, 24),
}


def span_of(**changes) -> RaySpan:
    return ray_span(BOX.shape, np.eye(4), **(VIEW | {"pixel": (12, 12)} | changes))


def test_a_ray_tells_why_it_begins_and_ends():
    plain = span_of()
    assert (plain.begins, plain.ends) == ("box", "box")
    assert plain.exit - plain.entry == pytest.approx(20.0)
    assert span_of(crop=(0, 20, 3, 20, 0, 20)).begins == "crop"
    assert span_of(crop=(0, 20, 0, 12.5, 0, 20)).ends == "crop"
    assert span_of(crop=(0, 20, 0, 20, 0, 20)).ends == "box"
    plane = ((0.0, 5.0, 0.0), (0.0, 1.0, 0.0))
    assert span_of(clip_planes=[plane]).begins == "plane"
    assert span_of(clip_planes=[(plane[0], (0.0, -1.0, 0.0))]).ends == "plane"
    near = look_at((10.0, 8.0, 10.0), (10.0, 10.0, 10.0))
    assert span_of(view=near).begins == "eye"
    assert span_of(pixel=(0, 0)).entry >= span_of(pixel=(0, 0)).exit


def test_opaque_geometry_ends_a_ray_where_its_depth_says():
    near, far, place = 0.1, 1000.0, 47.0
    depth = (place - near) / (far - near)
    span = span_of(depth=depth)
    assert span.ends == "mesh"
    assert span.start[1] + span.exit == pytest.approx(-40.0 + place)
    assert span_of(depth=1.0).ends == "box"


def test_a_dense_ray_ends_at_the_sample_that_makes_it_dense():
    span = span_of()
    optics = Optics(lambda v, _g: np.tile([1.0, 1.0, 1.0, 0.3], (len(v), 1)), early_termination=0.95)
    profile = ray_profile(Lattice(BOX, np.eye(4), 0.0, 1.0), span, ray_pieces(span, 1.0, 0.5), optics)
    assert profile.terminated
    # 1 - 0.7^n reaches 0.95 at n = 9
    assert len(profile.values) == 9
    assert profile.color[3] == pytest.approx(1 - 0.7**9)


def test_slices_stand_for_longer_pieces_of_oblique_rays():
    span = span_of()
    normal = np.array([0.6, 0.8, 0.0])
    pieces = slice_pieces(span, normal, (0.0, 28.0), 28)
    np.testing.assert_allclose(pieces.lengths[1:-1], 1.0 / 0.8)
    # without gaps, from end to end
    np.testing.assert_allclose(pieces.fronts[1:], (pieces.fronts + pieces.lengths)[:-1])
    assert pieces.fronts[0] == pytest.approx(span.entry)
    assert pieces.lengths.sum() == pytest.approx(span.exit - span.entry)
    heights = (span.start + pieces.places[:, None] * span.direction) @ normal
    np.testing.assert_allclose(heights % 1.0, 0.5, atol=1e-9)
    assert len(pieces.places) == pytest.approx(20 * 0.8, abs=1)


def test_the_noise_of_a_pixel_is_fixed_and_spreads_evenly():
    noise = [pixel_noise((x, y), (64, 64)) for x in range(64) for y in range(64)]
    assert noise[0] == pixel_noise((0, 0), (64, 64))
    counts, _ = np.histogram(noise, 8, (0, 1))
    assert counts.min() > 0.8 * len(noise) / 8
