"""How the convergence of a technique is measured: the setting that is refined, its values, what counts as converged.

A technique declares it in its folder (`TechniqueInfo.study`); what several have in common is here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from volviz.custom_gl.oracles import OracleScene
from volviz.volume_data.volume import Volume

#: Steps that are tried, in voxels of the smallest spacing, and the one of the converged image.
STEPS = (2.0, 1.4, 1.0, 0.7, 0.5, 0.35)
REFERENCE_STEP = 0.05
#: Distances of splats that are tried, as multiples of those when every voxel is one.
SPLAT_DISTANCES = (6.0, 5.0, 4.0, 3.0, 2.0, 1.5)
#: Every how many voxels a mesh is extracted; all divide `STRIDE_CELLS`, so that all meshes end at the same border.
STRIDES, STRIDE_CELLS, LEAST_CELLS = (6.0, 4.0, 3.0, 2.0), 12, 4
#: Largest images that are drawn, unless they are expensive.
PIXELS = 320 * 240

Parameter = Literal["step", "bisections", "splats_per_axis", "stride"]


@dataclass(frozen=True)
class Study:
    """How the convergence of one technique is measured.

    Attributes
    ----------
    parameter : {"step", "bisections", "splats_per_axis", "stride"}
        The setting that is varied.
    values : tuple of numbers
        Coarsest first.
    best : number or None
        The value of what counts as converged; None stands for a splat at every voxel.
    axis : str
        What errors are plotted over, in words, in voxels of the smallest spacing.
    converged : str
        Id of the technique whose image counts as converged; empty for its own.
    beside : str
        Id of a technique with the same settings from whose converged image the distance of this one's own is told.
    is_exact : callable or None
        Whether `TechniqueInfo.oracle` draws the very limit of the images in a scene with these settings; the distance
        of the converged image from that is told.
    finest : float
        What the errors would be plotted over for the technique's own converged image, in voxels; 0 where that image
        is so much finer that it does not matter, or is another's.
    most_pixels : int
        Of the images that are drawn.
    """

    parameter: Parameter
    values: tuple[float, ...]
    best: float | None
    axis: str
    converged: str = ""
    beside: str = ""
    is_exact: Callable[[OracleScene, Any], bool] | None = None
    finest: float = 0.0
    most_pixels: int = PIXELS


def sample_distances(converged: str = "", beside: str = "") -> Callable[[Volume], Study]:
    """Samples along the ray come closer; see `Study` for the arguments."""
    finest = 0.0 if converged else REFERENCE_STEP

    def study(_volume: Volume) -> Study:
        return Study("step", STEPS, REFERENCE_STEP, "distance of samples", converged, beside, finest=finest)

    return study


def mesh_strides(volume: Volume) -> Study | None:
    """A mesh of every n-th voxel: at least four cells are left along every axis."""
    cells = (min(volume.dimensions) - 1) // STRIDE_CELLS * STRIDE_CELLS
    strides = tuple(stride for stride in STRIDES if cells >= LEAST_CELLS * stride)
    if len(strides) < 2:
        return None
    coarsest = max(volume.spacing) / min(volume.spacing)
    return Study("stride", strides, 1, "distance of grid points", finest=coarsest)


def splat_lattices(volume: Volume) -> Study | None:
    """Splats whose largest distance of neighbours is about 6, 5, 4, 3, 2 and 1.5 times the finest."""
    longest = max(n * s for n, s in zip(volume.dimensions, volume.spacing, strict=True))
    finest = max(volume.spacing)
    distinct = dict.fromkeys(round(longest / (factor * finest)) for factor in SPLAT_DISTANCES)
    counts = tuple(float(n) for n in distinct if n >= 3)
    # splats of two lattices lie at other places: their errors are independent, and nothing is to be taken off
    return Study("splats_per_axis", counts, None, "distance of splats") if len(counts) > 1 else None


def splat_distance(volume: Volume, per_axis: int | None) -> float:
    """Largest distance of neighbouring splats, in voxels of the smallest spacing."""
    steps = [1.0 if per_axis is None else max(n / per_axis, 1.0) for n in volume.dimensions]
    return max(n * s for n, s in zip(steps, volume.spacing, strict=True)) / min(volume.spacing)


def diagonal(volume: Volume) -> float:
    """Length of the volume's diagonal in voxels of the smallest spacing."""
    lengths = (np.array(volume.dimensions) - 1) * volume.spacing
    return float(np.linalg.norm(lengths)) / min(volume.spacing)
