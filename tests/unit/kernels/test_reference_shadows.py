"""The oracle of volumetric shadows: closed forms, and the same definition written another way."""

from __future__ import annotations

import numpy as np
import pytest

from tests.unit.kernels.cameras import look_at, orthographic
from tests.unit.kernels.scenes import colorful_table, scene, smooth_field
from tests.unit.kernels.slow_renderer import SlowRenderer
from volviz.errors import InputError
from volviz.reference.image import reference_render
from volviz.reference.rays import pixel_rays
from volviz.reference.shadows import reference_shadows

SHOWN = (0, 11, 0, 15, 0, 13)


@pytest.mark.parametrize(
    ("light", "options"),
    [
        ((60.0, -40.0, 70.0), {}),
        ((60.0, -40.0, 70.0), {"density_threshold": 0.4, "ambient": 0.2}),
        ("inside", {}),
        ((-50.0, 10.0, 30.0), {"crop": (2.0, 9.0, 1.5, 13.0, 3.0, 12.5)}),
        ((-50.0, 10.0, 30.0), {"clip_planes": "middle"}),
    ],
    ids=["outside", "threshold", "inside", "crop", "planes"],
)
@pytest.mark.parametrize("left_handed", [False, True])
def test_a_second_implementation_gives_the_same_pixels(light, options, left_handed):
    array, table = smooth_field(), colorful_table()
    geometry, camera, matrix = scene(left_handed=left_handed, size=(5, 4))
    middle = matrix[:3] @ (5.5, 7.5, 6.5, 1)
    light = np.add(middle, (1.0, 2.0, -1.5)) if light == "inside" else np.array(light)
    options = dict(options)
    if "clip_planes" in options:
        options["clip_planes"] = [(middle - np.array([1.0, 0, 0]), (0.8, 0.6, 0.0))]
    kappa, color, ambient = np.array([0.4, 1.0, 1.7]), np.array([1.0, 0.9, 0.7]), options.get("ambient", 0.0)
    image = reference_shadows(
        array, **geometry, **camera, table=table, value_range=(0, 1), step_world=0.9, light_step=1.1,
        unit_distance=1.3, light_position=light, light_color=color, kappa=kappa, **options,
    )  # fmt: skip
    slow = SlowRenderer(array, matrix, table, (0, 1))
    shown, planes = options.get("crop", SHOWN), options.get("clip_planes", ())
    threshold = options.get("density_threshold", 0.0)
    starts, rays, lengths = pixel_rays(camera["view"], camera["projection"], camera["size"])

    def corrected(world, d):
        values = slow.values(world)
        rgba = slow.rgba(values)
        rgba[values < threshold, 3] = 0
        return rgba[:, :3], 1 - (1 - rgba[:, 3]) ** (d / 1.3)

    expected = np.zeros_like(image)
    for pixel in np.ndindex(image.shape[:2]):
        near, far = slow.interval(starts[pixel], rays[pixel], lengths[pixel], shown, planes)
        if far <= near:
            continue
        t, d = slow.sample_positions(near, far, 0.9, 0.5)
        world = starts[pixel] + t[:, None] * rays[pixel]
        colors, alphas = corrected(world, d)
        for point, c, a in zip(world, colors, alphas, strict=True):
            way = np.linalg.norm(light - point)
            toward = (light - point) / way
            near, far = slow.interval(point, toward, way, shown, planes)
            t, d = slow.sample_positions(max(near, 0.0), far, 1.1, 0.5)
            shadow = np.prod(1 - corrected(point + t[:, None] * toward, d)[1]) ** kappa
            rest = (1 - expected[pixel][3]) * a
            expected[pixel] += rest * np.append(c * (ambient + (1 - ambient) * color * shadow), 1)
    assert (expected[..., 3] > 0.02).sum() > 4
    np.testing.assert_allclose(image, expected, atol=1e-9)


def test_light_decays_exponentially_into_a_homogeneous_box():
    n, a = 21, 0.06
    kappa = np.array([0.5, 1.0, 2.0])
    image = reference_shadows(
        np.ones((n, n, n)), table=[[0.9, 0.8, 0.7, a]] * 2, value_range=(0, 1), unit_distance=1.0,
        view=look_at((10, -60, 10), (10, 10, 10)), projection=orthographic(10), size=(3, 10), step_world=0.7,
        light_position=(10, 10, 1e9), kappa=kappa, light_color=(1, 0.5, 0.25),
    )  # fmt: skip
    depth = (np.arange(10) + 0.5) * 2.0  # below the top face
    alpha = 1 - (1 - a) ** 20.0
    light = (1 - a) ** (depth[:, None] * kappa) * (1, 0.5, 0.25)
    np.testing.assert_allclose(image[:, 1, :3], alpha * light * (0.9, 0.8, 0.7), atol=1e-6)
    np.testing.assert_allclose(image[:, 1, 3], alpha, atol=1e-12)


def test_without_attenuation_it_is_the_plain_composite():
    geometry, camera, _ = scene()
    common = dict(**geometry, **camera, table=colorful_table(), value_range=(0, 1), step_world=0.6)
    plain = reference_render(smooth_field(), **common)
    for options in ({"kappa": (0, 0, 0)}, {"ambient": 1.0}):
        lit = reference_shadows(smooth_field(), light_position=(50, 50, 50), **common, **options)
        np.testing.assert_allclose(lit, plain, atol=1e-12)


def test_an_opaque_plate_casts_a_hard_shadow():
    array = np.full((24, 24, 24), 0.5)
    array[17:20, :, :12] = 1.0
    table = np.zeros((3, 4))
    table[1], table[2] = (1, 1, 1, 0.02), (1, 1, 1, 1.0)
    image = reference_shadows(
        array, table=table, value_range=(0, 1), step_world=0.5, light_position=(11.5, 11.5, 1e6),
        view=look_at((11.5, -60, 11.5), (11.5, 11.5, 11.5)), projection=orthographic(11.5), size=(24, 24),
    )  # fmt: skip
    below = image[10:, :, 0] / image[10:, :, 3]
    assert below[:, :11].max() < 0.01
    assert below[:, 14:].min() > 0.5


def test_the_light_step_converges():
    geometry, camera, _ = scene()
    common = dict(
        **geometry,
        **camera,
        table=colorful_table(),
        value_range=(0, 1),
        step_world=1.0,
        light_position=(60, -40, 70),
    )
    best, *images = (reference_shadows(smooth_field(), **common, light_step=s) for s in (0.02, 2.0, 0.5))
    coarse, fine = (np.abs(p - best).mean() for p in images)
    assert fine < coarse / 6


def test_bad_arguments_are_refused_in_words():
    geometry, camera, _ = scene()
    common = dict(**geometry, **camera, table=colorful_table(), value_range=(0, 1), light_position=(9, 9, 9))
    with pytest.raises(InputError, match="light_step"):
        reference_shadows(smooth_field(), **common, step_world=0.5, light_step=0)
    with pytest.raises(InputError, match="table"):
        reference_shadows(smooth_field(), **(common | {"table": [1, 2]}), step_world=0.5)
