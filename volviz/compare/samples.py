"""How many samples a ray takes: from the geometry of box and camera and from the distance of the samples.

It is the number that a ray would take from where it enters the box to where it leaves it. What a technique saves by
jumping over empty space and by ending rays early is not taken off.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.resolve import resolve
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.parameters import setting_values
from volviz.model.render_spec import RenderSpec, View
from volviz.reference.rays import box_interval, index_limits, plane_interval
from volviz.volume_data.volume import Volume

Float64Array = npt.NDArray[np.float64]

#: At most so many rays are looked at, evenly over the image.
MOST_RAYS = 40_000


@dataclass(frozen=True)
class RaySamples:
    """Samples of the rays that meet the box.

    Attributes
    ----------
    mean, maximum : float
        Samples of a ray.
    hit_share : float
        Share of the image's rays that meet the box, 0..1.
    distance : float
        Between samples, in world units: along the ray, or between slices.
    """

    mean: float
    maximum: float
    hit_share: float
    distance: float


def ray_samples(spec: RenderSpec, view: View) -> RaySamples | None:
    """Samples per ray of a technique that goes along rays; None for the others.

    Parameters
    ----------
    spec : RenderSpec
        What is drawn, with a setting ``step`` in voxels of the smallest spacing, and perhaps a number of ``slices``.
    view : View
        With a camera.
    """
    shown, camera = resolve(spec), view.camera
    values = setting_values(shown.settings)
    if "step" not in values or camera is None:
        return None
    starts, directions = camera_rays(camera, view.size)
    lengths = _lengths(shown.volume, starts, directions, shown.clipping)
    met = lengths > 0
    distance = shown.common.step * min(shown.volume.spacing)
    if shown.info.view_slices is not None:
        forward = np.asarray(camera.direction)
        # slices reach a little beyond the box: where the step divides its depth, that is not a sample more
        distance *= 1.0 + 1e-6
        low, high, number = shown.info.view_slices(shown.settings, shown.box_corners, forward, distance)
        distance = (high - low) / number
        counts = lengths * np.abs(directions @ forward) / distance
    elif values.get("slices") is not None:
        # their direction depends on the light
        return None
    else:
        counts = np.ceil(lengths / distance - 1e-9)
    if not met.any():
        return RaySamples(0.0, 0.0, 0.0, distance)
    return RaySamples(float(counts[met].mean()), float(counts.max()), float(met.mean()), distance)


def camera_rays(camera: Camera, size: tuple[int, int]) -> tuple[Float64Array, Float64Array]:
    """Rays through pixel centres, evenly thinned out.

    Returns
    -------
    starts, directions : ndarray of shape (N, 3)
        World points at the eye (on the plane through it for parallel projection) and unit vectors.
    """
    width, height = size
    stride = max(1, math.ceil(math.sqrt(width * height / MOST_RAYS)))
    x = (2.0 * (np.arange(stride // 2, width, stride) + 0.5) / width - 1.0) * width / height
    y = 1.0 - 2.0 * (np.arange(stride // 2, height, stride) + 0.5) / height
    across, upward = (grid.ravel()[:, None] for grid in np.meshgrid(x, y))
    forward = np.asarray(camera.direction)
    right = np.cross(forward, camera.view_up)
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    eye = np.asarray(camera.position)
    if camera.parallel:
        starts = eye + camera.scale * (across * right + upward * up)
        return starts, np.broadcast_to(forward, starts.shape)
    slope = math.tan(math.radians(camera.view_angle) / 2)
    directions = forward + slope * (across * right + upward * up)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return np.broadcast_to(eye, directions.shape), directions


def _lengths(
    volume: Volume, starts: Float64Array, directions: Float64Array, clipping: Clipping
) -> Float64Array:
    """World length of each ray within what is shown of the volume, 0 for rays that miss it."""
    to_index = volume.world_to_index
    box_near, box_far = box_interval(
        starts @ to_index[:3, :3].T + to_index[:3, 3],
        directions @ to_index[:3, :3].T,
        index_limits(volume.array.shape, clipping.crop),
    )
    near, far = plane_interval(starts, directions, clipping.planes)
    # a camera inside the box: rays begin at the eye; parallel rays have no such place
    return np.asarray(np.maximum(np.minimum(box_far, far) - np.maximum(np.maximum(box_near, near), 0.0), 0.0))
