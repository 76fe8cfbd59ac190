"""The float64 oracle of several layers in one ray integral: NumPy, all rays of an image at once.

The law. All layers are sampled at the same points of a ray. A layer with opacity a per unit distance u has the
extinction ``-ln(1 - a) / u``. Extinctions add, and what a point emits is the mean of the layers' colours weighted by
their extinctions. A segment of length d has the opacity ``1 - exp(-d sum extinction)``, and segments are blended
front to back. So the order of layers means nothing, red and green of equal strength are yellow, and a layer beside
itself at half its extinction is one layer.

A ray is cut into segments from where it enters the first layer to where it leaves the last. Each layer has the
part of a segment that lies in its box. Colours are lit by the gradient of their own layer before the mean is taken.

Label layers are surfaces in that matter: where the ray crosses from one label to another within a segment, the part of
its matter before the border is blended first, then the surface, then the rest. The surface is that of the label which
the ray enters or, where that is not shown, of the one that it leaves.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.reference.image import MODES
from volviz.reference.labels import ReferenceLabels
from volviz.reference.layer_rays import LayerRays, ReferenceLayer, Sampling, lit
from volviz.reference.rays import Plane, pixel_rays
from volviz.reference.sampling import Float64Array, Shading


def reference_layers(
    layers: Sequence[ReferenceLayer | ReferenceLabels],
    *,
    view: npt.ArrayLike,
    projection: npt.ArrayLike,
    size: tuple[int, int],
    step_world: float,
    first_sample: float = 0.5,
    mode: str = "composite",
    attenuation: float = 1.0,
    early_termination: float = 1.0,
    sampling: Sampling | None = None,
    clip_planes: Sequence[Plane] = (),
) -> Float64Array:
    """The image of several layers that a perfect renderer would draw.

    Parameters
    ----------
    layers : sequence of ReferenceLayer or ReferenceLabels
        In any order. Labels are drawn by the mode "composite" only; as masks they count in every mode.
    view, projection, size, step_world, first_sample, attenuation, early_termination, clip_planes
        As in `volviz.reference.image.reference_render`.
    mode : {"composite", "maximum", "minimum", "average", "additive", "attenuated_maximum"}
        "composite" and "additive" follow the law above. The others make one scalar of each layer and classify it;
        premultiplied colours of the layers are added and clamped to 1. Samples count where the masks are seen;
        there is no extinction that could be modulated.
    sampling : Sampling, optional
        How layers are sampled and lit.

    Returns
    -------
    ndarray of shape (h, w, 4), float64
        Premultiplied RGBA, row 0 at the top; colours of "composite" are not clamped.

    Raises
    ------
    InputError
        No layer whose matter is added, or an impossible step or mode.
    """
    added = [layer for layer in layers if isinstance(layer, ReferenceLayer) and layer.mode == "add"]
    surfaces = [layer for layer in layers if isinstance(layer, ReferenceLabels) and layer.mode == "add"]
    if not added and not (surfaces and mode == "composite"):
        raise InputError("no layer is added: masks alone show nothing.")
    if mode not in MODES:
        raise InputError(f"mode must be one of {', '.join(MODES)}, got {mode!r}.")
    if not step_world > 0 or not 0 <= first_sample <= 1:
        raise InputError("step_world must be above 0 and first_sample between 0 and 1.")
    starts, directions, lengths = (
        each.reshape(-1, *each.shape[2:]) for each in pixel_rays(view, projection, size)
    )
    march = LayerRays(layers, starts, directions, lengths, clip_planes, sampling or Sampling())
    if mode == "composite":
        image = _composited(march, added, surfaces, step_world, first_sample, early_termination)
    elif mode == "additive":
        image = _added_up(march, added, step_world, first_sample)
    else:
        each = (_of_scalar(march, layer, step_world, first_sample, mode, attenuation) for layer in added)
        image = np.minimum(sum(each), 1.0)
    return image.reshape(size[1], size[0], 4)


def _composited(
    march: LayerRays,
    added: Sequence[ReferenceLayer],
    surfaces: Sequence[ReferenceLabels],
    step: float,
    first_sample: float,
    early_termination: float,
) -> Float64Array:
    count = len(march.starts)
    image = np.zeros((count, 4))
    hits = np.flatnonzero(march.far > march.near)
    before = [np.zeros(count, np.int64) for _ in surfaces]
    for layer, known in zip(surfaces, before, strict=True):
        # a label that is cut has a face where the ray begins
        known[hits] = march.labels(layer, hits, march.near[hits])
        face = layer.palette[known[hits]]
        _blend(image, hits, face[:, 3], face[:, :3])
    for segment in march.segments(step, first_sample):
        goes_on = image[segment[0], 3] < early_termination
        rays, begin, piece, at = (part[goes_on] for part in segment)
        depth, emitted = march.matter(added, rays, begin, piece, at)
        color = emitted / np.where(depth > 0, depth, 1.0)[:, None]
        crossed = [
            _border(march, layer, known, rays, begin, piece)
            for layer, known in zip(surfaces, before, strict=True)
        ]
        passed = np.zeros(len(rays))
        if crossed:
            places = np.stack([place for place, _ in crossed])
            for nearest in np.argsort(places, axis=0, kind="stable"):
                place = np.take_along_axis(places, nearest[None], axis=0)[0]
                surface = np.stack([each for _, each in crossed])[nearest, np.arange(len(rays))]
                met = np.isfinite(place)
                reached = np.where(met, (place - begin) / piece, passed)
                _blend(image, rays, -np.expm1(-depth * (reached - passed)), color)
                _blend(image, rays, surface[:, 3], surface[:, :3])
                passed = reached
        _blend(image, rays, -np.expm1(-depth * (1.0 - passed)), color)
    return image


def _blend(image: Float64Array, rays: Any, alpha: Float64Array, color: Float64Array) -> None:
    """Put straight colours behind what rays have gathered."""
    rest = (1.0 - image[rays, 3]) * alpha
    image[rays, :3] += rest[:, None] * color
    image[rays, 3] += rest


def _border(
    march: LayerRays,
    layer: ReferenceLabels,
    known: npt.NDArray[np.int64],
    rays: Any,
    begin: Float64Array,
    piece: Float64Array,
) -> tuple[Float64Array, Float64Array]:
    """Where rays cross a visible border within a segment, inf where not, and the surface there, straight RGBA (n, 4).

    `known` holds the label of each ray at the segment's beginning and is brought to its end.
    """
    end = begin + piece
    place, surface = np.full(len(rays), np.inf), np.zeros((len(rays), 4))
    after = march.labels(layer, rays, end)
    before = known[rays]
    met = np.flatnonzero((after != before) & (layer.is_shown(after) | layer.is_shown(before)))
    known[rays] = after
    if len(met):
        there = rays[met]
        at, owner = march.border(layer, there, begin[met], end[met], before[met], after[met])
        place[met] = at
        surface[met] = layer.palette[owner]
        p = march.points(there, at)
        shading = march.sampling.surface_shading or Shading()
        gradient = layer.gradient(layer.index_of(p), owner)
        surface[met, :3] = lit(surface[met, :3], gradient, p, march.directions[there], shading)
    return place, surface


def _added_up(
    march: LayerRays, added: Sequence[ReferenceLayer], step: float, first_sample: float
) -> Float64Array:
    image = np.zeros((len(march.starts), 4))
    for rays, begin, piece, at in march.segments(step, first_sample):
        depth, emitted = march.matter(added, rays, begin, piece, at)
        image[rays, :3] += emitted
        image[rays, 3] += depth
    return np.minimum(image, 1.0)


def _of_scalar(
    march: LayerRays, layer: ReferenceLayer, step: float, first_sample: float, mode: str, attenuation: float
) -> Float64Array:
    """Premultiplied RGBA of the one scalar that a mode makes of a layer along each ray, shape (rays, 4)."""
    count = len(march.starts)
    seen, result, depth = np.zeros(count), np.zeros(count), np.zeros(count)
    low, high = layer.value_range
    span = high - low
    threshold = march.sampling.density_threshold
    lowest = low + threshold * span if threshold > 0 else -np.inf
    for there, begin, piece, at in march.segments(step, first_sample):
        length = piece * march.share(layer, there, begin, piece)
        _, values = march.values(layer, there, at)
        counts = (length > 0) & (values >= lowest) & (march.factor(("mask",), there, begin, piece, at) >= 0.5)
        rays, values, length = there[counts], values[counts], length[counts]
        first = seen[rays] == 0
        if mode == "maximum":
            result[rays] = np.where(first, values, np.maximum(result[rays], values))
        elif mode == "minimum":
            result[rays] = np.where(first, values, np.minimum(result[rays], values))
        elif mode == "average":
            result[rays] += values * length
        else:
            s = np.clip((values - low) / (span if span > 0 else 1.0), 0.0, 1.0)
            result[rays] = np.maximum(result[rays], s * np.exp(-attenuation * depth[rays]))
            depth[rays] += s * length / layer.unit_distance
        seen[rays] += length
    if mode == "average":
        result /= np.where(seen > 0, seen, 1.0)
    elif mode == "attenuated_maximum":
        result = low + result * span
    rgba = layer.classified(result, 0.0)
    rgba[seen == 0] = 0.0
    rgba[:, :3] *= rgba[:, 3:]
    return rgba
