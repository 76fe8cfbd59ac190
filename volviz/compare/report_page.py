"""The HTML page of a report: pictures as data in the page, plots as SVG, light and dark."""

from __future__ import annotations

import base64
import io
import json
import math
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.compare.convergence import LEVELS, Convergence
from volviz.compare.matching import in_words
from volviz.compare.mesh_metrics import MeshMetrics
from volviz.compare.pictures import color_table
from volviz.compare.plots import convergence_plot, times_plot
from volviz.compare.results import Comparison, PairResult, SideResult
from volviz.compare.timing import ratio

STYLE = Path(__file__).with_name("report_page.css")
#: Numbers stand to the right.
NUMBER = ' class="number"'


def page(comparisons: Sequence[Comparison]) -> str:
    """The whole page, without references to anything outside it."""
    title = comparisons[0].title if len(comparisons) == 1 else "Comparison of techniques"
    parts = [
        "<!DOCTYPE html>",
        '<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{escape(title)}</title>",
        f"<style>\n{STYLE.read_text(encoding='utf-8')}</style></head><body>",
    ]
    if len(comparisons) > 1:
        parts += [f"<h1>{escape(title)}</h1>", *_contents(comparisons)]
    for number, comparison in enumerate(comparisons):
        parts += _comparison(comparison, number)
    last = comparisons[-1]
    parts += ["<h2>Machine and versions</h2>", _facts(last.machine), _facts(last.versions)]
    parts += ["<h2>How this was made</h2>", _bullets(last.remarks)]
    for command in dict.fromkeys(c.command for c in comparisons if c.command):
        parts.append(f"<pre>{escape(command)}</pre>")
    parts.append("</body></html>")
    return "\n".join(parts) + "\n"


def _contents(comparisons: Sequence[Comparison]) -> list[str]:
    """A table of all pairs of all comparisons: what a suite is read for."""
    rows = [
        [
            f'<a href="#c{number}">{escape(str(c.volume["name"]))}</a>',
            escape(f"{pair.first}, {pair.second}"),
            _decibels(pair.metrics.psnr),
            f"{pair.metrics.ssim:.4f}",
            f"{pair.metrics.max_difference:.0f}",
            _ratio(c, pair),
        ]
        for number, c in enumerate(comparisons)
        for pair in c.pairs
    ]
    return [
        _table(
            ["volume", "techniques", "PSNR", "SSIM", "largest difference", "time, second / first"], rows, 2
        )
    ]


def _comparison(comparison: Comparison, number: int) -> list[str]:
    volume = comparison.volume
    size = " x ".join(str(n) for n in volume["dimensions"])
    spacing = " x ".join(f"{s:g}" for s in volume["spacing"])
    low, high = volume["range"]
    unit = f" {volume['unit']}" if volume.get("unit") else ""
    width, height = comparison.view["size"]
    parts = [
        f'<h1 id="c{number}">{escape(comparison.title)}</h1>',
        (
            f'<p class="faint">{escape(str(volume["name"]))}: {size} voxels, {escape(volume["dtype"])}, '
            f"spacing {spacing}, values {low:g} to {high:g}{escape(unit)}; pictures of {width} x {height} "
            "pixels.</p>"
        ),
        '<div class="pictures">',
        *(_side_figure(side) for side in comparison.sides),
        "</div>",
        "<h2>Differences</h2>",
    ]
    parts.append(_pair_table(comparison))
    for pair in comparison.pairs:
        parts += _pair(pair)
    parts += _times(comparison) + _samples(comparison) + _meshes(comparison) + _convergence(comparison)
    parts += ["<h2>Settings</h2>", _settings(comparison.sides), _view(comparison)]
    return parts


def _side_figure(side: SideResult) -> str:
    caption = f"<b>{escape(side.name)}</b> · {escape(side.label)}"
    if side.times is not None and side.times.seconds:
        caption += f" · {_milliseconds(side.times.median)}"
    if side.notice:
        caption += f"<br>{escape(side.notice)}"
    return _figure(side.picture, f"drawn by {side.name}", caption)


def _pair_table(comparison: Comparison) -> str:
    rows = [
        [
            escape(f"{pair.first}, {pair.second}"),
            _decibels(m.psnr),
            f"{m.ssim:.5f}",
            f"{m.mean_difference:.3f}",
            f"{m.max_difference:.1f}",
            f"{100 * m.visible_share:.2f} %",
            "{:.2f}, {:.2f}".format(*(round(value, 2) + 0.0 for value in m.shift)),
            _ratio(comparison, pair),
        ]
        for pair in comparison.pairs
        for m in (pair.metrics,)
    ]
    heads = [
        "techniques",
        "PSNR",
        "SSIM",
        "mean difference",
        "largest difference",
        "pixels off by > 2",
        "time ratio",
    ]
    return _table(heads, rows, 1)


