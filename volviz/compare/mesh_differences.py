"""Why two isosurfaces of one volume differ: cell by cell, grouped by the case of the cell."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from volviz.kernels.marching.cube import boundary_loops

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

Array = npt.NDArray[Any]
Mesh = tuple[Array, Array]

#: What a difference can come from, in words.
REASONS = {
    "diagonals": "same polygons, cut into triangles along other diagonals",
    "sample": "a corner has the isovalue itself, so that vertices coincide and triangles have no area",
    "connection": "the polygons connect the same vertices in another way",
    "vertices": "a vertex lies elsewhere",
}


@dataclass(frozen=True)
class VertexMatch:
    """Vertices of two meshes, matched by position.

    Attributes
    ----------
    ours, theirs : int
        Vertices of each mesh.
    only_ours, only_theirs : int
        Positions without a partner within the tolerance.
    largest_distance : float
        Largest distance of a position to the nearest one of the other mesh, in world units.
    tolerance : float
        1e-5 of the smallest spacing, or 2 units in the last place of the largest coordinate where that is
        more.
    """

    ours: int
    theirs: int
    only_ours: int
    only_theirs: int
    largest_distance: float
    tolerance: float

    @property
    def are_identical(self) -> bool:
        """Tell whether every vertex has its partner."""
        return self.only_ours == self.only_theirs == 0


@dataclass(frozen=True)
class CaseDifference:
    """Cells of one kind in which the triangles differ.

    Attributes
    ----------
    inside_corners : int
        Corners inside, 0..8.
    polygons : tuple of int
        Sides of the polygons in which the surface leaves such a cell, ascending.
    reason : str
        One of `REASONS`.
    cells : int
        How many cells.
    our_triangles, their_triangles : int
        Triangles that only one of the meshes has there.
    area_difference : float
        Our area minus theirs in these cells, in squared world units.
    """

    inside_corners: int
    polygons: tuple[int, ...]
    reason: str
    cells: int
    our_triangles: int
    their_triangles: int
    area_difference: float


def position_tolerance(rounding: float, spacing: tuple[float, float, float]) -> float:
    """Distance up to which two positions are the same, in world units: 32-bit floats say no more.

    Parameters
    ----------
    rounding : float
        Distance from the largest coordinate to the next 32-bit float, in world units.
    spacing : tuple of 3 floats
        Of the volume.
    """
    return math.sqrt(3) * max(1e-5 * min(spacing), 2 * rounding)


def match_vertices(
    ours: Array, theirs: Array, spacing: tuple[float, float, float]
) -> tuple[VertexMatch, Array]:
    """Match vertices by position.

    Parameters
    ----------
    ours, theirs : ndarrays of shape (N, 3) and (M, 3)
        World positions (x, y, z).
    spacing : tuple of 3 floats
        Of the volume.

    Returns
    -------
    match : VertexMatch
    partner : ndarray of shape (M,), int64
        For each of their vertices the nearest of ours, or -1.
    """
    positions, others = np.asarray(ours, np.float64), np.asarray(theirs, np.float64)
    largest = max((float(np.abs(p).max()) for p in (positions, others) if len(p)), default=0.0)
    tolerance = position_tolerance(float(np.spacing(np.float32(largest))), spacing)
    if not len(positions) or not len(others):
        distance = 0.0 if len(positions) == len(others) else np.inf
        match = VertexMatch(len(positions), len(others), len(positions), len(others), distance, tolerance)
        return match, np.full(len(others), -1, np.int64)
    # imported where it is needed: a start of the program does not wait for SciPy
    from scipy.spatial import cKDTree

    to_ours, partner = cKDTree(positions).query(others)
    to_theirs, _ = cKDTree(others).query(positions)
    match = VertexMatch(
        len(positions),
        len(others),
        int(np.count_nonzero(to_theirs > tolerance)),
        int(np.count_nonzero(to_ours > tolerance)),
        float(max(to_ours.max(), to_theirs.max())),
        tolerance,
    )
    return match, np.where(to_ours <= tolerance, partner, -1)


def explain_differences(
    ours: Mesh, theirs: Mesh, partner: Array, volume: Volume, isovalue: float
) -> tuple[int, tuple[CaseDifference, ...]]:
    """Compare the triangles of two cleaned meshes and group the different ones by the case of their cell.

    Parameters
    ----------
    ours, theirs : vertices (V, 3) and faces (F, 3)
        Without coincident vertices.
    partner : ndarray
        See `match_vertices`.
    volume : Volume
        What both are surfaces of.
    isovalue : float
        In data units.

    Returns
    -------
    common : int
        Triangles that both have.
    differences : tuple of CaseDifference
        Most cells first.
    """
    # Vertices without partner get numbers of their own.
    number = np.where(partner >= 0, partner, len(ours[0]) + np.arange(len(partner)))
    keys = (_turned(ours[1]), _turned(number[theirs[1]]))
    only = _missing(keys[0], keys[1]), _missing(keys[1], keys[0])
    common = len(keys[0]) - int(np.count_nonzero(only[0]))
    sides = []
    for mesh, key, chosen in zip((ours, theirs), keys, only, strict=True):
        faces = mesh[1][chosen]
        sides.append((_cells(mesh[0], faces, volume), key[chosen], _areas(mesh[0], faces)))
    if not any(len(side[0]) for side in sides):
        return common, ()
    cells = np.unique(np.concatenate([side[0] for side in sides]))
    closes = _closes(cells, sides)
    columns = [np.searchsorted(cells, side[0]) for side in sides]
    counts = [np.bincount(c, minlength=len(cells)) for c in columns]
    areas = [np.bincount(c, side[2], minlength=len(cells)) for c, side in zip(columns, sides, strict=True)]
    strange = np.bincount(columns[1], (sides[1][1] >= len(ours[0])).any(axis=1), minlength=len(cells)) > 0
    case, on_sample = _cases(cells, volume, isovalue)
    reasons = np.select([strange, on_sample, closes], ["vertices", "sample", "diagonals"], "connection")
    which = np.unique(reasons, return_inverse=True)[1]
    groups: dict[tuple[int, tuple[int, ...], str], list[Array]] = {}
    kinds = 256 * which.reshape(-1) + case
    order = np.argsort(kinds, kind="stable")
    edges = np.flatnonzero(np.diff(kinds[order], prepend=-1))
    for members in np.split(order, edges[1:]):
        number_of_case, reason = int(case[members[0]]), str(reasons[members[0]])
        kind = (number_of_case.bit_count(), _polygons(number_of_case), reason)
        groups.setdefault(kind, []).append(members)
    differences = [
        CaseDifference(
            inside, polygons, reason, len(places),
            int(counts[0][places].sum()), int(counts[1][places].sum()),
            float((areas[0][places] - areas[1][places]).sum()),
        )
        for (inside, polygons, reason), places in (
            (kind, np.sort(np.concatenate(members))) for kind, members in groups.items()
        )
    ]  # fmt: skip
    return common, tuple(
        sorted(differences, key=lambda d: (-d.cells, d.inside_corners, d.polygons, d.reason))
    )


@cache
def _polygons(case: int) -> tuple[int, ...]:
    return tuple(sorted(len(loop) for loop in boundary_loops(case)))


def _turned(faces: Array) -> Array:
    """Each triangle turned to begin with its lowest vertex."""
    triangles = np.asarray(faces, np.int64).reshape(-1, 3)
    first = np.argmin(triangles, axis=1) if len(triangles) else np.empty(0, np.int64)
    return np.take_along_axis(triangles, (first[:, None] + np.arange(3)) % 3, axis=1)


def _missing(triangles: Array, others: Array) -> Array:
    """Tell which triangles are not among the others."""
    keys = _keys(np.concatenate([triangles, others]))
    wanted, there = keys[: len(triangles)], np.sort(keys[len(triangles) :])
    if not len(there):
        return np.ones(len(triangles), bool)
    place = np.minimum(np.searchsorted(there, wanted), len(there) - 1)
    return np.asarray(there[place] != wanted)


def _keys(rows: Array) -> Array:
    """One number for each different row of non-negative integers, ascending in lexical order, not dense."""
    limits = [int(column.max(initial=0)) + 1 for column in rows.T]
    if math.prod(limits) >= 2**63:
        return _names(rows)
    keys: Array = np.zeros(len(rows), np.int64)
    for column, limit in zip(rows.T, limits, strict=True):
        keys *= limit
        keys += column
    return keys


def _names(rows: Array) -> Array:
    """The same with the numbers 0, 1, 2 ..., for rows whose keys would not fit into 64 bits."""
    names: Array = np.zeros(len(rows), np.int64)
    for column in rows.T:
        values, ranks = np.unique(column, return_inverse=True)
        # Ranks are below the number of rows, so that products of two of them fit.
        names = np.unique(names * max(len(values), 1) + ranks, return_inverse=True)[1]
    return names


def _cells(vertices: Array, faces: Array, volume: Volume) -> Array:
    """Number of the cell that holds each triangle."""
    to_index = volume.world_to_index
    middles = np.asarray(vertices, np.float64)[faces].mean(axis=1) @ to_index[:3, :3].T + to_index[:3, 3]
    nearest = np.rint(middles)
    middles = np.where(np.abs(middles - nearest) < 1e-4, nearest, middles)
    x, y, z = np.clip(np.floor(middles).astype(np.int64), 0, np.array(volume.dimensions) - 2).T
    width, height, _ = volume.dimensions
    cells: Array = (z * height + y) * width + x
    return cells


def _areas(vertices: Array, faces: Array) -> Array:
    corners = np.asarray(vertices, np.float64)[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(np.linalg.norm(cross, axis=1) / 2)


def _closes(cells: Array, sides: list[tuple[Array, Array, Array]]) -> Array:
    """Tell for each cell whether both sets of triangles have the same rim: their sides cancel."""
    rows = []
    for sign, (owner, triangles, _) in zip((1, -1), sides, strict=True):
        for i in range(3):
            a, b = triangles[:, i], triangles[:, (i + 1) % 3]
            direction = sign * np.where(a < b, 1, -1)
            rows.append(np.stack([owner, np.minimum(a, b), np.maximum(a, b), direction], axis=1))
    table = np.concatenate(rows)
    keys = _keys(table[:, :3])
    order = np.argsort(keys)
    ordered = keys[order]
    first = np.flatnonzero(np.concatenate([[True], ordered[1:] != ordered[:-1]]))
    balance = np.add.reduceat(table[order, 3], first)
    closes = np.ones(len(cells), bool)
    closes[np.searchsorted(cells, table[order[first[balance != 0]], 0])] = False
    return closes


def _cases(cells: Array, volume: Volume, isovalue: float) -> tuple[Array, Array]:
    """Case of each cell, and whether one of its corners has the isovalue itself."""
    width, height, _ = volume.dimensions
    z, rest = np.divmod(cells, width * height)
    y, x = np.divmod(rest, width)
    case = np.zeros(len(cells), np.int64)
    on_sample = np.zeros(len(cells), bool)
    for corner in range(8):
        values = volume.array[z + (corner >> 2), y + (corner >> 1 & 1), x + (corner & 1)]
        case |= (values >= isovalue).astype(np.int64) << corner
        on_sample |= values == isovalue
    return case, on_sample
