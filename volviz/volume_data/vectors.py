"""Points and directions as plain tuples, checked once."""

from __future__ import annotations

import math
from collections.abc import Iterable

from volviz.errors import InputError

Vector = tuple[float, float, float]


def finite_vector(values: Iterable[float], what: str) -> Vector:
    """Three numbers (x, y, z) as a tuple of floats: values that can be compared, whatever they came as.

    Parameters
    ----------
    values : iterable of 3 numbers
        A tuple, list or array.
    what : str
        What they are, for the error.

    Raises
    ------
    InputError
        Not three numbers, or not all finite.
    """
    try:
        x, y, z = (float(value) for value in values)
    except (TypeError, ValueError):
        x = y = z = math.nan
    if not all(map(math.isfinite, (x, y, z))):
        raise InputError(f"{what} must be three finite numbers, got {values!r}.")
    return x, y, z
