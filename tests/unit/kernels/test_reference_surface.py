"""The oracle of isosurfaces: planes exactly, spheres to second order, translucency in the right order."""

from __future__ import annotations

import numpy as np
import pytest

from tests.unit.kernels.cameras import look_at, orthographic, perspective
from tests.unit.kernels.scenes import scene, smooth_field
from volviz.errors import InputError
from volviz.reference.isosurface import reference_isosurface
from volviz.reference.rays import index_to_world_matrix, pixel_rays
from volviz.reference.sampling import Shading

SPACING, ORIGIN = (0.5, 0.8, 1.1), (3.0, -2.0, 5.0)


def world_grid(shape, spacing, origin, direction=None):
    matrix = index_to_world_matrix(spacing, origin, direction)
    k, j, i = np.meshgrid(*[np.arange(n) for n in shape], indexing="ij")
    return np.stack([i, j, k], axis=-1) @ matrix[:3, :3].T + matrix[:3, 3]


def sphere(n, radius=6.0):
    """Signed distance to a sphere around (0, 0, 0), positive inside, in a box of 16 world units."""
    spacing = 16.0 / (n - 1)
    grid = world_grid((n, n, n), (spacing,) * 3, (-8.0,) * 3)
    return radius - np.linalg.norm(grid, axis=-1), (spacing,) * 3, (-8.0,) * 3


@pytest.mark.parametrize("left_handed", [False, True])
@pytest.mark.parametrize("parallel", [False, True])
def test_a_plane_is_hit_exactly_with_exact_normal_and_depth(parallel, left_handed):
    shape = (14, 16, 12)
    geometry, camera, matrix = scene(8, shape, left_handed=left_handed, parallel=parallel, size=(21, 17))
    normal = np.array([0.48, -0.6, 0.64])
    middle = matrix[:3] @ (5.5, 7.5, 6.5, 1)
    field = (world_grid(shape, **geometry) - middle) @ normal  # rises along `normal`
    image = reference_isosurface(
        field,
        **geometry,
        **camera,
        isovalues=[0.7],
        step_world=2.5,
        bisections=3,
        shading=Shading(gradient_delta=0.3),
    )
    hit = image.surface == 0
    assert hit.sum() > 15
    starts, rays, _ = pixel_rays(camera["view"], camera["projection"], camera["size"])
    t = (0.7 - (starts - middle) @ normal) / (rays @ normal)
    expected = starts + t[..., None] * rays
    np.testing.assert_allclose(image.position[hit], expected[hit], atol=1e-9)
    clip = np.append(expected, np.ones((*hit.shape, 1)), -1) @ (camera["projection"] @ camera["view"]).T
    np.testing.assert_allclose(image.depth[hit], (clip[..., 2] / clip[..., 3] / 2 + 0.5)[hit], atol=1e-9)
    inner = hit & (np.abs((image.position - middle) @ np.linalg.inv(matrix[:3, :3]).T) < 5).all(-1)
    assert inner.sum() > 5
    np.testing.assert_allclose(image.normal[inner], np.broadcast_to(-normal, (inner.sum(), 3)), atol=1e-9)
    assert np.all(image.depth[~hit] == 1)
    assert np.all(np.isnan(image.position[~hit]))
    assert np.all(image.color[~hit] == 0)


def test_a_sphere_is_found_to_second_order_in_the_grid():
    errors, tilts = [], []
    for n in (17, 33, 65):
        field, spacing, origin = sphere(n)
        image = reference_isosurface(
            field, spacing, origin, isovalues=[0.0], view=look_at((30, 10, 20), (0, 0, 0)),
            projection=perspective(30), size=(24, 24), step_world=0.4 * spacing[0], bisections=12,
        )  # fmt: skip
        hit = image.surface == 0
        assert 100 < hit.sum() < 500
        radius = np.linalg.norm(image.position[hit], axis=-1)
        errors.append(np.abs(radius - 6).max())
        cosine = (image.normal[hit] * image.position[hit]).sum(-1) / radius
        tilts.append(np.degrees(np.arccos(np.minimum(cosine, 1))).max())
    assert errors[-1] < 0.1 * 0.25
    assert tilts[-1] < 1.0
    assert np.polyfit(np.log([16, 32, 64]), np.log(errors), 1)[0] < -1.7


def test_a_camera_inside_a_sphere_sees_its_far_wall():
    field, spacing, origin = sphere(33)
    image = reference_isosurface(
        field, spacing, origin, isovalues=[0.0], view=look_at((0, 0, 0), (1, 2, 3)),
        projection=perspective(40), size=(8, 8), step_world=0.3,
    )  # fmt: skip
    assert np.all(image.surface == 0)
    np.testing.assert_allclose(np.linalg.norm(image.position, axis=-1), 6, atol=0.05)


