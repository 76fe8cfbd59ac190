"""The camera that shows what is visible of a volume as large as the viewport allows."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from volviz.model.camera import Camera
from volviz.model.transfer_function import TransferFunction
from volviz.model.volume import Volume
from volviz.offscreen import default_camera

SIDE = 40
"""Samples along each axis that are looked at: a hundredth of a second, and fine enough for a frame."""

VISIBLE = 0.005
"""Opacity from which a sample counts."""

FILL = 0.9


def visible_points(volume: Volume, function: TransferFunction) -> npt.NDArray[np.float64]:
    """World points around everything that a transfer function makes visible.

    Returns
    -------
    ndarray of shape (N, 3)
        Corners of the cells around visible samples; the corners of the whole box when nothing is visible.
    """
    steps = [max(1, n // SIDE) for n in volume.dimensions]
    x, y, z = (np.arange(0, n, step) for n, step in zip(volume.dimensions, steps, strict=True))
    values = volume.array[np.ix_(z, y, x)].astype(np.float64)
    values[~np.isfinite(values)] = volume.range[0]
    seen = np.argwhere(function.evaluate(values, volume.range)[..., 3] > VISIBLE)
    if len(seen) == 0:
        return np.asarray(volume.corners)
    index = seen[:, ::-1] * np.asarray(steps, float)
    last = np.asarray(volume.dimensions) - 1
    offsets = np.array([[c & 1, c >> 1 & 1, c >> 2 & 1] for c in range(8)]) * 2 - 1
    # a sample stands for its whole cell: what lies between two samples must not be cut off
    corners = np.clip(index[:, None, :] + 0.5 * offsets * np.asarray(steps), 0, last).reshape(-1, 3)
    corners = np.unique(corners, axis=0)
    matrix = volume.index_to_world
    return np.asarray(corners @ matrix[:3, :3].T + matrix[:3, 3])


def framing_camera(volume: Volume, function: TransferFunction, size: tuple[int, int]) -> Camera:
    """The usual first view, close to what is visible.

    Parameters
    ----------
    size : tuple of 2 ints
        Width and height of the viewport.
    """
    usual = default_camera(volume, size)
    return Camera.fit(
        visible_points(volume, function),
        direction=usual.direction,
        view_up=usual.view_up,
        aspect=size[0] / max(size[1], 1),
        fill=FILL,
    )
