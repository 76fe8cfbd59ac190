"""Pictures that tell how they were made: the session in a PNG text or a TIFF description."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from volviz.errors import LoadError
from volviz.model.picture import Picture
from volviz.model.scene import Scene
from volviz.model.session import KIND, scene_to_dict

#: Keyword of the text in PNG files.
PNG_KEYWORD = "VolViz session"
#: ImageDescription (TIFF 6.0, section 8).
TIFF_DESCRIPTION = 270
_PNG, _TIFF = (".png", ".apng"), (".tif", ".tiff")
SUFFIXES = (*_PNG, *_TIFF)
#: What is raised for a file that is not what its name says, or damaged (tifffile's own error is a ValueError).
_UNREADABLE = (SyntaxError, IndexError, KeyError, TypeError, ValueError, EOFError, struct.error)


def carries(path: Path) -> bool:
    """Whether a picture of that name can carry a session."""
    return path.suffix.lower() in SUFFIXES


def session_with(scene: Scene, picture: Picture, path: Path) -> dict[str, Any]:
    """A session that also says how a picture of the scene is made.

    Parameters
    ----------
    scene : Scene
    picture : Picture
    path : Path
        The file that is going to carry it: paths of volumes are relative to it, too.
    """
    return {**scene_to_dict(scene, path.absolute().parent), "picture": picture.to_dict()}


def picture_in(session: Mapping[str, Any]) -> Picture | None:
    """How the picture that carries a session was made, None where it does not say so.

    Raises
    ------
    LoadError
        What it says is damaged.
    """
    told = session.get("picture")
    if told is None:
        return None
    try:
        return Picture.from_dict(told)
    except (KeyError, TypeError, ValueError) as error:
        raise LoadError(f"what the picture says of itself is damaged: {error}.") from error


def saving_options(path: Path, session: Mapping[str, Any] | None) -> dict[str, Any]:
    """Keywords of Pillow's `save` with which a file of that name carries a session.

    Parameters
    ----------
    path : Path
    session : mapping or None
        As from `volviz.model.session.scene_to_dict`; None, or a format that carries none, gives no keywords.
    """
    if session is None or not carries(path):
        return {}
    text = json.dumps(session)
    if path.suffix.lower() in _TIFF:
        return {"tiffinfo": {TIFF_DESCRIPTION: text}}
    from PIL.PngImagePlugin import PngInfo

    info = PngInfo()
    info.add_itxt(PNG_KEYWORD, text, zip=True)
    return {"pnginfo": info}


def session_in(path: Path) -> dict[str, Any] | None:
    """The session that a picture carries, None where it carries none or is no picture.

    Raises
    ------
    LoadError
        The file cannot be read.
    """
    if path.suffix.lower() not in SUFFIXES:
        return None
    try:
        text = _png_text(path) if path.suffix.lower() in _PNG else _tiff_text(path)
    except _UNREADABLE:
        return None
    except OSError as error:
        raise LoadError(f"{path}: the file cannot be read ({error.strerror or error}).") from None
    if not isinstance(text, str):
        return None
    try:
        found = json.loads(text)
    except ValueError:
        return None
    return found if isinstance(found, dict) and found.get("kind") == KIND else None


def _png_text(path: Path) -> Any:
    """What stands before the pixels, which are not read; however many there are."""
    from PIL.PngImagePlugin import PngImageFile

    with PngImageFile(path) as picture:
        return picture.info.get(PNG_KEYWORD)


def _tiff_text(path: Path) -> Any:
    # not Pillow: it warns of files that it finds damaged, which other stacks are to it
    from tifffile import TiffFile

    with TiffFile(path) as file:
        return file.pages.first.description
