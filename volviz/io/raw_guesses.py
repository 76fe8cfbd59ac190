"""What a raw file may hold: guesses from its name, its size and how smooth its values are, and slices to judge them by.

Neighbours in a volume are more alike than values taken anywhere. A guess is good when that holds along all three axes:
a wrong type or byte order makes neighbours along x differ, a wrong width those along y, a wrong height those along z.
"""

from __future__ import annotations

import gzip
import math
import re
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.raw import named_type

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    import numpy.typing as npt

#: Types that are tried, the usual ones first: of equal guesses the first one stays.
DTYPES = ("uint8", "uint16", "int16", "float32", "int8", "uint32", "int32", "float64")

#: Bytes that usual headers have.
_HEADERS = (0, 256, 348, 352, 512, 1024, 2048, 4096)

#: Widths that scanners and reconstructions like.
_WIDTHS = (
    32, 41, 64, 80, 96, 100, 120, 128, 144, 150, 160, 176, 180, 181, 192, 197, 200, 208, 217, 224, 233, 240, 250, 256,
    288, 300, 301, 320, 341, 352, 360, 384, 400, 416, 432, 448, 480, 492, 500, 512, 540, 576, 600, 640, 672, 700, 720,
    750, 768, 800, 832, 900, 960, 1000, 1008, 1024, 1080, 1100, 1120, 1200, 1250, 1280, 1400, 1440, 1500, 1536, 1600,
    1800, 1920, 2000, 2048, 2160, 2500, 2560, 3000, 4000, 4096,
)  # fmt: skip

#: Bytes in the middle of a file that are looked at; packed files are unpacked up to this.
_LOOKED_AT = 24 << 20
_UNPACKED = 512 << 20
_SAMPLES = 2000
#: The row of a picture or the column is at most so many times the other.
_ASPECT = 8
#: Values in which repetitions are looked for.
_REPEATING = 1 << 17
#: Weight of what speaks against a guess: a header, a type that is seldom used.
_PENALTY, _ODD_PENALTY = 0.03, 0.3
_RARE = ("int8", "uint32", "int32", "float64")
#: Above this neighbours are no more alike than any two values.
_ROUGH = 0.95
#: Below this no further headers are tried.
_GOOD = 0.25

_NAMED_SIZES = re.compile(r"(?<!\d)(\d{1,5})[xX×_](\d{1,5})[xX×_](\d{1,5})(?!\d)")


@dataclass(frozen=True)
class RawGuess:
    """One way to read a raw file.

    Attributes
    ----------
    dims : tuple of 3 ints
        Voxels along (x, y, z).
    dtype : str
    endian : {"little", "big"}
    header : int
        Bytes before the values.
    roughness : float
        Mean difference of neighbours along the three axes, as a fraction of that of any two values; the lower the
        better. Below 0 where the name of the file says it all.
    """

    dims: tuple[int, int, int]
    dtype: str
    endian: str = "little"
    header: int = 0
    roughness: float = 1.0

    @property
    def hints(self) -> dict[str, Any]:
        """As keywords of `volviz.load`."""
        return {"dims": self.dims, "dtype": self.dtype, "endian": self.endian, "header": self.header}

    @property
    def stored(self) -> np.dtype[Any]:
        """Type with its byte order."""
        return np.dtype(self.dtype).newbyteorder(">" if self.endian == "big" else "<")

    @property
    def nbytes(self) -> int:
        """Size of a file that holds just this."""
        return self.header + math.prod(self.dims) * self.stored.itemsize


def raw_bytes(path: Path) -> npt.NDArray[np.uint8]:
    """The bytes of a raw file, packed ones unpacked (as far as half a gigabyte).

    Raises
    ------
    OSError
        Unreadable or damaged.
    """
    with path.open("rb") as stream:
        is_packed = stream.read(2) == b"\x1f\x8b"
    if is_packed:
        try:
            with gzip.open(path) as plain:
                return np.frombuffer(plain.read(_UNPACKED), np.uint8)
        except (EOFError, zlib.error) as error:
            raise OSError(str(error)) from None
    if not path.stat().st_size:
        return np.empty(0, np.uint8)
    return np.memmap(path, np.uint8, mode="r")


def sizes_from_name(name: str) -> tuple[int, int, int] | None:
    """Three numbers in a name that may be sizes along x, y, z: ``head_256_256_225``, ``foot-128x128x90``."""
    found = _NAMED_SIZES.search(name)
    return (int(found[1]), int(found[2]), int(found[3])) if found else None


