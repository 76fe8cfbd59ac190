"""First regions over value and gradient magnitude: the borders between materials."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from volviz.kernels.histogram import even_histogram
from volviz.model.transfer.automatic import ramp_color
from volviz.model.transfer.first_look import FirstLook
from volviz.model.transfer.function_2d import Region, TransferFunction2D

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

#: Part of the largest gradient (without outliers) above which a place counts as a border.
BORDER = 0.4
#: Most regions that are made.
MOST = 3


def auto_regions(volume: Volume) -> TransferFunction2D:
    """Soft ellipses over the values at which the data change most.

    The values at large gradients are counted, smoothed, and the highest peaks that stand apart are taken.

    Parameters
    ----------
    volume : Volume
        Any data.

    Returns
    -------
    TransferFunction2D
        One to three regions; gradients in data units per world unit.
    """
    look = FirstLook.at(volume)
    low = volume.range[0]
    if look is None:
        return TransferFunction2D((Region("rectangle", low, 1.0, 0.0, 1.0, ramp_color(0.6), 0.05),))
    cell = [look.cell_size[axis] for axis in range(3)]
    squares = [np.gradient(look.values / look.scale, c, axis=axis) ** 2 for axis, c in enumerate(cell)]
    gradient = np.sqrt(sum(squares)) * look.scale
    moving = gradient > 0
    if not moving.any():
        return TransferFunction2D((Region("rectangle", low, 1.0, 0.0, 1.0, ramp_color(0.6), 0.05),))
    most = float(np.quantile(gradient[moving], 0.999))
    border = gradient >= BORDER * most
    span = look.high - look.low
    weights = (gradient[border] / most) ** 2
    counts, edges = even_histogram(look.values[border], 64, look.low, look.high, weights)
    smooth = np.convolve(counts, np.exp(-0.5 * (np.arange(-6, 7) / 2.5) ** 2), mode="same")
    centers = (edges[:-1] + edges[1:]) / 2
    chosen: list[float] = []
    for i in np.argsort(smooth)[::-1]:
        if smooth[i] < 0.15 * smooth.max() or len(chosen) == MOST:
            break
        if all(abs(centers[i] - other) > 0.25 * span for other in chosen):
            chosen.append(float(centers[i]))
    regions = []
    for value in sorted(chosen):
        color = ramp_color(0.3 + 0.6 * (value - look.low) / span)
        regions.append(
            Region("ellipse", value, 0.4 * span, 0.5 * BORDER * most, 1.6 * most, color, 0.35, 0.7)
        )
    return TransferFunction2D(tuple(regions))
