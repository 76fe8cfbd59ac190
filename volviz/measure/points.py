"""Points along a ray, found by a stated rule, with the error of their place along it.

The values between voxels are linear. What that leaves open is found by two levels (Richardson 1911; Roache,
"Perspective: a method for uniform reporting of grid refinement studies", 1994, with the factor 3 for two levels): the
same rule on every second voxel, for each of the eight ways to choose them, and on means of neighbours. How far these
lie off together is the error of the interpolation; how much they differ, that of where the voxels happen to lie. To
that comes the noise of the values and, if told, the error of the isovalue, both divided by the slope along the ray.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from volviz.errors import InputError
from volviz.measure.noise import noise_of
from volviz.measure.results import Float64Array, along
from volviz.model.measurements import COVERAGE, Point
from volviz.model.transfer.function import TransferFunction
from volviz.reference.rays import box_interval, index_limits
from volviz.reference.surface_pick import values_at
from volviz.volume_data.vectors import finite_vector
from volviz.volume_data.volume import Volume

#: Distance of samples along a ray, in the smallest spacing.
STEP = 0.25
#: On the coarser level a place is looked for within so many voxels.
REACH = 3.0
#: Voxels to each side of a point from which the noise around it is found.
SURROUNDINGS = 12
#: What rounding may cost, in the smallest spacing.
ROUNDING = 1e-5
#: Share of a ray's opacity at which it has arrived, as in picking.
ARRIVED = 0.5
_OFFSETS = np.array([(c & 1, c >> 1 & 1, c >> 2 & 1) for c in range(8)])

Values = Callable[[Float64Array], Float64Array]
"""From distances along the ray to values."""
Finder = Callable[[Values, float, float], float | None]
"""From values and a part of the ray to the place there, None where there is none."""


def isovalue_point(
    volume: Volume,
    start: Sequence[float],
    direction: Sequence[float],
    isovalue: float,
    *,
    isovalue_error: float = 0.0,
    length: float = math.inf,
) -> Point | None:
    """The first place along a ray at which the values pass an isovalue.

    Parameters
    ----------
    volume : Volume
    start, direction : 3 floats
        World point and direction of the ray.
    isovalue : float
        In data units.
    isovalue_error : float
        Half-width of the 95 % interval in which the right isovalue lies.
    length : float
        World length at which the ray ends.

    Returns
    -------
    Point or None
        With the rule "isovalue"; None where the ray does not meet it.

    Raises
    ------
    InputError
        Numbers that are not finite, or a direction of length zero.
    """
    if not (math.isfinite(isovalue) and 0 <= isovalue_error < math.inf):
        raise InputError(
            f"an isovalue and its error must be finite, the error not negative, got {isovalue!r} and "
            f"{isovalue_error!r}."
        )
    ray = _Ray(volume, start, direction, length)
    found = ray.place(lambda values, near, far: _crossing(values, near, far, isovalue, ray.step))
    if found is None:
        return None
    t, error = found
    slope = ray.slope(t)
    chance = math.hypot(COVERAGE * ray.noise(t), isovalue_error)
    return ray.point(t, math.hypot(error, chance / slope if slope > 0 else ray.spacing), "isovalue", isovalue)


def maximum_point(
    volume: Volume, start: Sequence[float], direction: Sequence[float], *, length: float = math.inf
) -> Point | None:
    """The place of the largest value along a ray, as a maximum projection shows it.

    Parameters
    ----------
    volume, start, direction, length
        As for `isovalue_point`.

    Returns
    -------
    Point or None
        With the rule "maximum" and the value there; None where the ray misses the volume.
    """
    ray = _Ray(volume, start, direction, length)
    found = ray.place(_largest(ray.step))
    if found is None:
        return None
    t, error = found
    # where noise decides: all places whose value is as large within its standard deviation
    places = ray.places(ray.near, ray.far)
    values = ray.values(places)
    highest = float(ray.values(np.array([t]))[0])
    alike = places[values >= highest - COVERAGE * ray.noise(t)]
    near = alike[np.abs(alike - t) <= REACH * ray.spacing]
    flat = float(np.ptp(near)) / 2 if near.size else 0.0
    return ray.point(t, math.hypot(error, flat), "maximum", highest)


def opacity_point(
    volume: Volume,
    start: Sequence[float],
    direction: Sequence[float],
    transfer_function: TransferFunction,
    *,
    unit_distance: float | None = None,
    length: float = math.inf,
) -> Point | None:
    """The place at which a ray has gathered half of its whole opacity.

    Parameters
    ----------
    volume, start, direction, length
        As for `isovalue_point`.
    transfer_function : TransferFunction
        Over the value.
    unit_distance : float, optional
        World length to which its opacities belong; the default is the mean spacing.

    Returns
    -------
    Point or None
        With the rule "opacity" and the value there; None where the ray meets nothing.
    """
    ray = _Ray(volume, start, direction, length)
    unit = unit_distance or volume.mean_spacing
    function = transfer_function.resolved(volume.range)

    def arrival(values: Values, near: float, far: float) -> float | None:
        # the whole ray counts, whichever part of it is asked for
        edges = ray.places(ray.near, ray.far)
        found = np.clip(function.evaluate(values((edges[1:] + edges[:-1]) / 2))[:, 3], 0.0, 1.0 - 1e-9)
        clear = np.cumprod((1.0 - found) ** ((edges[1] - edges[0]) / unit))
        gathered = np.concatenate([[0.0], 1.0 - clear])
        if gathered[-1] < 1e-3:
            return None
        t = float(np.interp(ARRIVED * gathered[-1], gathered, edges))
        return t if near <= t <= far else None

    found = ray.place(arrival)
    if found is None:
        return None
    t, error = found
    value = float(ray.values(np.array([t]))[0])
    noise = COVERAGE * ray.noise(t)

    def brighter(by: float) -> Values:
        return lambda places: ray.values(places) + by

    moved = [arrival(brighter(by), ray.near, ray.far) for by in (-noise, noise)]
    chance = max((abs(other - t) for other in moved if other is not None), default=0.0)
    return ray.point(t, math.hypot(error, chance, ray.step / 2), "opacity", value)


def label_point(
    labels: Volume,
    start: Sequence[float],
    direction: Sequence[float],
    *,
    hidden: Sequence[int] = (),
    length: float = math.inf,
) -> Point | None:
    """The first surface of a label along a ray: where the interpolated indicator of it passes one half.

    Parameters
    ----------
    labels : Volume
        Whole numbers; 0 is nothing.
    start, direction, length
        As for `isovalue_point`.
    hidden : sequence of int
        Labels that are looked through.

    Returns
    -------
    Point or None
        With the rule "label" and the label; None where the ray meets none.
    """
    ray = _Ray(labels, start, direction, length)
    if not ray.far > ray.near:
        return None
    places = ray.places(ray.near, ray.far)
    nearest = values_at(labels.array, ray.indices(places), nearest=True, lowest=0.0)
    seen = np.flatnonzero(~np.isin(nearest, (0, *hidden)))
    if not seen.size:
        return None
    t, label = float(places[seen[0]]), int(nearest[seen[0]])
    own = _Ray(_indicator(labels, label, ray.indices(np.array([t]))[0]), start, direction, length)
    found = own.place(lambda values, near, far: _crossing(values, near, far, 0.5, own.step))
    # a voxel that touches others of its label by corners only has no surface of one half
    t, error = (t, own.spacing) if found is None else found
    # the border lies anywhere between two voxels of different labels
    return ray.point(t, math.hypot(error, COVERAGE * own.spacing / 12**0.5), "label", label)


def _indicator(labels: Volume, label: int, index: Float64Array) -> Volume:
    """1 where a label is, else 0, around a continuous index (i, j, k)."""
    last = np.asarray(labels.dimensions) - 1
    low = np.clip(np.floor(index).astype(int) - SURROUNDINGS, 0, last - 1)
    high = np.clip(np.ceil(index).astype(int) + SURROUNDINGS, low + 1, last)
    part = labels.array[low[2] : high[2] + 1, low[1] : high[1] + 1, low[0] : high[0] + 1]
    x, y, z = labels.index_to_world[:3, :3] @ low + labels.index_to_world[:3, 3]
    return Volume((part == label).astype(np.uint8), labels.spacing, (x, y, z), labels.direction)


class _Ray:
    """A ray through a volume: values along it on the lattice itself and on coarser ones."""

    def __init__(
        self, volume: Volume, start: Sequence[float], direction: Sequence[float], length: float
    ) -> None:
        self._volume = volume
        self.start = np.asarray(finite_vector(start, "start of a ray"))
        unit = np.asarray(finite_vector(direction, "direction of a ray"))
        if not np.any(unit):
            raise InputError("the direction of a ray has length zero; give where it goes.")
        self.direction = unit / np.linalg.norm(unit)
        matrix = volume.world_to_index
        self._from = matrix[:3, :3] @ self.start + matrix[:3, 3]
        self._along = matrix[:3, :3] @ self.direction
        #: World length of a voxel along the ray.
        self.spacing = float(1.0 / np.abs(self._along).max())
        self.step = STEP * min(volume.spacing)
        near, far = box_interval(self._from[None], self._along[None], index_limits(volume.array.shape, None))
        self.near, self.far = max(float(near[0]), 0.0), min(float(far[0]), length)

    def indices(self, t: Float64Array) -> Float64Array:
        """Continuous voxel indices (n, 3) at distances."""
        return np.asarray(self._from + np.atleast_1d(t)[:, None] * self._along)

    def places(self, near: float, far: float) -> Float64Array:
        """Distances no farther apart than a step, both ends among them."""
        return np.linspace(near, far, max(math.ceil((far - near) / self.step), 1) + 1)

    def values(self, t: Float64Array) -> Float64Array:
        """Values at distances, linear between voxels."""
        return self._sampled(self.indices(t))

    def place(self, find: Finder) -> tuple[float, float] | None:
        """Where a rule leads along the ray, and the 95 % half-width that the lattice leaves."""
        if not self.far > self.near:
            return None
        t = find(self.values, self.near, self.far)
        if t is None:
            return None
        reach = REACH * self.spacing
        near, far = max(t - reach, self.near), min(t + reach, self.far)
        coarse = []
        for offset in _OFFSETS:
            found = find(lambda places, offset=offset: self._every_second(places, offset), near, far)  # type: ignore[misc]
            # what every second voxel does not show may be a voxel off
            coarse.append(t + self.spacing if found is None else found)
        blurred = find(self._blurred, near, far)
        shift = max(abs(t - float(np.mean(coarse))), self.spacing if blurred is None else abs(t - blurred))
        # variances grow at least with the square of the spacing: from one level to the next by three of the finer
        spread = COVERAGE * float(np.std(coarse)) / 3**0.5
        return t, math.hypot(shift, spread, ROUNDING * self.spacing)

    def slope(self, t: float) -> float:
        """Magnitude of the derivative along the ray, over a voxel, in data units per world unit."""
        a, b = self.values(np.array([t - self.spacing / 2, t + self.spacing / 2]))
        return abs(float(b - a)) / self.spacing

    def noise(self, t: float) -> float:
        """Standard deviation of the interpolated value at a distance, from the noise of the voxels around."""
        middle = np.rint(self.indices(np.array([t]))[0]).astype(int)[::-1]
        around = tuple(slice(max(m - SURROUNDINGS, 0), m + SURROUNDINGS + 1) for m in middle)
        part = self.indices(np.array([t]))[0] % 1.0
        weights = np.prod((1.0 - part) ** 2 + part**2)
        return noise_of(self._volume.array[around]) * math.sqrt(float(weights))

    def point(self, t: float, error: float, rule: str, number: float) -> Point:
        """The point at a distance."""
        x, y, z = (float(v) for v in self.start + t * self.direction)
        return Point((x, y, z), along(self.direction, error), rule, float(number))

    def _sampled(self, indices: Float64Array) -> Float64Array:
        return values_at(self._volume.array, indices, nearest=False, lowest=float(self._volume.range[0]))

    def _every_second(self, t: Float64Array, offset: Float64Array) -> Float64Array:
        i, j, k = offset
        array = self._volume.array[k::2, j::2, i::2]
        if min(array.shape) < 2:
            return self.values(t)
        return values_at(
            array, (self.indices(t) - offset) / 2.0, nearest=False, lowest=float(self._volume.range[0])
        )

    def _blurred(self, t: Float64Array) -> Float64Array:
        """Means of the eight places half a voxel away along each axis."""
        shifted = self.indices(t)[:, None, :] + (_OFFSETS - 0.5)
        return np.asarray(self._sampled(shifted.reshape(-1, 3)).reshape(-1, 8).mean(axis=1))


def _crossing(values: Values, near: float, far: float, isovalue: float, step: float) -> float | None:
    """First place at which values pass the isovalue, to rounding."""
    places = np.linspace(near, far, max(math.ceil((far - near) / step), 1) + 1)
    inside = values(places) >= isovalue
    changes = np.flatnonzero(inside[1:] != inside[:-1])
    if not changes.size:
        return None
    low, high = float(places[changes[0]]), float(places[changes[0] + 1])
    state = bool(inside[changes[0]])
    for _ in range(20):
        middle = (low + high) / 2
        if bool(values(np.array([middle]))[0] >= isovalue) == state:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def _largest(step: float) -> Finder:
    def find(values: Values, near: float, far: float) -> float | None:
        places = np.linspace(near, far, max(math.ceil((far - near) / step), 1) + 1)
        found = values(places)
        # the middle of those that are equally large
        highest = np.flatnonzero(found == found.max())
        return float(places[highest[(len(highest) - 1) // 2]])

    return find
