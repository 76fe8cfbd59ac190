"""How quickly pictures converge: error against a converged picture over step, or over bisections.

Pictures are compared as 32-bit floats, without early termination and without jitter, so that only the discretisation
is seen. An order of convergence is the slope of a straight line through the points in a log-log plot (least squares):
2 for the midpoint rule on continuous transfer functions, 1 where samples lie at the ends of their segments or the
function jumps (Etiene et al. 2014).
"""

from __future__ import annotations

import math
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.compare.samples import ray_samples
from volviz.compare.stage import Stage, View
from volviz.custom_gl.registry import technique as technique_info
from volviz.custom_gl.technique import TechniqueInfo
from volviz.errors import InputError

#: Steps that are tried, in voxels of the smallest spacing, and the one of the converged picture.
STEPS = (2.0, 1.4, 1.0, 0.7, 0.5, 0.35)
REFERENCE_STEP = 0.05
#: Bisections that are tried, and those of the converged picture.
BISECTIONS = (0, 1, 2, 3, 4, 5)
REFERENCE_BISECTIONS = 14
#: Techniques whose pictures are compared with the integral along the ray to which our ray caster converges. VTK's on
#: the processor has no limit of its own: its numbers of 15 bits lose more with every shorter step.
ONE_INTEGRAL = ("raycast", "two_pass_raycast", "slicing", "vtk_fixed_point")
#: These are compared with their own picture at the finest step: VTK's on the graphics card cannot be kept from ending
#: rays early, so that its limit is another one, and its isosurface is lit in its own way.
OWN_LIMIT = ("vtk_gpu", "vtk_isosurface")
#: Largest picture that is drawn for it.
MOST_PIXELS = 320 * 240
#: Errors below this, in levels of 0..255, are rounding of 32-bit floats over many samples, not discretisation.
ROUNDING = 2e-3


