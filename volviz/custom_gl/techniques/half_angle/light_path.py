"""Where the slices lie and how the light sees the box: arithmetic without OpenGL.

Light and eye are homogeneous world points (x, y, z, w): w = 1 is a place, w = 0 a direction to somewhere
infinitely far away. The ray from such a point to p has the direction ``w p - (x, y, z)``.

Slices are perpendicular to a vector half-way between the direction to the light and the view (Kniss et al.,
"A Model for Volume Lighting and Modeling", TVCG 2003), so that one sequence of slices serves eye and light
alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

#: A light nearer to the box than this share of the box's diagonal counts as inside.
NEAREST_LIGHT = 0.02
#: Pixels around the box's image that stay white in the light buffer.
MARGIN = 2.0


@dataclass(frozen=True)
class Slicing:
    """Order and direction of slices.

    Attributes
    ----------
    half_vector : ndarray of shape (3,)
        Unit world vector, normal of the slices, pointing to the light's side. Slices are drawn in the order
        of falling distance along it: away from the light.
    front_to_back : bool
        Whether that order leads away from the eye too; otherwise it comes nearer.
    exact : bool
        Every ray of eye and light meets the slices in that order. False for very wide views or lights very
        close to the box: some rays then mix their samples up.
    """

    half_vector: Array
    front_to_back: bool
    exact: bool


def unit(vector: npt.ArrayLike) -> Array:
    """The vector at length 1."""
    v = np.asarray(vector, np.float64)
    return np.asarray(v / np.linalg.norm(v))


def rays_from(viewpoint: Array, points: Array) -> Array:
    """Directions (not of unit length) of the rays from a homogeneous point to points of shape (N, 3)."""
    return np.asarray(viewpoint[3] * points - viewpoint[:3])


def choose_slicing(view: Array, light: Array, eye_rays: Array, corners: Array) -> Slicing:
    """Normal and order of the slices.

    Parameters
    ----------
    view : ndarray of shape (3,)
        Unit viewing direction.
    light : ndarray of shape (4,)
        Homogeneous world point, outside the box.
    eye_rays : ndarray of shape (N, 3)
        Extreme directions of the eye's rays.
    corners : ndarray of shape (8, 3)
        World corners of the box.
    """
    center = corners.mean(axis=0)
    to_light = -unit(rays_from(light, center[None])[0])
    front_to_back = bool(view @ to_light < 0)
    half = unit(to_light - view if front_to_back else to_light + view)
    light_rays = rays_from(light, corners)
    eye_sign = 1.0 if front_to_back else -1.0
    # A light close to the box sends rays along its face. Slices turned towards the light keep their order, as
    # long as the eye's rays keep theirs.
    for turn in np.linspace(0.0, 1.0, 11):
        normal = unit((1 - turn) * half + turn * to_light)
        if np.all(light_rays @ normal < 0) and np.all(eye_sign * (eye_rays @ normal) < 0):
            return Slicing(normal, front_to_back, True)
    return Slicing(half, front_to_back, False)


def smallest_cosine(normal: Array, rays: Array) -> float:
    """Smallest cosine between a normal and rays of shape (N, 3), at least 0.2."""
    cosines = np.abs(rays @ normal) / np.linalg.norm(rays, axis=1)
    return float(np.clip(cosines.min(), 0.2, 1.0))


def is_inside(light: Array, corners: Array, world_to_index: Array, low: Array, high: Array) -> bool:
    """Whether a light is in the box, or so near that it sees hardly more than one face.

    Parameters
    ----------
    light : ndarray of shape (4,)
        Homogeneous world point.
    corners : ndarray of shape (8, 3)
        World corners of the box.
    world_to_index : ndarray of shape (4, 4)
        Maps the world to continuous voxel indices.
    low, high : ndarray of shape (3,)
        The box in these.
    """
    if light[3] == 0:
        return False
    index = (world_to_index @ light)[:3]
    nearest = np.clip(index, low, high)
    index_to_world = np.linalg.inv(world_to_index)[:3, :3]
    gap = float(np.linalg.norm(index_to_world @ (index - nearest)))
    return gap < NEAREST_LIGHT * float(np.linalg.norm(corners[7] - corners[0]))


def light_matrix(light: Array, corners: Array, size: int) -> Array:
    """World to the light's clip space, fitted to a box; clip z is 0.

    The axes of the light's image follow the box, never a fixed up direction, so a light straight above is
    like any other.

    Parameters
    ----------
    light : ndarray of shape (4,)
        Homogeneous world point, outside the box.
    corners : ndarray of shape (8, 3)
        World corners; bit 0 of the row is x, bit 1 y, bit 2 z.
    size : int
        Edge of the light buffer in pixels, some of which stay free around the box.

    Returns
    -------
    ndarray of shape (4, 4)
        All corners have w > 0 and x/w, y/w within the margin.
    """
    edges = [unit(corners[1 << axis] - corners[0]) for axis in range(3)]
    forward = _forward(light, corners, edges)
    # the edge that is most perpendicular to the light's axis lies level in its image
    level = edges[int(np.argmin([abs(edge @ forward) for edge in edges]))]
    right = unit(level - (level @ forward) * forward)
    up = np.cross(right, forward)
    rays = rays_from(light, corners)
    depth = rays @ forward if light[3] else np.ones(8)
    center = corners.mean(axis=0)
    points = rays if light[3] else corners - center
    origin = light[:3] if light[3] else center
    matrix = np.zeros((4, 4))
    for row, axis in enumerate((right, up)):
        flat = points @ axis / depth
        low, high = float(flat.min()), float(flat.max())
        scale = 2.0 / (high - low) * (1.0 - 2.0 * MARGIN / size)
        middle = (low + high) / 2
        # x_clip = scale (axis . (p - origin) - middle w)
        matrix[row, :3] = scale * axis
        matrix[row, 3] = -scale * (axis @ origin)
        if light[3]:
            matrix[row, :3] -= scale * middle * forward
            matrix[row, 3] += scale * middle * (forward @ origin)
        else:
            matrix[row, 3] -= scale * middle
    if light[3]:
        matrix[3, :3], matrix[3, 3] = forward, -(forward @ origin)
    else:
        matrix[3, 3] = 1.0
    return matrix


def _forward(light: Array, corners: Array, edges: list[Array]) -> Array:
    """Axis of the light's view: to the centre, unless a corner would lie (almost) beside the light."""
    center = corners.mean(axis=0)
    to_center = unit(rays_from(light, center[None])[0])
    if light[3] == 0:
        return to_center
    rays = rays_from(light, corners)
    candidates = [to_center, *edges, *(-edge for edge in edges)]
    nearness = [float((rays @ axis).min() / np.abs(rays @ axis).max()) for axis in candidates]
    return candidates[0] if nearness[0] > 0.1 else candidates[int(np.argmax(nearness))]
