"""The volume within an isosurface.

The error has two parts, as for points along a ray (`volviz.measure.points`): the surface of every second voxel, for
each of the eight ways to choose them, and that of means of eight voxels. How far these are off together is the error
of the extraction (after Roache 1994; `SAFETY`); how much they differ is where voxels happen to lie, and noise. The
latter is found for each of the six sides of the body, since opposite faces may hide from each other what they are
off.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from volviz.errors import Cancelled, InputError
from volviz.measure.results import Float64Array, Measured, cell_volume, length_unit
from volviz.model.measurements import COVERAGE
from volviz.volume_data.volume import Volume

#: By how much the error of the second order, a third of what both levels differ by, is widened. Roache takes 3 for two
#: levels; here two kinds of coarser level are compared, and the farther one counts.
SAFETY = 2.0

Triangles = tuple[Float64Array, npt.NDArray[Any]]


def isosurface_volume(
    volume: Volume,
    isovalue: float,
    *,
    isovalue_error: float = 0.0,
    part: Literal["all", "largest"] | Sequence[float] = "all",
    progress: Callable[[float], object] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> Measured:
    """Volume within the surface of an isovalue, where values are at least the isovalue.

    A surface that meets the border of the volume is closed there, at the outermost voxel centres.

    Parameters
    ----------
    volume : Volume
    isovalue : float
        In data units.
    isovalue_error : float
        Half-width of the 95 % interval in which the right isovalue lies.
    part : {"all", "largest"} or 3 floats
        All connected parts; the one with the most triangles; or the one that passes nearest to a world point. A
        cavity is a part of its own.
    progress, cancel : callable, optional
        As for `volviz.marching_cubes`.

    Returns
    -------
    Measured
        In cubic world units.

    Raises
    ------
    InputError
        The isovalue lies outside the values: there is no surface.
    Cancelled
        `cancel` returned True.
    """
    array = volume.finite_array
    choose = _chooser(volume, part)
    levels = _levels(array)
    found: list[Float64Array] = []
    middle = np.zeros(3)
    for n, (values, step, shift) in enumerate(levels):
        if cancel is not None and cancel():
            raise Cancelled("measuring was stopped; nothing was changed.")
        vertices, faces = choose(_surface(values, isovalue, step, shift, cancel))
        if n == 0 and len(vertices):
            middle = vertices.mean(axis=0)
        found.append(_sides(vertices - middle, faces))
        if progress is not None:
            progress((n + 1) / len(levels))
    size = _volume(found[0])
    if size == 0:
        low, high = volume.range
        raise InputError(
            f"{volume.name} has no surface of {isovalue:g}; its values lie between {low:g} and {high:g}."
        )
    cell = cell_volume(volume)
    coarse, means = np.array(found[1:-1]), found[-1]
    off = max(abs(size - float(np.mean([_volume(sides) for sides in coarse]))), abs(size - _volume(means)))
    # variances grow at least with the square of the spacing: from one level to the next by three of the finer
    spread = math.sqrt(float(coarse.var(axis=0).sum()) / 3)
    doubt = 0.0
    if isovalue_error > 0:
        around = [
            _volume(_sides(*choose(_surface(array, isovalue + by, 1, np.zeros(3), cancel))))
            for by in (-isovalue_error, isovalue_error)
        ]
        doubt = max(abs(other - size) for other in around)
    error = math.hypot(SAFETY / 3 * off, COVERAGE * spread, doubt)
    return Measured(size * cell, f"{length_unit(volume)}³", error * cell)


def _levels(array: npt.NDArray[Any]) -> list[tuple[npt.NDArray[Any], int, Float64Array]]:
    """Values, their distance in voxels and the index of the first: all, every second of eight kinds, means of eight."""
    levels: list[tuple[npt.NDArray[Any], int, Float64Array]] = [(array, 1, np.zeros(3))]
    for corner in range(8):
        i, j, k = corner & 1, corner >> 1 & 1, corner >> 2 & 1
        levels.append((array[k::2, j::2, i::2], 2, np.array([i, j, k], np.float64)))
    even = array[tuple(slice(n // 2 * 2) for n in array.shape)]
    shape = [size for n in even.shape for size in (n // 2, 2)]
    means = even.reshape(shape).mean(axis=(1, 3, 5), dtype=np.float64)
    levels.append((means, 2, np.full(3, 0.5)))
    return levels


def _surface(
    values: npt.NDArray[Any],
    isovalue: float,
    step: int,
    shift: Float64Array,
    cancel: Callable[[], bool] | None,
) -> Triangles:
    """Triangles in voxel indices, closed at the border."""
    from volviz.kernels.marching import marching_cubes

    # next to what is not finite the surface passes through the finite neighbour
    closed = np.pad(values.astype(np.result_type(values.dtype, np.float32)), 1, constant_values=np.nan)
    vertices, faces, _ = marching_cubes(closed, isovalue, normals=None, cancel=cancel)
    return (vertices.astype(np.float64) - 1.0) * step + shift, faces


def _chooser(volume: Volume, part: Any) -> Callable[[Triangles], Triangles]:
    """What takes the part of a surface that is asked for."""
    if isinstance(part, str):
        if part not in ("all", "largest"):
            raise InputError(f"part of an isosurface must be all, largest or a world point, got {part!r}.")
        if part == "all":
            return lambda triangles: triangles
        point = None
    else:
        point = volume.world_to_index @ (*(float(v) for v in part), 1.0)

    def choose(triangles: Triangles) -> Triangles:
        from volviz.kernels.marching import face_components

        vertices, faces = triangles
        if not len(faces):
            return triangles
        numbers, _ = face_components(faces, len(vertices))
        if point is None:
            chosen = int(np.argmax(np.bincount(numbers)))
        else:
            away = np.linalg.norm(vertices - point[:3], axis=1)[faces].min(axis=1)
            chosen = int(numbers[int(np.argmin(away))])
        return vertices, faces[numbers == chosen]

    return choose


def _sides(vertices: Float64Array, faces: npt.NDArray[Any]) -> Float64Array:
    """Volume within a closed mesh by what each side adds to it, along each axis: shape (3, 2), lower and higher side.

    By the divergence theorem the volume is the integral of one coordinate times the normal along it; so the sum along
    each axis is the volume. Coordinates count from the middle of the body: what cancels between the sides is small.
    """
    a, b, c = (vertices[faces[:, n]] for n in range(3))
    normals = np.cross(b - a, c - a) / 2
    parts = (a + b + c) / 3 * normals
    higher = normals > 0
    return np.stack(
        [np.where(higher, 0.0, parts).sum(axis=0), np.where(higher, parts, 0.0).sum(axis=0)], axis=1
    )


def _volume(sides: Float64Array) -> float:
    """Of the body: the same along each axis but for rounding; that of a cavity counts as it is."""
    return abs(float(sides.sum(axis=1).mean()))
