"""A plain float64 ray caster, independent of the program's own, that judges transfer functions."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import map_coordinates

from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.volume import Volume


def image(
    volume: Volume, function: TransferFunction, azimuth: float = 30.0, elevation: float = 20.0, size: int = 36
) -> tuple[np.ndarray, np.ndarray]:
    """Orthographic image (size, size, 4), premultiplied, and the mask of rays that meet the box."""
    low = volume.range[0]
    array = np.nan_to_num(volume.array.astype(np.float64), nan=low, posinf=low, neginf=low)
    extent = np.array(volume.extent)
    turn, rise = np.radians((azimuth, elevation))
    ahead = -np.array([np.cos(rise) * np.sin(turn), np.cos(rise) * np.cos(turn), np.sin(rise)])
    aside = np.cross(ahead, (0.0, 0.0, 1.0))
    aside /= np.linalg.norm(aside)
    upward = np.cross(aside, ahead)
    reach = np.linalg.norm(extent) / 2 * (np.arange(size) + 0.5 - size / 2) / (size / 2)
    start = extent / 2 + reach[None, :, None] * aside - reach[:, None, None] * upward
    with np.errstate(divide="ignore"):
        a, b = -start / ahead, (extent - start) / ahead
    near, far = np.minimum(a, b).max(-1), np.maximum(a, b).min(-1)
    hit = far > near
    depth = np.where(hit, far - near, 0.0)
    steps = min(int(np.ceil(depth.max() / volume.mean_spacing)), 160)
    out, through = np.zeros((size, size, 4)), np.ones((size, size))
    for i in range(steps):
        at = (start + (near + (i + 0.5) / steps * depth)[..., None] * ahead) / np.array(volume.spacing)
        rgba = function.evaluate(
            map_coordinates(array, [at[..., 2], at[..., 1], at[..., 0]], order=1, mode="nearest")
        )
        alpha = np.where(hit, 1 - (1 - rgba[..., 3]) ** (depth / steps / volume.mean_spacing), 0.0)
        out[..., :3] += (through * alpha)[..., None] * rgba[..., :3]
        through *= 1 - alpha
    out[..., 3] = 1 - through
    return out, hit
