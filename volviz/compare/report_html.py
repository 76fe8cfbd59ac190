"""Pieces of a report's page: tables, figures, lists. Cells and captions are HTML already, everything else is text."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
import numpy.typing as npt

#: Numbers stand to the right.
NUMBER = ' class="number"'


def table(
    heads: Sequence[str], rows: Sequence[Sequence[str]], numbers_from: int = 99, marks: Sequence[bool] = ()
) -> str:
    """A table that scrolls sideways where it is wider than the page.

    Parameters
    ----------
    heads : sequence of str
        One for each column, or none at all.
    rows : sequence of sequences of str
        Cells as HTML.
    numbers_from : int
        Columns from here on hold numbers.
    marks : sequence of bool
        Rows that stand out.
    """
    parts = ['<div class="wide"><table>']
    if heads:
        cells = (
            f'<th scope="col"{NUMBER if i >= numbers_from else ""}>{escape(head)}</th>'
            for i, head in enumerate(heads)
        )
        parts.append("<thead><tr>" + "".join(cells) + "</tr></thead>")
    parts.append("<tbody>")
    for number, row in enumerate(rows):
        mark = ' class="differs"' if number < len(marks) and marks[number] else ""
        filled = (f"<td{NUMBER if i >= numbers_from else ''}>{cell}</td>" for i, cell in enumerate(row))
        parts.append(f"<tr{mark}>" + "".join(filled) + "</tr>")
    return "\n".join([*parts, "</tbody></table></div>"])


def without_empty(heads: list[str], rows: list[list[str]]) -> list[list[str]]:
    """Rows without the columns in which nothing stands; their heads are taken away as well."""
    empty = [i for i in range(len(heads)) if not any(row[i] for row in rows)]
    for i in reversed(empty):
        del heads[i]
    return [[cell for i, cell in enumerate(row) if i not in empty] for row in rows]


def properties(values: Mapping[str, Any]) -> str:
    """A table of names and values."""
    return table([], [[escape(str(name)), escape(str(value))] for name, value in values.items()])


def bullets(sentences: Iterable[str]) -> str:
    """A list of sentences."""
    return "<ul>" + "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences) + "</ul>"


def tiles(values: Sequence[tuple[str, str]]) -> str:
    """Large numbers with small words below: (number, words)."""
    cells = (
        f'<div class="tile"><b>{number}</b><span>{escape(words)}</span></div>' for number, words in values
    )
    return '<div class="tiles">' + "".join(cells) + "</div>"


def plot(svg: str) -> str:
    """A plot that keeps a readable size: on narrow screens it scrolls sideways."""
    return f'<div class="wide plot">{svg}</div>'


def figure(image: npt.NDArray[np.uint8], alternative: str, caption: str) -> str:
    """An image with a caption; `alternative` is for those who cannot see it."""
    return (
        f'<figure><img alt="{escape(alternative)}" src="{data_uri(image)}">'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def color_bar(colors: npt.NDArray[np.uint8], low: str, high: str, words: str) -> str:
    """A strip of colours, shape (N, 3), between two numbers."""
    return (
        f'<div class="bar">{low}<img alt="{escape(words)}" src="{data_uri(colors[None])}">{high}</div>'
    )  # fmt: skip


def data_uri(image: npt.NDArray[np.uint8]) -> str:
    """An image of shape (H, W, 3) within the page, as PNG."""
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(image)).save(file, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(file.getvalue()).decode()
