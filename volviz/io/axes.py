"""From whatever axes a file has to one (Z, Y, X) array: time points, channels, colours."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.volume_data.source import checked_number

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.reader import LoadRequest

#: Weights of red, green and blue in the brightness of a display-referred colour (ITU-R BT.709-6, item 3.2).
LUMA = (0.2126, 0.7152, 0.0722)

#: Names of axes in files of general kinds.
_LETTERS = {
    "time": "T", "frame": "T", "channel": "C", "depth": "Z", "plane": "Z", "slice": "Z", "lev": "Z", "level": "Z",
    "height": "Y", "row": "Y", "lat": "Y", "latitude": "Y", "width": "X", "column": "X", "col": "X", "lon": "X",
    "longitude": "X", **{letter.lower(): letter for letter in "TCZYX"},
}  # fmt: skip

_WORDS = {"T": ("time", "time point"), "C": ("channel", "channel"), "S": ("channel", "colour component")}


def axis_letter(name: object) -> str:
    """The letter of an axis by its name: "T", "C", "Z", "Y", "X", or "-" for one that nothing is known of."""
    return _LETTERS.get(str(name).strip().lower(), "-")


def usual_axes(shape: tuple[int, ...], dtype: npt.DTypeLike) -> str:
    """What three to five axes without names are taken for: t, c, z, y, x, and colours of 8 bits last."""
    colours = len(shape) > 3 and shape[-1] in (3, 4) and np.dtype(dtype) == np.uint8
    return {3: "ZYX", 4: "ZYXS" if colours else "TZYX", 5: "TZYXS" if colours else "TCZYX"}[len(shape)]


def choose(request: LoadRequest, letter: str, count: int) -> int:
    """Index along a time or channel axis: what is asked for, or the first one with a note.

    Parameters
    ----------
    letter : {"T", "C", "S"}
        Time, channel, colour component.
    count : int
        How many there are.

    Raises
    ------
    LoadError
        What is asked for lies outside.
    """
    what, word = _WORDS[letter]
    wanted = request.time if letter == "T" else request.channel
    if wanted is None:
        if count > 1:
            request.note(f"The first of {count} {word}s is shown; choose another with {what}=0..{count - 1}.")
        return 0
    return checked_number(what, wanted, count, request.path.name)


def to_zyx(
    array: npt.NDArray[Any], axes: str, request: LoadRequest, *, colour: bool | None = None
) -> npt.NDArray[Any]:
    """The part of an array that a job asks for, with three axes in the order (Z, Y, X).

    Parameters
    ----------
    array : ndarray
    axes : str
        One letter an axis: "Z", "Y", "X", "T" (time), "C" (channel), "S" (colour component).
    colour : bool or None
        The axis "S" holds red, green, blue (and alpha); None = when there are 3 or 4 components of 8 bits.
        Colours become their brightness, unless a channel is asked for.
    """
    for letter in "TC":
        if letter in axes:
            at = axes.index(letter)
            array = np.take(array, choose(request, letter, array.shape[at]), axis=at)
            axes = axes.replace(letter, "")
            if letter == "C":
                # a channel that was found is no component of colours as well
                request = replace(request, channel=None)
    if "S" in axes:
        array = np.moveaxis(array, axes.index("S"), -1)
        axes = axes.replace("S", "")
        count = array.shape[-1]
        if are_colours("S", (count,), array.dtype, colour) and request.channel is None:
            request.note("Colours are shown as their brightness; their components are channels 0, 1 and 2.")
            array = brightness(array)
        else:
            array = array[..., choose(request, "S", count)]
    if sorted(axes) != ["X", "Y", "Z"]:
        if set(axes) == {"X", "Y"}:
            array, axes = array[None], "Z" + axes
        else:
            raise request.error(
                f"its axes {axes!r} are not those of a volume; save it with the axes z, y, x."
            )
    array = array.transpose([axes.index(letter) for letter in "ZYX"])
    if request.box is not None:
        i0, i1, j0, j1, k0, k1 = request.box
        array = array[k0:k1, j0:j1, i0:i1]
    return np.ascontiguousarray(array)


def are_colours(axes: str, shape: tuple[int, ...], dtype: npt.DTypeLike | None, colour: bool | None) -> bool:
    """Whether the axis "S" holds red, green, blue (and alpha); see `to_zyx` for `colour`."""
    if "S" not in axes or shape[axes.index("S")] not in (3, 4):
        return False
    return np.dtype(dtype) == np.uint8 if colour is None else colour


def brightness(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Brightness of colours in the type of the components.

    Parameters
    ----------
    array : ndarray of shape (..., 3) or (..., 4)
        Red, green, blue; a fourth component (alpha) is ignored.

    Returns
    -------
    ndarray of shape (...)
        ``0.2126 R + 0.7152 G + 0.0722 B``, rounded for integer types.
    """
    result = np.empty(array.shape[:-1], array.dtype)
    # slab by slab, so that no float copy of the whole volume exists
    for slab, out in zip(array, result, strict=True):
        value = slab[..., :3] @ np.asarray(LUMA, np.float32 if array.dtype.itemsize < 4 else np.float64)
        out[...] = np.rint(value) if array.dtype.kind in "ui" else value
    return result
