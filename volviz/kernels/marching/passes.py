"""The passes of an extraction over the planes of a volume, on threads.

1. `mark`: which voxels are inside, as bits.
2. `list_cells`: crossed edges of every row counted, configurations of the active cells listed.
3. Cumulative sums over the rows give the exact sizes of the outputs and the place where each row writes.
4. `write_triangles` and `write_vertices` fill the outputs. Each thread writes to a range of its own, so the result does
   not depend on the number of threads.

Each thread reads its own planes of the volume and one more on either side. Only these are converted when the array is
not contiguous, has another byte order, or is mapped from disk.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import wait
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import Cancelled
from volviz.kernels.arrays import native_slab
from volviz.kernels.compiled import compiled
from volviz.kernels.marching.buffers import new_array
from volviz.kernels.marching.decisions import count_triangles, decide_configurations
from volviz.kernels.marching.lattice import Lattice
from volviz.kernels.marching.rows import (
    cell_words,
    count_vertices,
    list_active_cells,
    mark_inside,
    words_in_row,
)
from volviz.kernels.marching.tables import CellTables
from volviz.kernels.marching.topology import TopologicalTables
from volviz.kernels.marching.triangles import NUMBER_TRIANGLES
from volviz.kernels.marching.vertices import COLUMNS, Geometry, place_vertices
from volviz.kernels.threads import executor, split_range, worker_count

Array = npt.NDArray[Any]

#: Voxels in a piece of work: large enough for the cost of handing it over, small enough for even loads and
#: progress.
PIECE_VOXELS = 1 << 21
_NO_ROWS = np.full(256, -1, np.int64)
_NO_FACES = np.full((256, 6), -1, np.int64)
for _array in (_NO_ROWS, _NO_FACES):
    _array.flags.writeable = False

#: A volume smaller than this is not worth a second thread.
SINGLE_PIECE_VOXELS = 1 << 16


@compiled
def running_sums(counts: Array) -> int:
    """Replace counts by the sum of all that come before, in place, and return the sum of all; 1-D."""
    total = 0
    for i in range(counts.size):
        here = counts[i]
        counts[i] = total
        total += here
    return total


class Extraction:
    """One extraction in progress.

    Parameters
    ----------
    lattice : Lattice
        The samples and where they lie.
    isovalue : float
        In data units.
    tables : CellTables
        Of the chosen method, mirrored when the lattice is.
    with_normals : bool
        Compute normals from gradients.
    topology : TopologicalTables, optional
        How to decide ambiguous cells; `tables` are then its own.
    mask : ndarray of shape (Z, Y, X), bool, optional
        Only cells with all corners set are drawn; `tables` then end with 256 rows without triangles.
    progress : callable, optional
        Called with the finished fraction, 0..1, from the calling thread.
    cancel : callable, optional
        Asked between pieces; the extraction ends with `Cancelled` once it returns True.
    """

    def __init__(
        self,
        lattice: Lattice,
        isovalue: float,
        tables: CellTables,
        *,
        with_normals: bool,
        topology: TopologicalTables | None = None,
        mask: Array | None = None,
        progress: Callable[[float], object] | None = None,
        cancel: Callable[[], bool] | None = None,
    ) -> None:
        self.lattice = lattice
        self.isovalue = isovalue
        self.tables = tables
        self.with_normals = with_normals
        self.topology = topology
        self.mask = mask
        self.progress = progress
        self.cancel = cancel
        depth, height, width = self.samples.shape
        words = words_in_row(width)
        self.bits = new_array(depth * height * words, np.uint64).reshape(depth, height, words)
        self.cells = cell_words(width)
        self.steps = np.array(tables.steps, np.int64)
        # Kinds of vertices: one for each step, and one more for vertices in the middle of cells.
        self.has_middles = any(edge.step == 0 for edge in tables.edges)
        kinds = len(tables.steps) + self.has_middles
        self.vertex_starts = np.zeros((depth, kinds, height), np.int64)
        self.cell_counts = np.zeros((depth - 1, height - 1), np.int32)
        self.triangle_starts = np.zeros((depth - 1, height - 1), np.int64)
        self.configurations: list[Array] = []
        self.pieces = split_range(depth - 1, self._piece_count())

    @property
    def samples(self) -> Array:
        """The scalars, shape (Z, Y, X)."""
        return self.lattice.samples

    def _piece_count(self) -> int:
        size = self.samples.size
        if size < SINGLE_PIECE_VOXELS:
            return 1
        return max(2 * worker_count(), size // PIECE_VOXELS)

    def _for_all_pieces(self, work: Callable[[int, int, int], Any], begin: float, end: float) -> list[Any]:
        """Results of ``work(number, first, stop)`` over the planes of cells, on threads, in order."""
        if self.cancel is not None and self.cancel():
            raise Cancelled("The extraction of the isosurface was cancelled.")
        if len(self.pieces) == 1:
            result = [work(0, *self.pieces[0])]
            self._report(end)
            return result
        futures = [executor().submit(work, i, a, b) for i, (a, b) in enumerate(self.pieces)]
        try:
            results = []
            for i, future in enumerate(futures):
                results.append(future.result())
                self._report(begin + (end - begin) * (i + 1) / len(futures))
                if self.cancel is not None and self.cancel():
                    raise Cancelled("The extraction of the isosurface was cancelled.")
        finally:
            # After an error or a cancel nothing of this extraction stays behind in the pool.
            for future in futures:
                future.cancel()
            wait(futures)
        return results

    def _report(self, fraction: float) -> None:
        if self.progress is not None:
            self.progress(min(fraction, 1.0))

    def _planes(self, first: int, stop: int) -> int:
        """End of the planes of samples that go with planes of cells: the last piece has one more."""
        return stop + 1 if stop == self.samples.shape[0] - 1 else stop

    def run(self, threshold: Any) -> tuple[Array, Array, Array | None]:
        """Go through all passes.

        Parameters
        ----------
        threshold : scalar of the samples' native type
            Lowest value that is inside.

        Returns
        -------
        vertices : ndarray of shape (V, 3), float32
        faces : ndarray of shape (F, 3), int32 or int64
        normals : ndarray of shape (V, 3), float32, or None
        """
        self._for_all_pieces(lambda _, a, b: self.mark(a, b, threshold), 0.0, 0.1)
        self.configurations = self._for_all_pieces(self.list_cells, 0.1, 0.3)
        edges = len(self.steps)
        starts = self.vertex_starts
        if self.has_middles:
            middles = np.ascontiguousarray(starts[:, edges])
            on_edges = np.ascontiguousarray(starts[:, :edges])
            edge_vertices = running_sums(on_edges.reshape(-1))
            vertex_count = edge_vertices + running_sums(middles.reshape(-1))
            starts[:, :edges], starts[:, edges] = on_edges, middles + edge_vertices
        else:
            vertex_count = running_sums(starts.reshape(-1))
        face_count = running_sums(self.triangle_starts.reshape(-1))

        number_type = np.int32 if vertex_count < 2**31 else np.int64
        faces = new_array(3 * face_count, number_type)
        vertices = new_array(3 * vertex_count, np.float32)
        normals = new_array(3 * vertex_count if self.with_normals else 0, np.float32)
        self._for_all_pieces(lambda i, a, b: self.write_triangles(i, a, b, faces), 0.3, 0.5)
        self.configurations = []
        real = np.float32 if _fits_float32(self.samples.dtype) else np.float64
        geometry = self._geometry(real)
        self._for_all_pieces(lambda _, a, b: self.write_vertices(a, b, geometry, vertices, normals), 0.5, 1.0)
        shaped = normals.reshape(-1, 3) if self.with_normals else None
        if self.has_middles:
            place_middles(
                edge_vertices, vertices.reshape(-1, 3), faces.reshape(-1, 3), normals.reshape(-1, 3)
            )
        return vertices.reshape(-1, 3), faces.reshape(-1, 3), shaped

    def mark(self, first: int, stop: int, threshold: Any) -> None:
        """Set the bits of the planes of samples first..stop-1."""
        stop = self._planes(first, stop)
        mark_inside(native_slab(self.samples, first, stop), threshold, self.bits, first)

    def list_cells(self, _number: int, first: int, stop: int) -> Array:
        """Count crossed edges and list active cells of some planes."""
        width = self.samples.shape[2]
        count_vertices(
            self.bits, self.cells, self.steps, self.vertex_starts, first, self._planes(first, stop)
        )
        room = new_array((stop - first) * (self.samples.shape[1] - 1) * (width - 1) + 4, np.uint8)
        cells = list_active_cells(
            self.bits,
            self.cells,
            self.tables.triangle_count,
            room,
            self.cell_counts,
            self.triangle_starts,
            first,
            stop,
        )
        if self.topology is None and self.mask is None:
            return room[:cells].copy()
        return self.decide(room[:cells], first, stop)

    def decide(self, cases: Array, first: int, stop: int) -> Array:
        """Configurations of cells whose case alone does not say what to draw."""
        tables = self.tables
        mask = (
            np.empty((0, 0, 0), bool)
            if self.mask is None
            else np.ascontiguousarray(self.mask[first : stop + 1])
        )
        configurations = np.empty(len(cases), np.uint16)
        decided = self.topology
        decide_configurations(
            native_slab(self.samples, first, stop + 1), mask, first,
            self.bits, self.cells, self.isovalue, cases,
            _NO_ROWS if decided is None else decided.first_row,
            _NO_FACES if decided is None else decided.faces,
            _NO_ROWS if decided is None else decided.inside_regions,
            len(tables.triangle_count) - 256,
            configurations, first, stop,
        )  # fmt: skip
        middles = np.zeros(self.vertex_starts.shape[::2], np.int64)
        count_triangles(
            configurations, self.cell_counts, tables.triangle_count, tables.middle_count,
            self.triangle_starts, middles, first, stop,
        )  # fmt: skip
        if self.has_middles:
            self.vertex_starts[first:stop, len(self.steps)] = middles[first:stop]
        return configurations

    def write_triangles(self, number: int, first: int, stop: int, faces: Array) -> None:
        """Write the triangles of some planes of cells."""
        tables = self.tables
        kind = {step: k for k, step in enumerate(tables.steps)} | {0: len(tables.steps)}
        rows = [(kind[edge.step], edge.start >> 1 & 1, edge.start >> 2 & 1) for edge in tables.edges]
        NUMBER_TRIANGLES[tables.shift.shape[1]](
            self.configurations[number],
            self.cell_counts,
            self.triangle_starts,
            self.vertex_starts,
            np.array(rows, np.int64),
            tables.triangle_count,
            tables.triangles,
            tables.shift,
            tables.advance,
            faces,
            first,
            stop,
        )

    def _geometry(self, real: Any) -> Geometry:
        """What `place_vertices` wants to know of the lattice, gradients in the given type."""
        matrix = self.lattice.to_world[:, :3]
        to_normals = -np.linalg.inv(matrix).T
        to_normals /= np.abs(to_normals).max()
        axes = np.array([[s & 1, s >> 1 & 1, s >> 2 & 1] for s in self.steps], np.float64)
        directions = axes @ matrix.T
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        return Geometry(
            self.lattice.coordinates,
            self.lattice.gradient_neighbours(real),
            self.lattice.to_world,
            np.ascontiguousarray(to_normals, real),
            directions.astype(real),
            real(np.finfo(real).tiny),
        )

    def write_vertices(
        self, first: int, stop: int, geometry: Geometry, vertices: Array, normals: Array
    ) -> None:
        """Write vertices and normals of the edges that start in some planes."""
        depth = self.samples.shape[0]
        stop = self._planes(first, stop)
        slab_first = max(first - 1, 0)
        slab = native_slab(self.samples, slab_first, min(stop + 2, depth))
        columns = np.empty(COLUMNS, geometry.directions.dtype)
        short = slab.dtype.kind in "iu" and slab.dtype.itemsize <= 2
        raw = np.empty(COLUMNS, np.int32) if short else np.empty_like(columns)
        place_vertices(
            slab, slab_first, self.bits, self.cells, self.isovalue, self.steps, self.vertex_starts,
            geometry, columns, raw, vertices, normals, first, stop,
        )  # fmt: skip


@compiled
def place_middles(first: int, vertices: Array, faces: Array, normals: Array) -> None:
    """Put every vertex from number `first` on into the mean of its neighbours, its normal likewise.

    Parameters
    ----------
    first : int
        Number of the first vertex in the middle of a cell.
    vertices : ndarray of shape (V, 3), float32
        The rows from `first` on are written.
    faces : ndarray of shape (F, 3), integers
        Each triangle has at most one vertex in the middle of a cell.
    normals : ndarray of shape (V, 3) or (0, 3), float32
    """
    count = vertices.shape[0] - first
    sums = np.zeros((count, 6), np.float64)
    uses = np.zeros(count, np.int64)
    with_normals = normals.shape[0] > 0
    for f in range(faces.shape[0]):
        for i in range(3):
            middle = faces[f, i] - first
            if middle < 0:
                continue
            uses[middle] += 2
            for j in range(1, 3):
                other = faces[f, (i + j) % 3]
                for axis in range(3):
                    sums[middle, axis] += vertices[other, axis]
                    if with_normals:
                        sums[middle, 3 + axis] += normals[other, axis]
    for middle in range(count):
        if uses[middle] == 0:
            continue
        for axis in range(3):
            vertices[first + middle, axis] = sums[middle, axis] / uses[middle]
        if with_normals:
            x, y, z = sums[middle, 3], sums[middle, 4], sums[middle, 5]
            length = np.sqrt(x * x + y * y + z * z)
            if not length > 1e-12:
                x, y, z, length = 1.0, 0.0, 0.0, 1.0
            normals[first + middle, 0] = x / length
            normals[first + middle, 1] = y / length
            normals[first + middle, 2] = z / length


def _fits_float32(dtype: np.dtype[Any]) -> bool:
    """Tell whether every value of a type is a float32 as well."""
    return bool(np.can_cast(dtype.newbyteorder("="), np.float32, "safe"))
