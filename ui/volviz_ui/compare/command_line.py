"""The views of the window as arguments of ``volviz compare``: what makes a report can make it again. No Qt."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from volviz.custom_gl.scene_techniques import current_technique, settings_at_cursor
from volviz.model.camera import Camera
from volviz.model.layers import ImageLayer
from volviz.model.light import Light
from volviz.model.parameters import setting_values, value_text
from volviz.model.scene import Scene


def compare_arguments(
    scene: Scene, size: tuple[int, int], function_file: str, output: str, options: tuple[str, ...] = ()
) -> list[str]:
    """Arguments that follow ``volviz``.

    Parameters
    ----------
    scene : Scene
        With a layer, at least two views and a camera.
    size : tuple of 2 ints
        Width and height of the images.
    function_file : str
        A file that holds the transfer function.
    output : str
        The report.
    options : tuple of str
        Further ones, such as ``--convergence``.
    """
    layer, camera = scene.layer, scene.view.camera
    if layer is None or camera is None:
        raise ValueError("a scene without volume or camera shows nothing to report on")
    words = ["compare", layer.volume.source, *input_words(layer)]
    for view in range(len(scene.views)):
        info, settings = current_technique(scene, view), settings_at_cursor(scene, view)
        parts = [info.id]
        values = setting_values(settings)
        parts += [
            f"{p.name}={value_text(values[p.name])}" for p in info.parameters if values[p.name] != p.default
        ]
        words += ["-t", ":".join(parts)]
    for text in shared_texts(scene):
        words += ["--set", text]
    words += [
        f"--transfer-function={function_file}",
        f"--size={size[0]}x{size[1]}",
        *camera_words(camera),
        "--unmatched",
        *options,
    ]
    if scene.background is not None:
        words.append(
            "--background=#" + "".join(f"{round(255 * channel):02x}" for channel in scene.background)
        )
    return [*words, "-o", output]


def shared_texts(scene: Scene) -> list[str]:
    """Light, crop box and clip planes as ``name=value``."""
    light, clipping = scene.light, scene.clipping
    values: dict[str, Any] = {}
    if light.beside_eye:
        values["light_beside_eye"] = True
    elif light.position is not None:
        values["light_position"] = light.position
    values["headlight"] = light.headlight
    if light.color != Light().color:
        values["light_color"] = light.color
    if clipping.crop is not None:
        values["crop"] = clipping.crop
    if clipping.planes:
        values["clip_planes"] = clipping.planes
    return [f"{name}={value_text(value)}" for name, value in values.items()]


def camera_words(camera: Camera) -> list[str]:
    """The camera; a parallel one stands where its scale follows from the angle of view."""
    position = camera.position
    if camera.parallel:
        distance = camera.scale / math.tan(math.radians(camera.view_angle) / 2)
        position = tuple(  # type: ignore[assignment]
            f - distance * d for f, d in zip(camera.focal_point, camera.direction, strict=True)
        )
    numbers = value_text((*position, *camera.focal_point, *camera.view_up))
    words = [f"--camera={numbers}", f"--view-angle={camera.view_angle!r}"]
    return [*words, "--parallel"] if camera.parallel else words


def input_words(layer: ImageLayer) -> list[str]:
    """How to read the volume, and which channel and time point of it."""
    words = []
    chosen = (("channel", layer.channel), ("time", layer.time or None))
    for name, value in (*layer.key.ref.hints, *chosen):
        if value is None:
            continue
        text = ",".join(map(str, value)) if isinstance(value, tuple) else str(value)
        words.append(f"--{name}={text}")
    return words


def function_name(output: Path) -> str:
    """Name of the file with the transfer function beside a report, so that its command works again."""
    return f"{output.stem}.transfer-function.json"
