"""The float64 oracle of volumetric shadows of several layers: a ray towards the light from every sample."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from volviz.reference.layer_rays import LayerRays, ReferenceLayer, Sampling
from volviz.reference.rays import Plane, pixel_rays
from volviz.reference.sampling import Float64Array

#: Opacity from which a ray is not followed farther.
NEARLY_OPAQUE = 0.9999


def reference_layer_shadows(
    layers: Sequence[ReferenceLayer],
    *,
    view: npt.ArrayLike,
    projection: npt.ArrayLike,
    size: tuple[int, int],
    step_world: float,
    light_position: Sequence[float],
    kappa: Sequence[float] = (1.0, 1.0, 1.0),
    ambient: float = 0.0,
    light_step: float | None = None,
    clip_planes: Sequence[Plane] = (),
) -> Float64Array:
    """The image of layers that all throw shadows on all.

    The law is that of `volviz.reference.layers`; the colour of a sample is multiplied by ``ambient + (1 - ambient) T``
    with ``T_rgb = exp(-kappa_rgb tau)``, where tau is the optical depth of all layers between the sample and the light,
    as in `volviz.reference.shadows`.

    Parameters
    ----------
    layers : sequence of ReferenceLayer
        In any order.
    view, projection, size, step_world, clip_planes
        As in `volviz.reference.layers.reference_layers`; samples lie in the middle of segments.
    light_position : sequence of 3 floats
        World position of the light.
    kappa, ambient, light_step
        As in `volviz.reference.shadows.reference_shadows`.

    Returns
    -------
    ndarray of shape (h, w, 4), float64
        Premultiplied RGBA, row 0 at the top.
    """
    added = [layer for layer in layers if layer.mode == "add"]
    starts, directions, lengths = (
        each.reshape(-1, *each.shape[2:]) for each in pixel_rays(view, projection, size)
    )
    march = LayerRays(layers, starts, directions, lengths, clip_planes, Sampling())
    image = np.zeros((len(starts), 4))
    for met, begin, piece, at in march.segments(step_world, 0.5):
        depth, emitted = march.matter(added, met, begin, piece, at)
        seen = (depth > 0) & (image[met, 3] < NEARLY_OPAQUE)
        rays, depth, emitted = met[seen], depth[seen], emitted[seen]
        points = march.points(rays, at[seen])
        before = _depth_to_light(layers, added, points, light_position, light_step or step_world, clip_planes)
        light = np.exp(-np.outer(before, np.asarray(kappa)))
        color = emitted / depth[:, None] * (ambient + (1.0 - ambient) * light)
        weight = (1.0 - image[rays, 3]) * -np.expm1(-depth)
        image[rays, :3] += weight[:, None] * color
        image[rays, 3] += weight
    return image.reshape(size[1], size[0], 4)


def _depth_to_light(
    layers: Sequence[ReferenceLayer],
    added: Sequence[ReferenceLayer],
    points: Float64Array,
    light: Sequence[float],
    step: float,
    clip_planes: Sequence[Plane],
) -> Float64Array:
    """Optical depth of all layers between world points and the light, shape (n,)."""
    towards = np.asarray(light) - points
    lengths = np.linalg.norm(towards, axis=1)
    march = LayerRays(layers, points, towards / lengths[:, None], lengths, clip_planes, Sampling())
    total = np.zeros(len(points))
    for rays, begin, piece, at in march.segments(step, 0.5):
        total[rays] += march.matter(added, rays, begin, piece, at)[0]
    return total
