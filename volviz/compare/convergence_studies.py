"""What the pictures of a technique converge with: the setting, its values, and what counts as converged."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from volviz.custom_gl.technique import TechniqueInfo
from volviz.model.volume import Volume

#: Steps that are tried, in voxels of the smallest spacing, and the one of the converged picture.
STEPS = (2.0, 1.4, 1.0, 0.7, 0.5, 0.35)
REFERENCE_STEP = 0.05
#: Bisections that are tried, and those of the converged picture.
BISECTIONS = (0, 1, 2, 3, 4, 5)
REFERENCE_BISECTIONS = 14
#: Techniques whose pictures are compared with the integral along the ray to which our ray caster converges. VTK's on
#: the processor has no limit of its own: its numbers of 15 bits lose more with every shorter step.
ONE_INTEGRAL = ("raycast", "two_pass_raycast", "slicing", "reference", "vtk_fixed_point")
#: These are compared with their own picture at the finest step: VTK's on the graphics card cannot be kept from ending
#: rays early, so that its limit is another one, and its isosurface is lit in its own way.
OWN_LIMIT = ("vtk_gpu", "vtk_isosurface")
#: Half-angle slicing has at most 2048 slices; its finest picture has a few less, or this step.
SLICES, FINEST_SLICES_STEP = 2000, 0.2
#: Finest step of a picture with a shadow ray from every sample, and most samples along the diagonal of the box. The
#: work grows with the square of their number, and software OpenGL breaks loops off after 65,535 turns in all: with
#: shorter steps VTK's shadows are cut short without a word (on the MRI head below a step of 0.4).
FINEST_SHADOW_STEP, SHADOW_SAMPLES = 0.5, 700
#: Distances of splats that are tried, as multiples of those when every voxel is one.
SPLAT_DISTANCES = (6.0, 5.0, 4.0, 3.0, 2.0, 1.5)
#: Every how many voxels a mesh is extracted; all divide `STRIDE_CELLS`, so that all meshes end at the same border.
STRIDES, STRIDE_CELLS, LEAST_CELLS = (6.0, 4.0, 3.0, 2.0), 12, 4
#: Techniques that draw the triangles of an isosurface.
MESHES = ("marching_cubes", "marching_tetrahedra", "vtk_marching_cubes", "vtk_flying_edges")
#: Largest pictures that are drawn, by what a picture costs.
PIXELS, SLICED_PIXELS, SHADOW_PIXELS = 320 * 240, 160 * 120, 64 * 48

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
    own : bool
        The converged picture is the technique's own; else it is that of our ray caster.
    finest : float
        What the errors would be plotted over for the technique's own converged picture, in voxels; 0 where that picture
        is so much finer that it does not matter, or is another's.
    most_pixels : int
        Of the pictures that are drawn.
    """

    parameter: Parameter
    values: tuple[float, ...]
    best: float | None
    axis: str
    own: bool = True
    finest: float = 0.0
    most_pixels: int = PIXELS


def study(info: TechniqueInfo, volume: Volume) -> Study | None:
    """How the convergence of a technique is measured on a volume; None where nothing can be refined.

    Parameters
    ----------
    info : TechniqueInfo
    volume : Volume
        Its size decides how fine the finest picture can be.
    """
    names = {p.name for p in info.parameters}
    if "bisections" in names:
        return Study(
            "bisections", BISECTIONS, REFERENCE_BISECTIONS, "length within which the surface is known"
        )
    if info.id in ONE_INTEGRAL:
        return Study("step", STEPS, REFERENCE_STEP, "distance of samples", own=False)
    if info.id in OWN_LIMIT:
        return Study("step", STEPS, REFERENCE_STEP, "distance of samples", finest=REFERENCE_STEP)
    if info.id == "half_angle":
        best = max(FINEST_SLICES_STEP, diagonal(volume) / SLICES)
        values = tuple(factor * best for factor in (10.0, 7.0, 5.0, 3.5, 2.5))
        return Study(
            "step", values, best, "distance of slices", finest=best, most_pixels=SLICED_PIXELS
        )  # fmt: skip
    if info.id == "vtk_shadows":
        best = max(FINEST_SHADOW_STEP, diagonal(volume) / SHADOW_SAMPLES)
        values = tuple(factor * best for factor in (8.0, 5.6, 4.0, 2.8, 2.0))
        return Study(
            "step", values, best, "distance of samples", finest=best, most_pixels=SHADOW_PIXELS
        )  # fmt: skip
    coarsest = max(volume.spacing) / min(volume.spacing)
    strides = mesh_strides(volume)
    if info.id in MESHES and len(strides) > 1:
        return Study("stride", strides, 1, "distance of grid points", finest=coarsest)
    counts = splat_counts(volume)
    if "splats_per_axis" in names and len(counts) > 1:
        # splats of two lattices lie at other places: their errors are independent, and nothing is to be taken off
        return Study("splats_per_axis", counts, None, "distance of splats")
    return None


