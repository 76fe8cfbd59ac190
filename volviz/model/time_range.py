"""Colours through time: whether those of a time point are the colours of its values, or of its own range of values."""

from __future__ import annotations

from typing import Literal

from volviz.model.auto_isovalue import auto_isovalue, keep_isovalue
from volviz.model.transfer.first_look import automatic_window, keep_window
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.volume import Volume

#: "fixed": a value has one colour at all times. "widest": functions are stretched over the range of all time points
#: that have been shown. "each": over that of each.
TimeRange = Literal["fixed", "widest", "each"]


def look_like(volume: Volume, first: Volume) -> None:
    """Let what is chosen from the values of a time point (first isovalue, grey window) be that of another one."""
    keep_isovalue(volume, auto_isovalue(first))
    keep_window(volume, automatic_window(first))


def refitted(
    function: TransferFunction, before: tuple[float, float], after: tuple[float, float]
) -> TransferFunction:
    """A function of one range of values, moved and stretched to another one; unchanged where either is empty.

    Parameters
    ----------
    function : TransferFunction
        In data units; one in fractions of the range follows by itself and stays.
    before, after : tuple of 2 floats
        Limits in data units.
    """
    (low, high), (first, last) = before, after
    if function.domain != "data" or before == after or not (low < high and first < last):
        return function
    return function.stretched((last - first) / (high - low), low).shifted(first - low)
