"""What is drawn, from where and how large: options and values that all commands that draw share."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from volviz.commands.layers import asks_for_layers
from volviz.errors import InputError
from volviz.model.render_spec import DEFAULT_TECHNIQUE

if TYPE_CHECKING:
    from volviz.custom_gl.technique import TechniqueInfo
    from volviz.model.camera import Camera
    from volviz.model.layers import ImageLayer
    from volviz.model.render_spec import RenderSpec
    from volviz.model.transfer.function import TransferFunction
    from volviz.volume_data.volume import Volume


def add_look_options(parser: argparse.ArgumentParser) -> None:
    """What is drawn, from where and how large: for all that draws."""
    parser.add_argument(
        "-t", "--technique", metavar="ID", help=f"see volviz techniques (default {DEFAULT_TECHNIQUE})"
    )
    parser.add_argument(
        "--look",
        metavar="NAME",
        help='technique, function and light that suit the data: "best", or one that volviz looks FILE lists',
    )
    parser.add_argument("--preset", metavar="NAME", help="transfer function, see volviz presets")
    parser.add_argument(
        "--transfer-function", metavar="FILE", help="transfer function from a file (JSON, .vp, .dat)"
    )
    parser.add_argument("--size", default="800x600", metavar="WxH", help="in pixels (default 800x600)")
    parser.add_argument(
        "--azimuth", type=float, default=0.0, metavar="DEG", help="turn about the upright axis"
    )
    parser.add_argument("--elevation", type=float, default=0.0, metavar="DEG", help="turn above the horizon")
    parser.add_argument("--zoom", type=float, default=1.0, metavar="FACTOR", help="above 1 comes nearer")
    parser.add_argument("--parallel", action="store_true", help="parallel projection")
    parser.add_argument(
        "--background", default="black", metavar="COLOUR", help='name, #rrggbb or "none" for transparency'
    )
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="values",
                        help="a setting of technique, light, crop box or clip planes; can be repeated")  # fmt: skip
    parser.add_argument("--classic", action="store_true", help="values of the well-known teaching programs")


def check_look(options: argparse.Namespace, given: Mapping[str, Any] = MappingProxyType({})) -> None:
    """Refuse what does not go with ``--look``: other ways to say what a look says, and those given by name."""
    given = {
        "-t": options.technique, "--classic": options.classic,
        "--layer or --channel with a look": asks_for_layers(options), **given,
    }  # fmt: skip
    for name, value in given.items():
        if value:
            raise InputError(f"--look brings technique and settings; leave out {name}, or --look.")


def look_values(options: argparse.Namespace, volume: Volume) -> tuple[TechniqueInfo, dict[str, Any]]:
    """Technique and keywords of the look that the options name, with the settings that they give."""
    from volviz.custom_gl.registry import technique
    from volviz.model.looks.choice import look_named

    look = look_named(volume, options.look)
    info = technique(look.technique)
    return info, {"look": look, **parse_values(info, options.values)}


def turned_camera(spec: RenderSpec, size: tuple[int, int], options: argparse.Namespace) -> Camera:
    """The camera that the options ask for, around what is visible."""
    from volviz.custom_gl.resolve import resolve

    camera = resolve(spec).framing_camera(
        size, options.azimuth, options.elevation, stacks_from_faces=options.look is not None
    )
    return replace(
        camera,
        view_angle=max(min(camera.view_angle / options.zoom, 170.0), 1.0),
        parallel=options.parallel or camera.parallel,
        parallel_scale=camera.parallel_scale and camera.parallel_scale / options.zoom,
    )


def parse_size(text: str) -> tuple[int, int]:
    """Width and height from "1200x900"."""
    from volviz.custom_gl.offscreen import checked_size

    try:
        width, height = (int(part) for part in text.lower().replace(",", "x").split("x"))
    except ValueError:
        raise InputError(f"--size takes width and height such as 1200x900, got {text!r}.") from None
    return checked_size((width, height))


def parse_values(info: TechniqueInfo, texts: Iterable[str], *, lenient: bool = False) -> dict[str, Any]:
    """Settings from ``name=value`` texts.

    Parameters
    ----------
    info : TechniqueInfo
        Whose settings are meant; shared ones (light, crop, clip planes) are known as well.
    texts : iterable of str
        ``name=value`` each.
    lenient : bool
        Leave out names that this technique does not have, as for all techniques at once.
    """
    from volviz.custom_gl.settings import SharedSettings
    from volviz.model.parameters import parameters_of, unknown_setting

    known = {p.name: p for p in (*info.parameters, *parameters_of(SharedSettings))}
    values: dict[str, Any] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals:
            raise InputError(f"--set takes NAME=VALUE, got {text!r}.")
        name = name.strip()
        if name in known:
            values[name] = known[name].parse(value)
        elif not lenient:
            raise InputError(unknown_setting(info.id, name, list(known)))
    return values


def image_layer(options: argparse.Namespace, volume: Volume) -> ImageLayer:
    """A volume with the function that the options name."""
    from volviz.model.layers import ImageLayer

    return ImageLayer(volume, transfer_function(options, volume))


def transfer_function(options: argparse.Namespace, volume: Volume) -> TransferFunction | None:
    """The function that the options name, fitted to the volume; None = automatic."""
    if options.preset and options.transfer_function:
        raise InputError("give either --preset or --transfer-function, not both.")
    if options.preset:
        from volviz.model.transfer.presets import preset_for

        return preset_for(options.preset, volume)
    if options.transfer_function:
        from volviz.model.transfer.formats import read_transfer_function

        return read_transfer_function(Path(options.transfer_function))
    return None
