"""Why a pixel looks as it does: the ray behind it, sample by sample, with the settings that draw the picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.registry import technique as technique_info
from volviz.custom_gl.settings import SamplingSettings
from volviz.custom_gl.technique import drawn_function
from volviz.kernels.preintegration import extinction_sums
from volviz.kernels.reference_profile import (
    SCALAR_MODES,
    Classify,
    Lattice,
    Optics,
    RayProfile,
    RaySpan,
    pixel_noise,
    ray_pieces,
    ray_profile,
    ray_span,
    sample,
    slice_pieces,
)
from volviz.kernels.reference_sampling import Shading
from volviz.kernels.slices import crop_corners
from volviz.model.clipping import Clipping
from volviz.model.light import Light, default_position
from volviz.model.render_spec import DEFAULT_TECHNIQUE
from volviz.model.transfer_function import table_size

if TYPE_CHECKING:
    from volviz.custom_gl.technique import TechniqueInfo
    from volviz.model.transfer_function import TransferFunction
    from volviz.model.volume import Volume

#: World length between samples when crossings of isovalues are looked for, as a share of the smallest spacing.
CROSSING_STEP = 0.25


@dataclass(frozen=True)
class Crossing:
    """A place where the ray meets an isosurface: distance from where it begins to be drawn, and isovalue."""

    distance: float
    isovalue: float


@dataclass(frozen=True)
class RayInspection:
    """One ray and what it gathered.

    Attributes
    ----------
    pixel : tuple of 2 ints
        Column and row, (0, 0) at the upper left.
    span : RaySpan
        The ray and the part of it that is drawn.
    profile : RayProfile
        Its samples.
    exact : bool
        The technique samples rays (or slices) like this, so that the last accumulated colour is the pixel's;
        False: the picture is made in another way, and this is what ray casting would gather.
    technique, mode : str
        Id of the technique, and its mode ("composite" where it has none).
    acts_on_scalar : bool
        The mode makes one scalar of the ray, which is classified once.
    jittered : bool
        The samples are moved by a noise of the pixel's own.
    preintegrated : bool
        Pieces are classified by the values at both ends.
    shows_machinery : bool
        The technique shows something else than its picture.
    reduced : bool
        The picture may be drawn from smoothed, coarser data (mipmaps).
    crossings : tuple of Crossing
        Where the ray meets the surfaces of techniques that have isovalues.
    """

    pixel: tuple[int, int]
    span: RaySpan
    profile: RayProfile
    exact: bool
    technique: str
    mode: str
    acts_on_scalar: bool
    jittered: bool
    preintegrated: bool
    shows_machinery: bool
    reduced: bool
    crossings: tuple[Crossing, ...] = ()

    @property
    def ends(self) -> str:
        """Why it ends: "opacity" (enough has gathered), "missed", or one of `RaySpan.ends`."""
        if not self.span.exit > self.span.entry:
            return "missed"
        return "opacity" if self.profile.terminated else self.span.ends


def inspect_ray(
    volume: Volume,
    technique: str,
    settings: Any,
    transfer_function: TransferFunction,
    *,
    view: npt.ArrayLike,
    projection: npt.ArrayLike,
    size: tuple[int, int],
    pixel: tuple[int, int],
    light: Light | None = None,
    clipping: Clipping | None = None,
    depth: float | None = None,
) -> RayInspection:
    """Follow the ray through the middle of a pixel, in float64.

    Parameters
    ----------
    volume : Volume
        The data.
    technique : str
        Id of the technique that draws.
    settings : object
        Its settings.
    transfer_function : TransferFunction
        The function that is drawn.
    view, projection : array_like of shape (4, 4)
        World to eye and eye to clip space, OpenGL conventions.
    size : tuple of 2 ints
        Width and height of the picture.
    pixel : tuple of 2 ints
        Column and row, (0, 0) at the upper left.
    light, clipping
        Those of the scene.
    depth : float, optional
        Window depth 0..1 of opaque geometry in that pixel.

    Raises
    ------
    InputError
        There is no such technique, or the crop box leaves nothing.
    """
    light, clipping = light or Light(), clipping or Clipping()
    info = technique_info(technique)
    function = drawn_function(info, settings, transfer_function.resolved(volume.range))
    sampling = settings if isinstance(settings, SamplingSettings) else _as_ray_casting(info, settings)
    crop = clipping.crop_within(volume.dimensions)
    matrix = volume.index_to_world
    span = ray_span(
        volume.array.shape, matrix, view=view, projection=projection, size=size, pixel=pixel,
        crop=crop if clipping.crop is not None else None, clip_planes=clipping.planes, depth=depth,
    )  # fmt: skip
    optics = _optics(volume, sampling, function, light, slices=info.view_slices is not None)
    low, high = volume.range
    nearest = sampling.interpolation == "nearest"
    lattice = Lattice(
        volume.array, matrix, low, high, nearest, float(getattr(sampling, "gradient_delta", 1.0))
    )
    jitter = pixel_noise(pixel, size) if sampling.jitter else None
    if info.view_slices is not None:
        normal = -np.asarray(view, np.float64)[2, :3]
        normal /= np.linalg.norm(normal)
        corners = crop_corners(matrix, crop, volume.dimensions)
        low, high, count = info.view_slices(settings, corners, normal, sampling.step * min(volume.spacing))
        pieces = slice_pieces(span, normal, (low, high), count, sampling.first_sample, jitter=jitter)
    else:
        first = 0.5 if optics.extinction is not None else sampling.first_sample
        pieces = ray_pieces(span, sampling.step * min(volume.spacing), first, jitter=jitter)
    display = getattr(settings, "display", "image")
    return RayInspection(
        pixel,
        span,
        ray_profile(lattice, span, pieces, optics),
        exact=info.samples_rays,
        technique=technique,
        mode=optics.mode,
        acts_on_scalar=optics.mode in SCALAR_MODES,
        jittered=jitter is not None,
        preintegrated=optics.extinction is not None,
        shows_machinery=display not in ("image", "both"),
        reduced=bool(getattr(settings, "mipmaps", False)),
        crossings=_crossings(volume, lattice, span, info.isovalues(settings, volume)),
    )


def _as_ray_casting(info: TechniqueInfo, settings: Any) -> Any:
    """Ray casting with the settings that another technique has in common with it, its mode only if that is the same."""
    casting = technique_info(DEFAULT_TECHNIQUE)
    names = [p.name for p in casting.parameters if hasattr(settings, p.name)]
    same = {name: getattr(settings, name) for name in names if info.samples_rays or name != "mode"}
    return casting.settings(**same)


def _optics(
    volume: Volume, settings: Any, function: TransferFunction, light: Light, *, slices: bool
) -> Optics:
    low, high = volume.range
    integer = volume.array.dtype.kind in "iu"
    shading = None
    if settings.shading:
        place = None if light.headlight else light.position or default_position(volume.bounds)
        shading = Shading(
            settings.ambient, settings.diffuse, settings.specular, settings.shininess, place, light.color,
            settings.gradient_delta,
        )  # fmt: skip
    extinction, extinction_range = None, (low, high)
    regions = function.by_gradient is not None
    if settings.mode == "composite" and getattr(settings, "preintegrated", False) and not regions:
        extinction_range = function.oracle_range(volume.range)
        table = function.bake(extinction_range, table_size(extinction_range, integer)).astype(np.float64)
        if settings.density_threshold > 0:
            values = np.linspace(*extinction_range, len(table))
            table[values < low + settings.density_threshold * (high - low), 3] = 0.0
        extinction = extinction_sums(table)
    unit = settings.opacity_unit_distance
    return Optics(
        classify=_by_gradient(function) if regions else _by_value(volume, function, integer),
        uses_gradient=regions,
        mode=settings.mode,
        unit_distance=volume.mean_spacing if unit is None else float(unit),
        early_termination=1.0 if slices else settings.early_termination,
        attenuation=settings.attenuation,
        density_threshold=settings.density_threshold,
        gradient_opacity=settings.gradient_opacity,
        gradient_reference=0.25 * (high - low) / volume.mean_spacing,
        shading=shading,
        extinction=extinction,
        extinction_range=extinction_range,
    )


def _by_gradient(function: TransferFunction) -> Classify:
    """The regions over value and gradient."""
    regions = function.by_gradient
    assert regions is not None

    def classify(
        values: npt.NDArray[np.float64], gradients: npt.NDArray[np.float64]
    ) -> npt.NDArray[np.float64]:
        rgba = regions.evaluate(values, gradients)
        rgba[:, 3] *= function.opacity
        return rgba

    return classify


def _by_value(volume: Volume, function: TransferFunction, integer: bool) -> Classify:
    """Look-up in the table that the pictures are drawn with."""
    first, last = function.table_range(volume.range)
    table = function.bake((first, last), table_size((first, last), integer)).astype(np.float64)
    places = np.linspace(first, last, len(table))

    def classify(values: npt.NDArray[np.float64], _gradients: Any) -> npt.NDArray[np.float64]:
        return np.column_stack([np.interp(values, places, table[:, c]) for c in range(4)])

    return classify


def _crossings(
    volume: Volume, lattice: Lattice, span: RaySpan, isovalues: tuple[float, ...]
) -> tuple[Crossing, ...]:
    if not isovalues or not span.exit > span.entry:
        return ()
    count = max(int((span.exit - span.entry) / (CROSSING_STEP * min(volume.spacing))), 1) + 1
    places = np.linspace(span.entry, span.exit, count)
    values = sample(lattice, span.start + places[:, None] * span.direction)
    found = []
    for isovalue in isovalues:
        inside = values >= isovalue
        for i in np.flatnonzero(inside[1:] != inside[:-1]).tolist():
            part = (isovalue - values[i]) / (values[i + 1] - values[i])
            distance = places[i] + part * (places[i + 1] - places[i]) - span.entry
            found.append(Crossing(float(distance), isovalue))
    return tuple(sorted(found, key=lambda crossing: crossing.distance))
