"""Pictures of two surfaces in the colours of their distance to each other, for reports."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.compare.distance_colors import distance_colors
from volviz.compare.distance_map import DistanceMap
from volviz.compare.stage import Stage, View

Bytes = npt.NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class DistancePictures:
    """Both surfaces of a pair, coloured.

    Attributes
    ----------
    first, second : ndarray of shape (H, W, 3), uint8
        Pictures from the camera of the comparison, over its background.
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


def distance_pictures(
    view: View,
    sides: tuple[tuple[str, Any], tuple[str, Any]],
    maps: tuple[DistanceMap, DistanceMap],
    limit: float | None = None,
) -> DistancePictures:
    """Draw two surfaces in the colours of their distance.

    Parameters
    ----------
    view : View
        From where.
    sides : tuple of 2 (technique, settings)
        As for `Stage`.
    maps : tuple of 2 DistanceMap
        Of the meshes that these techniques draw.
    limit : float, optional
        Distance of the strongest colour; the default is the largest distance.

    Raises
    ------
    VolvizError
        Drawing failed, or `limit` is not above 0.
    """
    colors = distance_colors(maps, view.volume.spacing, limit)
    pictures = []
    for (technique, settings), each in zip(sides, (colors.first, colors.second), strict=True):
        with Stage(view, technique, settings) as stage:
            stage.handle.color_surface(each)
            pictures.append(stage.picture())
    return DistancePictures(
        pictures[0], pictures[1], colors.limit, colors.first.table, colors.largest, colors.is_signed,
        colors.are_same, colors.are_vertices_same,
    )  # fmt: skip
