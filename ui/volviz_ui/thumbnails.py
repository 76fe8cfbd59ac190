"""Small pictures of presets on the user's own volume: made of a coarse copy, on a worker, in milliseconds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QObject
from PySide6.QtGui import QImage

from volviz.model.transfer_function import TransferFunction
from volviz.model.volume import Volume
from volviz_ui.workers import Task, Workers

SIDE = 72
"""Voxels of the coarse copy along its longest axis, and pixels of a picture."""

BACKGROUND = (0.11, 0.12, 0.14)
Deliver = Callable[[QImage], None]


class Thumbnails(QObject):
    """The `thumbnail_provider` of the transfer-function editor."""

    def __init__(self, workers: Workers, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._workers = workers
        self._volume: Volume | None = None
        self._coarse: npt.NDArray[np.float32] | None = None

    def set_volume(self, volume: Volume | None) -> None:
        """Show presets on another volume."""
        self._volume = volume
        self._coarse = None

    def request(self, function: TransferFunction, deliver: Deliver) -> None:
        """Draw a function on the volume and hand the picture to `deliver`, on the GUI thread."""
        volume, coarse = self._volume, self._coarse
        if volume is None:
            return

        def work(_task: Task) -> Any:
            copy = coarse if coarse is not None else coarse_copy(volume)
            return copy, drawn(copy, function, volume)

        def arrived(result: Any) -> None:
            if volume is self._volume:
                self._coarse = result[0]
                deliver(image_of(result[1]))

        self._workers.start(work).succeeded.connect(arrived)


def coarse_copy(volume: Volume) -> npt.NDArray[np.float32]:
    """Every n-th voxel so that the longest world axis has about `SIDE`; shape (z, y, x), cubic cells."""
    longest = max(volume.extent) / SIDE
    index = [
        np.minimum(np.arange(0, n, max(longest / spacing, 1e-9)), n - 1).astype(np.intp)
        for n, spacing in zip(volume.dimensions, volume.spacing, strict=True)
    ]
    coarse = volume.array[np.ix_(index[2], index[1], index[0])].astype(np.float32)
    coarse[~np.isfinite(coarse)] = volume.range[0]
    return coarse


def drawn(
    coarse: npt.NDArray[np.float32], function: TransferFunction, volume: Volume
) -> npt.NDArray[np.float64]:
    """The copy composited from front to back along y, shape (height, width, 3), 0..1; head up."""
    cell = max(volume.extent) / SIDE
    colors = function.evaluate(coarse, volume.range)
    # opacities refer to one voxel of the volume, a cell of the copy is longer
    alpha = 1 - (1 - np.clip(colors[..., 3], 0, 1 - 1e-6)) ** (cell / volume.mean_spacing)
    picture = np.zeros((coarse.shape[0], coarse.shape[2], 3))
    through = np.ones((coarse.shape[0], coarse.shape[2]))
    for y in range(coarse.shape[1]):
        picture += (through * alpha[:, y])[..., None] * colors[:, y, :, :3]
        through *= 1 - alpha[:, y]
    return np.asarray((picture + through[..., None] * np.asarray(BACKGROUND))[::-1])


def image_of(picture: npt.NDArray[np.float64]) -> QImage:
    """A picture as QImage."""
    pixels = np.ascontiguousarray(np.rint(np.clip(picture, 0, 1) * 255).astype(np.uint8))
    height, width = pixels.shape[:2]
    return QImage(pixels.data, width, height, 3 * width, QImage.Format.Format_RGB888).copy()
