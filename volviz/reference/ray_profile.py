"""One ray of the float64 oracle, sample by sample: what a ray inspector shows.

The model is that of `volviz.reference.image`, computed with NumPy for the samples of a single ray, so that
the array is read where the ray passes and never copied. Samples of a ray caster lie in segments counted from
where the ray enters; those of view-aligned slices lie where the ray meets the slices.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.kernels.preintegration import MAX_OPACITY, Extinction, segment_color
from volviz.reference.rays import Plane, box_interval, index_limits, pixel_rays, plane_interval
from volviz.reference.sampling import FLAT_GRADIENT, Float64Array, Shading

#: From values and gradient magnitudes, both of shape (n,), to straight RGBA of shape (n, 4).
Classify = Callable[[Float64Array, Float64Array], Float64Array]

SCALAR_MODES = ("maximum", "minimum", "average", "attenuated_maximum")


class RaySpan(NamedTuple):
    """The ray through the middle of one pixel, and the part of it that is drawn.

    Attributes
    ----------
    start : ndarray of shape (3,)
        World point on the near plane.
    direction : ndarray of shape (3,)
        Unit vector into the scene.
    entry, exit : float
        World lengths from `start` between which samples lie; nothing is drawn when entry >= exit.
    begins : {"box", "crop", "plane", "eye"}
        Why the drawn part begins where it does; "eye" is the near plane, with the camera inside the volume.
    ends : {"box", "crop", "plane", "mesh", "far"}
        Why it ends: it leaves the volume or the crop box, meets a clip plane or opaque geometry, or reaches
        the far plane.
    """

    start: Float64Array
    direction: Float64Array
    entry: float
    exit: float
    begins: str
    ends: str


class Pieces(NamedTuple):
    """The pieces of a ray for which one sample each stands, front to back; all of shape (n,), world lengths.

    Attributes
    ----------
    places : ndarray
        Where the samples lie, from the start of the ray.
    fronts : ndarray
        Where the pieces begin.
    lengths : ndarray
        How long they are.
    """

    places: Float64Array
    fronts: Float64Array
    lengths: Float64Array


class Lattice(NamedTuple):
    """The scalars and how they are read.

    Attributes
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars of any type; NaN and infinities count as `low`.
    index_to_world : ndarray of shape (4, 4)
        From continuous index (i, j, k, 1) to world (x, y, z, 1).
    low, high : float
        Range of the finite values.
    nearest : bool
        Nearest voxel instead of trilinear interpolation.
    gradient_delta : float
        Distance of the central differences to each side, in voxels.
    """

    array: npt.NDArray[Any]
    index_to_world: Float64Array
    low: float
    high: float
    nearest: bool = False
    gradient_delta: float = 1.0


class Optics(NamedTuple):
    """What is made of the samples; names and units are those of `reference_render`."""

    classify: Classify
    mode: str = "composite"
    unit_distance: float = 1.0
    early_termination: float = 1.0
    attenuation: float = 1.0
    density_threshold: float = 0.0
    gradient_opacity: float = 0.0
    gradient_reference: float = 1.0
    shading: Shading | None = None
    extinction: Extinction | None = None
    """Given: `composite` is pre-integrated with this table over `extinction_range`."""
    extinction_range: tuple[float, float] = (0.0, 1.0)
    uses_gradient: bool = False
    """Whether `classify` wants gradient magnitudes."""


class RayProfile(NamedTuple):
    """What happens along one ray; arrays have one entry per sample, front to back.

    Attributes
    ----------
    distances : ndarray of shape (n,)
        World length from where the drawn part of the ray begins.
    positions : ndarray of shape (n, 3)
        World positions (x, y, z).
    values : ndarray of shape (n,)
        Scalars in data units.
    gradients : ndarray of shape (n,)
        Gradient magnitudes, data units per world unit; zeros where nobody needed them.
    colors : ndarray of shape (n, 3)
        Straight colours as classified and lit.
    opacities : ndarray of shape (n,)
        Opacity of the piece that the sample stands for; in modes that act on the scalar, that of its value.
    accumulated : ndarray of shape (n, 4)
        Premultiplied RGBA of the ray after the sample; in modes that act on the scalar, the classified
        result up to here.
    results : ndarray of shape (n,)
        In these modes the scalar result up to here, otherwise the values again; NaN before the first sample
        that counts.
    terminated : bool
        The ray ended early, since enough opacity had gathered; no sample behind follows.
    """

    distances: Float64Array
    positions: Float64Array
    values: Float64Array
    gradients: Float64Array
    colors: Float64Array
    opacities: Float64Array
    accumulated: Float64Array
    results: Float64Array
    terminated: bool

    @property
    def color(self) -> Float64Array:
        """Premultiplied RGBA of the pixel."""
        return self.accumulated[-1] if len(self.accumulated) else np.zeros(4)


def ray_span(
    shape: Sequence[int],
    index_to_world: npt.ArrayLike,
    *,
    view: npt.ArrayLike,
    projection: npt.ArrayLike,
    size: tuple[int, int],
    pixel: tuple[int, int],
    crop: Sequence[float] | None = None,
    clip_planes: Sequence[Plane] = (),
    depth: float | None = None,
) -> RaySpan:
    """The ray through a pixel.

    Parameters
    ----------
    shape, index_to_world, view, projection, size, crop, clip_planes
        As in `volviz.reference.rays.volume_rays`.
    pixel : tuple of 2 ints
        Column and row, (0, 0) at the upper left.
    depth : float, optional
        Window depth 0..1 of opaque geometry in that pixel; None or 1 = there is none.
    """
    width, height = size
    x = 2.0 * (pixel[0] + 0.5) / width - 1.0
    y = 1.0 - 2.0 * (pixel[1] + 0.5) / height
    # the frustum of that pixel alone
    pick = np.array(
        [[width, 0, 0, -x * width], [0, height, 0, -y * height], [0, 0, 1, 0], [0, 0, 0, 1]], float
    )
    narrow = pick @ np.asarray(projection, np.float64)
    starts, directions, lengths = pixel_rays(view, narrow, (1, 1))
    start, direction = starts[0, 0], directions[0, 0]
    to_index = np.linalg.inv(np.asarray(index_to_world, np.float64))
    index_start = to_index[:3, :3] @ start + to_index[:3, 3]
    index_direction = to_index[:3, :3] @ direction
    box = box_interval(index_start, index_direction, index_limits(shape, None))
    cropped = box_interval(index_start, index_direction, index_limits(shape, crop))
    plane = plane_interval(start, direction, clip_planes)
    begins = {"eye": 0.0, "box": float(box[0]), "crop": float(cropped[0]), "plane": float(plane[0])}
    ends = {
        "box": float(box[1]), "crop": float(cropped[1]), "plane": float(plane[1]), "far": float(lengths[0, 0]),
    }  # fmt: skip
    if depth is not None and depth < 1.0:
        inverse = np.linalg.inv(narrow @ np.asarray(view, np.float64))
        point = inverse @ np.array([0.0, 0.0, 2.0 * depth - 1.0, 1.0])
        ends["mesh"] = float(np.linalg.norm(point[:3] / point[3] - start))
    # of equal ones the first counts: a crop box that reaches the border of the volume cuts nothing away
    begin = max(begins, key=lambda name: begins[name])
    end = min(ends, key=lambda name: ends[name])
    return RaySpan(start, direction, begins[begin], ends[end], begin, end)


def ray_pieces(span: RaySpan, step: float, first_sample: float, *, jitter: float | None = None) -> Pieces:
    """The segments of a ray caster.

    Parameters
    ----------
    step : float
        Length of a segment, world units.
    first_sample : float
        Place of the sample in its segment, 0..1; see `volviz.reference.image` for 1.0.
    jitter : float, optional
        The place that replaces it for a jittered ray.
    """
    inside = span.exit - span.entry
    place = first_sample if jitter is None else jitter
    # `volviz.reference.march.segment_count`, without waiting for it to be compiled
    whole = first_sample == 1.0 and jitter is None
    pieces = np.floor(inside / step + 1e-9) if whole else np.ceil(inside / step - 1e-11)
    count = max(int(pieces), 0)
    begins = step * np.arange(count, dtype=np.float64)
    fronts, lengths = span.entry + begins, np.minimum(step, inside - begins)
    return Pieces(fronts + place * lengths, fronts, lengths)


def slice_pieces(
    span: RaySpan,
    normal: npt.ArrayLike,
    depths: tuple[float, float],
    count: int,
    position: float = 0.5,
    *,
    jitter: float | None = None,
) -> Pieces:
    """Where a ray meets view-aligned slices.

    Each stands for half a slab before and behind it, the first and the last for all of the ray up to its ends.

    Parameters
    ----------
    normal : array_like of shape (3,)
        Unit vector along the view.
    depths : tuple of 2 floats
        Distances of the box's nearest and farthest corner along it, from the world's origin.
    count : int
        Number of slices.
    position : float
        Place of a slice in its slab, 0..1.
    jitter : float, optional
        Place 0..1 in the slab to which the samples of this ray are moved.
    """
    n = np.asarray(normal, np.float64)
    cosine = max(float(span.direction @ n), 1e-3)
    length = (depths[1] - depths[0]) / count / cosine
    first = (depths[0] - float(span.start @ n)) / cosine
    places: Float64Array = first + (np.arange(count, dtype=np.float64) + position) * length
    places = places[(places >= span.entry) & (places <= span.exit)]
    if jitter is not None:
        places = places + (jitter - 0.5) * length
    before, behind = places - span.entry, span.exit - places
    half = 0.5 * length
    back = np.where(before < length, np.maximum(before, 0.0), half)
    ahead = np.where(behind < length, np.maximum(behind, 0.0), half)
    return Pieces(places, places - back, back + ahead)


def pixel_noise(pixel: tuple[int, int], size: tuple[int, int], seed: float = 0.0) -> float:
    """The place 0..1 at which jitter puts the samples of a pixel (interleaved gradient noise, Jimenez 2014)."""
    x, y = pixel[0] + 0.5 + seed * 5.588238, size[1] - 1 - pixel[1] + 0.5 + seed * 2.345678
    inner = (0.06711056 * x + 0.00583715 * y) % 1.0
    return float((52.9829189 * inner) % 1.0)


def ray_profile(lattice: Lattice, span: RaySpan, pieces: Pieces, optics: Optics) -> RayProfile:
    """What a ray gathers sample by sample.

    Parameters
    ----------
    lattice : Lattice
        The scalars.
    span : RaySpan
        The ray.
    pieces : Pieces
        Where it is sampled.
    optics : Optics
        What is made of the samples.
    """
    positions = span.start + pieces.places[:, None] * span.direction
    values = sample(lattice, positions)
    gradients = np.zeros((len(values), 3))
    if optics.uses_gradient or optics.gradient_opacity > 0 or optics.shading is not None:
        gradients = gradient(lattice, positions)
    magnitudes = np.linalg.norm(gradients, axis=-1)
    lowest = lattice.low + optics.density_threshold * (lattice.high - lattice.low)
    counts = values >= lowest if optics.density_threshold > 0 else np.ones(len(values), bool)
    rgba = optics.classify(values, magnitudes)
    results = values
    if optics.mode in SCALAR_MODES:
        opacities = np.where(counts, rgba[:, 3], 0.0)
        results, accumulated = _scalar(lattice, pieces, optics, values, counts)
        return RayProfile(
            pieces.places - span.entry, positions, values, magnitudes, rgba[:, :3], opacities, accumulated,
            results, False,
        )  # fmt: skip
    units = pieces.lengths / optics.unit_distance
    if optics.extinction is not None and optics.mode == "composite":
        rgba = _preintegrated(lattice, span, pieces, optics, units)
        alpha = rgba[:, 3]
        rgba[:, 3] = 1.0 - (1.0 - np.minimum(alpha, MAX_OPACITY)) ** (1.0 / np.maximum(units, 1e-12))
    elif optics.density_threshold > 0:
        rgba[:, 3] = np.where(counts, rgba[:, 3], 0.0)
    if optics.gradient_opacity > 0:
        g, reference = optics.gradient_opacity, optics.gradient_reference
        share = np.minimum(magnitudes / reference, 1.0) if reference > 0 else 1.0
        rgba[:, 3] *= 1.0 - g + g * share
    if optics.shading is not None:
        rgba[:, :3] = _lit(rgba[:, :3], gradients, positions, span.direction, optics.shading)
    if optics.mode == "additive":
        thickness = -np.log1p(-np.minimum(rgba[:, 3], MAX_OPACITY)) * units
        weights = np.column_stack([rgba[:, :3], np.ones(len(rgba))]) * thickness[:, None]
        accumulated = np.minimum(np.cumsum(weights, axis=0), 1.0)
        opacities, last = -np.expm1(-thickness), len(rgba)
    else:
        opacities = 1.0 - (1.0 - rgba[:, 3]) ** units
        through = np.cumprod(1.0 - opacities)
        before = np.concatenate([[1.0], through[:-1]])[: len(through)]
        sums = np.cumsum(rgba[:, :3] * (before * opacities)[:, None], axis=0)
        accumulated = np.column_stack([sums, 1.0 - through])
        enough = np.flatnonzero(accumulated[:, 3] >= optics.early_termination)
        stops = optics.early_termination < 1.0 and len(enough) > 0
        last = int(enough[0]) + 1 if stops else len(rgba)
    return RayProfile(
        (pieces.places - span.entry)[:last],
        positions[:last],
        values[:last],
        magnitudes[:last],
        rgba[:last, :3],
        opacities[:last],
        accumulated[:last],
        results[:last],
        last < len(rgba) or _ended(optics, accumulated),
    )


def _ended(optics: Optics, accumulated: Float64Array) -> bool:
    """Whether the very last sample was the one that made the ray dense enough."""
    if optics.mode != "composite" or optics.early_termination >= 1.0 or not len(accumulated):
        return False
    return bool(accumulated[-1, 3] >= optics.early_termination)


def _scalar(
    lattice: Lattice, pieces: Pieces, optics: Optics, values: Float64Array, counts: npt.NDArray[np.bool_]
) -> tuple[Float64Array, Float64Array]:
    """Running result and its classified, premultiplied colour, for the modes that act on the scalar."""
    lengths = np.where(counts, pieces.lengths, 0.0)
    span = lattice.high - lattice.low
    if optics.mode == "maximum":
        results = np.maximum.accumulate(np.where(counts, values, -np.inf))
    elif optics.mode == "minimum":
        results = np.minimum.accumulate(np.where(counts, values, np.inf))
    elif optics.mode == "average":
        with np.errstate(invalid="ignore"):
            results = np.cumsum(np.where(counts, values, 0.0) * lengths) / np.cumsum(lengths)
    else:
        s = np.clip((values - lattice.low) / span, 0.0, 1.0) if span > 0 else np.zeros_like(values)
        behind = np.cumsum(s * lengths / optics.unit_distance)
        before = np.concatenate([[0.0], behind[:-1]])[: len(behind)]
        weakened = np.where(counts, s * np.exp(-optics.attenuation * before), -1.0)
        results = lattice.low + np.maximum.accumulate(weakened) * span
    seen = np.cumsum(counts) > 0
    results = np.where(seen, results, np.nan)
    rgba = optics.classify(np.where(seen, results, lattice.low), np.zeros(len(values)))
    alpha = np.where(seen, rgba[:, 3], 0.0)
    return results, np.column_stack([rgba[:, :3] * alpha[:, None], alpha])


def _preintegrated(
    lattice: Lattice, span: RaySpan, pieces: Pieces, optics: Optics, units: Float64Array
) -> Float64Array:
    """Straight colour and opacity of each piece from the values at both its ends."""
    assert optics.extinction is not None
    ends = np.concatenate([pieces.fronts, pieces.fronts[-1:] + pieces.lengths[-1:]])
    values = sample(lattice, span.start + ends[:, None] * span.direction)
    low, high = optics.extinction_range
    t = np.clip((values - low) / (high - low), 0.0, 1.0) if high > low else np.zeros_like(values)
    places = t * (len(optics.extinction.nodes) - 1)
    rgba = np.zeros((len(units), 4))
    for i in range(len(units)):
        *color, alpha = segment_color(
            optics.extinction, float(places[i]), float(places[i + 1]), float(units[i])
        )
        rgba[i] = (*(np.asarray(color) / alpha), alpha) if alpha > 0 else (0.0, 0.0, 0.0, 0.0)
    return rgba


def _lit(
    colors: Float64Array,
    gradients: Float64Array,
    positions: Float64Array,
    direction: Float64Array,
    shading: Shading,
) -> Float64Array:
    """Colours under the light; unlit where there is no gradient. See `Shading`."""
    sizes = np.linalg.norm(gradients, axis=-1)
    has = sizes > 0
    normals = gradients / np.where(has, sizes, 1.0)[:, None]
    to_eye = -np.asarray(direction)
    if shading.light_position is None:
        to_light = np.broadcast_to(to_eye, gradients.shape)
    else:
        to_light = np.asarray(shading.light_position) - positions
        far = np.linalg.norm(to_light, axis=-1, keepdims=True)
        to_light = to_light / np.where(far > 0, far, 1.0)
    half = to_light + to_eye
    length = np.linalg.norm(half, axis=-1)
    diffuse = np.abs(np.sum(normals * to_light, axis=-1))
    cosine = np.abs(np.sum(normals * half, axis=-1)) / np.where(length > 0, length, 1.0)
    highlight = np.where(length > 0, cosine, 0.0) ** shading.shininess
    light = np.asarray(shading.light_color)
    lit = colors * (shading.ambient + shading.diffuse * diffuse[:, None] * light)
    lit = lit + shading.specular * highlight[:, None] * light
    return np.asarray(np.where(has[:, None], lit, colors))


def sample(lattice: Lattice, positions: Float64Array) -> Float64Array:
    """Values at world positions of shape (n, 3), clamped to the first and last voxel along each axis."""
    return _at(lattice, _index(lattice, positions))


def gradient(lattice: Lattice, positions: Float64Array) -> Float64Array:
    """World gradients (n, 3) from central differences of clamped samples; 0 where it is only rounding."""
    index, delta = _index(lattice, positions), lattice.gradient_delta
    differences = np.empty((len(index), 3))
    for axis in range(3):
        shift = np.zeros(3)
        shift[axis] = delta
        differences[:, axis] = (_at(lattice, index + shift) - _at(lattice, index - shift)) / (2 * delta)
    axes = lattice.index_to_world[:3, :3]
    world = differences @ np.linalg.inv(axes)
    flat = FLAT_GRADIENT * (lattice.high - lattice.low) / float(np.linalg.norm(axes, axis=0).mean())
    return np.asarray(np.where(np.linalg.norm(world, axis=-1, keepdims=True) > flat, world, 0.0))


def _index(lattice: Lattice, positions: Float64Array) -> Float64Array:
    to_index = np.linalg.inv(lattice.index_to_world)
    return np.asarray(positions @ to_index[:3, :3].T + to_index[:3, 3])


def _at(lattice: Lattice, index: Float64Array) -> Float64Array:
    """Values at continuous indices (i, j, k)."""
    last = np.array(lattice.array.shape[::-1]) - 1
    place = np.clip(index, 0, last)
    if lattice.nearest:
        i, j, k = np.floor(place + 0.5).astype(np.intp).T
        return _finite(lattice, lattice.array[k, j, i])
    low = np.minimum(place.astype(np.intp), np.maximum(last - 1, 0))
    high = np.minimum(low + 1, last)
    part = place - low
    result = np.zeros(len(place))
    for corner in range(8):
        chosen = np.array([corner & 1, corner >> 1 & 1, corner >> 2], bool)
        i, j, k = np.where(chosen, high, low).T
        weight = np.where(chosen, part, 1.0 - part).prod(axis=-1)
        result += weight * _finite(lattice, lattice.array[k, j, i])
    return result


def _finite(lattice: Lattice, values: npt.NDArray[Any]) -> Float64Array:
    numbers = values.astype(np.float64)
    return numbers if values.dtype.kind in "iu" else np.where(np.isfinite(numbers), numbers, lattice.low)
