"""A scene from the command line: a session, a picture that carries one, or a file with the options of ``render``."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from volviz.commands.images import check_look, look_values, parse_values, transfer_function, turned_camera
from volviz.commands.inputs import hints_of, open_input, part_of, source_of
from volviz.commands.layers import asks_for_layers, file_of, layers_of_options, single_channel
from volviz.errors import InputError
from volviz.model.render_spec import DEFAULT_TECHNIQUE

if TYPE_CHECKING:
    from volviz.model.layers import ImageLayer, LabelLayer
    from volviz.model.scene import Scene
    from volviz.volume_data.references import VolumeRef

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


def scene_of_options(options: argparse.Namespace, size: tuple[int, int]) -> Scene:
    """The scene that FILE and the options ask for, with a camera.

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
    from volviz.scene_volumes import scene_in

    session = None if options.file is None else scene_in(Path(options.file).expanduser())
    if session is not None:
        given = [name for name in _LOOKS if getattr(options, name)]
        if given:
            names = {"values": "set", "layers": "layer"}
            told = ", ".join("--" + names.get(name, name).replace("_", "-") for name in given)
            raise InputError(f"{options.file}: a session says how it is shown; leave out {told}.")
        return session
    return _scene_of_file(options, size)


def _scene_of_file(options: argparse.Namespace, size: tuple[int, int]) -> Scene:
    from volviz.custom_gl.arguments import spec_of
    from volviz.custom_gl.registry import technique
    from volviz.model.layers import volume_of
    from volviz.model.scene import Scene, SceneView

    if not options.zoom > 0:
        raise InputError(f"--zoom takes a factor greater than 0, got {options.zoom:g}.")
    if options.look is not None:
        check_look(options)
    found = _layers(options)
    layers = [layer for layer, _ in found]
    if options.look is None:
        info = technique(options.technique or DEFAULT_TECHNIQUE)
        spec = spec_of(layers, info.id, classic=options.classic, **parse_values(info, options.values))
    else:
        info, values = look_values(options, volume_of(layers[0]))
        spec = spec_of(layers, None, **values)
        found = [(shown, ref) for shown, (_, ref) in zip(spec.layers, found, strict=True)]
    view = SceneView(info.id, camera=turned_camera(spec, size, options))
    return Scene(
        tuple(replace(layer, volume=ref) for layer, ref in found),
        light=spec.light,
        clipping=spec.clipping,
        views=(view.with_settings(info.id, spec.settings),),
    )


def _layers(options: argparse.Namespace) -> list[tuple[ImageLayer | LabelLayer, VolumeRef]]:
    """What FILE, ``--channel`` and ``--layer`` name, with references to the files."""
    from volviz.model.layers import ImageLayer
    from volviz.volume_data.references import reference_to

    hints = {name: hint for name, hint in hints_of(options).items() if name not in ("time", "channel")}
    own = reference_to(source_of(options), hints)
    if asks_for_layers(options):
        layers = layers_of_options(options, transfer_function)
        others = [reference_to(file_of(text), {}) for text in options.layers]
        refs = [own] * (len(layers) - len(others)) + others
        return list(zip(layers, refs, strict=True))
    single_channel(options)
    source, part = open_input(options), part_of(options)
    if "channel" in part:
        part["channel"] = source.channel_number(part["channel"])
    function = transfer_function(options, source.read(source.default_level, **part))
    return [(ImageLayer(source, function, **part), own)]
