"""A comparison from beginning to end: images, times, differences, meshes, convergence, piece by piece."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.compare.convergence import Convergence, ConvergenceRun, study, why_not
from volviz.compare.distance_images import DistanceImages, distance_images
from volviz.compare.distance_map import distance_maps, distance_metrics
from volviz.compare.image_metrics import (
    COLORED_SHARE,
    Difference,
    compare_images,
    difference_image,
    dissimilarity_image,
    ssim_map,
)
from volviz.compare.machine import machine_properties, version_properties
from volviz.compare.matching import MatchedSide, match_sides, settings_differences
from volviz.compare.meshes import Mesh, cleaned, drawn_mesh
from volviz.compare.results import Comparison, PairResult, SideResult, image_pairs
from volviz.compare.samples import ray_samples
from volviz.compare.surface_distance import SurfaceDistance, surface_distance
from volviz.compare.timing import Drawn, FrameTimes, frame_timer
from volviz.custom_gl.framing import default_camera
from volviz.custom_gl.registry import technique
from volviz.custom_gl.resolve import resolve
from volviz.errors import InputError
from volviz.kernels.mesh_metrics import mesh_metrics
from volviz.model.parameters import Parameter, setting_values
from volviz.model.render_spec import RenderSpec, View
from volviz.renderer import Renderer
from volviz.volume_data.volume import Volume

#: Seconds for the frame times of each side.
TIMING_SECONDS = 20.0

REMARKS = (
    (
        "Pictures are drawn off-screen at full quality over the background; figures are of their red, green and blue, "
        "differences in levels of 0 to 255."
    ),
    (
        "Frame times are wall times of complete frames in one process, taken in turn from slightly turned cameras, "
        "the first frame of each side apart: it uploads the data, compiles shaders and extracts meshes."
    ),
    (
        "Samples per ray are computed from the box, the camera and the distance of samples; what is saved by leaving "
        "out empty space and by ending rays early is not taken off."
    ),
)


@dataclass(frozen=True)
class Side:
    """A technique that takes part, with settings that are given for it."""

    technique: str
    values: Mapping[str, Any] = field(default_factory=dict)


class ComparisonRun:
    """Compares techniques on one view; each step of `steps` is an image, a frame or a figure.

    Parameters
    ----------
    spec : RenderSpec
        What all sides show: layers, light and clipping.
    view : View
        From where; without a background the images are compared over black.
    sides : sequence of Side
        At least two.
    frames : int, default: 7
        Measured frames of each side, 0 = no times.
    matched : bool, default: True
        Give VTK's techniques the settings of ours, and ours what VTK's cannot do otherwise.
    convergence : bool, default: False
        Also draw each side at several steps or bisections.
    surface_images : bool, default: True
        Also draw meshes in the colours of their distance to each other.
    distance_limit : float, optional
        Distance of the strongest colour, in world units; the default is the largest one of the pair.
    title, command : str
        For the report.
    patience : float, default: 20.0
        Seconds for the frame times of each side. A slow one is measured in fewer frames, and a note says so.

    Raises
    ------
    InputError
        Fewer than two sides, or settings that do not fit.
    """

    def __init__(
        self,
        spec: RenderSpec,
        view: View,
        sides: Sequence[Side],
        *,
        frames: int = 7,
        matched: bool = True,
        convergence: bool = False,
        surface_images: bool = True,
        distance_limit: float | None = None,
        title: str = "",
        command: str = "",
        patience: float = TIMING_SECONDS,
    ) -> None:
        if len(sides) < 2:
            raise InputError(f"a comparison needs at least two techniques, got {len(sides)}.")
        shown = resolve(replace(spec, technique=sides[0].technique, settings=None))
        camera = view.camera or default_camera(
            shown.volume, view.size, transfer_function=shown.transfer_function
        )
        self._spec, self._volume, self._function = spec, shown.volume, shown.transfer_function
        self._view = replace(view, camera=camera, background=view.background or (0.0, 0.0, 0.0))
        self._sides = match_sides(
            [(side.technique, side.values) for side in sides], matched=matched, light=spec.light
        )
        self._frames = frames
        self._patience = patience
        self._convergence = convergence
        self._surface_images = surface_images
        self._distance_limit = distance_limit
        names = [side.name for side in self._sides]
        self._title = title or f"{', '.join(names[:-1])} and {names[-1]} on {self._volume.name}"
        self._command = command
        self._meshes: dict[str, Mesh] = {}
        self.result: Comparison | None = None

    def steps(self) -> Generator[tuple[float, str], None, None]:
        """Work; gives the finished fraction, 0..1, and what comes next in words. `result` stands at the end.

        Closing the iterator early gives every window back.
        """
        results: dict[str, SideResult] = {}
        opengl = ""
        with ExitStack() as stack:
            drawn: dict[str, Drawn] = {}
            for i, side in enumerate(self._sides):
                yield 0.3 * i / len(self._sides), f"drawing {side.name}"
                made = stack.enter_context(Renderer(self._view.size))
                opengl = opengl or made.opengl
                drawn[side.name] = Drawn.first(made, self._spec_of(side), self._view)
                results[side.name] = self._side_result(side, drawn[side.name])
            times: dict[str, FrameTimes] = {}
            # an oracle has all the time in the world
            timed = {
                name: each for name, each in drawn.items() if not technique(each.spec.technique).is_oracle
            }
            if self._frames and timed:
                timer = frame_timer(timed, self._frames, patience=self._patience)
                for fraction in timer.steps():
                    yield 0.3 + 0.3 * fraction, "taking frame times"
                times = timer.times
        for side in self._sides:
            yield 0.6, f"measuring the mesh of {side.name}"
            results[side.name] = self._with_metrics(results[side.name], times.get(side.name))
        pairs = []
        for first, second in image_pairs(
            list(results), [s.name for s in self._sides if technique(s.technique).is_oracle]
        ):
            yield 0.7, f"comparing {first} and {second}"
            pairs.append(self._pair(results[first], results[second]))
        orders: list[Convergence] = []
        if self._convergence:
            for fraction, words in self._converge(orders):
                yield 0.75 + 0.25 * fraction, words
        self.result = self._comparison(tuple(results.values()), tuple(pairs), tuple(orders), opengl)
        yield 1.0, "done"

    def _time_given(self) -> tuple[str, ...]:
        """A sentence on how long times were taken."""
        if not self._frames:
            return ()
        words = f"as many as {self._patience:.3g} s allow, one at least."
        return (f"Up to {self._frames} frames of each side are measured: {words}",)

    def _hurried(self, sides: Sequence[SideResult]) -> tuple[str, ...]:
        """Sentences on the sides that were too slow for all frames."""
        return tuple(
            f"{side.name} takes {times.median:.3g} s a frame: "
            f"{len(times.seconds)} of {self._frames} frames {'was' if len(times.seconds) == 1 else 'were'} measured, "
            f"since {self._patience:.3g} s are given to the frame times of each side."
            for side in sides
            if (times := side.times) is not None and 0 < len(times.seconds) < self._frames
        )

    def _spec_of(self, side: MatchedSide) -> RenderSpec:
        """What a side draws."""
        return self._spec.drawn_by(side.technique, side.settings)

    def _side_result(self, side: MatchedSide, drawn: Drawn) -> SideResult:
        info = technique(side.technique)
        values = setting_values(side.settings)
        settings = {p.name: shown_value(p, values[p.name]) for p in info.parameters}
        image = drawn.renderer.draw(drawn.spec, self._view)[..., :3]
        return SideResult(
            side.name, side.technique, info.label, settings, image,
            samples=ray_samples(drawn.spec, self._view), notice=drawn.renderer.notice,
        )  # fmt: skip

    def _with_metrics(self, side: SideResult, times: FrameTimes | None) -> SideResult:
        mesh = drawn_mesh(self._volume, side.technique, side.settings)
        if mesh is not None:
            self._meshes[side.name] = mesh
        return replace(side, times=times, mesh=None if mesh is None else mesh_metrics(*cleaned(mesh)))

    def _pair(self, first: SideResult, second: SideResult) -> PairResult:
        words = settings_differences(first, second)
        for side in (first, second):
            other = second if side is first else first
            words += [s for s in self._matched(side.name).differences.get(other.name, ()) if s not in words]
        distance, images = self._distance(first.name, second.name)
        return PairResult(
            first.name,
            second.name,
            compare_images(first.image, second.image),
            _shown_difference(first.image, second.image),
            dissimilarity_image(ssim_map(first.image, second.image)),
            tuple(words),
            distance,
            images,
        )

    def _matched(self, name: str) -> MatchedSide:
        return next(side for side in self._sides if side.name == name)

    def _distance(self, first: str, second: str) -> tuple[SurfaceDistance | None, DistanceImages | None]:
        """How far two meshes lie apart, and images of it where they are wanted."""
        a, b = self._meshes.get(first), self._meshes.get(second)
        if a is None or b is None or not len(a[1]) or not len(b[1]):
            return None, None
        if not self._surface_images:
            return surface_distance(cleaned(a), cleaned(b)), None
        maps = distance_maps(a, b)
        one, other = self._matched(first), self._matched(second)
        specs = (self._spec_of(one), self._spec_of(other))
        return distance_metrics(maps), distance_images(specs, self._view, maps, self._distance_limit)

    def _converge(self, found: list[Convergence]) -> Iterator[tuple[float, str]]:
        able = [s for s in self._sides if study(technique(s.technique), self._volume) is not None]
        for i, side in enumerate(able):
            words = f"drawing for the convergence of {side.name}"
            yield i / len(able), words
            run = ConvergenceRun(self._spec, self._view, side.name, side.technique, side.own_values)
            for fraction in run.steps():
                yield (i + fraction) / len(able), words
            if run.result is not None:
                found.append(run.result)

    def _without_curve(self) -> tuple[str, ...]:
        """Sentences on the techniques that have no order of convergence; nobody is left out silently."""
        infos = [technique(ident) for ident in dict.fromkeys(side.technique for side in self._sides)]
        if not self._convergence:
            return ()
        return tuple(why_not(info) for info in infos if study(info, self._volume) is None)

    def _comparison(
        self,
        sides: tuple[SideResult, ...],
        pairs: tuple[PairResult, ...],
        orders: tuple[Convergence, ...],
        renderer: str,
    ) -> Comparison:
        return Comparison(
            title=self._title,
            volume=volume_properties(self._volume),
            view=view_properties(self._spec, self._view),
            sides=sides,
            pairs=pairs,
            transfer_function=self._function.to_dict(),
            machine=machine_properties(renderer),
            versions=version_properties(),
            convergence=orders,
            without_curve=self._without_curve(),
            command=self._command,
            remarks=REMARKS + self._time_given(),
            notes=self._hurried(sides),
        )


def _shown_difference(first: npt.NDArray[np.uint8], second: npt.NDArray[np.uint8]) -> Difference:
    """The absolute difference in colours that one pixel in a thousand goes beyond: a single one dims nothing."""
    whole = difference_image(first, second)
    limit = max(float(np.quantile(whole.values, COLORED_SHARE)), 1.0)
    return whole if limit >= whole.limit else difference_image(first, second, limit=limit)


def shown_value(parameter: Parameter, value: Any) -> Any:
    """A setting as reports show it: files by their names alone, since folders are nobody's business."""
    return Path(value).name if parameter.kind == "path" and value else value


