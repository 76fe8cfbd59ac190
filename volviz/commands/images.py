"""``volviz render``: images into files."""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from volviz.commands.inputs import add_input, load_input
from volviz.commands.layers import (
    add_layer_option,
    asks_for_layers,
    layers_of_options,
    single_channel,
)
from volviz.commands.slices import add_plane_options, asks_for_slice, plane_values, slicing_technique
from volviz.errors import InputError, VolvizError
from volviz.model.render_spec import DEFAULT_TECHNIQUE

if TYPE_CHECKING:
    from volviz.custom_gl.technique import TechniqueInfo
    from volviz.model.camera import Camera
    from volviz.model.layers import ImageLayer, LabelLayer
    from volviz.model.render_spec import RenderSpec
    from volviz.model.transfer.function import TransferFunction
    from volviz.volume_data.brick_cache.cache import BrickStatus
    from volviz.volume_data.volume import Volume

IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp", ".bmp")
#: These hold no transparency.
OPAQUE_SUFFIXES = (".jpg", ".jpeg", ".bmp")


def add_commands(commands: Any) -> None:
    """Add ``render``."""
    parser = commands.add_parser(
        "render",
        help="draw a volume into a picture file",
        description="Draws a volume off-screen into a file.",
    )
    add_input(parser, optional=True, several_channels=True)
    add_layer_option(parser)
    parser.add_argument("-o", "--output", required=True, metavar="FILE", help="picture (.png, .tif, ...) or .npy;"
                        " a folder with --all-techniques")  # fmt: skip
    parser.add_argument(
        "-t", "--technique", metavar="ID", help=f"see volviz techniques (default {DEFAULT_TECHNIQUE})"
    )
    parser.add_argument(
        "--all-techniques", action="store_true", help="draw with every technique into a folder"
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
    parser.add_argument("--report", metavar="FILE.json",
                        help="write which level and bricks of a large volume the picture shows")  # fmt: skip
    add_plane_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Draw one image, or one with every technique."""
    from volviz.custom_gl.registry import technique, techniques

    size = parse_size(options.size)
    output = Path(options.output).expanduser()
    if options.look is not None:
        draw_look(options, size, output)
        return 0
    if asks_for_layers(options):
        draw_layers(options, size, output)
        return 0
    single_channel(options)
    if not options.all_techniques:
        chosen = slicing_technique(options.technique) if asks_for_slice(options) else options.technique
        info = technique(chosen or DEFAULT_TECHNIQUE)
        values = parse_values(info, options.values)
        check_output(output)
        volume = _loaded(options)
        if asks_for_slice(options):
            values |= plane_values(options, volume, info)
        draw([image_layer(options, volume)], info, values, size, options, output)
        return 0
    if asks_for_slice(options) or options.technique is not None:
        raise InputError(
            "--all-techniques draws with every technique; leave out -t, --plane, --at and --slab."
        )
    volume = _loaded(options)
    layer = image_layer(options, volume)
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{output}: the folder cannot be made ({error.strerror}); choose another one."
        ) from None
    for info in techniques().values():
        if not info.counterpart_of:
            values = parse_values(info, options.values, lenient=True)
            draw([layer], info, values, size, options, output / f"{info.id}.png")
    return 0


def _loaded(options: argparse.Namespace) -> Volume:
    """The volume, and what there is to say of it: which level was chosen, say."""
    volume = load_input(options)
    for note in volume.metadata.get("notes", ()):
        print(f"note: {note}")
    return volume


def draw_look(options: argparse.Namespace, size: tuple[int, int], output: Path) -> None:
    """Draw a volume as one of its looks shows it."""
    from volviz.custom_gl.registry import technique
    from volviz.model.looks.choice import look_named

    given = {
        "-t": options.technique, "--classic": options.classic, "--all-techniques": options.all_techniques,
        "--layer or --channel with a look": asks_for_layers(options), "--plane": asks_for_slice(options),
    }  # fmt: skip
    for name, value in given.items():
        if value:
            raise InputError(f"--look brings technique and settings; leave out {name}, or --look.")
    single_channel(options)
    check_output(output)
    volume = _loaded(options)
    look = look_named(volume, options.look)
    info = technique(look.technique)
    values = {"look": look, **parse_values(info, options.values)}
    draw([image_layer(options, volume)], info, values, size, options, output)


def draw_layers(options: argparse.Namespace, size: tuple[int, int], output: Path) -> None:
    """Draw several layers in one image."""
    from volviz.custom_gl.registry import technique

    if options.all_techniques or asks_for_slice(options):
        raise InputError("--channel with a look and --layer go with neither --all-techniques nor slices.")
    info = technique(options.technique or DEFAULT_TECHNIQUE)
    values = parse_values(info, options.values)
    check_output(output)
    draw(layers_of_options(options, transfer_function), info, values, size, options, output)


def draw(
    layers: Sequence[ImageLayer | LabelLayer],
    info: TechniqueInfo,
    values: dict[str, Any],
    size: tuple[int, int],
    options: argparse.Namespace,
    output: Path,
) -> None:
    """Draw one image and say where it lies and how long it took."""
    from volviz.custom_gl.arguments import spec_of
    from volviz.custom_gl.offscreen import background_color
    from volviz.model.render_spec import View
    from volviz.renderer import Renderer

    if not options.zoom > 0:
        raise InputError(f"--zoom takes a factor greater than 0, got {options.zoom:g}.")
    spec = spec_of(layers, None if "look" in values else info.id, classic=options.classic, **values)
    transparent = options.background.lower() == "none" and output.suffix.lower() not in OPAQUE_SUFFIXES
    background = "black" if options.background.lower() == "none" else options.background
    camera = turned_camera(spec, size, options)
    begin = time.perf_counter()
    with Renderer(size) as renderer:
        view = View(camera, size, None if transparent else background_color(background))
        image = renderer.draw(spec, view, dtype="float32" if output.suffix.lower() == ".npy" else "uint8")
        notice, bricks = renderer.notice, renderer.bricks
    seconds = time.perf_counter() - begin
    save_image(image, output)
    print(f"{output}: {info.label}, {size[0]} x {size[1]}, {seconds:.2f} s")
    if notice:
        print(f"note: {notice}")
    if options.report:
        write_report(Path(options.report).expanduser(), layers, bricks, seconds)


def write_report(
    output: Path, layers: Sequence[ImageLayer | LabelLayer], bricks: BrickStatus | None, seconds: float
) -> None:
    """Write what of the data a picture shows: levels, bricks, bytes.

    Raises
    ------
    VolvizError
        The file cannot be written.
    """
    from volviz.model.layers import volume_of
    from volviz.volume_data.finer_levels import levels_behind

    volume = volume_of(layers[0])
    finer = levels_behind(volume)
    levels = (
        [volume.dimensions]
        if finer is None
        else [each.dimensions for each in finer.levels[: finer.stored_count]]
    )
    report: dict[str, Any] = {
        "levels": [list(dimensions) for dimensions in levels],
        "level_in_memory": 0 if finer is None else finer.held_level,
        "level": finer.held_level if finer is not None and bricks is None else 0,
        "bytes_in_memory": int(volume.array.nbytes),
        "bricks": None,
        "seconds": seconds,
    }
    if bricks is not None:
        report["level"] = bricks.level
        report["bricks"] = {
            "needed": bricks.needed, "present": bricks.present, "failed": bricks.failed,
            "bytes": bricks.held_bytes, "complete": bricks.is_complete, "limited_by_budget": bricks.limited,
        }  # fmt: skip
    try:
        output.write_text(json.dumps(report, indent=1), encoding="utf-8")
    except OSError as error:
        raise VolvizError(f"{output}: the report cannot be written ({error.strerror or error}).") from None


def turned_camera(spec: RenderSpec, size: tuple[int, int], options: argparse.Namespace) -> Camera:
    """The camera that the options ask for, around what is visible."""
    from volviz.custom_gl.framing import default_camera, layers_camera
    from volviz.custom_gl.resolve import resolve

    shown = resolve(spec)
    facing = shown.info.facing(shown.settings) if shown.info.facing is not None else None
    if facing is not None:
        camera = default_camera(shown.volume, size, options.azimuth, options.elevation, facing=facing)
    else:
        camera = layers_camera(shown.seen, size, options.azimuth, options.elevation)
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


def check_output(output: Path) -> None:
    """Refuse what cannot be written before minutes are spent on drawing it."""
    if output.suffix.lower() not in (*IMAGE_SUFFIXES, ".npy"):
        raise InputError(
            f"{output}: pictures end in {', '.join((*IMAGE_SUFFIXES, '.npy'))}; give -o such a name."
        )
    if not output.absolute().parent.is_dir():
        raise InputError(f"{output}: there is no folder {output.absolute().parent}; make it first.")


def save_image(image: Any, output: Path) -> None:
    """Write an image of shape (H, W, 4), uint8, or any array as .npy."""
    try:
        if output.suffix.lower() == ".npy":
            import numpy as np

            with output.open("wb") as file:
                np.save(file, image)
            return
        from PIL import Image

        converted = Image.fromarray(image)
        if output.suffix.lower() in OPAQUE_SUFFIXES:
            converted = converted.convert("RGB")
        converted.save(output)
    except OSError as error:
        raise VolvizError(f"{output}: the picture cannot be written ({error.strerror or error}).") from None
