"""What a comparison found, as plain values: what reports are written from."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from volviz.compare.image_metrics import Difference, ImageMetrics
from volviz.compare.samples import RaySamples
from volviz.compare.surface_distance import SurfaceDistance
from volviz.compare.timing import FrameTimes, ratio
from volviz.kernels.mesh_metrics import MeshMetrics

if TYPE_CHECKING:
    from volviz.compare.convergence import Convergence
    from volviz.compare.distance_images import DistanceImages

#: Version of the JSON that `Comparison.to_dict` gives.
SCHEMA = 1


@dataclass(frozen=True)
class SideResult:
    """One technique of a comparison.

    Attributes
    ----------
    name : str
        Unique within the comparison: the technique's id, numbered where it takes part twice.
    technique, label : str
        Its id, and what people call it.
    settings : mapping
        All settings as they were used, as plain data.
    image : ndarray of shape (H, W, 3), uint8
    times : FrameTimes or None
        None where times would say nothing.
    samples : RaySamples or None
        None for techniques that do not go along rays.
    mesh : MeshMetrics or None
        None for techniques that draw no mesh.
    notice : str
        What the image shows differently from what was asked for; mostly empty.
    """

    name: str
    technique: str
    label: str
    settings: Mapping[str, Any]
    image: npt.NDArray[np.uint8]
    times: FrameTimes | None = None
    samples: RaySamples | None = None
    mesh: MeshMetrics | None = None
    notice: str = ""


@dataclass(frozen=True)
class PairResult:
    """Two sides against each other; differences are the second minus the first.

    Attributes
    ----------
    first, second : str
        Names of the sides.
    metrics : ImageMetrics
    difference : Difference
        The absolute difference of luminance, drawn.
    dissimilarity : Difference
        Map of what is lost of structural similarity, drawn.
    differences : tuple of str
        What the two do differently, a sentence each.
    distance : SurfaceDistance or None
        Between the meshes of both.
    distance_images : DistanceImages or None
        Both meshes in the colours of that distance.
    """

    first: str
    second: str
    metrics: ImageMetrics
    difference: Difference
    dissimilarity: Difference
    differences: tuple[str, ...] = ()
    distance: SurfaceDistance | None = None
    distance_images: DistanceImages | None = None


@dataclass(frozen=True)
class Comparison:
    """Everything a report tells.

    Attributes
    ----------
    title : str
    volume, view : mapping of str to plain data
        What was shown, and from where.
    sides, pairs : tuples
        Results in the order of the techniques.
    convergence : tuple of Convergence
        Empty unless asked for.
    without_curve : tuple of str
        Why some of the techniques have no order of convergence, a sentence each.
    transfer_function : mapping
        Plain data of `TransferFunction.to_dict`.
    machine, versions : mapping of str to str
    command : str
        The command that makes the report again.
    remarks : tuple of str
        Sentences on how the figures were made.
    notes : tuple of str
        What is special about figures of this comparison: sides for which there was no time for all frames.
    """

    title: str
    volume: Mapping[str, Any]
    view: Mapping[str, Any]
    sides: tuple[SideResult, ...]
    pairs: tuple[PairResult, ...]
    transfer_function: Mapping[str, Any]
    machine: Mapping[str, str]
    versions: Mapping[str, str]
    convergence: tuple[Convergence, ...] = ()
    without_curve: tuple[str, ...] = ()
    command: str = ""
    remarks: tuple[str, ...] = field(default=())
    notes: tuple[str, ...] = ()

    def side(self, name: str) -> SideResult:
        """The side of that name."""
        return next(side for side in self.sides if side.name == name)

    def to_dict(self) -> dict[str, Any]:
        """All figures as plain data for JSON; images are left out."""
        return {
            "schema": SCHEMA,
            "title": self.title,
            "volume": plain(self.volume),
            "view": plain(self.view),
            "sides": [side_dict(side) for side in self.sides],
            "pairs": [pair_dict(self, pair) for pair in self.pairs],
            "convergence": [plain(dataclasses.asdict(c)) for c in self.convergence],
            "without_curve": list(self.without_curve),
            "transfer_function": plain(self.transfer_function),
            "machine": dict(self.machine),
            "versions": dict(self.versions),
            "remarks": list(self.remarks),
            "notes": list(self.notes),
            "command": self.command,
        }


def side_dict(side: SideResult) -> dict[str, Any]:
    """A side as plain data."""
    return {
        "name": side.name,
        "technique": side.technique,
        "label": side.label,
        "settings": plain(side.settings),
        "times": None if side.times is None else times_dict(side.times),
        "samples_per_ray": None if side.samples is None else plain(dataclasses.asdict(side.samples)),
        "mesh": None if side.mesh is None else plain(dataclasses.asdict(side.mesh)),
        "notice": side.notice,
    }


def times_dict(times: FrameTimes) -> dict[str, Any]:
    """Frame times as plain data, in seconds."""
    low, high = times.quartiles
    data: dict[str, Any] = plain({
        "median": times.median, "quartile_low": low, "quartile_high": high, "spread": times.spread,
        "first": times.first, "frames": list(times.seconds),
        "gpu_median": times.gpu_median, "gpu_frames": list(times.gpu_seconds),
    })  # fmt: skip
    return data


def pair_dict(comparison: Comparison, pair: PairResult) -> dict[str, Any]:
    """A pair as plain data."""
    first, second = comparison.side(pair.first).times, comparison.side(pair.second).times
    timed = first is not None and second is not None and first.seconds and second.seconds
    return {
        "first": pair.first,
        "second": pair.second,
        **plain(dataclasses.asdict(pair.metrics)),
        "difference_limit": pair.difference.limit,
        "time_ratio": plain(dataclasses.asdict(ratio(second, first))) if timed and first and second else None,
        "distance": None if pair.distance is None else plain(dataclasses.asdict(pair.distance)),
        "differences": list(pair.differences),
    }


def plain(value: Any) -> Any:
    """A value as JSON can hold it: infinities and NaN become None, arrays and tuples lists."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (str, bool)) or value is None:
        return value
    if isinstance(value, Sequence):
        return [plain(item) for item in value]
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return float(value) if math.isfinite(value) else None
    return str(value)


def image_pairs(names: Sequence[str], oracles: Sequence[str] = ()) -> list[tuple[str, str]]:
    """Which sides are set against each other.

    All pairs of up to four; of more, everyone against the first and against the oracles.
    """
    pairs = [(a, b) for i, a in enumerate(names) for b in names[i + 1 :]]
    if len(names) <= 4:
        return pairs
    return [(a, b) for a, b in pairs if a == names[0] or a in oracles or b in oracles]
