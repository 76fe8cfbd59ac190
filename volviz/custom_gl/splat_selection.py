"""Which voxels become splats, and how large these are: the same for our splatting and for VTK's points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from volviz.kernels.splats import Splats, select_splats
from volviz.volume_data.scalars import BRICK, bricks_of

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

#: Standard deviation of a Gaussian footprint as a share of the splat's diameter: 0.675 voxels at the default size.
SIGMA_PER_DIAMETER = 0.45


def splats_of(volume: Volume, isovalue: float, per_axis: int | None, *, cull: bool) -> Splats:
    """The splats of a volume; see `volviz.kernels.splats.select_splats`.

    Parameters
    ----------
    volume : Volume
        The data.
    isovalue : float
        In data units.
    per_axis : int or None
        At most so many along each axis; None for every voxel.
    cull : bool
        Leave hidden ones out.
    """
    bricks = bricks_of(volume)
    return select_splats(
        volume.array,
        isovalue,
        spacing=volume.spacing,
        direction=volume.direction,
        splats_per_axis=per_axis,
        cull_interior=cull,
        bricks=(bricks.low, bricks.high),
        brick=BRICK,
        lowest=volume.range[0],
    )


def lattice_steps(volume: Volume, per_axis: int | None) -> npt.NDArray[np.float64]:
    """Distance of neighbouring splats along x, y, z, in voxels."""
    if per_axis is None:
        return np.ones(3)
    return np.asarray(np.maximum(np.array(volume.dimensions) / per_axis, 1.0))
