"""Coefficients of the cubic B-spline through the voxels, in a texture of their own."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np
import numpy.typing as npt

from volviz.tasks import LatestResult

if TYPE_CHECKING:
    from volviz.custom_gl.technique import Frame
    from volviz.volume_data.scalars import TextureData

#: Bytes uploaded in one chunk of a frame: some milliseconds.
CHUNK_BYTES = 4 * 2**20


class SplineTexture:
    """Computed on a worker, uploaded in chunks; kept while the texels stay the same."""

    def __init__(self) -> None:
        self._found: LatestResult[int, npt.NDArray[np.float32]] = LatestResult("spline")
        self._texels: TextureData | None = None
        self._texture: Any = None
        self._uploaded = 0

    def chunks(self, frame: Frame) -> int | None:
        """How many chunks the upload takes, 0 once it is done; None while the coefficients are being computed."""
        texels = frame.resources.texels
        if self._texels is not texels:
            self.release()
            self._texels = texels
        data = self._found.get(frame.tasks, id(texels), _work(texels.data))
        if data is None:
            return None
        return -(-(len(data) - self._uploaded) // _planes(data))

    def upload(self, frame: Frame) -> None:
        """Upload one chunk."""
        data = self._found.last
        assert data is not None
        z, y, x = data.shape
        if self._texture is None:
            self._texture = frame.gpu.gl.texture3d((x, y, z), 1, dtype="f4", alignment=1)
            self._texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        count = min(_planes(data), z - self._uploaded)
        part = data[self._uploaded : self._uploaded + count]
        self._texture.write(part, viewport=(0, 0, self._uploaded, x, y, count), alignment=1)
        self._uploaded += count
        frame.gpu.uploads += 1

    @property
    def texture(self) -> Any:
        """The coefficients, in the unit of the stored scalars."""
        return self._texture

    def release(self) -> None:
        """Release the texture."""
        if self._texture is not None:
            self._texture.release()
        self._texture, self._uploaded = None, 0


def _planes(data: npt.NDArray[np.float32]) -> int:
    return int(max(CHUNK_BYTES // data[0].nbytes, 1))


def _work(stored: npt.NDArray[Any]) -> Callable[[Any, Any], npt.NDArray[np.float32]]:
    def coefficients(_progress: Any, _cancel: Any) -> npt.NDArray[np.float32]:
        from scipy.ndimage import spline_filter

        # shaders read normalised integers as fractions of the largest one
        scale = 1.0 / np.iinfo(stored.dtype).max if stored.dtype.kind == "u" else 1.0
        found = spline_filter(stored, order=3, output=np.float32, mode="mirror")
        found *= np.float32(scale)
        return np.asarray(found, np.float32)

    return coefficients
