"""Surfaces of labels in the oracle: where they lie, how they face, and what is in front of what."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.unit.kernels.cameras import look_at, orthographic
from volviz.errors import InputError
from volviz.reference.labels import ReferenceLabels, first_border
from volviz.reference.layer_rays import ReferenceLayer, Sampling
from volviz.reference.layers import reference_layers
from volviz.reference.sampling import Shading

CENTER, RADIUS = np.array([15.3, 15.8, 16.1]), 10.0
PALETTE = np.array([[0, 0, 0, 0], [1, 0, 0, 1], [0, 1, 0, 1]], float)
#: Colours as they are.
FLAT = Shading(1.0, 0.0, 0.0)
CAMERA = {
    "view": look_at((15.5, 15.5, 80.0), (15.5, 15.5, 15.5), (0.0, 1.0, 0.0)),
    "projection": orthographic(16.0),
    "size": (32, 32),
}


def sphere(spacing=(1.0, 1.0, 1.0)):
    """Labels of a ball, 1 inside, and of another that cuts into it, 2."""
    z, y, x = np.mgrid[:32, :32, :32]
    distance = np.linalg.norm(np.stack([x, y, z], axis=-1) - CENTER, axis=-1)
    return ReferenceLabels((distance <= RADIUS).astype(np.int64), np.diag([*spacing, 1.0]), PALETTE)


def drawn(*layers, shading=FLAT, step=0.5, **options):
    return reference_layers(
        layers, **CAMERA, step_world=step, sampling=Sampling(surface_shading=shading), **options
    )


def hits(layer, count=3000):
    """Distances from the middle at which the surface of a ball is met in all directions, and those directions."""
    out = np.random.default_rng(0).normal(size=(count, 3))
    out /= np.linalg.norm(out, axis=1)[:, None]
    near, far = np.full(count, 5.0), np.full(count, 14.0)
    lengths, owner = first_border(
        layer, np.tile(CENTER, (count, 1)), out, near, far, np.ones(count, int), np.zeros(count, int)
    )
    assert np.all(owner == 1)
    return lengths, out


def test_a_ball_of_ten_voxels_lies_where_it_is_and_its_normals_point_outwards():
    layer = sphere()
    lengths, out = hits(layer)
    off = np.abs(lengths - RADIUS)
    assert off.mean() < 0.2
    assert off.max() < 0.6
    normals = -layer.gradient(layer.index_of(CENTER + lengths[:, None] * out), np.ones(len(out), int))
    cosines = (normals * out).sum(axis=1) / np.linalg.norm(normals, axis=1)
    angles = np.degrees(np.arccos(np.clip(cosines, -1, 1)))
    assert angles.mean() < 4.0
    assert np.quantile(angles, 0.99) < 10.0


def test_normals_of_anisotropic_voxels_are_those_of_the_world():
    layer = sphere((1.0, 2.0, 0.5))
    index = CENTER + RADIUS * np.array([[0.6, 0.8, 0.0]])
    expected = np.array([0.6 / 1.0, 0.8 / 2.0, 0.0])
    slope = -layer.gradient(index, np.array([1]))[0]
    assert slope @ expected / np.linalg.norm(slope) / np.linalg.norm(expected) > np.cos(np.radians(8.0))


def test_labels_that_touch_leave_no_gap_and_hide_nothing_of_each_other():
    labels = np.ones((32, 32, 32), np.int64)
    labels[:, :, 16:] = 2
    image = drawn(ReferenceLabels(labels, np.eye(4), PALETTE))
    inside = image[1:-1, 1:-1]
    np.testing.assert_allclose(inside[..., 3], 1.0)
    np.testing.assert_allclose(inside[..., 0] + inside[..., 1], 1.0)


def test_a_hidden_label_uncovers_what_it_hid():
    labels = np.zeros((32, 32, 32), np.int64)
    labels[20:28, 4:28, 4:28], labels[6:14, 4:28, 4:28] = 1, 2
    layer = ReferenceLabels(labels, np.eye(4), PALETTE)
    assert tuple(drawn(layer)[16, 16]) == (1.0, 0.0, 0.0, 1.0)
    hidden = replace(layer, palette=PALETTE * np.array([[1], [0], [1]]))
    assert tuple(drawn(hidden)[16, 16]) == (0.0, 1.0, 0.0, 1.0)


def test_translucent_surfaces_are_seen_on_both_sides():
    layer = replace(sphere(), palette=PALETTE * np.array([1, 1, 1, 0.25]))
    np.testing.assert_allclose(drawn(layer)[16, 16, 3], 1.0 - 0.75**2)


def test_a_surface_within_matter_hides_what_is_behind_and_not_what_is_before():
    fog = ReferenceLayer(
        np.zeros((32, 32, 32)), np.eye(4), np.array([[0, 0, 1, 0.02]] * 2), (0.0, 1.0), (0.0, 1.0)
    )
    wall = np.zeros((32, 32, 32), np.int64)
    wall[:16] = 1
    layer = ReferenceLabels(wall, np.eye(4), PALETTE)
    before = 1.0 - 0.98 ** (31.0 - 15.5)
    for step in (0.3, 0.5, 1.7):
        image = drawn(fog, layer, step=step)[16, 16]
        np.testing.assert_allclose(image, (1 - before, 0.0, before, 1.0), atol=1e-9)
        np.testing.assert_allclose(drawn(layer, fog, step=step)[16, 16], image, atol=1e-12)


def test_a_label_that_is_cut_has_a_face_there():
    layer = replace(sphere(), smooth=True)
    image = drawn(layer, clip_planes=(((0.0, 0.0, 16.0), (0.0, 0.0, -1.0)),))
    assert tuple(image[16, 16]) == (1.0, 0.0, 0.0, 1.0)
    assert image[1, 1, 3] == 0.0


def test_labels_of_voxels_end_where_voxels_do():
    labels = np.zeros((32, 32, 32), np.int64)
    labels[10:20, 10:20, 10:20] = 1
    image = drawn(ReferenceLabels(labels, np.eye(4), PALETTE, smooth=False))
    assert np.count_nonzero(image[..., 3]) == 100


def test_masks_of_complementary_labels_add_up_to_the_whole():
    fog = ReferenceLayer(
        np.zeros((32, 32, 32)), np.eye(4), np.array([[0, 0, 1, 0.004]] * 2), (0.0, 1.0), (0.0, 1.0)
    )
    ball = replace(sphere(), mode="mask")
    rest = replace(ball, palette=np.array([[1, 1, 1, 1], [1, 1, 1, 0]], float))
    whole = drawn(fog, mode="additive")
    parts = [drawn(fog, mask, mode="additive") for mask in (ball, rest)]
    assert min(part[16, 16, 3] for part in parts) > 0.03
    np.testing.assert_allclose(sum(parts), whole, atol=1e-12)


def test_labels_alone_are_drawn_by_compositing_only():
    with pytest.raises(InputError, match="no layer is added"):
        drawn(sphere(), mode="maximum")
