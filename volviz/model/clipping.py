"""Crop box and clip planes: the part of the volume that is shown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from volviz.errors import InputError

Vector = tuple[float, float, float]
Plane = tuple[Vector, Vector]
Crop = tuple[float, float, float, float, float, float]

MAX_PLANES = 6


@dataclass(frozen=True)
class Clipping:
    """What is cut away.

    Attributes
    ----------
    crop : tuple of 6 floats or None
        (i0, i1, j0, j1, k0, k1) in continuous voxel indices along the volume's own axes; None = all of it.
    planes : tuple of (origin, normal)
        Up to six planes in world space; the normal points to the side that is kept.
    """

    crop: Crop | None = None
    planes: tuple[Plane, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "crop", checked_crop(self.crop))
        object.__setattr__(self, "planes", checked_planes(self.planes))

    def crop_within(self, dimensions: tuple[int, int, int]) -> Crop:
        """The crop box limited to a volume of that many voxels (x, y, z).

        Raises
        ------
        InputError
            Nothing of the volume is left.
        """
        full = [(0.0, float(n - 1)) for n in dimensions]
        if self.crop is None:
            return full[0] + full[1] + full[2]
        limits: list[float] = []
        for axis, (low, high) in enumerate(full):
            a = max(low, self.crop[2 * axis])
            b = min(high, self.crop[2 * axis + 1])
            if b <= a:
                raise InputError(
                    f"crop leaves nothing along axis {'ijk'[axis]}: {self.crop[2 * axis]:g} to "
                    f"{self.crop[2 * axis + 1]:g} of 0 to {high:g}; choose a wider box."
                )
            limits += [a, b]
        return limits[0], limits[1], limits[2], limits[3], limits[4], limits[5]


def checked_crop(crop: Sequence[float] | None) -> Crop | None:
    """`crop` as six finite floats with i0 < i1, j0 < j1, k0 < k1, or None."""
    if crop is None:
        return None
    try:
        values = [float(v) for v in crop]
    except (TypeError, ValueError):
        values = []
    if len(values) != 6 or not np.all(np.isfinite(values)):
        raise InputError(f"crop must be six numbers (i0, i1, j0, j1, k0, k1) in voxels, got {crop!r}.")
    if values[0] >= values[1] or values[2] >= values[3] or values[4] >= values[5]:
        raise InputError(f"crop needs i0 < i1, j0 < j1 and k0 < k1, got {tuple(values)}.")
    return values[0], values[1], values[2], values[3], values[4], values[5]


def checked_planes(planes: Sequence[Sequence[Sequence[float]]]) -> tuple[Plane, ...]:
    """Clip planes as ((origin), (unit normal)) pairs."""
    result: list[Plane] = []
    try:
        for origin, normal in planes:
            ox, oy, oz = (float(v) for v in origin)
            nx, ny, nz = (float(v) for v in normal)
            length = (nx * nx + ny * ny + nz * nz) ** 0.5
            if not np.all(np.isfinite((ox, oy, oz, nx, ny, nz))) or length == 0:
                raise ValueError
            result.append(((ox, oy, oz), (nx / length, ny / length, nz / length)))
    except (TypeError, ValueError):
        raise InputError(
            f"clip_planes must be pairs ((x, y, z), (nx, ny, nz)), the normal not zero, got {planes!r}."
        ) from None
    if len(result) > MAX_PLANES:
        raise InputError(f"at most {MAX_PLANES} clip planes can be used at once, got {len(result)}.")
    return tuple(result)
