"""Images of colours and normals on a plane through a volume."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz.kernels.tangents import plane_basis
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.volume import Volume

Float64Array = npt.NDArray[np.float64]

#: Height of the whole range of the data at strength 1, in mean voxel spacings.
VOXELS_HIGH = 6.0
#: Opacity of the transfer function from which on a place is shown as opaque.
SHOWN = 0.005


class PlaneRequest(NamedTuple):
    """What the images depend on; equal requests have equal images.

    `normal` points to the side that is seen; `corners` is the (cropped) box as a tuple of 8 points; `settings` an
    instance of the technique's settings.
    """

    volume: Volume
    function: TransferFunction
    settings: Any
    origin: tuple[float, ...]
    normal: tuple[float, ...]
    crop: tuple[float, ...]
    planes: Any
    corners: tuple[tuple[float, ...], ...]
    texels: int


class PlaneMaps(NamedTuple):
    """Images of a rectangle in the world.

    Attributes
    ----------
    corners : ndarray of shape (4, 3)
        World corners: texture coordinates (0, 0), (1, 0), (1, 1), (0, 1).
    normal : ndarray of shape (3,)
        Unit vector to the side that is seen; tangent x binormal.
    colors : ndarray of shape (h, w, 4), uint8
        Straight RGBA, row 0 at texture coordinate v = 0; alpha 0 where nothing is shown.
    normals : ndarray of shape (h, w, 3), uint8
        0.5 + 0.5 n in the basis (tangent, binormal, normal).
    """

    corners: Float64Array
    normal: Float64Array
    colors: npt.NDArray[np.uint8]
    normals: npt.NDArray[np.uint8]


def plane_maps(request: PlaneRequest) -> PlaneMaps:
    """Sample a volume on a plane: colours by the transfer function, normals by the slope of the data.

    The normal at a point is norm(n - h (t (t . g) + b (b . g))) with g the gradient as a fraction of the data range
    (Blinn 1978, for a flat surface).
    """
    volume, settings = request.volume, request.settings
    axes = volume.direction
    tangent, binormal, normal = plane_basis(request.normal, [axes[:, 2], axes[:, 1], axes[:, 0]])
    origin = np.asarray(request.origin)
    local = np.asarray(request.corners) - origin
    u, v = local @ tangent, local @ binormal
    low, high = np.array([u.min(), v.min()]), np.array([u.max(), v.max()])
    size = np.maximum(high - low, 1e-12)
    width, height = (max(int(n), 2) for n in np.ceil(request.texels * size / size.max()))
    across = low[0] + size[0] * (np.arange(width) + 0.5) / width
    up = low[1] + size[1] * (np.arange(height) + 0.5) / height
    world = origin + across[None, :, None] * tangent + up[:, None, None] * binormal
    matrix = volume.world_to_index
    index = world @ matrix[:3, :3].T + matrix[:3, 3]
    limits = np.asarray(request.crop).reshape(3, 2)
    shown = np.all((index >= limits[:, 0]) & (index <= limits[:, 1]), axis=-1)
    for point, kept in request.planes:
        shown &= (world - np.asarray(point)) @ np.asarray(kept) >= 0
    values = sampled(volume, index)
    rgba = request.function.evaluate(values)
    alpha = np.clip(rgba[..., 3] / SHOWN, 0.0, 1.0) if settings.cut_out else np.ones_like(values)
    color = rgba[..., :3] if settings.color_source == "transfer_function" else np.asarray(settings.flat_color)
    colors = np.empty((height, width, 4))
    colors[..., :3] = color
    colors[..., 3] = np.where(shown, alpha, 0.0)
    slope = slopes(volume, index, settings.gradient_delta) @ matrix[:3, :3]
    span = volume.range[1] - volume.range[0]
    relief = settings.bump_strength * VOXELS_HIGH * volume.mean_spacing / (span if span > 0 else 1.0)
    normals = np.stack(
        [-relief * (slope @ tangent), -relief * (slope @ binormal), np.ones_like(values)], axis=-1
    )
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    ends = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
    corners = np.array([origin + a * tangent + b * binormal for a, b in ends])
    return PlaneMaps(corners, normal, _bytes(colors), _bytes(0.5 + 0.5 * normals))


def sampled(volume: Volume, index: Float64Array) -> Float64Array:
    """Trilinear values at continuous indices (..., 3) in the order i, j, k; clamped to the first and last voxel."""
    from scipy.ndimage import map_coordinates

    places = np.moveaxis(index[..., ::-1], -1, 0)
    return np.asarray(
        map_coordinates(
            volume.finite_array, places, output=np.float64, order=1, mode="nearest", prefilter=False
        )
    )


def slopes(volume: Volume, index: Float64Array, delta: float) -> Float64Array:
    """Central differences along i, j, k per voxel at continuous indices, shape (..., 3)."""
    result = np.empty(index.shape)
    for axis in range(3):
        step = np.zeros(3)
        step[axis] = delta
        result[..., axis] = (sampled(volume, index + step) - sampled(volume, index - step)) / (2.0 * delta)
    return result


def _bytes(values: Float64Array) -> npt.NDArray[np.uint8]:
    return np.rint(np.clip(values, 0.0, 1.0) * 255.0).astype(np.uint8)
