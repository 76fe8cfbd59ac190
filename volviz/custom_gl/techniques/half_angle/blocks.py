"""The blocks of a volume that hold anything visible, and their slice polygons; of layers, on the first's lattice.

Software OpenGL pays for every fragment, so slices are drawn only where the transfer function shows something.
Neighbouring blocks share their corners exactly, and so their polygons share edges without gap or overlap.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise, product
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.technique import Frame
from volviz.custom_gl.techniques.half_angle.light_path import Array
from volviz.kernels.bricks import grow_occupancy, occupancy_elsewhere
from volviz.kernels.slices import crop_corners, slice_polygons
from volviz.volume_data.scalars import BRICK
from volviz.volume_data.volume import Volume

Crop = tuple[float, float, float, float, float, float]
Occupied = npt.NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Visible:
    """What transfer functions show of a volume, or of several on the lattice of the first.

    Attributes
    ----------
    box : tuple of 6 floats
        Part of the crop box outside which nothing is visible, in continuous voxel indices.
    occupied : ndarray of shape (b_z, b_y, b_x), bool
        Bricks in which something may be visible.
    first : tuple of 3 ints
        Place (x, y, z) of the first one, in bricks from the first voxel.
    """

    box: Crop
    occupied: Occupied
    first: tuple[int, int, int] = (0, 0, 0)


class VisiblePart:
    """The visible part of a frame's volume, kept as long as nothing it depends on changes."""

    def __init__(self) -> None:
        self._key: Any = None
        self._visible: Visible | None = None

    def of(self, frame: Frame) -> Visible | None:
        """What is visible within the crop box; None when there is nothing to see."""
        joint = frame.joint
        shown = frame.resources.occupancy_key(frame) if joint is None else joint.visible_key(frame)
        key = (frame.volume, frame.crop, *shown)
        if self._key != key:
            self._visible = _find(frame)
            self._key = key
        return self._visible


def _find(frame: Frame) -> Visible | None:
    occupied, first = _occupied(frame)
    if not occupied.any():
        return None
    limits: list[float] = []
    for axis in range(3):
        others = tuple(other for other in range(3) if other != 2 - axis)
        indices = np.flatnonzero(occupied.any(axis=others)) + first[axis]
        low, high = frame.crop[2 * axis], frame.crop[2 * axis + 1]
        # what a brick shows reaches one voxel beyond its own
        limits.append(min(max(float(indices[0] * BRICK - 1), low), high))
        limits.append(max(min(float((indices[-1] + 1) * BRICK), high), low))
        if limits[-1] <= limits[-2]:
            return None
    box = (limits[0], limits[1], limits[2], limits[3], limits[4], limits[5])
    return Visible(box, occupied, first)


def _occupied(frame: Frame) -> tuple[Occupied, tuple[int, int, int]]:
    """Bricks in which something may be visible, and the place of the first one."""
    if frame.joint is None:
        return frame.resources.occupied(frame), (0, 0, 0)
    by_lattice = frame.joint.visible_bricks(frame, whole=True)
    if len(by_lattice) == 1:
        return by_lattice[0], (0, 0, 0)
    limits = np.floor(np.array(frame.crop).reshape(3, 2) / BRICK).astype(int)
    i, j, k = (int(n) for n in limits[:, 0])
    shape = tuple(limits[::-1, 1] - limits[::-1, 0] + 1)
    occupied = np.zeros(shape, bool)
    for lead, bricks in by_lattice.items():
        matrix = frame.volume.world_to_index @ frame.layers[lead].volume.index_to_world
        occupied |= occupancy_elsewhere(bricks, matrix, shape, (i, j, k), BRICK)
    return occupied, (i, j, k)


def grown_box(visible: Visible, margin: Array) -> Crop:
    """The visible box with a margin, in voxels along each axis, on all sides."""
    grown = np.array(visible.box).reshape(3, 2) + np.outer(margin, (-1.0, 1.0))
    i0, i1, j0, j1, k0, k1 = (float(v) for v in grown.ravel())
    return i0, i1, j0, j1, k0, k1


def block_polygons(
    volume: Volume, visible: Visible, margin: Array, block: int, normal: Array, distances: Array
) -> tuple[Array, npt.NDArray[np.int32], npt.NDArray[np.int64]]:
    """Slice polygons of all blocks in which something is visible.

    Parameters
    ----------
    volume : Volume
        The data.
    visible : Visible
        What is visible of it.
    margin : ndarray of shape (3,)
        By which the outermost blocks are larger than the visible box, in voxels; also how far a sample may lie beside
        its fragment.
    block : int
        Edge of a block in voxels, a multiple of the brick.
    normal : ndarray of shape (3,)
        Unit world vector along which the slices follow one another.
    distances : ndarray of shape (S,)
        Of the slices along it, equally spaced and ascending.

    Returns
    -------
    vertices : ndarray of shape (P, 6, 3), float64
        World polygons, slice after slice, as `volviz.kernels.slices.slice_polygons` gives them.
    sides : ndarray of shape (P,), int32
        Number of their vertices.
    first : ndarray of shape (S + 1,), int64
        Slice s has the polygons ``first[s] .. first[s + 1] - 1``.
    """
    # trilinear support is in the bricks already
    reach = int(np.ceil(max(float(margin.max()) - 1.0, 0.0) / BRICK))
    occupied = grow_occupancy(visible.occupied, reach) if reach else visible.occupied
    grown = grown_box(visible, margin)
    edges = [_edges(visible.box, grown, axis, block) for axis in range(3)]
    low, step = distances[0], distances[1] - distances[0]
    vertices, sides, slices = [], [], []
    for x, y, z in product(*(list(pairwise(axis)) for axis in edges)):
        bricks = tuple(_bricks(along, axis, visible) for axis, along in ((2, z), (1, y), (0, x)))
        if not occupied[bricks].any():
            continue
        corners = crop_corners(volume.index_to_world, (*x, *y, *z), volume.dimensions)
        along = corners @ normal
        begin = max(int(np.ceil((along.min() - low) / step)), 0)
        end = min(int(np.floor((along.max() - low) / step)) + 1, len(distances))
        if end > begin:
            polygons, counts = slice_polygons(corners, normal, distances[begin:end])
            vertices.append(polygons)
            sides.append(counts)
            slices.append(np.arange(begin, end))
    if not vertices:
        return np.zeros((0, 6, 3)), np.zeros(0, np.int32), np.zeros(len(distances) + 1, np.int64)
    number = np.concatenate(slices)
    order = np.argsort(number, kind="stable")
    first = np.searchsorted(number[order], np.arange(len(distances) + 1))
    return np.concatenate(vertices)[order], np.concatenate(sides)[order], first


def _edges(box: Crop, grown: Crop, axis: int, block: int) -> list[float]:
    """Faces between blocks along an axis: multiples of the block, and the margin outside."""
    low, high = box[2 * axis], box[2 * axis + 1]
    inner = np.arange(np.floor(low / block) + 1, np.ceil(high / block)) * block
    return [grown[2 * axis], *(float(v) for v in inner), grown[2 * axis + 1]]


def _bricks(limits: tuple[float, float], axis: int, visible: Visible) -> slice:
    """Bricks that voxel indices between two faces across an axis (0 = x) belong to."""
    count = visible.occupied.shape[2 - axis]
    low, high = (limit / BRICK - visible.first[axis] for limit in limits)
    first = min(max(int(np.floor(low)), 0), count - 1)
    return slice(first, max(min(int(np.ceil(high)), count), first + 1))
