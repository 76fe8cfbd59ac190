"""A scene from the command line: a session, a picture that carries one, or a file with the options of ``render``."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from volviz.commands.drawing import check_look, look_values, parse_values, transfer_function, turned_camera
from volviz.commands.inputs import hints_of, open_input, part_of, source_of
from volviz.commands.layers import asks_for_layers, file_of, layers_of_options, single_channel
from volviz.errors import InputError
from volviz.model.render_spec import DEFAULT_TECHNIQUE

if TYPE_CHECKING:
    from volviz.model.camera import Camera
    from volviz.model.layers import ImageLayer, LabelLayer
    from volviz.model.render_spec import RenderSpec
    from volviz.model.scene import Color, Scene
    from volviz.scene_volumes import SceneVolumes
    from volviz.volume_data.volume import Volume

#: Options that say how a file is shown; a session says that itself.
_LOOKS = (
    "technique",
    "look",
    "preset",
    "transfer_function",
    "values",
    "classic",
    "layers",
    "channel",
    "parallel",
)


def scene_of_options(options: argparse.Namespace, size: tuple[int, int]) -> tuple[Scene, SceneVolumes]:
    """The scene that FILE and the options ask for, and its volumes as far as they have been read.

    Parameters
    ----------
    options : argparse.Namespace
        Of a parser with `add_input` and `add_look_options`.
    size : tuple of 2 ints
        Width and height of the image in pixels.

    Raises
    ------
    VolvizError
        A file that cannot be read, or options that do not go together.
    """
    from volviz.scene_volumes import SceneVolumes, holds_scene, load_scene

    path = None if options.file is None else Path(options.file).expanduser()
    if path is not None and holds_scene(path):
        given = [name for name in _LOOKS if getattr(options, name)]
        if given:
            names = {"values": "set", "layers": "layer"}
            told = ", ".join("--" + names.get(name, name).replace("_", "-") for name in given)
            raise InputError(f"{options.file}: a session says how it is shown; leave out {told}.")
        return load_scene(path), SceneVolumes()
    return _scene_of_file(options, size)


def scene_of_spec(
    options: argparse.Namespace, spec: RenderSpec, camera: Camera, background: Color | None = None
) -> Scene:
    """The scene of what the options have drawn: with references to the files in the place of what was read.

    Parameters
    ----------
    options : argparse.Namespace
        Of a parser with `add_input`, after `single_channel` where one layer is drawn.
    spec : RenderSpec
        What is drawn: the layers that FILE, ``--channel`` and ``--layer`` name.
    camera : Camera
    background : tuple of 3 floats, optional
    """
    from volviz.custom_gl.registry import technique
    from volviz.model.scene import Scene, SceneView
    from volviz.volume_data.references import reference_to
    from volviz.volume_data.volume import Volume

    hints = {name: hint for name, hint in hints_of(options).items() if name not in ("time", "channel")}
    others = [reference_to(file_of(text), {}) for text in options.layers]
    refs = [reference_to(source_of(options), hints)] * (len(spec.layers) - len(others)) + others
    layers = []
    for layer, ref in zip(spec.layers, refs, strict=True):
        part = {} if not isinstance(layer.volume, Volume) else part_of(options)
        if isinstance(part.get("channel"), str):
            part["channel"] = open_input(options).channel_number(part["channel"])
        layers.append(replace(layer, volume=ref, **part))
    info = technique(spec.technique)
    faces = info.facing is not None and info.facing(spec.settings) is not None
    view = SceneView(info.id, camera=camera, own_camera=faces)
    return Scene(
        tuple(layers),
        light=spec.light,
        clipping=spec.clipping,
        background=background,
        views=(view.with_settings(info.id, spec.settings),),
    )


def _scene_of_file(options: argparse.Namespace, size: tuple[int, int]) -> tuple[Scene, SceneVolumes]:
    from volviz.custom_gl.arguments import spec_of
    from volviz.custom_gl.registry import technique
    from volviz.scene_volumes import SceneVolumes

    if not options.zoom > 0:
        raise InputError(f"--zoom takes a factor greater than 0, got {options.zoom:g}.")
    if options.look is not None:
        check_look(options)
    # sources give the same volumes again as long as these are held
    layers, volumes = zip(*_layers(options), strict=True)
    if options.look is None:
        info = technique(options.technique or DEFAULT_TECHNIQUE)
        spec = spec_of(layers, info.id, classic=options.classic, **parse_values(info, options.values))
    else:
        info, values = look_values(options, volumes[0])
        spec = spec_of(layers, None, **values)
    # as volviz render draws it
    scene = scene_of_spec(options, spec, turned_camera(spec, size, options), (0.0, 0.0, 0.0))
    known = {layer.key: volume for layer, volume in zip(scene.layers, volumes, strict=True)}
    return scene, SceneVolumes(known)


def _layers(options: argparse.Namespace) -> list[tuple[ImageLayer | LabelLayer, Volume]]:
    """What FILE, ``--channel`` and ``--layer`` name, and the values of each."""
    from volviz.model.layers import ImageLayer, volume_of

    if asks_for_layers(options):
        return [(layer, volume_of(layer)) for layer in layers_of_options(options, transfer_function)]
    single_channel(options)
    source, part = open_input(options), part_of(options)
    if "channel" in part:
        part["channel"] = source.channel_number(part["channel"])
    layer = ImageLayer(source, **part)
    volume = volume_of(layer)
    return [(replace(layer, transfer_function=transfer_function(options, volume)), volume)]