@dataclass(frozen=True)
class Convergence:
    """Errors of one technique over one setting.

    Attributes
    ----------
    name, technique : str
        Side of the comparison, and id of its technique.
    parameter : {"step", "bisections"}
        What is varied.
    values : tuple of floats
        Its values, coarsest first.
    distances : tuple of floats
        What the errors are plotted over, in voxels of the smallest spacing: distance of the samples, or for
        bisections the length within which the surface is known.
    errors, max_errors : tuple of floats
        Root of the mean squared difference, and largest difference, in levels of 0..255.
    slope : float
        Fitted order of convergence; NaN with fewer than two errors above rounding.
    fitted : tuple of 2 floats
        Factor c and exponent p of the fitted line c * distance^p.
    reference : str
        Which picture was taken as converged.
    offset : float or None
        How far that picture is from the one to which our ray caster converges, in levels (RMS); None where it
        is that picture, or where our ray caster shows something else.
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


def fitted_line(distances: Sequence[float], errors: Sequence[float]) -> tuple[float, float]:
    """Factor c and exponent p of c * distance^p through the points, least squares of the logarithms.

    Points at or below `ROUNDING` are left out; (NaN, NaN) with fewer than two others.
    """
    points = [(math.log(d), math.log(e)) for d, e in zip(distances, errors, strict=True) if e > ROUNDING]
    if len(points) < 2:
        return math.nan, math.nan
    x, y = np.array(points).T
    slope, offset = np.polyfit(x, y, 1)
    return math.exp(float(offset)), float(slope)


class ConvergenceRun:
    """Draws one technique at several steps and compares with the converged picture.

    Parameters
    ----------
    view : View
        What is shown; pictures larger than 320 x 240 pixels are made smaller in proportion.
    name, technique : str
        Name for the result, and id of the technique.
    settings : mapping, optional
        Settings that differ from the defaults.
    values : sequence of floats, optional
        Steps, or bisections for a technique that has them.
    reference_value : float, optional
        The value of the converged picture.

    Raises
    ------
    InputError
        The technique has neither steps nor bisections.
    """

    def __init__(
        self,
        view: View,
        name: str,
        technique: str,
        settings: Mapping[str, Any] | None = None,
        values: Sequence[float] | None = None,
        reference_value: float | None = None,
    ) -> None:
        self._info = technique_info(technique)
        self._parameter = converging_parameter(self._info)
        if self._parameter is None:
            raise InputError(
                f"{technique} has neither a step nor bisections that its picture converges with."
            )
        self._view = smaller(view)
        self._name = name
        self._settings = dict(settings or {}) | _exact(self._info)
        stepped = self._parameter == "step"
        self._values = tuple(values or (STEPS if stepped else BISECTIONS))
        self._best = reference_value or (REFERENCE_STEP if stepped else REFERENCE_BISECTIONS)
        self.result: Convergence | None = None

    def steps(self) -> Generator[float, None, None]:
        """Draw; gives the finished fraction, 0..1, after every picture. `result` stands at the end."""
        settings = {key: value for key, value in self._settings.items() if key != "slices"}
        total = len(self._values) + 1
        truth, words = self._converged(settings)
        offset = self._offset(truth)
        yield 1 / total
        distances, errors, largest = [], [], []
        with Stage(self._view, self._info.id, settings | {self._parameter: self._values[0]}) as stage:
            for done, value in enumerate(self._values, 2):
                stage.update(**{str(self._parameter): value})
                difference = 255.0 * np.abs(stage.picture("float32").astype(np.float64) - truth)
                distances.append(self._distance(stage.settings))
                errors.append(float(np.sqrt(np.mean(difference**2))))
                largest.append(float(difference.max()))
                yield done / total
        factor, slope = fitted_line(distances, errors)
        self.result = Convergence(
            self._name, self._info.id, str(self._parameter), tuple(float(v) for v in self._values),
            tuple(distances), tuple(errors), tuple(largest), slope, (factor, slope), words, offset,
        )  # fmt: skip

    def _converged(self, settings: Mapping[str, Any]) -> tuple[npt.NDArray[np.float64], str]:
        technique, given = self._info.id, dict(settings)
        if technique in ONE_INTEGRAL:
            # slices are limited in number; the integral is the same
            technique, given = "raycast", self._as_raycast(given)
        given[str(self._parameter)] = self._best
        return self._picture(technique, given), f"{technique} with {self._parameter} = {self._best:g}"

    def _offset(self, truth: npt.NDArray[np.float64]) -> float | None:
        """Distance of VTK's limit from ours."""
        if "raycast" not in self._info.counterpart_of or self._info.id not in OWN_LIMIT:
            return None
        given = self._as_raycast(self._settings) | {"step": self._best}
        difference = 255.0 * (truth - self._picture("raycast", given))
        return float(np.sqrt(np.mean(difference**2)))

    def _as_raycast(self, settings: Mapping[str, Any]) -> dict[str, Any]:
        info = technique_info("raycast")
        known = {p.name for p in info.parameters}
        return {k: v for k, v in settings.items() if k in known} | {"first_sample": 0.5} | _exact(info)

    def _picture(self, technique: str, settings: Mapping[str, Any]) -> npt.NDArray[np.float64]:
        with Stage(self._view, technique, settings) as stage:
            return np.asarray(stage.picture("float32"), np.float64)

    def _distance(self, settings: Any) -> float:
        """What the error is plotted over, in voxels."""
        if self._parameter == "bisections":
            return float(settings.step) / 2.0 ** int(settings.bisections)
        samples = ray_samples(
            self._view.volume,
            self._view.camera,
            self._view.size,
            self._info.id,
            settings,
            self._view.clipping,
        )
        if samples is None:
            return float(settings.step)
        return samples.distance / min(self._view.volume.spacing)


def converging_parameter(info: TechniqueInfo) -> str | None:
    """The setting whose refinement makes the pictures of a technique converge; None when it has none."""
    names = [p.name for p in info.parameters]
    if "bisections" in names:
        return "bisections"
    # half-angle slicing compares with nothing: light and picture are refined by different settings
    return "step" if "step" in names and info.id in ONE_INTEGRAL + OWN_LIMIT else None


def smaller(view: View) -> View:
    """The view with at most 320 x 240 pixels, of the same proportions."""
    width, height = view.size
    factor = math.sqrt(MOST_PIXELS / (width * height))
    if factor >= 1:
        return view
    return replace(view, size=(max(round(width * factor), 1), max(round(height * factor), 1)))


def _exact(info: TechniqueInfo) -> dict[str, Any]:
    """Settings under which only the discretisation is left."""
    exact = {"early_termination": 1.0, "jitter": False}
    names = {p.name for p in info.parameters}
    return {name: value for name, value in exact.items() if name in names}