def _pair(pair: PairResult) -> list[str]:
    name = f"{pair.first}, {pair.second}"
    column, row = pair.metrics.max_position
    bar = (
        f'<div class="bar">0<img alt="colours from 0 to {pair.difference.limit:.1f} levels" '
        f'src="{_data_uri(color_table(pair.difference.kind)[None])}">{pair.difference.limit:.1f}</div>'
    )
    return [
        f"<h3>{escape(pair.first)} against {escape(pair.second)}</h3>",
        '<div class="pictures">',
        _figure(
            pair.difference.picture, f"difference of {name}",
            f"Absolute difference of luminance, in levels of 255; the largest difference of a channel lies at pixel "
            f"{column}, {row}.{bar}",
        ),
        _figure(
            pair.similarity, f"similarity of {name}",
            f"Structural similarity {pair.metrics.ssim:.5f}: white is equal, black is unlike.",
        ),
        "</div>",
        _bullets(pair.differences) if pair.differences else '<p class="faint">All shared settings are equal.</p>',
    ]  # fmt: skip


def _times(comparison: Comparison) -> list[str]:
    times = [side.times for side in comparison.sides if side.times is not None and side.times.seconds]
    if not times:
        return []
    base = times[0]
    rows = []
    for t in times:
        low, high = t.quartiles
        quotient = ratio(t, base)
        rows.append([
            escape(t.name),
            _milliseconds(t.median),
            f"{_milliseconds(low)} to {_milliseconds(high)}",
            "" if t.first is None else _milliseconds(t.first),
            "" if t.gpu_median is None else _milliseconds(t.gpu_median),
            "1" if t is base else f"{quotient.median:.2f} ({quotient.low:.2f} to {quotient.high:.2f})",
            str(len(t.seconds)),
        ])  # fmt: skip
    heads = [
        "technique",
        "median",
        "quartiles",
        "first frame",
        "GPU clock",
        f"ratio to {base.name}",
        "frames",
    ]
    notes = [_bullets(comparison.notes)] if comparison.notes else []
    return ["<h2>Frame times</h2>", _table(heads, _without_empty(heads, rows), 1), times_plot(times), *notes]


def _samples(comparison: Comparison) -> list[str]:
    rows = [
        [
            escape(side.name),
            f"{s.mean:.1f}",
            f"{s.maximum:.0f}",
            f"{s.distance:.4g}",
            f"{100 * s.hit_share:.0f} %",
        ]
        for side in comparison.sides
        if (s := side.samples) is not None
    ]
    if not rows:
        return []
    heads = ["technique", "mean", "most", "distance of samples (world)", "rays that meet the box"]
    return ["<h2>Samples per ray</h2>", _table(heads, rows, 1)]


def _meshes(comparison: Comparison) -> list[str]:
    shown = [(side.name, side.mesh) for side in comparison.sides if side.mesh is not None]
    if not shown:
        return []
    rows = [[escape(name), *_mesh_cells(mesh)] for name, mesh in shown]
    heads = ["technique", "triangles", "vertices", "area", "volume", "Euler characteristic", "open edges",
             "non-manifold edges", "parts"]  # fmt: skip
    parts = ["<h2>Meshes</h2>", _table(heads, rows, 1)]
    distances = [
        [escape(f"{p.first}, {p.second}"), f"{p.distance.hausdorff:.4g}", f"{p.distance.mean:.4g}"]
        for p in comparison.pairs
        if p.distance is not None
    ]
    if distances:
        parts.append(_table(["meshes", "Hausdorff distance (world)", "mean distance"], distances, 1))
    return parts


def _mesh_cells(mesh: MeshMetrics) -> list[str]:
    return [
        str(mesh.faces), str(mesh.vertices), f"{mesh.area:.6g}", f"{mesh.volume:.6g}", str(mesh.euler_characteristic),
        str(mesh.boundary_edges), str(mesh.non_manifold_edges), str(mesh.components),
    ]  # fmt: skip


def _convergence(comparison: Comparison) -> list[str]:
    found = comparison.convergence
    if not found and not comparison.without_curve:
        return []
    rows = [
        [
            escape(c.name),
            escape(c.parameter),
            "none" if math.isnan(c.slope) else f"{c.slope:.2f}",
            ", ".join(f"{d:.3g}: {e:.3g}" for d, e in zip(c.distances, c.errors, strict=True)),
            escape(c.reference),
            "" if c.offset is None else f"{c.offset:.3g} from {escape(c.offset_from)}",
            "" if c.unit != LEVELS else "{} x {}".format(*c.size),
        ]
        for c in found
    ]
    heads = [
        "technique",
        "setting",
        "slope",
        "error by distance in voxels",
        "converged",
        "how far the converged picture is off",
        "pixels",
    ]
    rows = _without_empty(heads, rows)
    parts = ["<h2>Convergence</h2>", *(f"<p>{escape(words)}</p>" for words in _about_convergence(found))]
    units = dict.fromkeys(c.unit for c in found)
    parts += [convergence_plot([c for c in found if c.unit == unit]) for unit in units]
    if found:
        parts.append(_table(heads, rows))
    return [*parts, _bullets(comparison.without_curve)] if comparison.without_curve else parts


