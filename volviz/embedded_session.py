"""Pictures that tell how they were made: the session in a PNG text, a TIFF description, the comment of a film."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from volviz.errors import LoadError
from volviz.model.session import KIND

#: Keyword of the text in PNG files.
PNG_KEYWORD = "VolViz session"
#: ImageDescription (TIFF 6.0, section 8).
TIFF_DESCRIPTION = 270
SUFFIXES = (".png", ".apng", ".tif", ".tiff")


def saving_options(path: Path, session: Mapping[str, Any] | None) -> dict[str, Any]:
    """Keywords of Pillow's `save` with which a file of that name carries a session.

    Parameters
    ----------
    path : Path
    session : mapping or None
        As from `volviz.model.session.scene_to_dict`; None, or a format that carries none, gives no keywords.
    """
    if session is None:
        return {}
    text = json.dumps(session)
    match path.suffix.lower():
        case ".png" | ".apng":
            from PIL.PngImagePlugin import PngInfo

            info = PngInfo()
            info.add_itxt(PNG_KEYWORD, text, zip=True)
            return {"pnginfo": info}
        case ".tif" | ".tiff":
            return {"tiffinfo": {TIFF_DESCRIPTION: text}}
        case _:
            return {}


def session_in(path: Path) -> dict[str, Any] | None:
    """The session that a picture carries, None where it carries none or is no picture.

    Raises
    ------
    LoadError
        The file cannot be read.
    """
    if path.suffix.lower() not in SUFFIXES:
        return None
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as picture:
            if picture.format == "PNG":
                # texts may stand behind the pixels
                picture.load()
                text = getattr(picture, "text", {}).get(PNG_KEYWORD)
            else:
                text = getattr(picture, "tag_v2", {}).get(TIFF_DESCRIPTION)
    except (UnidentifiedImageError, SyntaxError, ValueError):
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
