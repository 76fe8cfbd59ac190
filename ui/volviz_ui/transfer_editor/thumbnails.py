"""Small images of presets on the user's own volume: made of a coarse copy, on a worker, in milliseconds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QObject
from PySide6.QtGui import QImage

from volviz.custom_gl.oracles import OracleScene
from volviz.custom_gl.registry import technique
from volviz.custom_gl.settings import common_settings
from volviz.errors import VolvizError
from volviz.model.light import Light
from volviz.model.parameters import make_settings
from volviz.model.render_spec import DEFAULT_TECHNIQUE
from volviz.model.transfer.function import TransferFunction
from volviz.model.transfer.presets import Preset
from volviz.volume_data.orientation import direction_of, orientation_of
from volviz.volume_data.volume import Volume
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import volume_of
from volviz_ui.session.workers import Task, Workers
from volviz_ui.widgets.binding import show_value

SIDE = 72
"""Voxels of the coarse copy along its longest axis, and pixels of an image."""

BACKGROUND = (0.11, 0.12, 0.14)
FLAT = 0.5
"""A volume is a stack of slices when its depth is less than this share of its width and height."""
ASPECT = 104 / 72
"""Width divided by height of an image of a preset."""

Deliver = Callable[[QImage], None]


class Thumbnails(QObject):
    """The `thumbnail_provider` of the transfer-function editor."""

    def __init__(self, documents: Documents, workers: Workers, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._documents = documents
        self._workers = workers
        self._coarse: npt.NDArray[np.float32] | None = None
        show_value(documents, volume_of, self._forget)

    def _forget(self, _volume: Volume | None) -> None:
        self._coarse = None

    def request(self, preset: Preset, function: TransferFunction, deliver: Deliver) -> None:
        """Draw a preset on the volume, with its technique, and hand the image to `deliver`, on the GUI thread.

        `function` is the preset's in the units of the volume.
        """
        volume, coarse = self._documents.volume, self._coarse
        if volume is None:
            return

        def work(_task: Task) -> Any:
            copy = coarse if coarse is not None else coarse_copy(volume)
            plain = preset.technique is None and preset.settings is None
            image = None if plain else drawn_with(preset, copy, function, volume)
            return copy, drawn(copy, function, volume) if image is None else image

        def arrived(result: Any) -> None:
            if volume is self._documents.volume:
                self._coarse = result[0]
                deliver(image_of(framed(result[1])))

        self._workers.start(work).succeeded.connect(arrived)


def coarse_copy(volume: Volume) -> npt.NDArray[np.float32]:
    """Every n-th voxel, in cubic cells of which the longest axis has about `SIDE`; to be seen along the middle axis.

    That is y of the world, as in the first view: shape (z, y, x). A stack of few slices is turned so that one looks at
    its slices and not at their edges: (y, z, x) with the first row at the top, or (z, x, y).
    """
    longest = max(volume.extent) / SIDE
    index = [
        np.minimum(np.arange(0, n, max(longest / spacing, 1e-9)), n - 1).astype(np.intp)
        for n, spacing in zip(volume.dimensions, volume.spacing, strict=True)
    ]
    coarse = volume.array[np.ix_(index[2], index[1], index[0])].astype(np.float32)
    coarse[~np.isfinite(coarse)] = volume.range[0]
    x, y, z = volume.extent
    if z < FLAT * min(x, y):
        return np.ascontiguousarray(coarse[:, ::-1].transpose(1, 0, 2))
    if x < FLAT * min(y, z):
        return np.ascontiguousarray(coarse.transpose(0, 2, 1))
    # columns of the matrix are index axes i, j, k, axes of the array are k, j, i
    matrix = direction_of(orientation_of(volume.direction))
    order = [2 - int(np.flatnonzero(matrix[axis])[0]) for axis in (2, 1, 0)]
    turned = [axis for axis in range(3) if matrix[2 - axis].sum() < 0]
    return np.ascontiguousarray(np.flip(coarse.transpose(order), turned))


def framed(image: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """The image in the middle of one of the proportions that presets are shown in, on the background."""
    height, width = image.shape[:2]
    rows, columns = max(height, round(width / ASPECT)), max(width, round(height * ASPECT))
    frame = np.empty((rows, columns, 3))
    frame[:] = BACKGROUND
    top, left = (rows - height) // 2, (columns - width) // 2
    frame[top : top + height, left : left + width] = image
    return frame


def drawn(
    coarse: npt.NDArray[np.float32], function: TransferFunction, volume: Volume
) -> npt.NDArray[np.float64]:
    """The copy composited from front to back along y, shape (height, width, 3), 0..1; head up."""
    cell = max(volume.extent) / SIDE
    colors = function.evaluate(coarse, volume.range)
    # opacities refer to one voxel of the volume, a cell of the copy is longer
    alpha = 1 - (1 - np.clip(colors[..., 3], 0, 1 - 1e-6)) ** (cell / volume.mean_spacing)
    image = np.zeros((coarse.shape[0], coarse.shape[2], 3))
    through = np.ones((coarse.shape[0], coarse.shape[2]))
    for y in range(coarse.shape[1]):
        image += (through * alpha[:, y])[..., None] * colors[:, y, :, :3]
        through *= 1 - alpha[:, y]
    return np.asarray((image + through[..., None] * np.asarray(BACKGROUND))[::-1])


def drawn_with(
    preset: Preset, coarse: npt.NDArray[np.float32], function: TransferFunction, volume: Volume
) -> npt.NDArray[np.float64] | None:
    """The copy as the preset's technique draws it, by the oracle of that technique: same view and shape as `drawn`.

    None where there is no such technique here, or no oracle for it.
    """
    try:
        info = technique(preset.technique or DEFAULT_TECHNIQUE)
        settings = make_settings(info.settings, preset.settings or {}, owner=info.id)
    except VolvizError:
        return None
    if info.oracle is None:
        return None
    cell = max(volume.extent) / SIDE
    depth, height, width = cell * (np.array(coarse.shape)[[1, 0, 2]] - 1)
    view = np.array([[1, 0, 0, -width / 2], [0, 0, 1, -height / 2], [0, -1, 0, -cell], [0, 0, 0, 1]], float)
    size = (coarse.shape[2], coarse.shape[0])
    projection = np.diag([2 / (width + cell), 2 / (height + cell), -2 / (depth + 2 * cell), 1.0])
    projection[2, 3] = -1.0
    scene = OracleScene(
        coarse, (cell,) * 3, function, volume.range, volume.mean_spacing,
        max(common_settings(settings).step * min(volume.spacing), 0.5 * cell), view, projection, size,
        isovalues=info.isovalues(settings, volume),
        light=Light(headlight=False, position=(-0.3 * width, -1.5 * depth, height + 0.5 * depth)),
    )  # fmt: skip
    rgba = info.oracle(scene, settings)
    return np.clip(rgba[..., :3] + (1 - rgba[..., 3:]) * np.asarray(BACKGROUND), 0, 1)


def image_of(image: npt.NDArray[np.float64]) -> QImage:
    """An image as QImage."""
    pixels = np.ascontiguousarray(np.rint(np.clip(image, 0, 1) * 255).astype(np.uint8))
    height, width = pixels.shape[:2]
    return QImage(pixels.data, width, height, 3 * width, QImage.Format.Format_RGB888).copy()
