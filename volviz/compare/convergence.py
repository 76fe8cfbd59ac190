"""How quickly results converge: error against a converged one over step, bisections, splats or cells of a mesh.

Images are compared as 32-bit floats, without early termination and without jitter, so that only the discretisation
is seen; meshes by their distance. An order of convergence is the slope of a straight line through the points in a
log-log plot (least squares): 2 for the midpoint rule on continuous transfer functions, 1 where samples lie at the ends
of their segments or the function jumps (Etiene et al. 2014).
"""

from __future__ import annotations

import math
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.compare.meshes import side_mesh
from volviz.compare.samples import ray_samples
from volviz.compare.surface_distance import surface_distance
from volviz.custom_gl.oracles import OracleScene
from volviz.custom_gl.registry import technique as technique_info
from volviz.custom_gl.resolve import resolve
from volviz.custom_gl.study import STRIDE_CELLS, Study, diagonal, splat_distance
from volviz.custom_gl.technique import TechniqueInfo
from volviz.errors import InputError
from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.parameters import make_settings
from volviz.model.render_spec import RenderSpec, View
from volviz.renderer import Renderer
from volviz.volume_data.volume import Volume

#: Errors below this, in levels of 0..255, are rounding of 32-bit floats over many samples, not discretisation.
ROUNDING = 2e-3
#: Points of each mesh from which distances are taken.
MESH_SAMPLES = 100_000
#: Pixels of the image whose distance from the integral with shadow rays is told: every ray needs many of them. They
#: become fewer where the volume's diagonal is longer than so many voxels.
INTEGRAL_PIXELS, INTEGRAL_DIAGONAL = 80 * 60, 400.0
#: Step of its rays and shadow rays, in voxels of the smallest spacing.
INTEGRAL_STEP = 0.5
LEVELS, VOXELS = "levels of 255", "voxels"


@dataclass(frozen=True)
class Convergence:
    """Errors of one technique over one setting.

    Attributes
    ----------
    name, technique : str
        Side of the comparison, and id of its technique.
    parameter : {"step", "bisections", "splats_per_axis", "stride"}
        What is varied.
    values : tuple of floats
        Its values, coarsest first; those whose mesh is empty are left out.
    distances : tuple of floats
        What the errors are plotted over, in voxels of the smallest spacing; see `axis`.
    errors, max_errors : tuple of floats
        Of images: root of the mean squared difference, and largest difference, in levels of 0..255. Of meshes: mean
        and largest distance in voxels of the smallest spacing.
    slope : float
        Fitted order of convergence; NaN with fewer than two errors above rounding.
    fitted : tuple of 2 floats
        Factor c and exponent p of the fitted error c * distance^p.
    reference : str
        What was taken as converged, in words.
    offset : float or None
        How far the converged image is from that of another, better known model, in levels (RMS); None where it is
        that one, or where there is none.
    offset_from : str
        That model in words; empty without an offset.
    axis : str
        What the distances are, in words.
    finest : float
        Distance of the converged image, where it counts: errors are then c * (distance^p - finest^p).
    unit : {"levels of 255", "voxels"}
        Of the errors.
    size : tuple of 2 ints
        Pixels of the images that were compared; (0, 0) for meshes.
    """

    name: str
    technique: str
    parameter: str
    values: tuple[float, ...]
    distances: tuple[float, ...]
    errors: tuple[float, ...]
    max_errors: tuple[float, ...]
    slope: float
    fitted: tuple[float, float]
    reference: str
    offset: float | None = None
    offset_from: str = ""
    axis: str = "distance of samples"
    finest: float = 0.0
    unit: str = LEVELS
    size: tuple[int, int] = (0, 0)

    def expected(self, distance: float) -> float:
        """The fitted error at a distance in voxels; NaN when nothing was fitted."""
        factor, power = self.fitted
        return float(factor * (distance**power - (self.finest**power if self.finest > 0 else 0.0)))


