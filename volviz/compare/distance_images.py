"""Images of two surfaces in the colours of their distance to each other, for reports."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from volviz.compare.distance_colors import distance_colors
from volviz.compare.distance_map import DistanceMap
from volviz.custom_gl.resolve import resolve
from volviz.model.render_spec import RenderSpec, View
from volviz.renderer import Renderer

Bytes = npt.NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class DistanceImages:
    """Both surfaces of a pair, coloured.

    Attributes
    ----------
    first, second : ndarray of shape (H, W, 3), uint8
        Images from the camera of the comparison, over its background.
    limit : float
        Distance of the strongest colour, in world units.
    table : ndarray of shape (N, 3), uint8
        Colours from `low` to `limit`.
    largest : float
        Largest distance of a place of one surface to the other, in world units.
    is_signed, are_same, are_vertices_same : bool
        See `volviz.compare.distance_colors.DistanceColors`.
    """

    first: Bytes
    second: Bytes
    limit: float
    table: Bytes
    largest: float
    is_signed: bool
    are_same: bool
    are_vertices_same: bool

    @property
    def low(self) -> float:
        """Distance of the first colour."""
        return -self.limit if self.is_signed else 0.0


def distance_images(
    specs: tuple[RenderSpec, RenderSpec],
    view: View,
    maps: tuple[DistanceMap, DistanceMap],
    limit: float | None = None,
) -> DistanceImages:
    """Draw two surfaces in the colours of their distance.

    Parameters
    ----------
    specs : tuple of 2 RenderSpec
        Of techniques that draw meshes.
    view : View
        From where, with a background.
    maps : tuple of 2 DistanceMap
        Of the meshes that these techniques draw.
    limit : float, optional
        Distance of the strongest colour; the default is the largest distance.

    Raises
    ------
    VolvizError
        Drawing failed, or `limit` is not above 0.
    """
    colors = distance_colors(maps, resolve(specs[0]).volume.spacing, limit)
    images = []
    for spec, each in zip(specs, (colors.first, colors.second), strict=True):
        with Renderer(view.size) as renderer:
            images.append(renderer.draw(replace(spec, surface_colors=each), view)[..., :3])
    return DistanceImages(
        images[0], images[1], colors.limit, colors.first.table, colors.largest, colors.is_signed,
        colors.are_same, colors.are_vertices_same,
    )  # fmt: skip
