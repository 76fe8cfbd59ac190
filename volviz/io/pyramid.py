"""Stored arrays with named axes, in one or several resolutions, as a source that reads boxes of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.axes import choose, to_zyx
from volviz.io.file_source import file_source
from volviz.io.memory import free_bytes, free_in_words

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.geometry import Geometry
    from volviz.io.reader import LoadRequest

Index = tuple["int | slice", ...]


@dataclass(frozen=True)
class StoredLevel:
    """One resolution of an array that lies in a file.

    Attributes
    ----------
    shape : tuple of int
        One size for each axis.
    geometry : Geometry
        Where its lattice lies.
    read : callable(index, LoadRequest) -> ndarray
        Values of a number or slice along each axis, in the file's order; tells the progress and can be cancelled.
    """

    shape: tuple[int, ...]
    geometry: Geometry
    read: Callable[[Index, LoadRequest], npt.NDArray[Any]]


def pyramid_source(
    request: LoadRequest,
    axes: str,
    levels: Sequence[StoredLevel],
    dtype: npt.DTypeLike,
    *,
    colour: bool | None = None,
    **described: Any,
) -> FileSource:
    """The source of an array in several resolutions.

    Parameters
    ----------
    request : LoadRequest
    axes : str
        One letter for each axis as it is stored: "T", "C", "S", "Z", "Y", "X"; "-" for one that nothing is known
        of, whose first entry is taken.
    levels : sequence of StoredLevel
        Finest first; those with a single voxel along an axis are left out.
    dtype : dtype
        Of the values.
    colour, **described
        As for `file_source`.

    Raises
    ------
    LoadError
        Values that are no numbers, axes that are none of a volume.
    """
    dtype = np.dtype(dtype)
    if dtype.kind not in "buifc":
        raise request.error(f"values of type {dtype} cannot be shown; save them as integers or real numbers.")
    axes = _stacked(request, axes, levels[0].shape)
    unknown = [size for letter, size in zip(axes, levels[0].shape, strict=True) if letter == "-" and size > 1]
    if unknown:
        sizes = " and ".join(str(size) for size in unknown)
        request.note(f"An axis with {sizes} entries has no known meaning; the first entry is shown.")
    if not set("ZYX") <= set(axes):
        raise request.error(f"its axes {axes.lower()!r} are not those of a volume; z, y and x are needed.")
    kept = [level for level in levels if _is_volume(axes, level.shape)] or list(levels[:1])
    known = [at for at, letter in enumerate(axes) if letter != "-"]

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        level = kept[request.level]
        box: dict[str, slice] = {}
        if request.box is not None:
            i0, i1, j0, j1, k0, k1 = request.box
            box = {"X": slice(i0, i1), "Y": slice(j0, j1), "Z": slice(k0, k1)}
        index: list[int | slice] = []
        for letter, size in zip(axes, level.shape, strict=True):
            if letter in "TC":
                index.append(choose(request, letter, size))
            else:
                index.append(0 if letter == "-" else box.get(letter, slice(0, size)))
        left = "".join(letter for letter, i in zip(axes, index, strict=True) if isinstance(i, slice))
        _check_memory(request, index, [_bytes(each, axes, dtype) for each in kept], dtype)
        array = level.read(tuple(index), request)
        if array.dtype.kind == "c":
            request.note("Complex values are shown as their magnitude.")
            array = np.abs(array)
        chosen = request.channel if "C" not in axes else None
        return to_zyx(array, left, replace(request, box=None, channel=chosen), colour=colour)

    return file_source(
        request,
        values,
        "".join(axes[at] for at in known),
        [kept[0].shape[at] for at in known],
        kept[0].geometry,
        dtype=dtype,
        colour=colour,
        coarser=[(_dimensions(axes, level.shape), level.geometry) for level in kept[1:]],
        **described,
    )


def _stacked(request: LoadRequest, axes: str, shape: tuple[int, ...]) -> str:
    """Without z, time points or channels are slices; axes of single entries are none."""
    if "Z" in axes:
        return axes
    sizes = dict(zip(axes, shape, strict=True))
    for letter, word in (("T", "time points"), ("C", "channels")):
        if sizes.get(letter, 1) > 1:
            request.note(f"It has no axis z; its {word} are stacked as slices, as far apart as its columns.")
            return axes.replace(letter, "Z")
    return axes


def _dimensions(axes: str, shape: tuple[int, ...]) -> tuple[int, int, int]:
    sizes = dict(zip(axes, shape, strict=True))
    return sizes["X"], sizes["Y"], sizes["Z"]


def _is_volume(axes: str, shape: tuple[int, ...]) -> bool:
    return min(_dimensions(axes, shape)) > 1


def _bytes(level: StoredLevel, axes: str, dtype: np.dtype[Any]) -> int:
    """Memory that one time point and channel of a level needs."""
    counted = (size for letter, size in zip(axes, level.shape, strict=True) if letter in "ZYXS")
    return math.prod(counted) * dtype.itemsize


def _check_memory(
    request: LoadRequest, index: Sequence[int | slice], sizes: Sequence[int], dtype: np.dtype[Any]
) -> None:
    """Refuse what does not fit, with the level that would."""
    free = free_bytes()
    wanted = math.prod(i.stop - i.start for i in index if isinstance(i, slice)) * dtype.itemsize
    if free is None or wanted <= free:
        return
    what = f"level {request.level}" if len(sizes) > 1 else "it"
    what = what if request.box is None else f"this box of {what}"
    fitting = next((level for level in range(request.level + 1, len(sizes)) if sizes[level] <= free), None)
    advice = (
        "read a smaller box" if fitting is None else f"read level {fitting}, which fits, or a smaller box"
    )
    raise request.error(
        f"{what} needs {wanted / 2**30:.3g} GiB of memory and {free_in_words(free)}; {advice}."
    )
