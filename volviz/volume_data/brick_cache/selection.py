"""Which bricks a view needs: from coarse to fine wherever a voxel is larger than a pixel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from volviz.volume_data.brick_cache.layout import Brick

if TYPE_CHECKING:
    from volviz.volume_data.brick_cache.layout import BrickLayout

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BrickView:
    """From where bricks are seen, and what of them.

    Attributes
    ----------
    index_to_clip : ndarray of shape (4, 4)
        From continuous voxel indices of the finest level to clip space.
    eye, direction : ndarray of shape (3,)
        World position of the eye and unit vector along the view.
    index_to_world : ndarray of shape (4, 4)
        Of the finest level.
    pixel : float
        World size of a pixel, at unit distance along the view in perspective.
    parallel : bool
        Parallel projection: `pixel` is the same everywhere.
    crop : ndarray of shape (3, 2)
        What is shown, in continuous voxel indices of the finest level.
    planes : tuple of (origin, normal)
        Clip planes in the world; the normal points to the side that is kept.
    """

    index_to_clip: Floats
    eye: Floats
    direction: Floats
    index_to_world: Floats
    pixel: float
    parallel: bool
    crop: Floats
    planes: tuple[tuple[tuple[float, float, float], tuple[float, float, float]], ...] = ()

    def is_same(self, other: BrickView) -> bool:
        """Whether the same bricks are needed."""
        mine, others = vars(self), vars(other)
        return all(np.array_equal(mine[name], others[name]) for name in mine if name != "planes") and (
            self.planes == other.planes
        )


def needed_bricks(layout: BrickLayout, view: BrickView, base: int, at_most: int) -> list[Brick] | None:
    """The bricks that show a view, none finer than a level.

    A brick is divided where a voxel of it covers more than a pixel. What lies outside the crop box, behind a clip
    plane or out of sight is left out.

    Parameters
    ----------
    layout : BrickLayout
    view : BrickView
    base : int
        The finest level that may be used.
    at_most : int
        Where more are needed, the answer is None.

    Returns
    -------
    list of Brick or None
        Nearest to the eye first.
    """
    level = layout.coarsest
    z, y, x = np.indices(layout.counts[level][::-1]).reshape(3, -1)
    bricks = np.column_stack([x, y, z])
    found: list[tuple[int, npt.NDArray[np.int64], Floats]] = []
    taken = 0
    while len(bricks):
        bricks, depth = _seen(layout, view, level, bricks)
        pixels = view.pixel * (np.ones(len(bricks)) if view.parallel else depth)
        finer = (pixels < _voxel_size(layout, level)) & (level > base)
        found.append((level, bricks[~finer], depth[~finer]))
        taken += int((~finer).sum())
        if taken + int(finer.sum()) > at_most:
            return None
        if not finer.any():
            break
        bricks = _children(layout, level, bricks[finer])
        level -= 1
    ordered = [
        (float(d), Brick(number, *map(int, each)))
        for number, those, depths in found
        for each, d in zip(those, depths, strict=True)
    ]
    return [brick for _, brick in sorted(ordered, key=lambda pair: pair[0])]


def _children(layout: BrickLayout, level: int, bricks: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """The bricks of the next finer level inside these."""
    factor = layout.cells[level] // layout.cells[level - 1]
    z, y, x = np.indices(factor[::-1]).reshape(3, -1)
    children = (bricks[:, None, :] * factor + np.column_stack([x, y, z])).reshape(-1, 3)
    return np.asarray(children[(children < layout.counts[level - 1]).all(axis=1)], np.int64)


def _voxel_size(layout: BrickLayout, level: int) -> float:
    """World size of a voxel along the axes that the next finer level divides."""
    coarse, fine = np.array(layout.levels[level].spacing), np.array(layout.levels[level - 1].spacing)
    divided = coarse > 1.01 * fine
    return float(coarse[divided].max()) if divided.any() else 0.0


def _seen(
    layout: BrickLayout, view: BrickView, level: int, bricks: npt.NDArray[np.int64]
) -> tuple[npt.NDArray[np.int64], Floats]:
    """Those of the bricks that may be seen, and how near to the eye the nearest part of each is, along the view."""
    size = layout.cells[level] * layout.edge
    last = np.array(layout.levels[0].dimensions) - 1.0
    low, high = bricks * size, np.minimum((bricks + 1) * size, last)
    # flat crop boxes and those on a border show something, too
    shown = (low <= view.crop[:, 1]).all(axis=1) & (high >= view.crop[:, 0]).all(axis=1)
    bricks, low, high = bricks[shown], low[shown], high[shown]
    low, high = np.maximum(low, view.crop[:, 0]), np.minimum(high, view.crop[:, 1])
    bits = np.array([[c & 1, c >> 1 & 1, c >> 2] for c in range(8)])
    corners = np.where(bits[None], high[:, None], low[:, None])
    homogeneous = np.concatenate([corners, np.ones((*corners.shape[:2], 1))], axis=2)
    clip = homogeneous @ view.index_to_clip.T
    world = (homogeneous @ view.index_to_world.T)[..., :3]
    seen = np.ones(len(bricks), bool)
    for axis in range(3):
        # gradients look a little beyond what is seen
        seen &= ~(clip[..., axis] > 1.02 * clip[..., 3]).all(axis=1) | (axis == 2)
        seen &= ~(clip[..., axis] < -1.02 * clip[..., 3]).all(axis=1)
    for origin, normal in view.planes:
        seen &= ((world - np.asarray(origin)) @ np.asarray(normal)).max(axis=1) >= 0.0
    depth = ((world - view.eye) @ view.direction).min(axis=1)
    return bricks[seen], np.maximum(depth[seen], 1e-9)
