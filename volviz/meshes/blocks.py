"""The isosurface of a volume that need not fit into memory: read and extracted block by block."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import Cancelled, InputError
from volviz.meshes.extraction import Triangles

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.volume_data.source import VolumeSource

#: Fewer voxels along an edge of a block are mostly border.
SMALLEST = 8


def isosurface_by_blocks(
    source: VolumeSource,
    isovalue: float,
    method: str = "lorensen",
    *,
    block: int = 256,
    level: int = 0,
    time: int | None = None,
    channel: int | str | None = None,
    progress: Callable[[float], object] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> Triangles:
    """Surface on which the values have a given value; in memory are two blocks and the mesh.

    Parameters
    ----------
    source : VolumeSource
    isovalue : float
        In data units.
    method : {"lorensen", "topological", "tetrahedra"}
        As for `volviz.marching_cubes`.
    block : int
        Cells along the edges of a block, at least 8.
    level, time, channel
        As for `VolumeSource.read`.
    progress, cancel
        As for `volviz.marching_cubes`.

    Returns
    -------
    Triangles
        Vertex for vertex and triangle for triangle the mesh of the whole volume, in world units.

    Raises
    ------
    InputError
        An argument is not one of the above.
    LoadError
        The source cannot be read.
    Cancelled
        `cancel` returned True.
    """
    # here, where something is extracted: it imports numba
    from volviz.kernels.marching.blocks import BlockExtraction, joined
    from volviz.volume_data.source import checked_number

    if block < SMALLEST:
        raise InputError(f"blocks must have at least {SMALLEST} cells along an edge, got {block}.")
    lattice = source.levels[checked_number("level", level, len(source.levels), source.name)]
    to_world = np.column_stack([np.asarray(lattice.direction) * lattice.spacing, lattice.origin])
    extraction = BlockExtraction(lattice.dimensions, to_world, isovalue, method)
    blocks = _blocks(lattice.dimensions, block)

    def read(number: int) -> npt.NDArray[Any]:
        box = extraction.box(blocks[number])
        return source.read(level, time, channel, box, cancel).array

    lowest: float | None = None
    parts = []
    for number, values in enumerate(_read_ahead(read, len(blocks))):
        if cancel is not None and cancel():
            raise Cancelled("The extraction of the isosurface was cancelled.")
        samples = values
        if values.dtype.kind == "f" and not np.isfinite(values).all():
            # what is not finite counts as the lowest value of all, which a further pass must find
            if lowest is None:
                lowest = min(_lowest(each) for each in _read_ahead(read, len(blocks)))
            samples = np.where(np.isfinite(values), values, values.dtype.type(lowest))
        parts.append(extraction.extract(samples, blocks[number]))
        if progress is not None:
            progress((number + 1) / len(blocks))
    return Triangles(*joined(parts, extraction.shift))


def _blocks(dimensions: tuple[int, int, int], edge: int) -> list[tuple[int, ...]]:
    """First and last voxel of each block along x, y and z; a sliver at the end belongs to the block before it."""
    cuts = []
    for n in dimensions:
        first = list(range(0, max(n - 1 - SMALLEST, 1), edge))
        cuts.append(list(zip(first, [*first[1:], n - 1], strict=True)))
    return [(*x, *y, *z) for z in cuts[2] for y in cuts[1] for x in cuts[0]]


def _lowest(values: npt.NDArray[Any]) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.min()) if finite.size else np.inf


def _read_ahead(read: Callable[[int], npt.NDArray[Any]], count: int) -> Iterator[npt.NDArray[Any]]:
    """What is read one after another, the next while one is worked on."""
    with ThreadPoolExecutor(1, thread_name_prefix="volviz-read-ahead") as pool:
        ahead: Future[npt.NDArray[Any]] = pool.submit(read, 0)
        for number in range(count):
            values = ahead.result()
            if number + 1 < count:
                ahead = pool.submit(read, number + 1)
            yield values