def guesses(
    name: str, data: npt.NDArray[np.uint8], check: Callable[[], None] = lambda: None, *, at_most: int = 8
) -> list[RawGuess]:
    """Plausible ways to read a raw file, the best first.

    Parameters
    ----------
    name : str
        Of the file.
    data : ndarray of uint8
        All of its bytes, see `raw_bytes`.
    check : callable
        Called now and then; raises where the answer is not wanted any more.
    at_most : int

    Returns
    -------
    list of RawGuess
        Empty where nothing is plausible: values like noise, or a size that no shape fits.
    """
    sizes, kind = sizes_from_name(name), named_type(name)
    found: list[RawGuess] = []
    for header, shape in _headers(len(data), sizes):
        for width in (1, 2, 4, 8):
            check()
            if (len(data) - header) % width == 0:
                found.extend(_of_width(data, width, header, shape, kind))
        if found and min(guess.roughness for guess in found) < _GOOD:
            break
    return sorted(found, key=lambda guess: guess.roughness)[:at_most]


def _headers(
    size: int, sizes: tuple[int, int, int] | None
) -> Iterator[tuple[int, tuple[int, int, int] | None]]:
    """Headers to try, each with the shape that the name says, or None where it is to be found."""
    if sizes is not None and min(sizes) > 1:
        for width in (1, 2, 4, 8):
            rest = size - math.prod(sizes) * width
            # more than a quarter is no header
            if 0 <= rest <= size // 4:
                yield rest, sizes
    for header in _HEADERS:
        if size > header:
            yield header, None


def _of_width(
    data: npt.NDArray[np.uint8],
    width: int,
    header: int,
    shape: tuple[int, int, int] | None,
    named: str | None,
) -> list[RawGuess]:
    """Guesses of all types of so many bytes and their byte orders."""
    count = (len(data) - header) // width
    if shape is not None and math.prod(shape) != count:
        return []
    found: list[RawGuess] = []
    for endian in ("little", "big")[: 1 if width == 1 else 2]:
        # whole numbers that look like real ones are seldom what they seem: real ones come first
        for dtype in sorted((d for d in DTYPES if np.dtype(d).itemsize == width), key=lambda d: d[0] != "f"):
            stored = np.dtype(dtype).newbyteorder(">" if endian == "big" else "<")
            values = _Values.of(data, stored, header, count)
            if values is None:
                continue
            found.extend(_judged(values, dtype, endian, header, shape, is_named=dtype == named))
            if dtype[0] == "f":
                break
    return found


def _judged(
    values: _Values,
    dtype: str,
    endian: str,
    header: int,
    shape: tuple[int, int, int] | None,
    *,
    is_named: bool,
) -> list[RawGuess]:
    """Guesses of one type and header that are smoother than noise."""
    along_x = values.roughness(1)
    if along_x > _ROUGH and not is_named:
        return []
    penalty = (_PENALTY if header else 0.0) + (_PENALTY if dtype in _RARE else 0.0)
    penalty += _ODD_PENALTY if values.is_odd else 0.0
    penalty -= 1.0 if is_named and shape is not None else 0.1 if is_named else 0.0
    found = []
    for dims in [shape] if shape is not None else _found_shapes(values):
        rough = (along_x + values.roughness(dims[0]) + values.roughness(dims[0] * dims[1])) / 3
        if rough < _ROUGH or shape is not None:
            found.append(RawGuess(dims, dtype, endian, header, rough + penalty))
    return sorted(found, key=lambda one: one.roughness)[:3]


