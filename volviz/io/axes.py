"""From whatever axes a file has to one (Z, Y, X) array: time points, channels, colours."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import InputError

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.reader import Job

#: Weights of red, green and blue in the brightness of a display-referred colour (ITU-R BT.709-6, item 3.2).
LUMA = (0.2126, 0.7152, 0.0722)

_WORDS = {"T": ("time", "time point"), "C": ("channel", "channel"), "S": ("channel", "colour component")}


def choose(job: Job, letter: str, count: int) -> int:
    """Index along a time or channel axis: the hint, or the first one with a note.

    Parameters
    ----------
    letter : {"T", "C", "S"}
        Time, channel, colour component.
    count : int
        How many there are.

    Raises
    ------
    LoadError
        The hint lies outside.
    """
    hint, word = _WORDS[letter]
    wanted = getattr(job.hints, hint)
    if wanted is None:
        if count > 1:
            job.note(f"The first of {count} {word}s is shown; choose another with {hint}=0..{count - 1}.")
        return 0
    if not -count <= wanted < count:
        some = f"{hint} must lie in 0..{count - 1}" if count > 1 else f"there is only one {word}"
        raise InputError(f"{job.path.name}: {some}, got {wanted}.")
    return int(wanted) % count


def to_zyx(array: npt.NDArray[Any], axes: str, job: Job, *, colour: bool | None = None) -> npt.NDArray[Any]:
    """Reduce an array to three axes in the order (Z, Y, X).

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
            array = np.take(array, choose(job, letter, array.shape[at]), axis=at)
            axes = axes.replace(letter, "")
    if "S" in axes:
        array = np.moveaxis(array, axes.index("S"), -1)
        axes = axes.replace("S", "")
        count = array.shape[-1]
        if colour is None:
            colour = count in (3, 4) and array.dtype == np.uint8
        if colour and count in (3, 4) and job.hints.channel is None:
            job.note("Colours are shown as their brightness; take one component with channel=0, 1 or 2.")
            array = brightness(array)
        else:
            array = array[..., choose(job, "S", count)]
    if sorted(axes) != ["X", "Y", "Z"]:
        if set(axes) == {"X", "Y"}:
            array, axes = array[None], "Z" + axes
        else:
            raise job.error(f"its axes {axes!r} are not those of a volume; save it with the axes z, y, x.")
    return np.ascontiguousarray(array.transpose([axes.index(letter) for letter in "ZYX"]))


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
