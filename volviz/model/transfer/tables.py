"""Transfer functions as tables of texels: of the value alone, or of value and gradient magnitude; NumPy only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeVar, cast

import numpy as np
import numpy.typing as npt

from volviz.model.transfer.function import MAX_TABLE, TransferFunction
from volviz.model.transfer.function_2d import TransferFunction2D
from volviz.volume_data.volume import Volume

#: Entries over (value, gradient magnitude) at rest, and while something moves.
PLANE_SIZE = (512, 256)
PLANE_SIZE_INTERACTIVE = (256, 128)

Floats = npt.NDArray[np.float32]
Texels = TypeVar("Texels", bound=npt.NDArray[Any])


@dataclass(frozen=True, eq=False)
class Table:
    """A transfer function as shaders read it.

    Attributes
    ----------
    texels : ndarray of shape (rows, columns, 4), float32
        Straight RGBA in one row over the value; or, over the plane of value (columns) and gradient magnitude
        (rows), colours multiplied by opacity: between a region and nothing the colour must not fade to black.
    values : tuple of 2 floats
        Data values of the first and last column; beyond them the end entries count.
    gradients : tuple of 2 floats or None
        Gradient magnitudes of the first and last row, data units per world unit; None: they do not count.
    """

    texels: Floats
    values: tuple[float, float]
    gradients: tuple[float, float] | None = None

    @property
    def opacity(self) -> Floats:
        """Opacities, shape (rows, columns)."""
        return self.texels[..., 3]

    @staticmethod
    def folded(texels: Texels) -> Texels:
        """Texels as a texture takes them: what is too long for one row goes on in the next ones."""
        if len(texels) > 1 or rows_of(texels.shape[1]) == 1:
            return texels
        entries = texels[0]
        missing = -len(entries) % MAX_TABLE
        return cast(Texels, np.pad(entries, ((0, missing), (0, 0)), mode="edge").reshape(-1, MAX_TABLE, 4))

    def per_length(self, length: float) -> Floats:
        """Texels with opacities for pieces of ray of that length, in unit distances."""
        before = self.texels[..., 3].astype(np.float64)
        after = -np.expm1(length * np.log1p(-np.minimum(before, 1 - 1e-12)))
        texels = self.texels.copy()
        texels[..., 3] = after
        if self.gradients is not None:
            texels[..., :3] *= np.divide(after, before, out=np.zeros_like(after), where=before > 0)[..., None]
        return texels


def rows_of(entries: int) -> int:
    """Rows of a texture that a table of so many entries over the value takes."""
    return -(-entries // MAX_TABLE)


def baked(function: TransferFunction, volume: Volume, *, interactive: bool = False) -> Table:
    """The table of a function for a volume; of its regions when it has any (`TransferFunction.by_gradient`).

    Parameters
    ----------
    function : TransferFunction
        In data units.
    volume : Volume
        The data.
    interactive : bool
        A smaller plane, for images while something moves; tables of the value alone stay as they are.
    """
    if function.by_gradient is None:
        values = function.table_range(volume.range)
        texels = function.bake(values, table_entries(function, volume)[0])
        return Table(texels[np.newaxis], values)
    values, gradients = plane_ranges(function.by_gradient, volume)
    texels = function.by_gradient.bake(
        values, gradients, table_entries(function, volume, interactive=interactive)
    )
    texels[..., 3] *= function.opacity
    texels[..., :3] *= texels[..., 3:]
    return Table(texels, values, gradients)


def table_entries(
    function: TransferFunction, volume: Volume, *, interactive: bool = False
) -> tuple[int, int]:
    """Columns and rows of the table of a function."""
    if function.by_gradient is not None:
        return PLANE_SIZE_INTERACTIVE if interactive else PLANE_SIZE
    return function.table_size(function.table_range(volume.range), integer=volume.array.dtype.kind in "iu"), 1


def plane_ranges(
    regions: TransferFunction2D, volume: Volume
) -> tuple[tuple[float, float], tuple[float, float]]:
    """The part of the plane of value and gradient magnitude that regions cover and a volume can reach.

    A table over it and looked up with clamped coordinates is right everywhere: where it ends, the regions
    or the data do.
    """
    low, high = volume.range
    span = high - low if high > low else 1.0
    # no difference of neighbouring voxels is larger than the range
    steepest = span * float(np.linalg.norm(np.linalg.inv(volume.index_to_world[:3, :3]), 2)) * 3.0**0.5
    if not regions.regions:
        return (low, low + span), (0.0, steepest)
    left = min(r.value - 0.5 * r.width for r in regions.regions)
    right = max(r.value + 0.5 * r.width for r in regions.regions)
    bottom = min(r.gradient_low for r in regions.regions)
    top = max(r.gradient_high for r in regions.regions)
    # a little more, so that the outermost entries lie outside
    across, up = 1e-3 * (right - left), 1e-3 * (top - bottom)
    values = max(left - across, low), min(right + across, high)
    gradients = max(bottom - up, 0.0), min(top + up, steepest)
    return (
        values if values[0] < values[1] else (low, low + span),
        gradients if gradients[0] < gradients[1] else (0.0, steepest),
    )