class ConvergenceRun:
    """Draws one technique coarser and finer and compares with what counts as converged.

    Parameters
    ----------
    spec : RenderSpec
        What is shown: layers, light and clipping.
    view : View
        From where, with a camera; images larger than the study allows are made smaller in proportion.
    name, technique : str
        Name for the result, and id of the technique.
    settings : mapping, optional
        Settings that differ from the defaults.
    how : Study, optional
        What is varied; by default what the technique declares (`TechniqueInfo.study`).

    Raises
    ------
    InputError
        The technique has nothing that its images converge with.
    """

    def __init__(
        self,
        spec: RenderSpec,
        view: View,
        name: str,
        technique: str,
        settings: Mapping[str, Any] | None = None,
        how: Study | None = None,
    ) -> None:
        self._info = technique_info(technique)
        self._spec, self._volume = spec, resolve(spec.drawn_by(technique)).volume
        chosen = how or study(self._info, self._volume)
        if chosen is None:
            raise InputError(why_not(self._info))
        self._study = chosen
        self._view = smaller(replace(view, background=view.background or (0.0, 0.0, 0.0)), chosen.most_pixels)
        self._name = name
        # a number of slices would leave the step without effect
        given = {key: value for key, value in (settings or {}).items() if key != "slices"}
        self._settings = given | _exact(self._info)
        self.result: Convergence | None = None

    def steps(self) -> Generator[float, None, None]:
        """Work; gives the finished fraction, 0..1, after every image or mesh. `result` stands at the end."""
        return self._meshes() if self._study.parameter == "stride" else self._images()

    # ------------------------------------------------------------------------------------ images

    def _images(self) -> Generator[float, None, None]:
        how, total = self._study, len(self._study.values) + 2
        truth, words = self._converged()
        yield 1 / total
        offset, model = self._offset(truth)
        yield 2 / total
        distances, errors, largest = [], [], []
        with Renderer(self._view.size) as renderer:
            for done, value in enumerate(how.values, 3):
                spec = self._drawn_by(
                    self._info.id, self._settings | {how.parameter: self._as_setting(value)}
                )
                difference = 255.0 * np.abs(_image(renderer, spec, self._view) - truth)
                distances.append(self._distance(spec))
                errors.append(float(np.sqrt(np.mean(difference**2))))
                largest.append(float(difference.max()))
                yield done / total
        self._finish(how.values, distances, errors, largest, words, ROUNDING, offset, model)

    def _converged(self) -> tuple[npt.NDArray[np.float64], str]:
        technique, given = self._info.id, dict(self._settings)
        if self._study.converged:
            # slices are limited in number; the integral is the same
            technique = self._study.converged
            given = _settings_of(technique, given)
        best = self._as_setting(self._study.best)
        given[self._study.parameter] = best
        if self._study.parameter == "splats_per_axis":
            words = f"{technique} with a splat at every voxel"
        else:
            words = f"{technique} with {self._study.parameter} = {best:g}"
        return self._image(technique, given), words

    def _offset(self, truth: npt.NDArray[np.float64]) -> tuple[float | None, str]:
        """Distance of a technique's own limit from what it stands for, and what that is in words."""
        best = self._study.best
        if self._study.is_exact is not None and self._info.oracle is not None:
            share = min((INTEGRAL_DIAGONAL / diagonal(self._volume)) ** 2, 1.0)
            view = smaller(self._view, round(share * INTEGRAL_PIXELS))
            spec = self._drawn_by(self._info.id, self._settings | {"step": best})
            scene = oracle_scene(spec, view, INTEGRAL_STEP)
            with Renderer(view.size) as renderer:
                drawn = _image(renderer, spec, view)
                if renderer.notice or not self._study.is_exact(scene, spec.settings):
                    return None, ""
            rgba = self._info.oracle(scene, spec.settings)
            exact = rgba[..., :3] + (1.0 - rgba[..., 3:]) * np.asarray(view.background)
            return _rms(drawn - exact), "the integral with a shadow ray from every sample"
        if self._study.beside:
            other = self._study.beside
            given = _settings_of(other, self._settings) | {"step": best}
            return _rms(truth - self._image(other, given)), f"{other} with step = {best:g}"
        return None, ""

    def _drawn_by(self, technique: str, values: Mapping[str, Any]) -> RenderSpec:
        """What a technique draws with settings by name."""
        settings = make_settings(technique_info(technique).settings, values, owner=technique)
        return self._spec.drawn_by(technique, settings)

    def _image(self, technique: str, values: Mapping[str, Any]) -> npt.NDArray[np.float64]:
        with Renderer(self._view.size) as renderer:
            return _image(renderer, self._drawn_by(technique, values), self._view)

    def _as_setting(self, value: float | None) -> Any:
        whole = value is not None and self._study.parameter != "step"
        return int(value) if whole and value is not None else value

    def _distance(self, spec: RenderSpec) -> float:
        """What the error is plotted over, in voxels."""
        settings = spec.settings
        if self._study.parameter == "bisections":
            return float(settings.step) / 2.0 ** int(settings.bisections)
        if self._study.parameter == "splats_per_axis":
            return splat_distance(self._volume, settings.splats_per_axis)
        samples = ray_samples(spec, self._view)
        return float(settings.step) if samples is None else samples.distance / min(self._volume.spacing)

    # ------------------------------------------------------------------------------------ meshes

    def _meshes(self) -> Generator[float, None, None]:
        how, total = self._study, len(self._study.values) + 1
        volume, settings = cropped_to(self._volume, STRIDE_CELLS), dict(self._settings)
        if settings.get("isovalue") is None:
            settings["isovalue"] = auto_isovalue(self._volume)
        unit = min(volume.spacing)

        def mesh(stride: float) -> Any:
            return side_mesh(volume, self._info.id, settings | {"stride": int(stride)})

        truth = mesh(how.best or 1)
        yield 1 / total
        values, distances, errors, largest = [], [], [], []
        for done, stride in enumerate(how.values, 2):
            coarse = mesh(stride)
            if len(coarse[1]) and len(truth[1]):
                found = surface_distance(coarse, truth, max_samples=MESH_SAMPLES)
                values.append(stride)
                distances.append(stride * max(volume.spacing) / unit)
                errors.append(found.mean / unit)
                largest.append(found.hausdorff / unit)
            yield done / total
        self._finish(values, distances, errors, largest, f"{self._info.id} on every voxel", 0.0)

    def _finish(
        self,
        values: Sequence[float],
        distances: Sequence[float],
        errors: Sequence[float],
        largest: Sequence[float],
        reference: str,
        least: float,
        offset: float | None = None,
        model: str = "",
    ) -> None:
        how = self._study
        of_meshes = how.parameter == "stride"
        factor, slope = fitted_line(distances, errors, how.finest, least)
        self.result = Convergence(
            self._name, self._info.id, how.parameter, tuple(values), tuple(distances), tuple(errors),
            tuple(largest), slope, (factor, slope), reference, offset, model, how.axis, how.finest,
            VOXELS if of_meshes else LEVELS, (0, 0) if of_meshes else self._view.size,
        )  # fmt: skip


