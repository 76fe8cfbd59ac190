"""What the tests of extraction share: volumes with known surfaces, and VTK's answers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.kernels.marching import marching_cubes
from volviz.kernels.mesh_metrics import MeshMetrics, mesh_metrics

Array = npt.NDArray[Any]

METHODS = ("lorensen", "topological", "tetrahedra")
DTYPES = (
    np.uint8, np.int8, np.uint16, np.int16, np.uint32, np.int32, np.uint64, np.int64, np.float32, np.float64,
)  # fmt: skip


def for_every_case(check: Callable[[int], None]) -> Callable[[], None]:
    """One test that goes through the 256 cases of a cell, and names the one that fails."""

    def test() -> None:
        for case in range(256):
            try:
                check(case)
            except AssertionError as error:
                error.add_note(f"case {case}")
                raise

    test.__name__ = check.__name__
    test.__doc__ = check.__doc__
    return test


def lattice(n: int, half: float = 1.0) -> tuple[Array, Array, Array]:
    """Coordinates x, y, z in -half..half of n^3 samples, each of shape (n, n, n) with axes (z, y, x)."""
    axis = np.linspace(-half, half, n)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    return x, y, z


def sphere(n: int, radius: float = 0.7, dtype: Any = np.float32) -> Array:
    """Field that is `radius` minus the distance from the centre: 0 on the sphere, positive inside."""
    x, y, z = lattice(n)
    return (radius - np.sqrt(x * x + y * y + z * z)).astype(dtype)


def noise(shape: tuple[int, ...], dtype: Any, seed: int = 0) -> Array:
    """White noise of any type: 0..250 for unsigned, -120..120 for signed numbers."""
    values = np.random.default_rng(seed).random(shape)
    if np.dtype(dtype).kind == "u":
        return (values * 250).astype(dtype)
    return (values * 240 - 120).astype(dtype)


def closed(array: Array) -> Array:
    """The same volume in a shell of its lowest value, so that surfaces above that value are closed."""
    return np.pad(array, 1, constant_values=array.min())


def metrics_of(array: Array, isovalue: float, **keywords: Any) -> MeshMetrics:
    """Figures of the mesh of one extraction."""
    vertices, faces, _ = marching_cubes(array, isovalue, **keywords)
    return mesh_metrics(vertices, faces)
