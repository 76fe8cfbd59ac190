"""Slices by the float64 oracle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.techniques.slice.planes import shown_planes
from volviz.model.transfer.first_look import grey_window
from volviz.reference.rays import pixel_rays
from volviz.reference.slices import composited, index_box, projected, slab_offsets, slab_samples

if TYPE_CHECKING:
    from volviz.custom_gl.oracles import OracleScene


def resampled_planes(scene: OracleScene, settings: Any) -> npt.NDArray[np.float64]:
    """The nearest plane behind each pixel: premultiplied RGBA of shape (H, W, 4), row 0 at the top."""
    volume = scene.volume()
    starts, directions, lengths = pixel_rays(scene.view, scene.projection, scene.size)
    image = np.zeros((*lengths.shape, 4))
    nearest = np.full(lengths.shape, np.inf)
    box = index_box(volume.dimensions, scene.clipping.crop)
    for plane in shown_planes(settings, volume.center):
        normal = np.asarray(plane.normal)
        slope = directions @ normal
        with np.errstate(divide="ignore", invalid="ignore"):
            t = ((np.asarray(plane.point) - starts) @ normal) / slope
        seen = (t >= 0.0) & (t <= lengths) & (t < nearest)
        points = starts + np.where(seen, t, 0.0)[..., None] * directions
        for origin, inward in scene.clipping.planes:
            seen &= (points - np.asarray(origin)) @ np.asarray(inward) >= 0.0
        on_plane = slab_samples(
            volume.array, volume.world_to_index, points, plane.normal, np.zeros(1), "nearest", box
        )
        seen &= np.isfinite(next(on_plane))
        away = plane.normal if float(np.median(slope)) > 0 else tuple(-n for n in plane.normal)
        color = _colors(scene, settings, points, away, box)
        seen &= color[..., 3] > 0.0
        image[seen], nearest[seen] = color[seen], t[seen]
    return image


def _colors(
    scene: OracleScene, settings: Any, points: Any, away: Any, box: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Premultiplied colours at world points of a plane, as seen along a direction."""
    volume = scene.volume()
    offsets = slab_offsets(settings.slab, scene.step)
    samples = slab_samples(
        volume.array, volume.world_to_index, points, away, offsets, settings.interpolation, box
    )
    if settings.slab_mode == "composite":
        length = settings.slab / len(offsets) if settings.slab else scene.mean_spacing
        return composited(samples, scene.function.evaluate, length, scene.unit_distance(settings))
    values = projected(samples, settings.slab_mode)
    inside = np.isfinite(values)
    image = np.zeros((*values.shape, 4))
    if settings.coloring == "window":
        black, white = grey_window(volume, settings.window_level, settings.window_width)
        image[inside, :3] = np.clip((values[inside] - black) / (white - black), 0.0, 1.0)[:, None]
    else:
        image[inside, :3] = scene.function.evaluate(values[inside])[:, :3]
    image[inside, 3] = 1.0
    return image
