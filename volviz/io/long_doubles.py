"""128-bit real numbers of files as 64-bit ones, on any machine: NumPy knows only those of its own.

Two kinds stand under one name in files. The 80-bit numbers of x86 (exponent of 15 bits and all 64 bits of the
significand), padded with whatever lay there, are what nibabel writes there; IEEE 754 binary128 (significand of 112
bits without its leading one) is what others write.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

_BIAS = 16383


def doubles_of(array: npt.NDArray[Any], order: Literal["<", ">"]) -> npt.NDArray[np.float64]:
    """Numbers of 16 bytes each as float64; what is larger becomes infinite.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X), void of 16 bytes
    order : {"<", ">"}
        Order of the bytes.
    """
    result = np.empty(array.shape, np.float64)
    planes = [_lowest_byte_first(plane, order) for plane in array]
    convert = _of_80_bits if all(_has_leading_ones(plane) for plane in planes) else _of_128_bits
    for plane, out in zip(planes, result, strict=True):
        out[...] = convert(plane)
    return result


def _lowest_byte_first(plane: npt.NDArray[Any], order: Literal["<", ">"]) -> npt.NDArray[np.uint8]:
    """A view, or copy, of shape (Y, X, 16)."""
    numbers = np.ascontiguousarray(plane).view(np.uint8).reshape(*plane.shape, 16)
    return numbers if order == "<" else numbers[..., ::-1]


def _has_leading_ones(numbers: npt.NDArray[np.uint8]) -> bool:
    """Whether all but zeros have the leading one of a significand where numbers of 80 bits write it."""
    return bool(np.all((numbers[..., 7] & 0x80 != 0) | ~numbers[..., :10].any(axis=-1)))


def _of_80_bits(numbers: npt.NDArray[np.uint8]) -> npt.NDArray[np.float64]:
    significand = _whole(numbers[..., :8], np.uint64)
    return _assembled(
        significand.astype(np.float64) * 2.0**-63, significand << np.uint64(1), numbers[..., 8:10]
    )


def _of_128_bits(numbers: npt.NDArray[np.uint8]) -> npt.NDArray[np.float64]:
    # 48 upper bits of the significand and the 64 below; its leading one is not written
    upper, lower = _whole(numbers[..., 8:14], np.uint64), _whole(numbers[..., :8], np.uint64)
    fraction = upper.astype(np.float64) * 2.0**-48 + lower.astype(np.float64) * 2.0**-112
    leads = (_whole(numbers[..., 14:16], np.uint32) & 0x7FFF) > 0
    return _assembled(fraction + leads, upper | lower, numbers[..., 14:16])


def _assembled(
    significand: npt.NDArray[np.float64], fraction: npt.NDArray[np.uint64], ends: npt.NDArray[np.uint8]
) -> npt.NDArray[np.float64]:
    """Numbers of significands (1 to 2), the two bytes of sign and exponent, and fractions that tell NaN (not 0)."""
    sign_and_exponent = _whole(ends, np.uint32)
    exponent = (sign_and_exponent & 0x7FFF).astype(np.int64)
    with np.errstate(over="ignore", under="ignore"):
        values = np.ldexp(significand, np.clip(exponent - _BIAS, -2000, 2000).astype(np.int32))
    values = np.where(exponent == 0x7FFF, np.where(fraction == 0, np.inf, np.nan), values)
    return np.asarray(np.where(sign_and_exponent & 0x8000, -values, values))


def _whole(some: npt.NDArray[np.uint8], kind: Any) -> npt.NDArray[Any]:
    """Bytes, the lowest first, as whole numbers."""
    total = np.zeros(some.shape[:-1], kind)
    for at in range(some.shape[-1]):
        total |= some[..., at].astype(kind) << kind(8 * at)
    return total