def _about_convergence(found: Sequence[Convergence]) -> list[str]:
    """How the errors were taken, as far as it concerns these."""
    words = []
    if any(c.unit == LEVELS for c in found):
        words.append(
            "Errors of pictures against a converged one, as 32-bit floats, without early termination and jitter. The "
            "slope of the fitted line is the order of convergence."
        )
    if any(c.unit != LEVELS for c in found):
        words.append(
            "Errors of meshes are their mean distance from the mesh that the same technique makes of every voxel; the "
            "data ends at a common border."
        )
    if any(c.finest > 0 for c in found):
        words.append(
            "Where a technique is measured against its own finest result at distance h0, the line that is fitted is "
            "c (h^p - h0^p): the order p is that of the error against the limit."
        )
    return words


def _settings(sides: Sequence[SideResult]) -> str:
    names = dict.fromkeys(name for side in sides for name in side.settings)
    rows, marks = [], []
    for name in names:
        values = [in_words(side.settings[name]) if name in side.settings else "–" for side in sides]
        rows.append([escape(name), *map(escape, values)])
        marks.append(len({v for v in values if v != "–"}) > 1)
    return _table(["setting", *(side.name for side in sides)], rows, marks=marks)


def _view(comparison: Comparison) -> str:
    view = {key: value for key, value in comparison.view.items() if value not in (None, ())}
    data = json.dumps(comparison.to_dict()["transfer_function"], separators=(",", ":"))
    uri = "data:application/json;base64," + base64.b64encode(data.encode()).decode()
    link = f'<p><a download="transfer-function.json" href="{uri}">Transfer function as JSON</a></p>'
    return "<h3>View</h3>" + _facts({key: in_words(value) for key, value in view.items()}) + link


def _ratio(comparison: Comparison, pair: PairResult) -> str:
    first, second = comparison.side(pair.first).times, comparison.side(pair.second).times
    if first is None or second is None or not first.seconds or not second.seconds:
        return ""
    return f"{ratio(second, first).median:.2f}"


def _decibels(value: float) -> str:
    return "equal" if math.isinf(value) else f"{value:.1f} dB"


def _milliseconds(seconds: float) -> str:
    return f"{1000 * seconds:.3g} ms" if seconds < 1 else f"{seconds:.2f} s"


def _figure(picture: npt.NDArray[np.uint8], alternative: str, caption: str) -> str:
    return (
        f'<figure><img alt="{escape(alternative)}" src="{_data_uri(picture)}">'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def _data_uri(picture: npt.NDArray[np.uint8]) -> str:
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(picture)).save(file, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(file.getvalue()).decode()


def _facts(facts: Any) -> str:
    return _table([], [[escape(str(name)), escape(str(value))] for name, value in facts.items()])


def _bullets(sentences: Iterable[str]) -> str:
    return "<ul>" + "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences) + "</ul>"


def _without_empty(heads: list[str], rows: list[list[str]]) -> list[list[str]]:
    """Rows without the columns in which nothing stands; their heads are taken away as well."""
    empty = [i for i in range(len(heads)) if not any(row[i] for row in rows)]
    for i in reversed(empty):
        del heads[i]
    return [[cell for i, cell in enumerate(row) if i not in empty] for row in rows]


def _table(
    heads: Sequence[str], rows: Sequence[Sequence[str]], numbers_from: int = 99, marks: Sequence[bool] = ()
) -> str:
    """A table; cells are HTML already, heads are text; columns from `numbers_from` on hold numbers."""
    parts = ['<div class="wide"><table>']
    if heads:
        cells = (
            f"<th{NUMBER if i >= numbers_from else ''}>{escape(head)}</th>" for i, head in enumerate(heads)
        )
        parts.append("<tr>" + "".join(cells) + "</tr>")
    for number, row in enumerate(rows):
        mark = ' class="differs"' if number < len(marks) and marks[number] else ""
        filled = (f"<td{NUMBER if i >= numbers_from else ''}>{cell}</td>" for i, cell in enumerate(row))
        parts.append(f"<tr{mark}>" + "".join(filled) + "</tr>")
    return "\n".join([*parts, "</table></div>"])
