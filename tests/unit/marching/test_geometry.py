"""Convergence: finer lattices give surfaces that are quadratically nearer, and normals at least linearly."""

from __future__ import annotations

import numpy as np
import pytest

from volviz.kernels.marching import marching_cubes
from volviz.kernels.mesh_metrics import mesh_metrics

from .meshes import METHODS, lattice


class Shape:
    """A field with its gradient; the surface is where it is 0."""

    def __init__(self, value, gradient):
        self.value = value
        self.gradient = gradient


def _sphere(x, y, z):
    return 0.7 - np.sqrt(x * x + y * y + z * z)


def _sphere_gradient(x, y, z):
    r = np.sqrt(x * x + y * y + z * z)
    return np.stack([-x / r, -y / r, -z / r], axis=-1)


def _torus(x, y, z):
    ring = np.sqrt(x * x + y * y) - 0.6
    return 0.25 - np.sqrt(ring * ring + z * z)


def _torus_gradient(x, y, z):
    radius = np.sqrt(x * x + y * y)
    ring = radius - 0.6
    distance = np.sqrt(ring * ring + z * z)
    return np.stack([-ring * x / radius / distance, -ring * y / radius / distance, -z / distance], axis=-1)


K = 4.0


def _gyroid(x, y, z):
    return np.sin(K * x) * np.cos(K * y) + np.sin(K * y) * np.cos(K * z) + np.sin(K * z) * np.cos(K * x)


def _gyroid_gradient(x, y, z):
    s, c = np.sin, np.cos
    return K * np.stack(
        [
            c(K * x) * c(K * y) - s(K * z) * s(K * x),
            c(K * y) * c(K * z) - s(K * x) * s(K * y),
            c(K * z) * c(K * x) - s(K * y) * s(K * z),
        ],
        axis=-1,
    )


FM, ALPHA = 2.0, 0.25


def _marschner_lobb(x, y, z):
    """The test signal of Marschner and Lobb (1994), its frequency lowered to what 32 samples can hold."""
    r = np.sqrt(x * x + y * y)
    wave = np.cos(2 * np.pi * FM * np.cos(np.pi * r / 2))
    return (1 - np.sin(np.pi * z / 2) + ALPHA * (1 + wave)) / (2 * (1 + ALPHA)) - 0.5


def _marschner_lobb_gradient(x, y, z):
    r = np.maximum(np.sqrt(x * x + y * y), 1e-12)
    inner = 2 * np.pi * FM * np.cos(np.pi * r / 2)
    along = -np.sin(inner) * 2 * np.pi * FM * -np.sin(np.pi * r / 2) * np.pi / 2 * ALPHA
    scale = 2 * (1 + ALPHA)
    return np.stack(
        [along * x / r / scale, along * y / r / scale, -np.cos(np.pi * z / 2) * np.pi / 2 / scale + 0 * x],
        axis=-1,
    )


SHAPES = {
    "sphere": Shape(_sphere, _sphere_gradient),
    "torus": Shape(_torus, _torus_gradient),
    "gyroid": Shape(_gyroid, _gyroid_gradient),
    "marschner-lobb": Shape(_marschner_lobb, _marschner_lobb_gradient),
}


def errors(shape, n, method):
    """Root mean square distance of the vertices from the surface; largest angle of a normal in radians."""
    field = shape.value(*lattice(n)).astype(np.float32)
    step = 2.0 / (n - 1)
    vertices, _, normals = marching_cubes(field, 0.0, method=method, spacing=(step,) * 3, origin=(-1.0,) * 3)
    x, y, z = vertices.astype(np.float64).T
    gradient = shape.gradient(x, y, z)
    length = np.linalg.norm(gradient, axis=1)
    distance = np.abs(shape.value(x, y, z)) / length
    # One-sided differences at the border of the volume are of first order only.
    inside = (np.abs(vertices) < 1 - 1.5 * step).all(axis=1)
    cosine = -np.einsum("ij,ij->i", normals, gradient / length[:, None])[inside]
    return np.sqrt(np.mean(distance**2)), np.arccos(np.clip(cosine, -1, 1)).max()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", SHAPES)
def test_distances_shrink_quadratically_and_normals_at_least_linearly(name, method):
    sizes = np.array([49, 97, 145])
    found = np.array([errors(SHAPES[name], n, method) for n in sizes])
    distance, angle = np.polyfit(np.log(1.0 / (sizes - 1)), np.log(found), 1)[0]
    assert distance == pytest.approx(2.0, abs=0.25)
    assert angle >= 1.0


@pytest.mark.parametrize("method", METHODS)
def test_area_and_volume_of_a_sphere_are_right(method):
    n = 65
    vertices, faces, _ = marching_cubes(
        _sphere(*lattice(n)).astype(np.float32), 0.0, method=method, spacing=(2.0 / (n - 1),) * 3
    )
    metrics = mesh_metrics(vertices, faces)
    assert metrics.is_closed
    assert metrics.euler_characteristic == 2
    assert metrics.area == pytest.approx(4 * np.pi * 0.7**2, rel=2e-3)
    assert metrics.volume == pytest.approx(4 / 3 * np.pi * 0.7**3, rel=2e-3)


@pytest.mark.parametrize("method", METHODS)
def test_a_torus_has_one_hole(method):
    metrics = mesh_metrics(*marching_cubes(_torus(*lattice(48)), 0.0, method=method)[:2])
    assert metrics.euler_characteristic == 0
    assert metrics.components == 1
