"""Settings of slices."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.settings import SamplingSettings, taken_from
from volviz.model.parameters import Cost, parameter

PLANES = (
    ("axial", "Axial"),
    ("coronal", "Coronal"),
    ("sagittal", "Sagittal"),
    ("orthogonal", "All three"),
    ("oblique", "Oblique"),
)
SLABS = (("mean", "Mean"), ("maximum", "Maximum"), ("minimum", "Minimum"), ("composite", "Compositing"))
COLORINGS = (("window", "Grey window"), ("function", "Transfer function"))
INTERPOLATIONS = (("linear", "Trilinear"), ("nearest", "Nearest voxel"), ("cubic", "Cubic B-spline"))


@dataclass(frozen=True)
class SliceSettings:
    """Where the planes lie, what is seen of the values across them, and in which colours."""

    plane: str = parameter(
        "orthogonal",
        "Plane",
        "Axial, coronal and sagittal planes lie across the world axes z, y and x; oblique ones across a direction of "
        "your choice.",
        choices=PLANES,
        group="Plane",
    )
    point: tuple[float, float, float] | None = parameter(
        None,
        "Point",
        "World point through which the planes go; automatic is the cross-hair, or the middle of the volume.",
        kind="vector",
        optional=True,
        none_label="at the cross-hair",
        group="Plane",
    )
    normal: tuple[float, float, float] = parameter(
        (0.0, -1.0, 0.0),
        "Normal",
        "World direction of an oblique plane, towards the viewer.",
        kind="vector",
        group="Plane",
        enabled_by=("plane", ("oblique",)),
    )
    slab: float = parameter(
        0.0,
        "Slab thickness",
        "Thickness in world units across which values are gathered, half of it to either side; 0 is the plane alone.",
        group="Slab",
        minimum=0.0,
        soft_maximum=50.0,
    )
    slab_mode: str = parameter(
        "mean",
        "Slab shows",
        "What is made of the values across the slab. Compositing classifies each with the transfer function, those "
        "nearer to the eye in front.",
        choices=SLABS,
        group="Slab",
        cost=Cost.PROGRAM,
    )
    coloring: str = parameter(
        "window",
        "Colours",
        "Grey between two values, or the colours of the transfer function, opaque.",
        choices=COLORINGS,
        group="Colours",
        cost=Cost.PROGRAM,
    )
    window_level: float | None = parameter(
        None,
        "Level",
        "Value in the middle of the grey window, in data units.",
        kind="float",
        optional=True,
        group="Colours",
        enabled_by=("coloring", ("window",)),
    )
    window_width: float | None = parameter(
        None,
        "Window",
        "Width of the grey window, in data units; automatic leaves out the outermost thousandth of the values.",
        kind="float",
        optional=True,
        minimum=1e-30,
        group="Colours",
        enabled_by=("coloring", ("window",)),
    )
    interpolation: str = parameter(
        "linear",
        "Interpolation",
        "Between voxel centres; the nearest voxel as a block; or the smooth cubic B-spline (third order) that passes "
        "through the voxels.",
        choices=INTERPOLATIONS,
        group="Sampling",
        cost=Cost.PROGRAM,
    )
    step: float = taken_from(
        SamplingSettings,
        "step",
        tooltip="Distance between samples across a slab, in voxels of the smallest spacing.",
    )
    opacity_unit_distance: float | None = taken_from(SamplingSettings, "opacity_unit_distance")
