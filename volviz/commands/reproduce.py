"""``volviz reproduce``: a picture drawn again from the session that it carries."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from volviz.commands.progress import ProgressLine
from volviz.errors import InputError
from volviz.new_files import check_target

if TYPE_CHECKING:
    from volviz.model.scene import Scene


def add_commands(commands: Any) -> None:
    """Add ``reproduce``."""
    parser = commands.add_parser(
        "reproduce",
        help="draw a picture again from the session that it carries",
        description="Draws a PNG or TIFF picture of VolViz again, and says how far both are from one another: on the "
        "same OpenGL, by the same version, they are equal to the bit.",
    )
    parser.add_argument("picture", metavar="PICTURE", help="a picture of volviz render or of the window")
    parser.add_argument("-o", "--output", required=True, metavar="FILE", help="picture that is written")
    parser.add_argument("--volume", metavar="FILE", help="take this file for the volume, which has moved")
    parser.add_argument("--overwrite", action="store_true", help="replace an existing file")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Draw the picture and tell how it compares."""
    from volviz.annotations.figure import is_vector
    from volviz.custom_gl.registry import known_settings
    from volviz.embedded_session import picture_in, session_in, session_with
    from volviz.model.session import scene_from_dict
    from volviz.renderer import Renderer
    from volviz.scene_drawing import compose, write_composition
    from volviz.scene_volumes import SceneVolumes

    source, output = Path(options.picture).expanduser(), Path(options.output).expanduser()
    if not source.is_file():
        raise InputError(f"{source}: there is no such file.")
    session = session_in(source)
    picture = None if session is None else picture_in(session)
    if session is None or picture is None:
        raise InputError(
            f"{source}: the picture does not say how it was made; PNG and TIFF files of VolViz do, unless that was "
            "switched off."
        )
    check_target(output, overwrite=options.overwrite)
    scene = scene_from_dict(session, known_settings, source.absolute().parent)
    if options.volume is not None:
        scene = _with_volume(scene, options.volume)
    volumes = SceneVolumes()
    with ProgressLine() as line, Renderer(picture.parts[0].size) as renderer:
        composition = compose(
            renderer, scene, picture, volumes.of(scene), vector=is_vector(output),
            progress=lambda fraction: line.show(fraction, "drawing"),
        )  # fmt: skip
    before = _pixels(source)
    alpha = before.shape[2] == 4
    write_composition(composition, output, session_with(scene, picture, output), alpha=alpha)
    compared = _compared(source.name, before, composition.image(alpha=alpha))
    print(f"{output}: {picture.size[0]} x {picture.size[1]}, {compared}")
    for changed in volumes.changed(scene):
        print(f"note: {changed} has changed since the picture was made.")
    return 0


def _with_volume(scene: Scene, file: str) -> Scene:
    """The scene whose volumes come from another file."""
    from volviz.volume_data.references import reference_to

    refs = {layer.key.ref for layer in scene.layers}
    if len(refs) > 1:
        names = ", ".join(sorted(ref.source for ref in refs))
        raise InputError(f"--volume is for pictures of one file; this one shows {names}.")
    layers = (replace(layer, volume=reference_to(file, dict(layer.key.ref.hints))) for layer in scene.layers)
    return replace(scene, layers=tuple(layers))


def _pixels(source: Path) -> npt.NDArray[np.uint8]:
    """The picture that is drawn again, shape (H, W, 3 or 4)."""
    from PIL.PngImagePlugin import PngImageFile
    from PIL.TiffImagePlugin import TiffImageFile

    # not Image.open: it has a limit on pixels that our pictures may exceed
    kind = TiffImageFile if source.suffix.lower().startswith(".tif") else PngImageFile
    with kind(source) as picture:
        return np.asarray(picture.convert("RGBA" if "A" in picture.getbands() else "RGB"))


def _compared(name: str, before: npt.NDArray[np.uint8], image: npt.NDArray[np.uint8]) -> str:
    """How far the picture is from the one that it was made from, in words."""
    if before.shape != image.shape:
        return f"not {before.shape[1]} x {before.shape[0]} as {name}"
    difference = np.abs(before.astype(int) - image).max(axis=2)
    if not difference.any():
        return f"equal to {name} to the bit"
    share = np.count_nonzero(difference) / difference.size
    return f"differs from {name} in {100 * share:.3g} % of the pixels, by at most {difference.max()} of 255"
