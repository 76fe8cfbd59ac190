"""The public function: arguments checked, method chosen, result made ready."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.kernels.marching.lattice import sample_lattice
from volviz.kernels.marching.passes import Extraction
from volviz.kernels.marching.surface import clean_mesh, drop_unused_vertices, face_normals
from volviz.kernels.marching.tables import (
    CellTables,
    lorensen_tables,
    mirrored,
    tetrahedra_tables,
    with_hidden_cases,
)
from volviz.kernels.marching.topology import TopologicalTables, topological_tables

Array = npt.NDArray[Any]

METHODS = ("lorensen", "topological", "tetrahedra")
_OTHER_NAMES = {"marching_cubes": "lorensen", "marching_tetrahedra": "tetrahedra"}


def marching_cubes(
    scalars: npt.ArrayLike,
    isovalue: float,
    *,
    method: str = "lorensen",
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    origin: Sequence[float] = (0.0, 0.0, 0.0),
    direction: npt.ArrayLike | None = None,
    stride: int = 1,
    normals: Literal["gradient", "flat"] | None = "gradient",
    mask: npt.ArrayLike | None = None,
    bounds: Sequence[int] | None = None,
    clean: bool = False,
    progress: Callable[[float], object] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> tuple[npt.NDArray[Any], Array, npt.NDArray[np.float32] | None]:
    """Triangles of the surface on which the scalars have a given value.

    A voxel is inside when its value is at least the isovalue. The mesh is closed but for the border of the
    volume (and of `mask`), edge-manifold, and the same whatever the number of threads.

    Parameters
    ----------
    scalars : array_like of shape (Z, Y, X)
        bool, integers or real numbers of any width; integers are not copied to floats. NaN is outside; at NaN
        and infinities the surface passes through the finite neighbour, so no vertex is ever NaN.
    isovalue : float
        In data units, finite. Outside the range of the scalars the mesh is empty.
    method : {"lorensen", "topological", "tetrahedra"}, default: "lorensen"
        The classic 256 cases (Lorensen and Cline 1987); the topology of the trilinear interpolant (Chernyaev
        1995; Nielson 2003); six tetrahedra a cell (Bloomenthal 1994). "marching_cubes" and
        "marching_tetrahedra" are other names of the first and the last.
    spacing : tuple of 3 floats, default: (1.0, 1.0, 1.0)
        Distance between voxel centres along (x, y, z), in world units, greater than 0.
    origin : tuple of 3 floats, default: (0.0, 0.0, 0.0)
        World position (x, y, z) of voxel (0, 0, 0).
    direction : array_like of shape (3, 3), default: identity
        Its columns are the world directions of the index axes. Triangles keep facing outward when it is
        left-handed.
    stride : int, default: 1
        Use every n-th voxel along each axis; the last, shorter cell is kept.
    normals : {"gradient", "flat"} or None, default: "gradient"
        One normal a vertex from interpolated central differences; one a triangle; or none.
    mask : array_like of shape (Z, Y, X), bool, optional
        Only cells whose eight corners are all True are used; the surface is open at their border.
    bounds : tuple of 6 ints (i0, i1, j0, j1, k0, k1), optional
        First and last voxel along x, y and z of the part to use, in voxel indices. Positions do not change;
        gradients at the faces of the part become one-sided.
    clean : bool, default: False
        Merge coincident vertices and drop triangles without area. Off, the mesh stays a manifold also where
        the isovalue equals samples.
    progress : callable, optional
        Called with the finished fraction, 0..1, in the calling thread.
    cancel : callable, optional
        Asked now and then; when it returns True the extraction ends with `Cancelled`.

    Returns
    -------
    vertices : ndarray of shape (V, 3), float32
        World positions (x, y, z); float64 for a lattice so far from the origin that 32 bits would lose parts of a
        voxel.
    faces : ndarray of shape (F, 3), int32 (int64 from 2^31 vertices on)
        Three different vertices each, counter-clockwise seen from where values are lower.
    normals : ndarray of shape (V, 3) or, flat, (F, 3), float32, or None
        Unit vectors (x, y, z) pointing to lower values. Where the gradient vanishes, the direction of the
        crossed edge; for flat normals of triangles without area (0, 0, 0).

    Raises
    ------
    InputError
        An argument is not one of the above.
    Cancelled
        `cancel` returned True.
    """
    value = checked_isovalue(isovalue)
    name = checked_method(method)
    if normals not in {"gradient", "flat", None}:
        raise InputError(f"normals is {normals!r}; choose 'gradient', 'flat' or None.")
    lattice = sample_lattice(scalars, spacing, origin, direction, stride, bounds)
    away = None
    if lattice.is_far:
        # computed about the first voxel of the part, moved in the end
        away = lattice.first_position
        lattice = lattice.moved(-away)
    chosen = None if mask is None else _mask(mask, np.shape(scalars))[lattice.choice]
    threshold = threshold_of(lattice.samples.dtype, value)
    if threshold is None:
        return _empty(normals)
    tables, topology = tables_of(name)
    if chosen is not None:
        tables = with_hidden_cases(tables)
    if lattice.is_mirrored:
        tables = mirrored(tables)
    extraction = Extraction(
        lattice,
        value,
        tables,
        with_normals=normals == "gradient",
        topology=topology,
        mask=chosen,
        progress=progress,
        cancel=cancel,
    )
    vertices, faces, shading = extraction.run(threshold)
    if chosen is not None:
        vertices, faces, shading = drop_unused_vertices(vertices, faces, shading)
    if clean:
        vertices, faces, shading = clean_mesh(vertices, faces, shading)
    if normals == "flat":
        shading = face_normals(vertices, faces)
    return vertices if away is None else vertices + away, faces, shading


def warm_up(dtype: npt.DTypeLike = np.uint8, methods: Sequence[str] = ("lorensen",)) -> None:
    """Compile, or load from disk, what extractions from volumes of one type need.

    Without compiled code on disk this takes seconds, and numba holds the interpreter lock for parts of that; with it,
    fractions of a second. A window calls it on a worker when a volume has been loaded.

    Parameters
    ----------
    dtype : dtype, default: uint8
        Type of the scalars.
    methods : sequence of str, default: ("lorensen",)
        See `marching_cubes`.
    """
    tiny = np.zeros((3, 3, 3), dtype)
    tiny[1, 1, 1] = 1
    for method in methods:
        marching_cubes(tiny, 0.5, method=method)


def checked_method(method: str) -> str:
    """One of `METHODS`, by any of its names.

    Raises
    ------
    InputError
        It is none of them.
    """
    name = _OTHER_NAMES.get(str(method), method)
    if name not in METHODS:
        raise InputError(f"method is {method!r}; choose one of {', '.join(map(repr, METHODS))}.")
    return name


def tables_of(method: str) -> tuple[CellTables, TopologicalTables | None]:
    """The tables of one of `METHODS`, and how it decides ambiguous cells."""
    if method == "topological":
        topology = topological_tables()
        return topology.cells, topology
    return (lorensen_tables() if method == "lorensen" else tetrahedra_tables()), None


def _mask(mask: npt.ArrayLike, shape: tuple[int, ...]) -> npt.NDArray[np.bool_]:
    array = np.asarray(mask)
    if array.dtype != np.bool_ or array.shape != shape:
        raise InputError(f"mask has shape {array.shape} and type {array.dtype}; give bool of shape {shape}.")
    return array


def checked_isovalue(isovalue: Any) -> float:
    """A finite number; anything else is an `InputError`."""
    try:
        value = float(isovalue)
    except (TypeError, ValueError):
        raise InputError(f"isovalue must be a number, got {isovalue!r}.") from None
    if not math.isfinite(value):
        raise InputError(f"isovalue must be finite, got {value}.")
    return value


def threshold_of(dtype: np.dtype[Any], isovalue: float) -> Any:
    """Lowest value that is inside, in the type that `native_slab` gives; None when all or none are."""
    if dtype.kind == "b":
        dtype = np.dtype(np.uint8)
    if dtype.kind in "iu":
        limits = np.iinfo(dtype)
        lowest = math.ceil(isovalue)
        return dtype.type(lowest) if int(limits.min) < lowest <= int(limits.max) else None
    real = np.float64 if dtype.itemsize > 4 else np.float32
    with np.errstate(over="ignore"):
        limit = real(isovalue)
    return limit if float(limit) >= isovalue else np.nextafter(limit, real(np.inf))


def _empty(normals: str | None) -> tuple[npt.NDArray[np.float32], Array, npt.NDArray[np.float32] | None]:
    nothing = np.empty((0, 3), np.float32)
    return nothing, np.empty((0, 3), np.int32), None if normals is None else nothing.copy()
