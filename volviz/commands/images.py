"""``volviz render``: images into files."""

from __future__ import annotations

import argparse
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from volviz.commands.drawing import (
    add_look_options,
    check_look,
    image_layer,
    look_values,
    parse_size,
    parse_values,
    transfer_function,
    turned_camera,
)
from volviz.commands.inputs import add_input, load_input
from volviz.commands.layers import (
    add_layer_option,
    asks_for_layers,
    layers_of_options,
    single_channel,
)
from volviz.commands.picture_report import write_report
from volviz.commands.slices import add_plane_options, asks_for_slice, plane_values, slicing_technique
from volviz.errors import InputError, VolvizError
from volviz.model.picture import SWITCHES, PictureContents
from volviz.model.render_spec import DEFAULT_TECHNIQUE

if TYPE_CHECKING:
    from volviz.annotations.shapes import Shape
    from volviz.custom_gl.technique import TechniqueInfo
    from volviz.model.layers import ImageLayer, LabelLayer
    from volviz.volume_data.volume import Volume

IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp", ".bmp", ".svg", ".pdf")
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
        "--all-techniques", action="store_true", help="draw with every technique into a folder"
    )
    add_look_options(parser)
    add_plane_options(parser)
    add_contents_options(parser)
    parser.add_argument("--report", metavar="FILE.json",
                        help="write which level and bricks of a large volume the picture shows")  # fmt: skip
    parser.set_defaults(run=run)


def add_contents_options(parser: argparse.ArgumentParser) -> None:
    """What belongs into a picture beside the volume."""
    parser.add_argument(
        "--show", default="", metavar="NAMES", help=f"what stands around the volume: {', '.join(SWITCHES)}"
    )
    parser.add_argument("--title", default="", metavar="WORDS", help="a line above the picture")
    parser.add_argument(
        "--dpi",
        type=float,
        default=96.0,
        metavar="N",
        help="pixels to an inch of paper (default 96); papers want 300",
    )
    parser.add_argument(
        "--no-session", action="store_true",
        help="do not write into PNG and TIFF files how they were made (paths of volumes; see volviz reproduce)",
    )  # fmt: skip
    parser.add_argument(
        "--methods", action="store_true", help="print a sentence for the methods section of a paper, too"
    )


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
    check_look(options, {"--all-techniques": options.all_techniques, "--plane": asks_for_slice(options)})
    single_channel(options)
    check_output(output)
    volume = _loaded(options)
    info, values = look_values(options, volume)
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
    from volviz.annotations.figure import is_vector
    from volviz.annotations.methods import methods_sentence
    from volviz.annotations.picture import usual_scale
    from volviz.custom_gl.arguments import spec_of
    from volviz.custom_gl.offscreen import background_color
    from volviz.custom_gl.resolve import resolve
    from volviz.embedded_session import carries, session_with
    from volviz.model.picture import Picture
    from volviz.model.render_spec import View
    from volviz.renderer import Renderer

    if not options.zoom > 0:
        raise InputError(f"--zoom takes a factor greater than 0, got {options.zoom:g}.")
    spec = spec_of(layers, None if "look" in values else info.id, classic=options.classic, **values)
    transparent = options.background.lower() == "none" and output.suffix.lower() not in OPAQUE_SUFFIXES
    background = "black" if options.background.lower() == "none" else options.background
    camera = turned_camera(spec, size, options)
    begin = time.perf_counter()
    contents = PictureContents.of([name for name in options.show.split(",") if name.strip()], options.title)
    ground = None if transparent else background_color(background)
    with Renderer(size) as renderer:
        view = View(camera, size, ground)
        if is_vector(output):
            image = renderer.draw(spec, replace(view, background=None))
            shapes = renderer.shapes(spec, view, contents)
        else:
            dtype: Any = "float32" if output.suffix.lower() == ".npy" else "uint8"
            image, shapes = renderer.draw(spec, view, dtype=dtype, contents=contents), ()
        notice, bricks = renderer.notice, renderer.bricks
    seconds = time.perf_counter() - begin
    session = None
    if carries(output) and not options.no_session:
        from volviz.commands.scene import scene_of_spec

        scene = scene_of_spec(options, spec, camera, ground)
        picture = Picture.of_view(
            0, size, usual_scale(size), contents=contents, transparent=transparent, dpi=options.dpi
        )
        session = session_with(scene, picture, output)
    save_image(image, output, shapes, ground, options.dpi, session)
    print(f"{output}: {info.label}, {size[0]} x {size[1]}, {seconds:.2f} s")
    if notice:
        print(f"note: {notice}")
    if options.methods:
        print(methods_sentence(resolve(spec), camera, size))
    if options.report:
        write_report(Path(options.report).expanduser(), layers, bricks, seconds)


def check_output(output: Path) -> None:
    """Refuse what cannot be written before minutes are spent on drawing it."""
    if output.suffix.lower() not in (*IMAGE_SUFFIXES, ".npy"):
        raise InputError(
            f"{output}: pictures end in {', '.join((*IMAGE_SUFFIXES, '.npy'))}; give -o such a name."
        )
    if not output.absolute().parent.is_dir():
        raise InputError(f"{output}: there is no folder {output.absolute().parent}; make it first.")


def save_image(
    image: Any,
    output: Path,
    shapes: Sequence[Shape] = (),
    background: tuple[float, float, float] | None = None,
    dpi: float = 96.0,
    session: Mapping[str, Any] | None = None,
) -> None:
    """Write an image of shape (H, W, 4), uint8, or any array as .npy; the rest as for `write_picture`."""
    try:
        if output.suffix.lower() == ".npy":
            import numpy as np

            with output.open("wb") as file:
                np.save(file, image)
            return
        from volviz.annotations.figure import write_picture
        from volviz.embedded_session import saving_options

        shown = image[..., :3] if output.suffix.lower() in OPAQUE_SUFFIXES else image
        write_picture(output, shown, shapes, background, dpi, **saving_options(output, session))
    except OSError as error:
        raise VolvizError(f"{output}: the picture cannot be written ({error.strerror or error}).") from None
