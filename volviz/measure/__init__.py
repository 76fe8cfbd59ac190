"""Measuring: lengths, angles, areas, volumes and profiles, each with its error.

Every number is a `Measured`: a value, its unit and the half-width of the interval that holds the true value in 95 of
100 cases. What goes into that interval is told by each function. Points are world positions (x, y, z), or `Point`
where it is known how well they are known: the functions of `volviz.measure.points` find such points along a ray.
"""

from __future__ import annotations

from volviz.measure.areas import Area, LayerStatistics, area, ellipse
from volviz.measure.label_table import label_statistics
from volviz.measure.lengths import angle, distance, polyline
from volviz.measure.points import isovalue_point, label_point, maximum_point, opacity_point
from volviz.measure.profiles import Profile, profile
from volviz.measure.results import Measured
from volviz.measure.surfaces import isosurface_volume
from volviz.measure.voxel_counts import label_volumes, threshold_volume
from volviz.model.measurements import Point

__all__ = [
    "Area",
    "LayerStatistics",
    "Measured",
    "Point",
    "Profile",
    "angle",
    "area",
    "distance",
    "ellipse",
    "isosurface_volume",
    "isovalue_point",
    "label_point",
    "label_statistics",
    "label_volumes",
    "maximum_point",
    "opacity_point",
    "polyline",
    "profile",
    "threshold_volume",
]