@dataclass(frozen=True)
class _Values:
    """Values of the middle of a file, as numbers between 0 and 1 where outliers are cut.

    Attributes
    ----------
    part : ndarray
        As they are stored.
    count : int
        Number of values that the whole file holds.
    low, high : float
        What becomes 0 and 1.
    is_odd : bool
        Whole numbers whose lower byte is always empty, as in the other byte order, or that have lost a sign.
    """

    part: npt.NDArray[Any]
    count: int
    low: float
    high: float
    is_odd: bool

    @classmethod
    def of(
        cls, data: npt.NDArray[np.uint8], stored: np.dtype[Any], header: int, count: int
    ) -> _Values | None:
        """Those of a file; None where they are all equal, or none of this type."""
        wanted = min(count, _LOOKED_AT // stored.itemsize)
        start = header + (count - wanted) // 2 * stored.itemsize
        part = np.asarray(data[start : start + wanted * stored.itemsize]).view(stored)
        few = part[:: max(len(part) // _SAMPLES, 1)]
        if len(part) < 8:
            return None
        is_whole = stored.kind in "iu" and stored.itemsize > 1
        is_odd = is_whole and (not np.any(few & 0xFF) or (stored.kind == "u" and _are_signed(few)))
        with np.errstate(over="ignore", invalid="ignore"):
            few = few.astype(np.float64)
            size = np.abs(few[few != 0])
            if stored.kind == "f" and not len(size):
                return None
            if stored.kind == "f" and not np.mean(np.isfinite(size) & (size > 1e-12) & (size < 1e12)) > 0.99:
                return None
        few = few[np.isfinite(few)]
        low, high = (float(v) for v in np.percentile(few, (1, 99)))
        if not high > low:
            low, high = float(few.min()), float(few.max())
        return cls(part, count, low, high, is_odd) if high > low else None

    def at(self, places: Any) -> npt.NDArray[np.float32]:
        with np.errstate(over="ignore", invalid="ignore"):
            values = (self.part[places].astype(np.float64) - self.low) / (self.high - self.low)
        found: npt.NDArray[np.float32] = np.clip(np.nan_to_num(values), 0.0, 1.0).astype(np.float32)
        return found

    def roughness(self, lag: int) -> float:
        """Mean difference of values so far apart, as a fraction of that of any two."""
        if lag >= len(self.part):
            return 1.0
        rng = np.random.default_rng(1)
        places = rng.integers(0, len(self.part) - lag, _SAMPLES)
        here, others = self.at(places), self.at(rng.integers(0, len(self.part), _SAMPLES))
        usual = float(np.mean(np.abs(here - others)))
        return float(np.mean(np.abs(here - self.at(places + lag)))) / usual if usual > 0 else 1.0


def _are_signed(values: npt.NDArray[Any]) -> bool:
    """Whether unsigned numbers are very small or very large, and hardly between: negative ones without their sign."""
    quarter = 1 << 8 * values.dtype.itemsize - 2
    return (
        float(np.mean(values >= 3 * quarter))
        > 1e-3
        > float(np.mean((values >= quarter) & (values < 3 * quarter)))
    )


def _found_shapes(values: _Values) -> list[tuple[int, int, int]]:
    """Shapes with so many values, by the widths and heights at which neighbours are most alike."""
    widths = {n for n in _WIDTHS if values.count % n == 0} | set(_periods(values))
    judged = sorted(widths, key=values.roughness)[:3]
    found: list[tuple[float, tuple[int, int, int]]] = []
    for width in judged:
        rest = values.count // width
        heights = [
            n for n in _divisors(rest)
            if max(width // _ASPECT, 2) <= n <= _ASPECT * width and 2 <= rest // n <= _ASPECT * max(width, n)
        ]  # fmt: skip
        found.extend((values.roughness(width * n), (width, n, rest // n)) for n in heights)
    # of heights that are equally good a square slice is the likelier one
    found.sort(key=lambda pair: (round(pair[0], 2), abs(math.log(pair[1][1] / pair[1][0]))))
    return [dims for _, dims in found[:4]]


def _periods(values: _Values) -> list[int]:
    """Distances at which the values repeat themselves most, among those that divide their number."""
    middle = max(len(values.part) - _REPEATING, 0) // 2
    part = values.at(slice(middle, middle + _REPEATING))
    spectrum = np.fft.rfft(part - part.mean(), 2 * len(part))
    likeness = np.fft.irfft(spectrum.real**2 + spectrum.imag**2)[: min(len(part) // 4, 8192)]
    inner = likeness[1:-1]
    peaks = np.flatnonzero((inner > likeness[:-2]) & (inner >= likeness[2:])) + 1
    fitting = [int(n) for n in peaks if n >= 8 and values.count % n == 0]
    return sorted(fitting, key=lambda n: -likeness[n])[:6]


def _divisors(number: int) -> list[int]:
    small = [n for n in range(1, math.isqrt(number) + 1) if number % n == 0]
    return sorted({*small, *(number // n for n in small)})


def middle_slices(
    data: npt.NDArray[np.uint8], guess: RawGuess, side: int = 160
) -> tuple[npt.NDArray[np.uint8], ...] | None:
    """The three slices through the middle as grey pictures of at most `side` pixels, None where the file is too short.

    Parameters
    ----------
    data : ndarray of uint8
        All bytes of the file.
    guess : RawGuess
    side : int

    Returns
    -------
    tuple of three ndarrays of uint8
        Across z (rows y, columns x), across y (rows z, columns x), across x (rows z, columns y), in a common window
        from the first to the last percent of their values.
    """
    if guess.nbytes > len(data) or min(guess.dims) < 1:
        return None
    x, y, z = guess.dims
    values = np.ndarray((z, y, x), guess.stored, buffer=data[guess.header : guess.nbytes].data)
    i, j, k = (max(-(-n // side), 1) for n in (x, y, z))
    with np.errstate(over="ignore", invalid="ignore"):
        found = [
            np.nan_to_num(np.asarray(part, np.float64), posinf=0.0, neginf=0.0)
            for part in (values[z // 2, ::j, ::i], values[::k, y // 2, ::i], values[::k, ::j, x // 2])
        ]
        low, high = np.percentile(np.concatenate([part.ravel() for part in found]), (1, 99))
        scale = 255.0 / (high - low) if high > low else 0.0
        return tuple(np.clip((part - low) * scale, 0, 255).astype(np.uint8) for part in found)
