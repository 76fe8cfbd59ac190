"""Why a pixel looks as it does: the ray behind it, sample by sample, with the settings that draw the image."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.resolve import ResolvedSpec, Volumes, resolve
from volviz.custom_gl.settings import CommonSettings
from volviz.errors import InputError
from volviz.kernels.preintegration import extinction_sums
from volviz.model.render_spec import RenderSpec, View
from volviz.reference.ray_profile import (
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
from volviz.reference.sampling import Shading
from volviz.volume_data.vectors import Vector

if TYPE_CHECKING:
    from volviz.model.transfer.function import TransferFunction
    from volviz.volume_data.volume import Volume

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
        False: the image is made in another way, and this is what ray casting would gather.
    technique, mode : str
        Id of the technique, and its mode ("composite" where it has none).
    acts_on_scalar : bool
        The mode makes one scalar of the ray, which is classified once.
    jittered : bool
        The samples are moved by a noise of the pixel's own.
    preintegrated : bool
        Pieces are classified by the values at both ends.
    shows_debug_view : bool
        The technique shows something else than its image.
    reduced : bool
        The image may be drawn from smoothed, coarser data (mipmaps).
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
    shows_debug_view: bool
    reduced: bool
    crossings: tuple[Crossing, ...] = ()

    @property
    def ends(self) -> str:
        """Why it ends: "opacity" (enough has gathered), "missed", or one of `RaySpan.ends`."""
        if not self.span.exit > self.span.entry:
            return "missed"
        return "opacity" if self.profile.terminated else self.span.ends


def inspect_ray(
    spec: RenderSpec,
    view: View,
    pixel: tuple[int, int],
    volumes: Volumes | None = None,
    *,
    depth: float | None = None,
) -> RayInspection:
    """Follow the ray through the middle of a pixel, in float64.

    Parameters
    ----------
    spec : RenderSpec
        What is drawn; the colours of a surface play no part. Of several layers the ray meets the first one that is
        seen, as if it were alone.
    view : View
        From where; `clipping_range` is that of the window for a ray in a window.
    pixel : tuple of 2 ints
        Column and row, (0, 0) at the upper left.
    volumes : mapping of VolumeKey to Volume, optional
        What has been read of the references in the layers.
    depth : float, optional
        Window depth 0..1 of opaque geometry in that pixel.

    Raises
    ------
    InputError
        There is no such technique, the view has no camera, or the crop box leaves nothing.
    """
    shown = resolve(replace(spec, surface_colors=None), volumes)
    if view.camera is None:
        raise InputError(
            "a ray starts from a camera: give the view one, such as volviz.custom_gl.framing.default_camera."
        )
    volume, info, size = shown.volume, shown.info, view.size
    # what other techniques have in common with ray casting; their modes mean something else
    common = shown.common if info.samples_rays else replace(shown.common, mode="composite")
    near_and_far = view.clipping_range or view.camera.clipping_range(volume.corners)
    matrix, projection = view.camera.matrices(size[0] / size[1], near_and_far)
    span = ray_span(
        volume.array.shape, volume.index_to_world, view=matrix, projection=projection, size=size, pixel=pixel,
        crop=None if shown.clipping.crop is None else shown.crop, clip_planes=shown.clipping.planes, depth=depth,
    )  # fmt: skip
    optics = _optics(shown, common, shown.light_seen_from(matrix))
    lattice = Lattice(
        volume.finite_array, volume.index_to_world, *volume.bulk_range, common.interpolation == "nearest",
        common.gradient_delta,
    )  # fmt: skip
    jitter = pixel_noise(pixel, size) if common.jitter else None
    step = common.step * min(volume.spacing)
    if info.view_slices is not None:
        normal = np.asarray(view.camera.direction)
        low, high, count = info.view_slices(shown.settings, shown.box_corners, normal, step)
        pieces = slice_pieces(span, normal, (low, high), count, common.first_sample, jitter=jitter)
    else:
        first = 0.5 if optics.extinction is not None else common.first_sample
        pieces = ray_pieces(span, step, first, jitter=jitter)
    return RayInspection(
        pixel,
        span,
        ray_profile(lattice, span, pieces, optics),
        exact=info.samples_rays,
        technique=info.id,
        mode=optics.mode,
        acts_on_scalar=optics.mode in SCALAR_MODES,
        jittered=jitter is not None,
        preintegrated=optics.extinction is not None,
        shows_debug_view=common.display not in ("image", "both"),
        reduced=common.mipmaps,
        crossings=_crossings(volume, lattice, span, shown.isovalues),
    )


def _optics(shown: ResolvedSpec, common: CommonSettings, light: Vector) -> Optics:
    volume, function = shown.volume, shown.drawn_function
    low, high = volume.bulk_range
    integer = volume.array.dtype.kind in "iu"
    shading = None
    if common.shading:
        shading = Shading(
            common.ambient, common.diffuse, common.specular, common.shininess,
            None if shown.light.headlight else light, shown.light.color, common.gradient_delta,
        )  # fmt: skip
    extinction, extinction_range = None, (low, high)
    regions = function.by_gradient is not None
    if common.mode == "composite" and common.preintegrated and not regions:
        extinction_range = function.oracle_range(volume.range)
        table = function.bake(
            extinction_range, function.table_size(extinction_range, integer=integer)
        ).astype(np.float64)
        if common.density_threshold > 0:
            values = np.linspace(*extinction_range, len(table))
            table[values < low + common.density_threshold * (high - low), 3] = 0.0
        extinction = extinction_sums(table)
    return Optics(
        classify=_by_gradient(function) if regions else _by_value(volume, function, integer),
        uses_gradient=regions,
        mode=common.mode,
        unit_distance=shown.unit_distance,
        early_termination=common.early_termination if shown.info.view_slices is None else 1.0,
        attenuation=common.attenuation,
        density_threshold=common.density_threshold,
        gradient_opacity=common.gradient_opacity,
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
    """Look-up in the table that the images are drawn with."""
    first, last = function.table_range(volume.range)
    table = function.bake((first, last), function.table_size((first, last), integer=integer)).astype(
        np.float64
    )
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
