"""What the values of a volume say about what it shows."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from volviz.kernels.histogram import even_histogram
from volviz.model.transfer.first_look import FirstLook, Floats
from volviz.model.transfer.label_values import label_values
from volviz.model.transfer.levels import Levels, is_dark_on_bright, levels_of
from volviz.model.transfer.presets import offset_of_hu

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

#: The gradient of a distance field has the same length nearly everywhere: its 10 % and 90 % quantiles differ by at
#: most so much of its median.
EVEN_GRADIENT = 0.25
#: Largest step from voxel to voxel, in ranges of the data, at the steepest places of a field without borders.
SMOOTH_STEP = 0.12
#: A field has no background, whose values would fill one of 64 bins: at most so much of it lies in one. And along one
#: axis at least it is free of grain: second differences are smaller than first ones.
BINS, COMMONEST, GRAIN = 64, 0.15, 0.9
#: Litres of tissue in a brain without its skull, and in a head.
BRAIN_LITRES, HEAD_LITRES = (0.7, 2.2), (2.2, 7.0)
#: Share of both halves of a head that agree when one is laid over the other.
SYMMETRIC = 0.75
#: Where the outer surface lies, from where matter begins to where its first class ends.
BORDER = 0.45
#: Share of the faces of the box that is covered with matter where that fills the box.
FULL = 0.6
#: Slices up to which a stack is seen best as a picture.
FEW_SLICES = 12
#: Edge of the block in the middle of the volume that is looked at voxel by voxel.
BLOCK = 64


@dataclass(frozen=True)
class Evidence:
    """A coarse look at a volume, and what follows from it.

    Attributes
    ----------
    volume : Volume
    look : FirstLook
        Of its values, or of their negatives where `is_mirrored`.
    is_mirrored : bool
        What is to be seen is darker than what surrounds it.
    """

    volume: Volume
    look: FirstLook
    is_mirrored: bool = False

    @classmethod
    def of(cls, volume: Volume) -> Evidence | None:
        """None for a volume that is the same everywhere."""
        look = FirstLook.at(volume)
        if look is None:
            return None
        if label_values(look) is None and is_dark_on_bright(look):
            return cls(volume, look.mirrored(), is_mirrored=True)
        return cls(volume, look)

    @cached_property
    def labels(self) -> Floats | None:
        """The numbers of the labels, ascending; None where the values are no labels."""
        return label_values(self.look)

    @cached_property
    def hu_offset(self) -> float | None:
        """What is added to Hounsfield units in the values; None where they are no CT."""
        return offset_of_hu(self.volume)

    @cached_property
    def levels(self) -> Levels:
        """Where matter begins, and where its classes part."""
        return levels_of(self.look)

    @cached_property
    def border(self) -> float:
        """The value at which the outer surface lies: above the background, below what is inside."""
        levels = self.levels
        return levels.start + BORDER * (levels.steps[0] - levels.start)

    @cached_property
    def is_distance(self) -> bool:
        """Whether the values are signed distances: both signs, and a gradient of the same length everywhere."""
        look = self.look
        if not look.low < 0.0 < look.high:
            return False
        total = np.zeros_like(look.values)
        for axis, size in enumerate(look.cell_size):
            total += (np.gradient(look.values / look.scale, axis=axis) / size) ** 2
        low, median, high = np.quantile(np.sqrt(total), (0.1, 0.5, 0.9))
        return bool(median > 0 and high - low <= EVEN_GRADIENT * median)

    @cached_property
    def is_smooth(self) -> bool:
        """Whether nothing in the middle of the volume has a border."""
        span = self.look.high - self.look.low
        steps = [np.abs(np.diff(self._block, axis=axis)).ravel() / span for axis in range(3)]
        return bool(np.quantile(np.concatenate(steps), 0.99) < SMOOTH_STEP)

    @cached_property
    def is_field(self) -> bool:
        """Whether the values are those of a field, from simulation or mathematics, and not a scan of things."""
        if self.is_smooth:
            return True
        look, block = self.look, self._block
        counts, _ = even_histogram(look.values.ravel(), BINS, look.low, look.high)
        if counts.max() > COMMONEST * counts.sum():
            return False
        axes = [axis for axis in range(3) if block.shape[axis] > 3]
        first, second = (
            np.array([np.abs(np.diff(block, n, axis=axis)).mean() for axis in axes]) for n in (1, 2)
        )
        return bool((second < GRAIN * first).any())

    @cached_property
    def _block(self) -> Floats:
        """Voxels in the middle of the volume, float64."""
        middle = tuple(
            slice(max(n - BLOCK, 0) // 2, max(n - BLOCK, 0) // 2 + BLOCK) for n in self.volume.array.shape
        )
        return np.asarray(self.volume.finite_array[middle], np.float64)

    @cached_property
    def anatomy(self) -> str:
        """What size and symmetry in the frame of a patient speak for: "head", "brain", or nothing."""
        volume = self.volume
        if volume.metadata.get("length_unit") != "mm" or self.hu_offset is not None or self.is_field:
            return ""
        levels = self.levels
        # lower than the surface: thin skin counts as well
        matter = self.look.values > levels.start + 0.3 * (levels.steps[0] - levels.start)
        # the index axis along which left and right lie, as an axis of the array
        across = 2 - int(np.argmax(np.abs(volume.direction[0])))
        both = matter & np.flip(matter, across)
        if both.sum() < SYMMETRIC * (matter | np.flip(matter, across)).sum():
            return ""
        litres = float(matter.sum() * np.prod(self.look.cell_size)) * 1e-6
        if BRAIN_LITRES[0] < litres <= BRAIN_LITRES[1]:
            return "brain"
        return "head" if HEAD_LITRES[0] < litres < HEAD_LITRES[1] else ""

    @property
    def fills_box(self) -> bool:
        """Whether matter reaches the faces of the box nearly everywhere, so that its surface is the box."""
        return float((self.look.shell > self.border).mean()) >= FULL

    @property
    def is_flat(self) -> bool:
        """Whether there are so few slices that shapes can hardly be seen."""
        return min(self.volume.dimensions) <= FEW_SLICES < max(self.volume.dimensions) / 4

    def along_rays(self) -> tuple[Floats, Floats]:
        """Mean and largest value along each foreseen ray that meets the box, shape (n,)."""
        seen = self.look.lengths > 0
        rays = self.look.rays[seen]
        return rays.mean(axis=1), rays.max(axis=1)
