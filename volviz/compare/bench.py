"""Frame times of techniques over volume size, window size and step."""

from __future__ import annotations

import dataclasses
from collections.abc import Generator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

import numpy as np

from volviz.compare.machine import machine_properties, version_properties
from volviz.compare.results import plain, times_dict
from volviz.compare.timing import Drawn, FrameTimes, Ratio, frame_timer, ratio
from volviz.custom_gl.framing import default_camera
from volviz.custom_gl.registry import technique as technique_info
from volviz.errors import InputError
from volviz.model.layers import ImageLayer
from volviz.model.render_spec import RenderSpec, View
from volviz.model.transfer.function import TransferFunction
from volviz.renderer import Renderer
from volviz.volume_data.volume import Volume

#: Version of the JSON.
SCHEMA = 1
#: Voxels along the longest axis that can be asked for.
LEAST_SIZE, MOST_SIZE = 8, 1024
#: Seconds for the frames of one technique in one case: slow ones are measured in fewer frames.
TECHNIQUE_SECONDS = 10.0


@dataclass(frozen=True)
class BenchCase:
    """What is drawn: voxels along the longest axis, window in pixels, step in voxels."""

    size: int
    window: tuple[int, int]
    step: float


@dataclass(frozen=True)
class BenchEntry:
    """Frame times of one technique in one case.

    Attributes
    ----------
    case : BenchCase
    technique : str
    dimensions : tuple of 3 ints
        Voxels along (x, y, z).
    times : FrameTimes
    """

    case: BenchCase
    technique: str
    dimensions: tuple[int, int, int]
    times: FrameTimes


class BenchRun:
    """Times techniques in all combinations of sizes, windows and steps; the sides of a case take turns.

    Parameters
    ----------
    volume : Volume
        Resampled to each of the sizes.
    transfer_function : TransferFunction
    techniques : sequence of str
        Ids; the first one is what the others are compared with where they are nobody's counterpart.
    sizes : sequence of ints
        Voxels along the longest axis, 8..1024.
    windows : sequence of pairs of ints
        Pixels.
    steps : sequence of floats
        In voxels; techniques without a step are measured once.
    frames : int
        Measured frames of each technique in each case; fewer of one that is too slow for all of them in ten seconds.

    Raises
    ------
    InputError
        An empty list or a value out of range.
    """

    def __init__(
        self,
        volume: Volume,
        transfer_function: TransferFunction,
        techniques: Sequence[str],
        sizes: Sequence[int],
        windows: Sequence[tuple[int, int]],
        steps: Sequence[float],
        frames: int = 5,
    ) -> None:
        if not (techniques and sizes and windows and steps):
            raise InputError("a benchmark needs at least one technique, size, window and step.")
        for size in sizes:
            if not LEAST_SIZE <= size <= MOST_SIZE:
                raise InputError(
                    f"sizes of volumes lie between {LEAST_SIZE} and {MOST_SIZE} voxels, got {size}."
                )
        if frames < 1:
            raise InputError(f"at least one frame is measured, got {frames}.")
        for ident in techniques:
            info = technique_info(ident)
            for p in info.parameters:
                if p.name == "step":
                    for step in steps:
                        p.checked(step)
        self._volume = volume
        self._function = transfer_function
        self._techniques = list(dict.fromkeys(techniques))
        self._cases = [BenchCase(n, w, s) for n in sizes for w in windows for s in steps]
        self._first_step = steps[0]
        self.frames = frames
        self._opengl = ""
        self.entries: list[BenchEntry] = []
        self.complete = False

    def steps(self) -> Generator[tuple[float, str], None, None]:
        """Measure; gives the finished fraction, 0..1, and words. `entries` grows case by case.

        Whoever stops keeps what has been measured, the case at hand included.
        """
        volume, size = self._volume, 0
        for number, case in enumerate(self._cases):
            if case.size != size:
                yield number / len(self._cases), f"resampling to {case.size} voxels"
                volume, size = resampled(self._volume, case.size), case.size
            for fraction in self._measure(case, volume):
                width, height = case.window
                words = f"{case.size} voxels, {width} x {height} pixels, step {case.step:g}"
                yield (number + fraction) / len(self._cases), words
        self.complete = True

    def _measure(self, case: BenchCase, volume: Volume) -> Generator[float, None, None]:
        camera = default_camera(volume, case.window, transfer_function=self._function)
        spec, view = RenderSpec((ImageLayer(volume, self._function),)), View(camera, case.window)
        with ExitStack() as stack:
            drawn: dict[str, Drawn] = {}
            for ident in self._techniques:
                info = technique_info(ident)
                stepped = "step" in {p.name for p in info.parameters}
                if not stepped and case.step != self._first_step:
                    continue
                yield 0.0
                renderer = stack.enter_context(Renderer(case.window))
                self._opengl = self._opengl or renderer.opengl
                settings = info.settings(step=case.step) if stepped else None
                drawn[ident] = Drawn.first(renderer, spec.drawn_by(ident, settings), view)
            if not drawn:
                return
            timer = frame_timer(drawn, self.frames, patience=TECHNIQUE_SECONDS)
            try:
                yield from timer.steps()
            finally:
                self.entries += [
                    BenchEntry(case, ident, volume.dimensions, times)
                    for ident, times in timer.times.items()
                    if times.seconds
                ]

    def ratios(self) -> list[tuple[BenchCase, str, str, Ratio]]:
        """For each case: technique, what it is compared with, and how many times as long it takes.

        Counterparts are set against each of ours that they stand for, the others against the first technique.
        """
        found = []
        for case in dict.fromkeys(entry.case for entry in self.entries):
            times = {entry.technique: entry.times for entry in self.entries if entry.case == case}
            first = next(iter(times))
            for ident, own in times.items():
                bases = [b for b in technique_info(ident).counterpart_of if b in times] or [first]
                found += [(case, ident, base, ratio(own, times[base])) for base in bases if base != ident]
        return found

    def to_dict(self, command: str = "") -> dict[str, Any]:
        """Everything measured so far as plain data for JSON; times in seconds."""
        return {
            "schema": SCHEMA,
            "complete": self.complete,
            "volume": self._volume.name,
            "machine": machine_properties(self._opengl),
            "versions": version_properties(),
            "command": command,
            "results": [
                {
                    **_case_dict(entry.case),
                    "dimensions": list(entry.dimensions),
                    "technique": entry.technique,
                    **times_dict(entry.times),
                }
                for entry in self.entries
            ],
            "ratios": [
                {**_case_dict(case), "technique": ident, "base": base, **plain(dataclasses.asdict(found))}
                for case, ident, base, found in self.ratios()
            ],
        }