def study(info: TechniqueInfo, volume: Volume) -> Study | None:
    """How the convergence of a technique is measured on a volume; None where nothing can be refined."""
    return None if info.study is None else info.study(volume)


def why_not(info: TechniqueInfo) -> str:
    """Why a technique for which there is no study has no order of convergence, in a sentence."""
    if info.study is not None:
        return f"{info.id} has no order of convergence here: the volume has too few voxels to leave some out."
    if "plane" in info.manipulators:
        return f"{info.id} looks its surface up once a pixel: there is nothing in its picture to refine."
    return f"{info.id} has no setting whose refinement its picture is known to converge with."


def fitted_line(
    distances: Sequence[float], errors: Sequence[float], finest: float = 0.0, least: float = 0.0
) -> tuple[float, float]:
    """Factor c and exponent p of an error c * distance^p, least squares of the logarithms.

    Parameters
    ----------
    distances, errors : sequences of floats
        Above 0; points at or below `least` are left out.
    finest : float, default: 0.0
        Where the errors were taken against the image at this distance instead of the limit, they are
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


def oracle_scene(spec: RenderSpec, view: View, step: float) -> OracleScene:
    """What an oracle draws, with samples a number of voxels of the smallest spacing apart; the view has a camera."""
    shown, camera = resolve(spec), view.camera
    assert camera is not None
    volume, light, (width, height) = shown.volume, shown.light, view.size
    modelview, projection = camera.matrices(width / height, camera.clipping_range(volume.corners))
    return OracleScene(
        volume.array, volume.spacing, shown.drawn_function, volume.bulk_range, volume.mean_spacing,
        step * min(volume.spacing), modelview, projection, view.size, volume.origin, volume.direction,
        isovalues=shown.isovalues,
        light=light if light.headlight else replace(light, position=shown.light_seen_from(modelview)),
        clipping=shown.clipping,
    )  # fmt: skip


def smaller(view: View, most_pixels: int) -> View:
    """The view with at most so many pixels, of the same proportions."""
    width, height = view.size
    factor = math.sqrt(most_pixels / (width * height))
    if factor >= 1:
        return view
    return replace(view, size=(max(round(width * factor), 1), max(round(height * factor), 1)))


def cropped_to(volume: Volume, cells: int) -> Volume:
    """The volume without its last voxels, so that every axis has a multiple of so many cells.

    Grids of every second, third, ... voxel then end at the same border, for numbers that divide `cells`.
    """
    nz, ny, nx = ((n - 1) // cells * cells + 1 for n in volume.array.shape)
    return Volume(
        volume.array[:nz, :ny, :nx], spacing=volume.spacing, origin=volume.origin, direction=volume.direction,
        unit=volume.unit, name=volume.name,
    )  # fmt: skip


def _image(renderer: Renderer, spec: RenderSpec, view: View) -> npt.NDArray[np.float64]:
    """Red, green and blue over the view's background, shape (H, W, 3), 0..1."""
    return np.asarray(renderer.draw(spec, view, dtype="float32")[..., :3], np.float64)


def _rms(difference: npt.NDArray[np.float64]) -> float:
    """Root of the mean squared difference in levels of 0..255."""
    return float(255.0 * np.sqrt(np.mean(difference**2)))


def _settings_of(technique: str, settings: Mapping[str, Any]) -> dict[str, Any]:
    """The settings that a technique knows, so that only its discretisation is left."""
    info = technique_info(technique)
    known = {p.name for p in info.parameters}
    return {k: v for k, v in settings.items() if k in known} | {"first_sample": 0.5} | _exact(info)


def _exact(info: TechniqueInfo) -> dict[str, Any]:
    """Settings under which only the discretisation is left."""
    exact = {"early_termination": 1.0, "jitter": False}
    names = {p.name for p in info.parameters}
    return {name: value for name, value in exact.items() if name in names}
