"""The HTML page of a report: images as data in the page, plots as SVG, light and dark."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Sequence
from html import escape
from pathlib import Path

from volviz.compare.convergence import LEVELS, Convergence
from volviz.compare.image_metrics import Difference, color_table
from volviz.compare.plots import convergence_plot, times_plot
from volviz.compare.report_distances import distances, length_unit
from volviz.compare.report_html import (
    bullets,
    color_bar,
    figure,
    plot,
    properties,
    table,
    tiles,
    without_empty,
)
from volviz.compare.report_overview import overview
from volviz.compare.results import Comparison, PairResult, SideResult
from volviz.compare.timing import ratio
from volviz.kernels.mesh_metrics import MeshMetrics
from volviz.model.parameters import value_text

STYLE = Path(__file__).with_name("report_page.css")
#: Techniques that a title names; of more it tells the number.
NAMED = 4


def page(comparisons: Sequence[Comparison], notes: Sequence[str] = ()) -> str:
    """The whole page, without references to anything outside it.

    Parameters
    ----------
    comparisons : sequence of Comparison
        Several are headed by an overview.
    notes : sequence of str
        What is missing on the page, a sentence each.
    """
    several = len(comparisons) > 1
    title = "Comparison of techniques" if several else comparisons[0].title
    parts = [
        "<!DOCTYPE html>",
        '<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        # browsers ask for an icon otherwise
        '<link rel="icon" href="data:,">',
        f"<title>{escape(title)}</title>",
        f"<style>\n{STYLE.read_text(encoding='utf-8')}</style></head><body><main>",
    ]
    if several:
        parts += [f"<h1>{escape(title)}</h1>", *overview(comparisons)]
    if notes:
        parts.append(bullets(notes))
    for number, comparison in enumerate(comparisons):
        parts += _comparison(comparison, number, several)
    last = comparisons[-1]
    parts += [
        "<h2>Machine and versions</h2>",
        '<div class="columns">',
        properties(last.machine),
        properties(last.versions),
    ]
    parts += ["</div>", "<h2>How this was made</h2>", bullets(last.remarks)]
    for command in dict.fromkeys(c.command for c in comparisons if c.command):
        parts.append(f"<pre>{escape(command)}</pre>")
    parts.append("</main></body></html>")
    return "\n".join(parts) + "\n"


def _comparison(comparison: Comparison, number: int, several: bool) -> list[str]:
    volume = comparison.volume
    size = " × ".join(str(n) for n in volume["dimensions"])
    spacing = " × ".join(f"{s:.4g}" for s in volume["spacing"])
    low, high = volume["range"]
    unit = f" {volume['unit']}" if volume.get("unit") else ""
    width, height = comparison.view["size"]
    parts = [
        f'<h1 id="c{number}"{" class=next" if several else ""}>{escape(_title(comparison))}</h1>',
        (
            f'<p class="faint">{escape(str(volume["name"]))}: {size} voxels, {escape(volume["dtype"])}, '
            f"spacing {spacing}, values {low:g} to {high:g}{escape(unit)}; pictures of {width} × {height} "
            "pixels.</p>"
        ),
        *([] if len(comparison.pairs) != 1 else [_summary(comparison, comparison.pairs[0])]),
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


def _title(comparison: Comparison) -> str:
    """As it was given; too many names become a number."""
    sides = comparison.sides
    names = ", ".join(side.name for side in sides[:-1])
    usual = f"{names} and {sides[-1].name} on {comparison.volume['name']}"
    if comparison.title != usual or len(sides) <= NAMED:
        return comparison.title
    return f"{len(sides)} techniques on {comparison.volume['name']}"


def _summary(comparison: Comparison, pair: PairResult) -> str:
    """The figures that everybody asks for first."""
    m = pair.metrics
    shown = [
        (_decibels(m.psnr), "PSNR"),
        (f"{m.ssim:.4f}", "structural similarity"),
        (f"{m.max_difference:.0f}", "largest difference of 255"),
        (f"{100 * m.visible_share:.2f} %", "pixels off by more than 2"),
    ]
    factor = _ratio(comparison, pair)
    if factor:
        shown.append((f"{factor} ×", f"time of {pair.second}, compared with {pair.first}"))
    if pair.distance is not None:
        shown.append((f"{pair.distance.hausdorff:.3g}", f"Hausdorff distance ({length_unit(comparison)})"))
    return tiles(shown)


def _side_figure(side: SideResult) -> str:
    caption = f"<b>{escape(side.name)}</b> · {escape(side.label)}"
    if side.times is not None and side.times.seconds:
        caption += f" · {_milliseconds(side.times.median)}"
    if side.notice:
        caption += f"<br>{escape(side.notice)}"
    return figure(side.image, f"drawn by {side.name}", caption)


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
        "shift right, down",
        "time ratio",
    ]
    return table(heads, rows, 1)


def _pair(pair: PairResult) -> list[str]:
    name = f"{pair.first}, {pair.second}"
    column, row = pair.metrics.max_position
    bar = _bar(pair.difference, "levels")
    return [
        f"<h3>{escape(pair.first)} against {escape(pair.second)}</h3>",
        '<div class="pictures">',
        figure(
            pair.difference.image, f"difference of {name}",
            f"Absolute difference of luminance, in levels of 255; the largest difference of a channel lies at pixel "
            f"{column}, {row}.{bar}",
        ),
        figure(
            pair.dissimilarity.image, f"lost similarity of {name}",
            f"1 - structural similarity: black is equal; the mean "
            f"similarity is {pair.metrics.ssim:.5f}.{_bar(pair.dissimilarity, 'of similarity')}",
        ),
        "</div>",
        bullets(pair.differences) if pair.differences else '<p class="faint">All shared settings are equal.</p>',
    ]  # fmt: skip


def _bar(shown: Difference, unit: str) -> str:
    beyond = "≥ " if shown.values.max() > shown.limit * (1 + 1e-9) else ""
    return color_bar(
        color_table(shown.kind), "0", f"{beyond}{shown.limit:.3g}", f"colours from 0 to {shown.limit:.3g} {unit}"
    )  # fmt: skip


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
    notes = [bullets(comparison.notes)] if comparison.notes else []
    return [
        "<h2>Frame times</h2>",
        table(heads, without_empty(heads, rows), 1),
        plot(times_plot(times)),
        *notes,
    ]


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
    return ["<h2>Samples per ray</h2>", table(heads, rows, 1)]


def _meshes(comparison: Comparison) -> list[str]:
    shown = [(side.name, side.mesh) for side in comparison.sides if side.mesh is not None]
    if not shown:
        return []
    rows = [[escape(name), *_mesh_cells(mesh)] for name, mesh in shown]
    heads = ["technique", "triangles", "vertices", "area", "volume", "Euler characteristic", "open edges",
             "non-manifold edges", "parts"]  # fmt: skip
    parts = ["<h2>Meshes</h2>", table(heads, rows, 1)]
    return parts + distances(comparison)


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
            '<div class="long">'
            + ", ".join(f"{d:.3g}: {e:.3g}" for d, e in zip(c.distances, c.errors, strict=True))
            + "</div>",
            escape(c.reference),
            "" if c.offset is None else f"{c.offset:.3g} from {escape(c.offset_from)}",
            "" if c.unit != LEVELS else "{}\N{NO-BREAK SPACE}×\N{NO-BREAK SPACE}{}".format(*c.size),
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
    rows = without_empty(heads, rows)
    parts = ["<h2>Convergence</h2>", *(f"<p>{escape(words)}</p>" for words in _about_convergence(found))]
    units = dict.fromkeys(c.unit for c in found)
    parts += [plot(convergence_plot([c for c in found if c.unit == unit])) for unit in units]
    if found:
        parts.append(table(heads, rows))
    return [*parts, bullets(comparison.without_curve)] if comparison.without_curve else parts


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
            "Where a technique is measured against its own finest result at distance h₀, the line that is fitted is "
            "c (hᵖ − h₀ᵖ): the order p is that of the error against the limit."
        )
    return words


def _settings(sides: Sequence[SideResult]) -> str:
    names = dict.fromkeys(name for side in sides for name in side.settings)
    rows, marks = [], []
    for name in names:
        values = [value_text(side.settings[name], 6) if name in side.settings else "–" for side in sides]
        rows.append([escape(name), *map(escape, values)])
        marks.append(len({v for v in values if v != "–"}) > 1)
    return table(["setting", *(side.name for side in sides)], rows, marks=marks)


def _view(comparison: Comparison) -> str:
    view = {key: value for key, value in comparison.view.items() if value not in (None, ())}
    data = json.dumps(comparison.to_dict()["transfer_function"], separators=(",", ":"))
    uri = "data:application/json;base64," + base64.b64encode(data.encode()).decode()
    link = f'<p><a download="transfer-function.json" href="{uri}">Transfer function as JSON</a></p>'
    return "<h3>View</h3>" + properties({key: value_text(value, 6) for key, value in view.items()}) + link


def _ratio(comparison: Comparison, pair: PairResult) -> str:
    first, second = comparison.side(pair.first).times, comparison.side(pair.second).times
    if first is None or second is None or not first.seconds or not second.seconds:
        return ""
    return f"{ratio(second, first).median:.2f}"


def _decibels(value: float) -> str:
    return "equal" if math.isinf(value) else f"{value:.1f} dB"


def _milliseconds(seconds: float) -> str:
    return f"{1000 * seconds:.3g} ms" if seconds < 1 else f"{seconds:.2f} s"
