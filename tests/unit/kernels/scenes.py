"""Fields, tables, volumes in space and cameras for tests of the oracle."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.spatial.transform import Rotation

from tests.unit.kernels.cameras import look_at, orthographic, perspective
from volviz.reference.rays import index_to_world_matrix


def smooth_field(seed=5, shape=(14, 16, 12), sigma=1.5):
    field = gaussian_filter(np.random.default_rng(seed).normal(size=shape), sigma)
    return (field - field.min()) / (field.max() - field.min())


def colorful_table(n=1024):
    t = np.linspace(0, 1, n)
    alpha = 0.45 * np.clip(t - 0.2, 0, None) ** 1.5 + 0.1 * np.sin(3 * t) ** 2
    return np.stack([t, 1 - t, 0.5 + 0.5 * np.sin(5 * t), alpha], axis=1)


def scene(seed=5, shape=(14, 16, 12), *, left_handed=False, parallel=False, size=(9, 7), distance=60.0):
    """An anisotropic, oblique volume and a camera that sees it whole."""
    spacing, origin = (0.9, 1.3, 1.7), (4.0, -7.0, 11.0)
    direction = Rotation.random(random_state=seed).as_matrix()
    if left_handed:
        direction[:, 1] *= -1
    matrix = index_to_world_matrix(spacing, origin, direction)
    middle = matrix[:3, :3] @ ((np.array(shape[::-1]) - 1) / 2) + matrix[:3, 3]
    toward = np.random.default_rng(seed).normal(size=3)
    eye = middle + distance * toward / np.linalg.norm(toward)
    aspect = size[0] / size[1]
    projection = orthographic(14.0, aspect) if parallel else perspective(24.0, aspect)
    geometry = {"spacing": spacing, "origin": origin, "direction": direction}
    camera = {"view": look_at(eye, middle), "projection": projection, "size": size}
    return geometry, camera, matrix
