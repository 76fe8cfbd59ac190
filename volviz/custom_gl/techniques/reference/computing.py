"""The oracle's image of a frame, of plain values, so that any thread can compute it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.model.transfer.function import MAX_TABLE, TransferFunction
from volviz.reference.image import Shading, reference_render
from volviz.volume_data.volume import Volume

Image = npt.NDArray[np.float64]

#: Entries of the table where the data do not name a number: so many that none of ours is finer.
FINE_TABLE = 2**16 + 1
#: Entries over value and gradient.
TABLE_2D_SIZE = (1536, 1024)


@dataclass(frozen=True)
class OracleRequest:
    """Everything that the image depends on; equal requests have equal images.

    Attributes
    ----------
    volume, function, settings
        What is shown and how; the function in data units.
    view, projection : tuple of 16 floats
        Row by row.
    size : (width, height)
        Pixels that are computed.
    step, unit_distance : float
        World units.
    crop, planes
        As in `Frame`.
    light : tuple of 3 floats or None
        World position, None = at the eye.
    light_color : tuple of 3 floats
        Its colour.
    """

    volume: Volume
    function: TransferFunction
    settings: Any
    view: tuple[float, ...]
    projection: tuple[float, ...]
    size: tuple[int, int]
    step: float
    unit_distance: float
    crop: tuple[float, ...]
    planes: Any
    light: Any
    light_color: tuple[float, float, float]


def computed(request: OracleRequest, progress: Any = None, cancel: Any = None) -> Image:
    """The oracle's image: premultiplied RGBA, shape (height, width, 4), row 0 at the top."""
    volume, settings = request.volume, request.settings
    scalar = settings.mode == "attenuated_maximum"
    table_range = volume.bulk_range if scalar else request.function.oracle_range(volume.range)
    entries = request.function.table_size(table_range, integer=volume.array.dtype.kind in "iu")
    if entries >= MAX_TABLE:
        entries = max(entries, FINE_TABLE)
    shading = None
    if settings.shading:
        shading = Shading(
            settings.ambient, settings.diffuse, settings.specular, settings.shininess, request.light,
            request.light_color, settings.gradient_delta,
        )  # fmt: skip
    regions = _regions(request)
    return reference_render(
        volume.array, volume.spacing, volume.origin, volume.direction,
        table=request.function.bake(table_range, entries), value_range=volume.bulk_range, table_range=table_range,
        view=np.reshape(request.view, (4, 4)), projection=np.reshape(request.projection, (4, 4)), size=request.size,
        step_world=request.step, first_sample=settings.first_sample, unit_distance=request.unit_distance,
        mode=settings.mode, attenuation=settings.attenuation, early_termination=settings.early_termination,
        shading=shading, gradient_opacity=settings.gradient_opacity, crop=request.crop, clip_planes=request.planes,
        interpolation=settings.interpolation,
        preintegrated=settings.preintegrated and settings.mode == "composite" and not regions,
        density_threshold=settings.density_threshold, gradient_delta=settings.gradient_delta,
        progress=progress, cancel=cancel, **regions,
    )  # fmt: skip


def _regions(request: OracleRequest) -> dict[str, Any]:
    """Arguments of the oracle for regions over value and gradient, where the function has any to be drawn."""
    regions = request.function.by_gradient
    if regions is None or not regions.regions:
        return {}
    top = max(region.gradient_high for region in regions.regions) * 1.01
    table = regions.bake(request.volume.range, (0.0, top), TABLE_2D_SIZE)
    table[..., 3] *= request.function.opacity
    return {"gradient_table": table, "gradient_range": (0.0, top)}