def why_not(info: TechniqueInfo) -> str:
    """Why a technique for which there is no study has no order of convergence, in a sentence."""
    names = {p.name for p in info.parameters}
    if "plane_origin" in names:
        return f"{info.id} looks its surface up once a pixel: there is nothing in its picture to refine."
    if "splats_per_axis" in names or info.id in MESHES:
        return f"{info.id} has no order of convergence here: the volume has too few voxels to leave some out."
    return f"{info.id} has no setting whose refinement its picture is known to converge with."


def diagonal(volume: Volume) -> float:
    """Length of the volume's diagonal in voxels of the smallest spacing."""
    lengths = (np.array(volume.dimensions) - 1) * volume.spacing
    return float(np.linalg.norm(lengths)) / min(volume.spacing)


def mesh_strides(volume: Volume) -> tuple[float, ...]:
    """Every how many voxels a mesh is extracted: at least four cells are left along every axis."""
    cells = (min(volume.dimensions) - 1) // STRIDE_CELLS * STRIDE_CELLS
    return tuple(stride for stride in STRIDES if cells >= LEAST_CELLS * stride)


def splat_counts(volume: Volume) -> tuple[float, ...]:
    """Splats per axis for which the largest distance of neighbours is about 6, 5, 4, 3, 2 and 1.5 times the finest."""
    longest = max(n * s for n, s in zip(volume.dimensions, volume.spacing, strict=True))
    finest = max(volume.spacing)
    counts = dict.fromkeys(round(longest / (factor * finest)) for factor in SPLAT_DISTANCES)
    return tuple(float(n) for n in counts if n >= 3)


def splat_distance(volume: Volume, per_axis: int | None) -> float:
    """Largest distance of neighbouring splats, in voxels of the smallest spacing."""
    steps = [1.0 if per_axis is None else max(n / per_axis, 1.0) for n in volume.dimensions]
    return max(n * s for n, s in zip(steps, volume.spacing, strict=True)) / min(volume.spacing)


def fitted_line(
    distances: Sequence[float], errors: Sequence[float], finest: float = 0.0, least: float = 0.0
) -> tuple[float, float]:
    """Factor c and exponent p of an error c * distance^p, least squares of the logarithms.

    Parameters
    ----------
    distances, errors : sequences of floats
        Above 0; points at or below `least` are left out.
    finest : float, default: 0.0
        Where the errors were taken against the picture at this distance instead of the limit, they are
        c * (distance^p - finest^p): fitted that way, a short series has the order of a long one.
    least : float, default: 0.0
        Errors that are rounding.

    Returns
    -------
    tuple of 2 floats
        c and p; (NaN, NaN) with fewer than two points.
    """
    points = [(d, e) for d, e in zip(distances, errors, strict=True) if e > least and d > finest * (1 + 1e-9)]
    if len({d for d, _ in points}) < 2:
        return math.nan, math.nan
    x, y = np.log(np.array(points)).T
    if finest <= 0.0:
        slope, offset = np.polyfit(x, y, 1)
        return math.exp(float(offset)), float(slope)
    powers = np.linspace(0.05, 6.0, 2381)[:, None]
    # log(distance^p - finest^p), kept exact where the two are close
    shapes = powers * x + np.log1p(-np.exp(powers * (math.log(finest) - x)))
    rest = y - shapes
    number = int(np.argmin(rest.var(axis=1)))
    return math.exp(float(rest[number].mean())), float(powers[number, 0])
