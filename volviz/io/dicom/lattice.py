"""Positions of slices as a lattice: the best even one, where slices are missing, what strays.

Nothing is rounded to decimals: what counts as the same place, as even and as a gap follows from the distance of the
slices themselves, so that micrometres are treated as millimetres are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.reader import LoadRequest

#: As fractions of the distance of slices: positions that are the same, that stray unnoticed, that stray with a note.
SAME = 0.05
EVEN = 0.01
STRAYING = 0.2


def same_places(depths: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
    """Number of the place, counted along the stack, that each depth belongs to.

    Parameters
    ----------
    depths : ndarray of shape (N,)
        Positions along the normal, mm.
    """
    order = np.argsort(depths, kind="stable")
    sorted_ = depths[order]
    # with n frames a place the distance of slices is at least n times the mean gap: the limit never joins two
    limit = SAME * float(sorted_[-1] - sorted_[0]) / max(len(depths) - 1, 1)
    numbers = np.zeros(len(depths), np.int64)
    numbers[order] = np.concatenate([[0], np.cumsum(np.diff(sorted_) > limit)])
    return numbers


@dataclass(frozen=True)
class SliceLattice:
    """Where slices lie.

    Attributes
    ----------
    start, step : ndarray of shape (3,)
        World position of the first slice, vector from one to the next, mm.
    at : ndarray of shape (N,)
        Index of every slice on the lattice; whole numbers, unless the slices lie unevenly.
    count : int
        Number of slices that the lattice has.
    """

    start: npt.NDArray[np.float64]
    step: npt.NDArray[np.float64]
    at: npt.NDArray[np.float64]
    count: int

    @property
    def is_complete(self) -> bool:
        """Every slice of the lattice is there, and no other."""
        return self.count == len(self.at) and bool(np.all(self.at == np.arange(self.count)))

    def part(self, first: int, last: int) -> SliceLattice:
        """The slices `first` to `last` (exclusive) of a complete lattice."""
        at = np.arange(last - first, dtype=np.float64)
        return SliceLattice(self.start + first * self.step, self.step, at, last - first)


def fit(
    request: LoadRequest, positions: npt.NDArray[np.float64], normal: npt.NDArray[np.float64], pixel: float
) -> SliceLattice:
    """The even lattice through positions that are sorted along the normal, with notes on what was done.

    Parameters
    ----------
    positions : ndarray of shape (N, 3), N >= 2
        World positions of the slices, all at different depths, mm.
    normal : ndarray of shape (3,)
        Unit vector across the slices.
    pixel : float
        Distance of pixels, mm: what slices may be shifted against one another.

    Raises
    ------
    LoadError
        More slices would have to be filled in than there are, or they are shifted against one another.
    """
    depths = positions @ normal
    gaps = np.abs(np.diff(depths))
    usual = float(np.median(gaps))
    # with many slices missing the smallest gap tells the distance better than the usual one
    found = [_numbered(gaps, distance, positions) for distance in (usual, float(gaps.min()))]
    index, straying = min(found, key=lambda pair: (pair[0][-1] >= 2 * len(positions), round(pair[1], 2)))
    start, step = _line(index, positions)
    count = int(index[-1]) + 1
    words = f"{gaps.min():.4g} to {gaps.max():.4g} mm apart"
    if count > 2 * len(positions):
        raise request.error(
            f"its slices lie {words}: more are missing than there are; they are parts of several stacks, "
            "or it is no volume."
        )
    if straying <= STRAYING:
        if count > len(positions):
            request.note(
                f"{count - len(positions)} of {count} slices are missing (slices lie {words}); they are filled in by "
                "interpolation between their neighbours."
            )
        elif straying > EVEN:
            request.note(f"Slices lie {words}; their mean distance is taken.")
        return SliceLattice(start, step, index, count)
    start, slope = _line(depths, positions)
    shifted = float(np.linalg.norm(positions - start - depths[:, None] * slope, axis=1).max())
    if shifted > max(pixel, STRAYING * usual):
        raise request.error(
            f"its slices are shifted against one another by up to {shifted:.3g} mm; it is no regular stack, "
            "resample it first."
        )
    count = max(round(float(depths[-1] - depths[0]) / usual), 1) + 1
    step = (depths[-1] - depths[0]) / (count - 1) * slope
    start = start + depths[0] * slope
    request.note(f"Slices lie {words}; they are resampled to {np.linalg.norm(step):.4g} mm by interpolation.")
    return SliceLattice(start, step, (depths - depths[0]) / (depths[-1] - depths[0]) * (count - 1), count)


def _numbered(
    gaps: npt.NDArray[np.float64], distance: float, positions: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float64], float]:
    """Indices of slices about a distance apart, and how far they stray from even ones, as a fraction of their step."""
    index = np.concatenate([[0.0], np.cumsum(np.maximum(np.rint(gaps / distance), 1))])
    start, step = _line(index, positions)
    better = np.rint((positions - start) @ step / (step @ step))
    if len(set(better.tolist())) == len(better):
        index = better - better[0]
        start, step = _line(index, positions)
    straying = np.linalg.norm(positions - start - index[:, None] * step, axis=1).max()
    return index, float(straying / np.linalg.norm(step))


def _line(
    index: npt.NDArray[np.float64], positions: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Position at index 0 and step of the line from the first position to the last."""
    step = (positions[-1] - positions[0]) / (index[-1] - index[0])
    return positions[0] - index[0] * step, step
