"""Textures of a layer of labels: dense indices, and a palette that alone changes with colours and what is hidden."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np
import numpy.typing as npt

from volviz.custom_gl.gpu.context import Gpu
from volviz.custom_gl.gpu.resources import SLAB_BYTES, brick_uniforms
from volviz.errors import RenderError
from volviz.kernels.bricks import brick_min_max, occupancy, visible_prefix
from volviz.model.label_palette import LabelLook
from volviz.volume_data.label_indices import label_indices_of
from volviz.volume_data.scalars import BRICK, TextureData, reduction
from volviz.volume_data.volume import Volume

if TYPE_CHECKING:
    from volviz.custom_gl.gpu.programs import Program

#: Entries in a row of the texture of a palette; ``glsl/label.glsl`` counts on it.
PALETTE_ROW = 1024


class LabelResources:
    """Textures of the labels of a volume.

    Attributes
    ----------
    texels : TextureData
        The indices as they are uploaded; of a volume beyond the limits of the driver, voxels are left out.
    """

    voxel_scale = 1.0

    def __init__(self, gpu: Gpu, volume: Volume) -> None:
        self.gpu = gpu
        self.volume = volume
        self._labels = label_indices_of(volume)
        indices = self._labels.indices
        kind: Any = {1: "u1", 2: "u2", 4: "f4"}[indices.dtype.itemsize]
        factor = reduction(indices.shape, kind, gpu.limits.max_3d_texture, gpu.max_texture_bytes)
        if factor != (1, 1, 1):
            # labels have no mean: the middle voxel of each block stands for it
            x, y, z = factor
            indices = np.ascontiguousarray(indices[z // 2 :: z, y // 2 :: y, x // 2 :: x])
        self.texels = TextureData(indices, 1.0, 0.0, factor)
        depth, height, width = indices.shape
        dtype = {1: "u1", 2: "u2", 4: "u4"}[indices.dtype.itemsize]
        self._texture = gpu.gl.texture3d((width, height, depth), 1, dtype=dtype, alignment=1)
        if gpu.gl.error == "GL_OUT_OF_MEMORY":
            self._texture.release()
            raise RenderError(
                f"{volume.name}: the graphics memory has no room for {indices.nbytes / 2**20:.0f} MB of labels; set "
                "VOLVIZ_TEXTURE_MB to less."
            )
        self._texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._texture.repeat_x = self._texture.repeat_y = self._texture.repeat_z = False
        self._uploaded = 0
        self._bounds: tuple[Any, Any] | None = None
        self._palette: tuple[LabelLook, npt.NDArray[np.float32], Any] | None = None

    @property
    def full_factor(self) -> tuple[int, int, int]:
        """Voxels per texel along (x, y, z)."""
        return self.texels.factor

    @property
    def complete(self) -> bool:
        """Whether all labels are on the GPU."""
        return self._uploaded >= len(self.texels.data)

    def upload_slab(self) -> None:
        """Upload some further planes."""
        data = self.texels.data
        count = min(max(SLAB_BYTES // data[0].nbytes, 1), len(data) - self._uploaded)
        slab = data[self._uploaded : self._uploaded + count]
        viewport = (0, 0, self._uploaded, data.shape[2], data.shape[1], count)
        self._texture.write(np.ascontiguousarray(slab), viewport=viewport, alignment=1)
        self._uploaded += count
        self.gpu.uploads += 1

    def select(self, level: int) -> None:
        """There is one level only."""

    def palette(self, look: LabelLook) -> npt.NDArray[np.float32]:
        """Colour and opacity of each label, shape (n, 4); made once for a look."""
        if self._palette is None or self._palette[0] != look:
            colors = look.palette(self._labels.labels)
            if self._palette is not None:
                self._palette[2].release()
            rows = -(-len(colors) // PALETTE_ROW)
            table = np.zeros((rows * PALETTE_ROW, 4), np.float32)
            table[: len(colors)] = colors
            texture = self.gpu.table_texture(table.reshape(rows, PALETTE_ROW, 4))
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
            self._palette = (look, colors, texture)
        return self._palette[1]

    def visible_bricks(self, look: LabelLook, *, whole: bool = False) -> npt.NDArray[np.bool_]:
        """Which bricks may hold a surface: those with more than one label, one of which may be shown.

        With `whole` those within a label count as well, whose inside is seen where it is cut.
        """
        if self._bounds is None:
            self._bounds = brick_min_max(self._labels.indices, BRICK)
        low, high = self._bounds
        last = len(self._labels.labels) - 1
        shown = occupancy(low, high, visible_prefix(self.palette(look)[:, 3]), (0.0, float(max(last, 1))))
        return np.asarray(shown if whole else shown & (low != high))

    def brick_uniforms(self) -> dict[str, Any]:
        """Uniforms of ``glsl/empty_space.glsl``."""
        return brick_uniforms(self.texels, self.volume)

    def table_uniforms(self, *_: Any, **__: Any) -> dict[str, Any]:
        """Labels have no table."""
        return {}

    @property
    def gradient_scale(self) -> float:
        """Not read: labels have no opacity by their gradient."""
        return 1.0

    def bind(self, program: Program, look: LabelLook, layer: int) -> None:
        """Bind what a program asks for in a layer."""
        self.palette(look)
        assert self._palette is not None
        program.use_texture("t_labels", self._texture, layer)
        program.use_texture("t_palette", self._palette[2], layer)

    def release(self) -> None:
        """Release all textures; the context must be current."""
        self._texture.release()
        if self._palette is not None:
            self._palette[2].release()
            self._palette = None