def compare(spec: RenderSpec, view: View, sides: Sequence[Side], **options: Any) -> Comparison:
    """Compare techniques on one view at once; see `ComparisonRun` for the options."""
    run = ComparisonRun(spec, view, sides, **options)
    for _ in run.steps():
        pass
    assert run.result is not None
    return run.result


def volume_properties(volume: Volume) -> dict[str, Any]:
    """What a volume is, without where it lies."""
    return {
        "name": volume.name,
        "dimensions": volume.dimensions,
        "dtype": str(volume.array.dtype),
        "spacing": volume.spacing,
        "range": volume.range,
        "unit": volume.unit,
        "length_unit": str(volume.metadata.get("length_unit", "")),
    }


def view_properties(spec: RenderSpec, view: View) -> dict[str, Any]:
    """Camera, size, light and clipping as plain data."""
    camera, light = view.camera, spec.light
    assert camera is not None
    return {
        "size": view.size,
        "position": camera.position,
        "focal_point": camera.focal_point,
        "view_up": camera.view_up,
        "view_angle": camera.view_angle,
        "parallel": camera.parallel,
        "background": view.background,
        "headlight": light.headlight,
        "light_beside_eye": light.beside_eye,
        "light_position": None if light.headlight or light.beside_eye else light.position,
        "light_color": light.color,
        "crop": spec.clipping.crop,
        "clip_planes": spec.clipping.planes,
    }