def resampled(volume: Volume, size: int) -> Volume:
    """The volume with so many voxels along its longest axis, trilinear, over the same box.

    Parameters
    ----------
    volume : Volume
    size : int
        At least 2; the other axes follow in proportion, with at least 2 voxels.
    """
    shape = np.array(volume.array.shape)
    target = np.maximum(np.rint(shape * size / shape.max()).astype(int), 2)
    if np.array_equal(target, shape):
        return volume
    # the outermost voxel centres stay where they are
    axes = [np.linspace(0.0, n - 1.0, m) for n, m in zip(shape, target, strict=True)]
    array = np.nan_to_num(volume.array, nan=volume.range[0]).astype(np.float32)
    for axis, places in enumerate(axes):
        low = np.minimum(places.astype(int), shape[axis] - 2) if shape[axis] > 1 else places.astype(int)
        share = (places - low).astype(np.float32)
        share = share.reshape([-1 if i == axis else 1 for i in range(3)])
        array = (1 - share) * array.take(low, axis) + share * array.take(low + 1, axis)
    spacing = np.array(volume.spacing) * (shape[::-1] - 1) / (target[::-1] - 1)
    if volume.array.dtype.kind in "iu":
        array = np.rint(array)
    return Volume(
        np.ascontiguousarray(array.astype(volume.array.dtype)),
        spacing=tuple(float(s) for s in spacing),
        origin=volume.origin,
        direction=volume.direction,
        unit=volume.unit,
        name=volume.name,
    )


def _case_dict(case: BenchCase) -> dict[str, Any]:
    return {"size": case.size, "window": list(case.window), "step": case.step}