def test_translucent_surfaces_blend_front_to_back_in_their_order_along_the_ray():
    ramp = np.broadcast_to(np.arange(9.0), (9, 9, 9))
    colors = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    common = {
        "isovalues": [2.2, 2.6, 7.0], "colors": colors, "opacities": [0.5, 0.25, 1.0],
        "projection": orthographic(1),
        "size": (1, 1), "step_world": 3.0,
    }  # fmt: skip
    from_low = reference_isosurface(ramp, view=look_at((-30, 4, 4), (4, 4, 4)), **common)
    np.testing.assert_allclose(from_low.color[0, 0], [0.5, 0.125, 0.375, 1], atol=1e-12)
    np.testing.assert_allclose(from_low.position[0, 0], [2.2, 4, 4], atol=1e-9)
    from_high = reference_isosurface(ramp, view=look_at((30, 4, 4), (4, 4, 4)), **common)
    np.testing.assert_allclose(from_high.color[0, 0], [0, 0, 1, 1], atol=1e-12)
    assert from_high.surface[0, 0] == 2


def test_a_shell_thinner_than_two_steps_is_crossed_rising_and_falling():
    bump = np.maximum(0, 2.0 - np.abs(np.arange(33.0) - 16))
    field = np.broadcast_to(bump, (5, 5, 33))
    image = reference_isosurface(
        field, isovalues=[1.0], opacities=0.5, colors=(1, 1, 1),
        view=look_at((-30, 2, 2), (4, 2, 2)), projection=orthographic(1), size=(1, 1), step_world=0.9,
    )  # fmt: skip
    np.testing.assert_allclose(image.color[0, 0, 3], 0.75, atol=1e-12)


def test_more_bisections_bring_the_point_closer():
    field = smooth_field(2, (14, 16, 12))
    geometry, camera, _ = scene(2)
    common = dict(**geometry, **camera, isovalues=[0.6], step_world=1.5)
    best = reference_isosurface(field, **common, bisections=50)
    hit = best.surface == 0
    assert hit.sum() > 5
    errors = [
        np.linalg.norm(
            reference_isosurface(field, **common, bisections=b).position[hit] - best.position[hit], axis=-1
        )
        for b in (0, 2, 4, 8)
    ]
    assert errors[0].max() > errors[1].max() > errors[2].max() > errors[3].max()
    assert errors[2].max() < 1.5 / 2**4
    assert errors[3].max() < 1.5 / 2**8


def test_a_headlight_lights_a_facing_plane_fully():
    ramp = np.broadcast_to(np.arange(9.0), (9, 9, 9))
    image = reference_isosurface(
        ramp, isovalues=[4.0], colors=(0.5, 0.4, 0.3), view=look_at((-30, 4, 4), (4, 4, 4)),
        projection=orthographic(1), size=(1, 1), step_world=0.5, shading=Shading(0.1, 0.6, 0.25, 250.0),
    )  # fmt: skip
    np.testing.assert_allclose(image.color[0, 0], [0.35 + 0.25, 0.28 + 0.25, 0.21 + 0.25, 1], atol=1e-12)


def test_crop_and_clip_planes_cut_surfaces_away():
    field, spacing, origin = sphere(33)
    common = {
        "isovalues": [0.0], "view": look_at((30, 0, 0), (0, 0, 0)), "projection": orthographic(7.0),
        "size": (32, 32),
        "step_world": 0.3,
    }  # fmt: skip
    whole = reference_isosurface(field, spacing, origin, **common)
    half = reference_isosurface(field, spacing, origin, clip_planes=[((0, 0, 0), (0, 0, 1))], **common)
    np.testing.assert_array_equal(half.surface[:16], whole.surface[:16])
    assert np.all(half.surface[16:] == -1)
    front_gone = reference_isosurface(field, spacing, origin, crop=(0, 16, 0, 32, 0, 32), **common)
    seen = front_gone.surface == 0
    assert np.all(front_gone.position[seen][:, 0] < 0)


def test_a_surface_out_of_range_is_an_empty_picture():
    field, spacing, origin = sphere(9)
    image = reference_isosurface(
        field, spacing, origin, isovalues=[99.0], view=look_at((30, 0, 0), (0, 0, 0)),
        projection=perspective(), size=(4, 4), step_world=0.5,
    )  # fmt: skip
    assert np.all(image.surface == -1)
    assert not image.color.any()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"isovalues": []}, "one or more"),
        ({"isovalues": [np.nan]}, "finite"),
        ({"bisections": 99}, "bisections"),
        ({"colors": np.zeros((3, 3))}, "one for each"),
    ],
)
def test_bad_arguments_are_refused_in_words(change, message):
    geometry, camera, _ = scene()
    arguments = {**geometry, **camera, "isovalues": [0.5, 0.6], "step_world": 0.5} | change
    with pytest.raises(InputError, match=message):
        reference_isosurface(smooth_field(), **arguments)
