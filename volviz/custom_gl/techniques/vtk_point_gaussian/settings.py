"""Settings of VTK's point Gaussians; the names are those of our splatting."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.model.parameters import Cost, parameter


@dataclass(frozen=True)
class VtkPointGaussianSettings:
    """Which voxels become splats and how they look."""

    isovalue: float | None = parameter(
        None,
        "Isovalue",
        "Voxels strictly above this value become splats.",
        kind="float",
        optional=True,
        none_label="from the histogram",
        group="Splats",
        cost=Cost.DATA,
    )
    splats_per_axis: int | None = parameter(
        None,
        "Splats per axis",
        "At most so many splats along each axis, on a regular lattice; automatic takes every voxel.",
        kind="int",
        optional=True,
        none_label="every voxel",
        minimum=1,
        maximum=4096,
        soft_minimum=16,
        soft_maximum=512,
        logarithmic=True,
        group="Splats",
        cost=Cost.DATA,
    )
    splat_size: float = parameter(
        1.5,
        "Splat size",
        "Diameter of a splat as a multiple of the largest distance between neighbours: below 1 they come apart.",
        group="Splats",
        minimum=0.05,
        maximum=20.0,
        soft_minimum=0.25,
        soft_maximum=4.0,
        logarithmic=True,
    )
    footprint: str = parameter(
        "disc",
        "Footprint",
        "Discs are opaque and hide one another. Gaussian footprints are translucent, with the opacity of the "
        "transfer function; VTK blends them in the order of the voxels, not from back to front.",
        choices=(("disc", "Opaque discs"), ("gaussian", "Gaussian")),
        group="Splats",
        cost=Cost.DATA,
    )
