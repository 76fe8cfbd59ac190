"""Names and colours of labels in files of their own: ITK-SNAP, FreeSurfer and 3D Slicer, BIDS, and CSV."""

from __future__ import annotations

import csv
import os
import shlex
from collections.abc import Iterable, Sequence
from pathlib import Path

from volviz.errors import LoadError
from volviz.new_files import check_target, written_beside
from volviz.volume_data.description import Color, Label

#: Titles of columns, lower case, by what they hold.
_NUMBERS, _NAMES = ("label", "index", "id", "number", "value"), ("name", "label_name", "structure")
_CHANNELS = ("red", "green", "blue")


def read_label_file(path: str | os.PathLike[str]) -> tuple[Label, ...]:
    """Labels with their names and colours.

    Parameters
    ----------
    path : str or path
        A label description of ITK-SNAP (``IDX R G B A VIS MSH "LABEL"``), a colour table of FreeSurfer or 3D Slicer
        (``number name R G B A``), or a table with titles and commas or tabs: ``label,name,red,green,blue``, or
        ``index``, ``name`` and ``color`` of BIDS.

    Raises
    ------
    LoadError
        It cannot be read, or is none of these.
    """
    source = Path(path)
    try:
        text = source.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        raise LoadError(f"{source.name} cannot be read: {error.strerror or error}.") from error
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    first = lines[0] if lines else ""
    separator = "\t" if "\t" in first else "," if "," in first else ""
    titles = [title.strip().strip('"').lower() for title in first.split(separator)] if separator else []
    try:
        if set(titles) & set(_NUMBERS):
            found = _with_titles(lines, titles, separator)
        else:
            found = tuple(_of_words(shlex.split(line, comments=False)) for line in lines)
    except (ValueError, IndexError, KeyError):
        found = ()
    if not found:
        raise LoadError(
            f"{source.name} holds no table of labels; give one of ITK-SNAP, FreeSurfer or 3D Slicer, or one with the "
            "titles label, name, red, green, blue."
        )
    return found


def _with_titles(lines: Sequence[str], titles: Sequence[str], separator: str) -> tuple[Label, ...]:
    number = next(title for title in _NUMBERS if title in titles)
    name = next((title for title in _NAMES if title in titles), "")
    found = []
    for row in csv.reader(lines[1:], delimiter=separator):
        cells = dict(zip(titles, (cell.strip() for cell in row), strict=False))
        color = None
        if all(cells.get(channel) for channel in _CHANNELS):
            color = _color(*(cells[channel] for channel in _CHANNELS))
        elif cells.get("color", "").startswith("#"):
            digits = cells["color"].removeprefix("#")
            color = _color(*(str(int(digits[n : n + 2], 16)) for n in (0, 2, 4)))
        found.append(Label(int(float(cells[number])), cells.get(name, ""), color))
    return tuple(found)


def _of_words(words: Sequence[str]) -> Label:
    """A line of ITK-SNAP, whose name comes last, or of FreeSurfer, where it comes second."""
    if len(words) == 8 and _is_number(words[1]):
        return Label(int(words[0]), words[7], _color(*words[1:4]))
    if len(words) not in (5, 6):
        raise ValueError
    return Label(int(words[0]), words[1], _color(*words[2:5]))


def _is_number(text: str) -> bool:
    return text.lstrip("-").replace(".", "", 1).isdigit()


def _color(red: str, green: str, blue: str) -> Color:
    channels = [float(channel) / 255.0 for channel in (red, green, blue)]
    if not all(0.0 <= channel <= 1.0 for channel in channels):
        raise ValueError
    return channels[0], channels[1], channels[2]


def save_label_file(
    labels: Iterable[Label], path: str | os.PathLike[str], *, overwrite: bool = False
) -> Path:
    """Write names and colours as CSV: ``label,name,red,green,blue``, colours 0..255.

    Raises
    ------
    InputError, VolvizError
        The file is there already, or cannot be written.
    """
    target = check_target(path, overwrite=overwrite)
    with written_beside(target) as part, part.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["label", "name", *_CHANNELS])
        for label in labels:
            color = [""] * 3 if label.color is None else [round(255 * channel) for channel in label.color]
            writer.writerow([label.number, label.name, *color])
    return target
