"""A volume on a lattice with other distances along its own axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import InputError
from volviz.volume_data.volume import checked_spacing

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.writers.request import SaveRequest
    from volviz.volume_data.description import Level

#: Voxels along an axis beyond which a spacing was mistyped.
LARGEST = 1 << 16


@dataclass(frozen=True)
class Resampling:
    """From one lattice to another that has the same axes and the same middle.

    Attributes
    ----------
    lattice : Level
        The new one: its samples lie between the first and the last of the old one, so nothing is made up outside.
    steps : tuple of 3 floats
        Distance of its samples along (x, y, z), in voxels of the old one.
    starts : tuple of 3 floats
        Index (x, y, z) of its first sample in the old one.
    is_labels : bool
        Nothing lies between the values: the nearest one is taken.
    """

    lattice: Level
    steps: tuple[float, ...]
    starts: tuple[float, ...]
    is_labels: bool = False

    @classmethod
    def onto(cls, lattice: Level, spacing: Sequence[float], *, is_labels: bool = False) -> Resampling:
        """With these distances along (x, y, z).

        Raises
        ------
        InputError
            Not three numbers greater than 0, or so large that fewer than two voxels are left along an axis.
        """
        wanted = checked_spacing(spacing, "resampling")
        steps = tuple(new / old for new, old in zip(wanted, lattice.spacing, strict=True))
        lasts = [count - 1 for count in lattice.dimensions]
        counts = [
            int(np.floor(min(last / step, LARGEST) + 1e-6)) + 1
            for last, step in zip(lasts, steps, strict=True)
        ]
        if min(counts) < 2 or max(counts) > LARGEST:
            sizes = " x ".join(str(n) for n in counts)
            raise InputError(
                f"resampling to {' x '.join(f'{s:g}' for s in wanted)} would leave {sizes} voxels; choose distances "
                f"nearer to those that there are, {' x '.join(f'{s:g}' for s in lattice.spacing)}."
            )
        starts = tuple(
            (last - (count - 1) * step) / 2 for last, count, step in zip(lasts, counts, steps, strict=True)
        )
        matrix = np.asarray(lattice.direction) * lattice.spacing
        x, y, z = (float(v) for v in np.asarray(lattice.origin) + matrix @ np.asarray(starts))
        dimensions = counts[0], counts[1], counts[2]
        return cls(
            replace(lattice, dimensions=dimensions, spacing=wanted, origin=(x, y, z)),
            steps,
            starts,
            is_labels,
        )

    def of(self, array: npt.NDArray[Any], request: SaveRequest) -> npt.NDArray[Any]:
        """The values, shape (z, y, x), on the new lattice; the type stays, whole numbers are rounded.

        Trilinear. Where the new lattice is coarser, values are smoothed before by a Gaussian whose standard
        deviation is half of what a new voxel is larger than an old one, so that no fine structure turns into a
        coarse one.
        """
        from scipy.ndimage import affine_transform, gaussian_filter

        steps, starts = self.steps[::-1], self.starts[::-1]
        x, y, z = self.lattice.dimensions
        if self.is_labels:
            request.note("The labels are resampled: each voxel gets the nearest one.")
            nearest: npt.NDArray[Any] = affine_transform(
                array, steps, starts, (z, y, x), order=0, mode="nearest"
            )
            return nearest
        smoothed = ", coarser axes smoothed before" if max(steps) > 1.0001 else ""
        request.note(f"The values are resampled linearly{smoothed}.")
        real = np.float32 if array.dtype.itemsize <= 2 or array.dtype == np.float32 else np.float64
        sigma = [max(step - 1.0, 0.0) / 2 for step in steps]
        values = array.astype(real)
        if max(sigma) > 1e-4:
            request.report(0.0, "smoothing")
            gaussian_filter(values, sigma, output=values, mode="nearest")
        result = np.empty((z, y, x), real)
        # slice by slice, so that it can be cancelled
        for k in range(z):
            request.report(k / z * 0.5, "resampling")
            affine_transform(
                values, steps, (starts[0] + k * steps[0], *starts[1:]), (1, y, x), output=result[k : k + 1],
                order=1, mode="nearest",
            )  # fmt: skip
        if array.dtype.kind in "ui":
            limits = np.iinfo(array.dtype)
            np.clip(np.rint(result, out=result), limits.min, limits.max, out=result)
        return result.astype(array.dtype)
