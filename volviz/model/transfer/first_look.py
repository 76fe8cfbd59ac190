"""A coarse look at a volume: enough to choose a first transfer function and to foresee its image."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from volviz.model.transfer.function import TransferFunction
    from volviz.volume_data.volume import Volume

Floats = npt.NDArray[np.float64]

#: Largest number of voxels along an axis that is looked at.
LATTICE = 88
#: Rays along either side of a foreseen image, and the largest number of samples on a ray.
RAYS, SAMPLES = 30, 96
#: Values are looked at as if none lay farther from the range without outliers than so many times its width.
OUTLIERS = 20.0
#: Directions (x, y, z) along the volume's own axes of the foreseen images: slanted, in front, above.
DIRECTIONS = ((1.0, 1.0, 1.0), (0.47, 0.81, 0.34), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


_windows: WeakKeyDictionary[Volume, tuple[float, float]] = WeakKeyDictionary()


def sample_values(volume: Volume) -> Floats:
    """Finite values of at most about 700 000 voxels spread evenly over the volume, shape (n,), without "no data"."""
    values = _strided(volume)[0].ravel()
    return values[_is_data(values, volume)]


def robust_range(volume: Volume) -> tuple[float, float]:
    """Range without the outermost thousandth of the values at either end, in data units.

    Widened again where that leaves nothing, as in data that are zero nearly everywhere.
    """
    values = sample_values(volume)
    return without_outliers(values) if len(values) else volume.data_range


def automatic_window(volume: Volume) -> tuple[float, float]:
    """The values that are shown black and white when nothing is said: the robust range, never empty; found once."""
    known = _windows.get(volume)
    if known is None:
        low, high = robust_range(volume)
        known = _windows[volume] = (low, high) if high > low else (low - 0.5, low + 0.5)
    return known


def keep_window(volume: Volume, window: tuple[float, float]) -> None:
    """Let `automatic_window` of a volume be another one: that of the first time point of a series, say."""
    _windows[volume] = window


def grey_window(volume: Volume, level: float | None, width: float | None) -> tuple[float, float]:
    """The values that are shown black and white for a middle and a width in data units; None for automatic ones."""
    low, high = automatic_window(volume)
    half = (high - low if width is None else width) / 2
    middle = (low + high) / 2 if level is None else level
    return middle - half, middle + half


def without_outliers(values: Floats) -> tuple[float, float]:
    """Range of values without rare extremes: the quantiles 0.001 and 0.999.

    Where nearly all values are equal (a constant background), both quantiles are that value. The range is then
    widened to the quantiles 0.01 and 0.99 of all other values.
    """
    low, high = (float(v) for v in np.quantile(values, (0.001, 0.999)))
    if low < high:
        return low, high
    others = values[values != low]
    if not len(others):
        return low, low
    a, b = (float(v) for v in np.quantile(others, (0.01, 0.99)))
    return min(a, low), max(b, low)


@dataclass(frozen=True)
class FirstLook:
    """Values on a coarse lattice and along a few rays.

    Attributes
    ----------
    values : ndarray of shape (z, y, x), float64
        Every n-th voxel, in data units; what is not finite or stands for "no data" replaced by the lowest other value.
    gradient : ndarray of shape (z, y, x), float64
        Gradient magnitude per cell, in units of the largest absolute value.
    rays : ndarray of shape (views, rays, samples), float64
        Values along parallel rays through the box, nearest voxel.
    lengths : ndarray of shape (views, rays), float64
        Length of one sample in mean spacings; 0 for rays that miss the box.
    low, high : float
        Range without outliers.
    integer : bool
        Whether all values are whole numbers.
    cell_size : tuple of 3 floats
        Distance of the lattice's points along (z, y, x), world units.
    scale : float
        Largest absolute value, in whose units `gradient` is: no square of it overflows.
    """

    values: Floats
    gradient: Floats
    rays: Floats
    lengths: Floats
    low: float
    high: float
    integer: bool
    cell_size: tuple[float, ...] = (1.0, 1.0, 1.0)
    scale: float = 1.0

    @classmethod
    def at(cls, volume: Volume) -> FirstLook | None:
        """None when there are not two different finite values."""
        low, high = volume.data_range
        if not low < high:
            return None
        values, steps = _strided(volume)
        values = np.where(_is_data(values, volume), values, low)
        if values.min() == values.max():
            values, steps = _around_extreme(volume, values.shape), (1, 1, 1)
        range_ = without_outliers(values.ravel())
        # a single hot voxel must not outweigh the gradients of everything else
        reach = OUTLIERS * (range_[1] - range_[0])
        if 0.0 < reach < np.inf:
            values = np.clip(values, range_[0] - reach, range_[1] + reach)
        cell = tuple(s * n for s, n in zip(volume.spacing[::-1], steps, strict=True))
        rays, lengths = _cast(values, cell)
        scale = float(np.abs(values).max())
        lengths = lengths / volume.mean_spacing
        integer = volume.array.dtype.kind in "bui" or bool(np.all(values == np.rint(values)))
        return cls(values, _magnitude(values, scale), rays, lengths, *range_, integer, cell, scale)

    @cached_property
    def shell(self) -> Floats:
        """Values on the six faces of the box, shape (n,)."""
        v = self.values
        faces = (v[0], v[-1], v[:, 0], v[:, -1], v[:, :, 0], v[:, :, -1])
        return np.concatenate([f.ravel() for f in faces])

    def mirrored(self) -> FirstLook:
        """The look at the negated values, for dark objects on a bright background."""
        return replace(self, values=-self.values, rays=-self.rays, low=-self.high, high=-self.low)

    def coverage(self, threshold: float) -> float:
        """Share of the rays through the box that meet a value of at least `threshold`."""
        met = self.rays.max(axis=2) >= threshold
        return float(np.mean(met[self.lengths > 0]))

    def extinctions(self, function: TransferFunction) -> Floats:
        """Integral of the extinction along every ray, shape (views, rays)."""
        opacity = np.interp(
            self.rays,
            [p.value for p in function.points],
            [p.opacity * function.opacity for p in function.points],
        )
        return np.asarray(-np.log1p(-np.minimum(opacity, 0.9999)).sum(axis=2) * self.lengths)

    def mean_alphas(self, extinctions: Floats) -> Floats:
        """Mean alpha inside the box of each foreseen image, shape (views,)."""
        alpha = 1.0 - np.exp(-extinctions)
        return np.array([a[n > 0].mean() for a, n in zip(alpha, self.lengths, strict=True)])


def _is_data(values: Floats, volume: Volume) -> npt.NDArray[np.bool_]:
    finite = np.isfinite(values)
    return finite & ~np.isin(values, volume.no_data) if volume.no_data else finite


def _magnitude(values: Floats, largest: float) -> Floats:
    total = np.zeros_like(values)
    for axis in range(3):
        total += np.gradient(values / largest, axis=axis) ** 2
    return np.sqrt(total)


def _strided(volume: Volume) -> tuple[Floats, tuple[int, ...]]:
    array: Any = volume.array
    steps = tuple(max(1, -(-n // LATTICE)) for n in array.shape)
    taken = array[
        tuple(
            # at least two planes an axis, centred
            slice(min((n - 1) % s // 2, n - 1 - s) if n > s else 0, None, s)
            for n, s in zip(array.shape, steps, strict=True)
        )
    ]
    return np.asarray(taken, dtype=np.float64), steps


def _around_extreme(volume: Volume, shape: tuple[int, ...]) -> Floats:
    """A block of full resolution around a rare value, when all that differs fell between the samples."""
    array: Any = volume.array
    low, high = volume.range
    wanted = high if float(array.flat[0]) != high else low
    where = np.unravel_index(int(np.argmax(array == array.dtype.type(wanted))), array.shape)
    corner = [
        int(min(max(p - n // 2, 0), full - n)) for p, n, full in zip(where, shape, array.shape, strict=True)
    ]
    block = array[tuple(slice(c, c + n) for c, n in zip(corner, shape, strict=True))].astype(np.float64)
    return np.where(np.isfinite(block), block, low)


def _cast(values: Floats, cell: tuple[float, ...]) -> tuple[Floats, Floats]:
    """Values along parallel rays through the box, and the world length of a sample on each ray.

    Parameters
    ----------
    values : ndarray of shape (z, y, x)
        The lattice.
    cell : tuple of 3 floats
        World length of a cell along (z, y, x).
    """
    size = np.array(cell)
    extent = size * (np.array(values.shape) - 1)
    rays = np.zeros((len(DIRECTIONS), RAYS * RAYS, SAMPLES))
    lengths = np.zeros((len(DIRECTIONS), RAYS * RAYS))
    for view, direction in enumerate(DIRECTIONS):
        ahead = np.array(direction[::-1]) / np.linalg.norm(direction)
        aside = np.cross(ahead, (0.0, 0.0, 1.0) if abs(ahead[2]) < 0.9 else (0.0, 1.0, 0.0))
        aside /= np.linalg.norm(aside)
        upward = np.cross(aside, ahead)
        corners = np.array([[c >> 2 & 1, c >> 1 & 1, c & 1] for c in range(8)]) * extent - extent / 2
        u, v = (
            (np.arange(RAYS) + 0.5) / RAYS * 2 * np.abs(corners @ axis).max() - np.abs(corners @ axis).max()
            for axis in (aside, upward)
        )
        start = extent / 2 + u[:, None, None] * aside + v[None, :, None] * upward
        start = start.reshape(-1, 3)
        with np.errstate(divide="ignore", invalid="ignore"):
            near, far = -start / ahead, (extent - start) / ahead
        inside = (start >= 0) & (start <= extent)
        parallel = ahead == 0
        near, far = np.minimum(near, far), np.maximum(near, far)
        near = np.where(parallel, np.where(inside, -np.inf, np.inf), near).max(axis=1)
        far = np.where(parallel, np.where(inside, np.inf, -np.inf), far).min(axis=1)
        hit = far > near
        depth = np.where(hit, far - near, 0.0)
        t = np.where(hit, near, 0.0)[:, None] + (np.arange(SAMPLES) + 0.5) / SAMPLES * depth[:, None]
        index = np.rint((start[:, None] + t[..., None] * ahead) / size).astype(np.intp)
        index = np.clip(index, 0, np.array(values.shape) - 1)
        rays[view] = values[index[..., 0], index[..., 1], index[..., 2]]
        lengths[view] = depth / SAMPLES
    return rays, lengths
