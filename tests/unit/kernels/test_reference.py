"""The oracle itself: closed forms, convergence, and a second implementation written another way."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.unit.kernels.cameras import look_at, orthographic
from tests.unit.kernels.scenes import colorful_table, scene, smooth_field
from tests.unit.kernels.slow_renderer import SlowRenderer
from volviz.errors import InputError
from volviz.reference.image import MODES, Shading, reference_render
from volviz.reference.rays import pixel_rays

FLAT = np.array([[1.0, 0.5, 0.25, 0.05]] * 2)

#: What a ray may be asked for besides its step, one thing or pair of things at a time.
OPTIONS = [
    {},
    {"first_sample": 0.0},
    {"first_sample": 1.0},
    {"early_termination": 0.6},
    {"density_threshold": 0.45},
    {"gradient_opacity": 0.7, "gradient_reference": 0.2},
    {"shading": Shading(0.2, 0.6, 0.4, 12.0, gradient_delta=0.7)},
    {"shading": Shading(0.2, 0.6, 0.4, 12.0, (30.0, -20.0, 40.0), (1.0, 0.8, 0.5))},
    {"crop": (1.25, 9.5, 2.0, 12.75, 0.5, 11.0)},
    {"clip_planes": ((-3.0, (0.6, 0.8, 0.0)), (-2.0, (0.0, 0.6, -0.8)))},
    {"interpolation": "nearest"},
    *[{"mode": mode} for mode in MODES[1:]],
    {"mode": "attenuated_maximum", "attenuation": 0.2},
    {"mode": "average", "density_threshold": 0.4},
    {"mode": "minimum", "density_threshold": 0.4},
    {"mode": "additive", "unit_distance": 30.0, "shading": Shading()},
]


@pytest.mark.parametrize("left_handed", [False, True])
@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize(
    "options",
    OPTIONS,
    ids=lambda o: "-".join(f"{k}={v}" for k, v in o.items())[:50] if isinstance(o, dict) else None,
)
def test_a_second_implementation_gives_the_same_pixels(options, left_handed, parallel):
    array, table, value_range = smooth_field() * 900 - 200, colorful_table(), (-150.0, 650.0)
    geometry, camera, matrix = scene(left_handed=left_handed, parallel=parallel)
    o = in_scene_units(options, matrix)
    image = reference_render(
        array, **geometry, **camera, table=table, value_range=value_range, step_world=0.73, **o
    )
    starts, directions, lengths = pixel_rays(camera["view"], camera["projection"], camera["size"])
    slow = SlowRenderer(
        array, matrix, table, value_range, order=0 if o.get("interpolation") == "nearest" else 1
    )
    threshold = o.get("density_threshold", 0)
    crop = o.get("crop", (0, 11, 0, 15, 0, 13))
    expected = np.zeros_like(image)
    for pixel in np.ndindex(image.shape[:2]):
        expected[pixel] = slow.pixel(
            starts[pixel], directions[pixel], lengths[pixel],
            step=0.73,
            first=o.get("first_sample", 0.5),
            unit=o.get("unit_distance", 1.3),
            mode=o.get("mode", "composite"),
            attenuation=o.get("attenuation", 1.0),
            shading=o.get("shading"),
            gradient_opacity=o.get("gradient_opacity", 0.0),
            gradient_reference=o.get("gradient_reference", 1.0),
            threshold=-150 + threshold * 800 if threshold else -np.inf,
            crop=crop,
            planes=o.get("clip_planes", ()),
            termination=o.get("early_termination", 1.0),
        )  # fmt: skip
    assert (expected[..., 3] > 0.02).sum() > 10
    np.testing.assert_allclose(image, expected, atol=1e-10)


def in_scene_units(options, matrix):
    """Gradients of the field of 900 units; planes from (distance from the middle, normal)."""
    scaled = dict(options)
    if "gradient_reference" in scaled:
        scaled["gradient_reference"] = scaled["gradient_reference"] * 900
    if "clip_planes" in scaled:
        middle = matrix[:3] @ (5.5, 7.5, 6.5, 1.0)
        scaled["clip_planes"] = [(middle + d * np.array(n), n) for d, n in scaled["clip_planes"]]
    return scaled


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**5), step=st.floats(0.05, 40.0), parallel=st.booleans())
def test_a_homogeneous_box_has_beer_lambert_alpha_for_every_ray_and_step(seed, step, parallel):
    array = np.full((14, 16, 12), 200, np.uint8)
    geometry, camera, matrix = scene(seed, left_handed=seed % 2 == 1, parallel=parallel)
    image = reference_render(
        array, **geometry, **camera, table=FLAT, value_range=(0, 255), step_world=step, unit_distance=1.0
    )
    slow = SlowRenderer(array, matrix, FLAT, (0, 255))
    starts, directions, lengths = pixel_rays(camera["view"], camera["projection"], camera["size"])
    hit = 0
    for pixel in np.ndindex(image.shape[:2]):
        near, far = slow.interval(starts[pixel], directions[pixel], lengths[pixel], (0, 11, 0, 15, 0, 13), ())
        inside = max(far - near, 0.0)
        exact = -np.expm1(np.log(0.95) * inside)
        np.testing.assert_allclose(image[pixel], exact * np.array([1, 0.5, 0.25, 1]), atol=1e-12)
        hit += inside > 0
    assert hit >= 5


@pytest.mark.parametrize("step", [0.25, 0.9, 1.0, 1.7, 3.3])
def test_first_sample_1_counts_whole_steps_only_as_vtk_does(step):
    box = np.full((40, 40, 40), 200, np.uint8)
    image = reference_render(
        box, table=FLAT, value_range=(0, 255), view=look_at((19.5, 19.5, 100), (19.5, 19.5, 19.5), (0, 1, 0)),
        projection=orthographic(10), size=(1, 1), step_world=step, unit_distance=1.0, first_sample=1.0,
    )  # fmt: skip
    whole = int(39 / step + 1e-9)
    np.testing.assert_allclose(image[0, 0, 3], 1 - 0.95 ** (whole * step), atol=1e-12)


def image_errors(steps, table, **options):
    """Mean error of the image against one with a far finer step, for each step."""
    array = smooth_field(3, (12, 12, 12))
    geometry, camera, _ = scene(3, (12, 12, 12), size=(24, 24))

    def render(step):
        return reference_render(
            array, **geometry, **camera, table=table, value_range=(0, 1), step_world=step, **options
        )

    best = render(min(steps) / 16)
    return np.array([np.abs(render(step) - best).mean() for step in steps])


def slope(steps, errors):
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


STEPS = np.array([1.0, 0.5, 0.25, 0.125, 0.0625])


def test_the_midpoint_rule_converges_with_order_2_for_a_continuous_transfer_function():
    assert abs(slope(STEPS, image_errors(STEPS, colorful_table(4096))) - 2) < 0.3


def test_samples_at_the_near_end_converge_with_order_1_only():
    errors = image_errors(STEPS, colorful_table(4096), first_sample=0.0)
    assert abs(slope(STEPS, errors) - 1) < 0.3


def jumping_table(n=65536):
    t = np.linspace(0, 1, n)
    alpha = np.select([t < 0.4, t < 0.55, t < 0.7], [0.0, 0.3, 0.05], 0.5)
    return np.stack([t, 1 - t, t * 0 + 0.3, alpha], axis=1)


def test_jumps_in_the_transfer_function_lower_the_order_to_1():
    assert abs(slope(STEPS, image_errors(STEPS, jumping_table())) - 1) < 0.3


@pytest.mark.parametrize("table", [colorful_table(4096), jumping_table(4096)], ids=["continuous", "jumps"])
def test_preintegration_converges_with_order_2(table):
    assert abs(slope(STEPS, image_errors(STEPS, table, preintegrated=True)) - 2) < 0.3


def test_preintegration_agrees_with_very_fine_sampling():
    array = smooth_field(3, (12, 12, 12))
    geometry, camera, _ = scene(3, (12, 12, 12))
    common = dict(**geometry, **camera, table=colorful_table(4096), value_range=(0, 1))
    fine = reference_render(array, **common, step_world=0.01)
    preintegrated = reference_render(array, **common, step_world=0.1, preintegrated=True)
    assert np.abs(fine - preintegrated).max() < 2e-4


def test_shaded_preintegration_agrees_with_very_fine_sampling():
    array = smooth_field(3, (12, 12, 12))
    geometry, camera, _ = scene(3, (12, 12, 12))
    common = dict(**geometry, **camera, table=colorful_table(4096), value_range=(0, 1), shading=Shading())
    fine = reference_render(array, **common, step_world=0.01, gradient_opacity=0.5)
    preintegrated = reference_render(
        array, **common, step_world=0.02, gradient_opacity=0.5, preintegrated=True
    )
    assert np.abs(fine - preintegrated).max() < 2e-3


def test_a_density_threshold_acts_alike_with_and_without_preintegration():
    array = smooth_field(3, (12, 12, 12))
    geometry, camera, _ = scene(3, (12, 12, 12))
    common = dict(
        **geometry,
        **camera,
        table=colorful_table(4096),
        value_range=(0, 1),
        step_world=0.01,
        density_threshold=0.4,
    )
    plain, whole = (
        reference_render(array, **common),
        reference_render(array, **common | {"density_threshold": 0}),
    )
    assert np.abs(plain - whole).max() > 0.05
    assert np.abs(plain - reference_render(array, **common, preintegrated=True)).max() < 2e-3


def test_the_first_row_is_the_top_and_axes_are_not_mirrored():
    array = np.zeros((9, 9, 9))
    array[7, 4, 1] = 1  # high z, low x
    image = reference_render(
        array, table=[[1, 1, 1, 0], [1, 1, 1, 1]], value_range=(0, 1), view=look_at((4, -50, 4), (4, 4, 4)),
        projection=orthographic(4.5), size=(9, 9), step_world=0.25, mode="maximum",
    )  # fmt: skip
    row, column = np.unravel_index(image[..., 3].argmax(), (9, 9))
    assert (row, column) == (1, 1)


def test_the_box_reaches_from_the_first_to_the_last_voxel_centre():
    array = np.ones((5, 5, 5))
    image = reference_render(
        array, (2.0, 2.0, 2.0), (-4.0, -4.0, -4.0), table=FLAT, value_range=(0, 1), step_world=1.0,
        view=look_at((0, 0, 50), (0, 0, 0), (0, 1, 0)), projection=orthographic(5.0), size=(100, 100),
    )  # fmt: skip
    covered = image[..., 3] > 0
    assert covered.any(0).sum() == 80  # 8 of 10 world units
    np.testing.assert_array_equal(covered, covered[::-1, ::-1])


def test_a_camera_inside_sees_what_lies_in_front_of_its_near_plane():
    box = np.ones((21, 21, 21))
    image = reference_render(
        box, table=FLAT, value_range=(0, 1), view=look_at((10, 10, 10), (10, 10, 0), (0, 1, 0)),
        projection=orthographic(1, near=2.0, far=100.0), size=(1, 1), step_world=0.3, unit_distance=1.0,
    )  # fmt: skip
    np.testing.assert_allclose(image[0, 0, 3], 1 - 0.95**8, atol=1e-12)


def test_averages_and_extremes_of_a_ramp_are_exact():
    ramp = np.broadcast_to(np.arange(11.0)[:, None, None], (11, 11, 11))
    common = {
        "table": [[0, 0, 0, 0], [1, 1, 1, 1]], "value_range": (0, 10),
        "projection": orthographic(1), "size": (1, 1),
        "view": look_at((5, 5, 50), (5, 5, 5), (0, 1, 0)), "step_world": 0.5,
    }  # fmt: skip
    alpha = {mode: reference_render(ramp, mode=mode, **common)[0, 0, 3] for mode in MODES}
    np.testing.assert_allclose(alpha["average"], 0.5, atol=1e-12)
    np.testing.assert_allclose(alpha["maximum"], 0.975, atol=1e-12)
    np.testing.assert_allclose(alpha["minimum"], 0.025, atol=1e-12)


def test_without_attenuation_the_attenuated_maximum_is_the_maximum():
    geometry, camera, _ = scene()
    common = dict(**geometry, **camera, table=colorful_table(), value_range=(0, 1), step_world=0.5)
    field = smooth_field()
    np.testing.assert_allclose(
        reference_render(field, mode="attenuated_maximum", attenuation=0.0, **common),
        reference_render(field, mode="maximum", **common),
        atol=1e-12,
    )


def test_the_additive_mode_does_not_depend_on_the_step():
    geometry, camera, _ = scene()
    common = dict(**geometry, **camera, table=FLAT, value_range=(0, 1), mode="additive", unit_distance=20.0)
    coarse, fine = (reference_render(np.ones((14, 16, 12)), step_world=s, **common) for s in (3.0, 0.1))
    np.testing.assert_allclose(coarse, fine, atol=1e-12)
    assert 0.02 < coarse[..., 3].max() < 1


def test_flat_regions_stay_unlit_and_nothing_is_nan():
    geometry, camera, _ = scene()
    common = dict(**geometry, **camera, table=FLAT, value_range=(0, 255), step_world=0.5)
    box = np.full((14, 16, 12), 77.7)
    lit = reference_render(box, shading=Shading(), **common)
    np.testing.assert_allclose(lit, reference_render(box, **common), atol=1e-12)


def test_nan_and_infinities_count_as_the_lowest_value():
    geometry, camera, _ = scene()
    common = dict(**geometry, **camera, table=colorful_table(), value_range=(0, 1), step_world=0.5)
    field = smooth_field()
    field[3, 4, 5], field[7, 8, 6] = np.nan, np.inf
    clean = np.where(np.isfinite(field), field, field[np.isfinite(field)].min())
    image = reference_render(field, **common)
    np.testing.assert_array_equal(image, reference_render(clean, **common))
    assert np.all(np.isfinite(image))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mode": "best"}, "mode must be one of"),
        ({"step_world": 0.0}, "step_world"),
        ({"first_sample": 1.5}, "first_sample"),
        ({"interpolation": "cubic"}, "interpolation"),
        ({"preintegrated": True, "mode": "maximum"}, "composite"),
        ({"size": (0, 5)}, "1 x 1"),
        ({"table": [[1, 1, 1, 2.0]] * 3}, "between 0 and 1"),
        ({"crop": (0, 1)}, "six numbers"),
        ({"shading": Shading(gradient_delta=0.0)}, "gradient_delta"),
    ],
)
def test_bad_arguments_are_refused_in_words(change, message):
    geometry, camera, _ = scene()
    arguments = {**geometry, **camera, "table": FLAT, "value_range": (0, 1), "step_world": 0.5} | change
    with pytest.raises(InputError, match=message):
        reference_render(smooth_field(), **arguments)
