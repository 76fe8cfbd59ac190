"""Isosurfaces block by block: parts of a volume give parts of one mesh, vertex for vertex that of the whole.

A vertex lies on an edge of the lattice, which names it whatever the block that finds it. Blocks are extracted with one
voxel more on all sides, so that gradients at their faces are those of the whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.kernels.marching.extract import checked_isovalue, checked_method, tables_of, threshold_of
from volviz.kernels.marching.lattice import Lattice
from volviz.kernels.marching.passes import Extraction
from volviz.kernels.marching.tables import mirrored, with_hidden_cases

Array = npt.NDArray[Any]
Ints = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class BlockMesh:
    """Part of a mesh.

    Attributes
    ----------
    keys : ndarray of shape (V,), int64
        Names of the vertices, ascending as in the mesh of the whole.
    vertices, normals : ndarray of shape (V, 3), float32
    faces : ndarray of shape (F, 3), int64
        Names of the vertices of each triangle.
    rows : ndarray of shape (F,), int64
        Row of cells that holds each triangle; equal ones follow one another along x.
    """

    keys: Ints
    vertices: Array
    normals: Array
    faces: Ints
    rows: Ints


class BlockExtraction:
    """An isosurface whose volume is seen one block at a time.

    Parameters
    ----------
    dimensions : tuple of 3 ints
        Voxels of the whole volume along (x, y, z).
    to_world : ndarray of shape (3, 4)
        From voxel index (i, j, k, 1) to world (x, y, z).
    isovalue, method
        As for `volviz.marching_cubes`.

    Raises
    ------
    InputError
        An isovalue or method that is none.
    """

    def __init__(self, dimensions: Sequence[int], to_world: Array, isovalue: float, method: str) -> None:
        self.dimensions = tuple(int(n) for n in dimensions)
        self.isovalue = checked_isovalue(isovalue)
        self._tables, self._topology = tables_of(checked_method(method))
        whole = Lattice(
            np.empty((0, 0, 0)),
            tuple(np.arange(n, dtype=np.float64) for n in self.dimensions),  # type: ignore[arg-type]
            np.asarray(to_world, np.float64),
            (slice(None), slice(None), slice(None)),
        )
        # far from the origin of the world positions are computed about the first voxel, and moved in the end
        self.shift = whole.first_position if whole.is_far else None
        self._whole = whole if self.shift is None else whole.moved(-self.shift)

    def box(self, block: Sequence[int]) -> tuple[int, ...]:
        """Voxels (i0, i1, j0, j1, k0, k1), i1, j1 and k1 no more, to read for cells from voxel i0 to i1 and so on."""
        return tuple(
            limit
            for low, high, n in zip(block[::2], block[1::2], self.dimensions, strict=True)
            for limit in (max(low - 1, 0), min(high + 2, n))
        )

    def extract(self, samples: Array, block: Sequence[int]) -> BlockMesh:
        """The part of the mesh in a block of cells.

        Parameters
        ----------
        samples : ndarray of shape (z, y, x)
            Finite values of the voxels in `box`.
        block : sequence of 6 ints
            First and last voxel of the block along x, y and z; blocks share these.
        """
        threshold = threshold_of(samples.dtype, self.isovalue)
        empty = np.empty((0, 3), np.float32)
        no_mesh = BlockMesh(
            np.empty(0, np.int64), empty, empty, np.empty((0, 3), np.int64), np.empty(0, np.int64)
        )
        if threshold is None or not samples.min() < threshold <= samples.max():
            return no_mesh
        i0, i1, j0, j1, k0, k1 = self.box(block)
        first = (i0, j0, k0)
        xs, ys, zs = (
            axis[low:high]
            for axis, low, high in zip(self._whole.coordinates, first, (i1, j1, k1), strict=True)
        )
        lattice = Lattice(
            samples, (xs, ys, zs), self._whole.to_world, (slice(None), slice(None), slice(None))
        )
        tables = with_hidden_cases(self._tables)
        if lattice.is_mirrored:
            tables = mirrored(tables)
        own = np.zeros(samples.shape, bool)
        own[tuple(
            slice(low - f, high - f + 1)
            for low, high, f in zip(block[4::-2], block[:0:-2], reversed(first), strict=True)
        )] = True  # fmt: skip
        extraction = Extraction(
            lattice, self.isovalue, tables, with_normals=True, topology=self._topology, mask=own
        )
        vertices, faces, normals = extraction.run(threshold)
        assert normals is not None
        if not len(faces):
            return no_mesh
        keys = self._keys(samples >= threshold, extraction, first, len(vertices))
        rows = self._rows(extraction, first, len(faces))
        named = keys[faces]
        used = np.zeros(len(vertices), bool)
        used[faces] = True
        return BlockMesh(keys[used], vertices[used], normals[used], named, rows)

    def _keys(
        self, inside: npt.NDArray[np.bool_], extraction: Extraction, first: Sequence[int], count: int
    ) -> Ints:
        """Names of all vertices of an extraction: plane, kind, row and place of the edge, as the whole counts them.

        Vertices in the middle of cells come after all others.
        """
        width, height, depth = self.dimensions
        kinds = len(extraction.steps)
        found = []
        for kind, step in enumerate(extraction.steps.tolist()):
            dx, dy, dz = step & 1, step >> 1 & 1, step >> 2 & 1
            nz, ny, nx = inside.shape
            crossed = inside[: nz - dz, : ny - dy, : nx - dx] != inside[dz:, dy:, dx:]
            z, y, x = np.nonzero(crossed)
            found.append((((z + first[2]) * kinds + kind) * height + y + first[1]) * width + x + first[0])
        edges = np.sort(np.concatenate(found))
        if not extraction.has_middles:
            return edges
        starts = extraction.vertex_starts[:, kinds]
        rows = np.repeat(np.arange(starts.size), np.diff(np.append(starts.reshape(-1), count)))
        z, y = np.divmod(rows, starts.shape[1])
        row = (z + first[2]) * height + y + first[1]
        # several in a row, and several blocks along it: numbered from the first voxel of this one
        place = np.arange(len(rows)) - np.searchsorted(rows, rows)
        middles = depth * kinds * height * width + row * 8 * width + 8 * first[0] + place
        return np.concatenate([edges, middles])

    def _rows(self, extraction: Extraction, first: Sequence[int], count: int) -> Ints:
        """Row of cells of each triangle, as the whole counts them."""
        starts = extraction.triangle_starts
        rows = np.repeat(np.arange(starts.size), np.diff(np.append(starts.reshape(-1), count)))
        z, y = np.divmod(rows, starts.shape[1])
        return np.asarray((z + first[2]) * self.dimensions[1] + y + first[1], np.int64)


def joined(parts: Sequence[BlockMesh], shift: Array | None) -> tuple[Array, Array, Array]:
    """The mesh of the whole from those of its blocks, which come in ascending order along x.

    Parameters
    ----------
    parts : sequence of BlockMesh
    shift : ndarray of shape (3,) or None
        `BlockExtraction.shift`.

    Returns
    -------
    vertices, faces, normals
        As `volviz.marching_cubes` gives them for the whole volume.
    """
    if not any(len(part.faces) for part in parts):
        nothing = np.empty((0, 3), np.float32)
        return nothing, np.empty((0, 3), np.int32), nothing.copy()
    keys, first = np.unique(np.concatenate([part.keys for part in parts]), return_index=True)
    vertices = np.concatenate([part.vertices for part in parts])[first]
    normals = np.concatenate([part.normals for part in parts])[first]
    number = np.int32 if len(keys) < 2**31 else np.int64
    order = np.argsort(np.concatenate([part.rows for part in parts]), kind="stable")
    faces = np.concatenate([np.searchsorted(keys, part.faces).astype(number) for part in parts])[order]
    return vertices if shift is None else vertices + shift, faces, normals
