"""Edits of what is measured and marked in a scene, as functions from scene to scene."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from volviz.model.measurements import COLORS, Measurement
from volviz.model.scene import Scene


def with_measurement(scene: Scene, measurement: Measurement) -> Scene:
    """The scene with one more, in the next colour and with a number in its name where it has none."""
    count = len(scene.measurements)
    if not measurement.name:
        same = {each.name for each in scene.measurements}
        numbers = (f"{measurement.kind.capitalize()} {n}" for n in range(1, count + 2))
        measurement = replace(measurement, name=next(name for name in numbers if name not in same))
    colored = replace(measurement, color=COLORS[count % len(COLORS)])
    return replace(scene, measurements=(*scene.measurements, colored))


def with_measurement_changed(scene: Scene, number: int, **changes: Any) -> Scene:
    """The scene with fields of one of them changed; a locked one keeps its points."""
    found = list(scene.measurements)
    if not 0 <= number < len(found) or (found[number].locked and "points" in changes):
        return scene
    found[number] = replace(found[number], **changes)
    return replace(scene, measurements=tuple(found))


def without_measurements(scene: Scene, numbers: set[int]) -> Scene:
    """The scene without some of them; locked ones stay."""
    kept = (each for n, each in enumerate(scene.measurements) if each.locked or n not in numbers)
    return replace(scene, measurements=tuple(kept))
