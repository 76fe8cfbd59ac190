"""The beginning of a page of many comparisons: how near all pairs are on all volumes, and how their times compare."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from html import escape

from volviz.compare.report_html import NUMBER
from volviz.compare.results import Comparison, PairResult
from volviz.compare.timing import ratio

#: PSNR at which a cell has no colour, and all of it.
PALE_DECIBELS, FULL_DECIBELS = 15.0, 65.0
#: Strongest tint of a cell in per cent.
TINT = 45.0


def overview(comparisons: Sequence[Comparison]) -> list[str]:
    """Tables with a row for each pair of techniques and a column for each volume; numbers lead to the comparison."""
    volumes = list(dict.fromkeys(str(c.volume["name"]) for c in comparisons))
    plural = "" if len(volumes) == 1 else "s"
    parts = [
        f'<p class="faint">{len(comparisons)} comparisons on {len(volumes)} volume{plural}.</p>',
        "<h2>How near the pictures are</h2>",
        (
            "<p>PSNR in dB: the higher, the more alike; above 45 dB hardly anybody sees a difference. Each number "
            "leads to its comparison.</p>"
        ),
        _matrix(comparisons, volumes, _decibels_cell),
    ]
    if any(side.times is not None and side.times.seconds for c in comparisons for side in c.sides):
        parts += [
            "<h2>How long the second takes, compared with the first</h2>",
            "<p>Median of the ratios of frame times: above 1 the first technique is the faster one.</p>",
            _matrix(comparisons, volumes, _ratio_cell),
        ]
    return parts


def _matrix(
    comparisons: Sequence[Comparison],
    volumes: Sequence[str],
    cell: Callable[[Comparison, PairResult], tuple[str, float]],
) -> str:
    """Cells are words and a strength of 0..1; pairs without any number are left out."""
    cells: dict[tuple[str, str], dict[str, str]] = {}
    for number, comparison in enumerate(comparisons):
        for pair in comparison.pairs:
            words, strength = cell(comparison, pair)
            if words:
                tint = f' style="--tint:{TINT * min(max(strength, 0.0), 1.0):.0f}%"'
                link = f'<td class="number heat"{tint}><a href="#c{number}">{words}</a></td>'
                cells.setdefault((pair.first, pair.second), {})[str(comparison.volume["name"])] = link
    heads = "".join(f'<th scope="col"{NUMBER}>{escape(name)}</th>' for name in volumes)
    rows = [
        f"<tr><td>{escape(first)}, {escape(second)}</td>"
        + "".join(row.get(name, f"<td{NUMBER}>–</td>") for name in volumes)
        + "</tr>"
        for (first, second), row in cells.items()
    ]
    return (
        f'<div class="wide matrix"><table><thead><tr><th scope="col">techniques</th>{heads}</tr></thead><tbody>'
        + "\n".join(rows)
        + "</tbody></table></div>"
    )


def _decibels_cell(_comparison: Comparison, pair: PairResult) -> tuple[str, float]:
    psnr = pair.metrics.psnr
    if math.isinf(psnr):
        return "equal", 1.0
    return f"{psnr:.1f}", (psnr - PALE_DECIBELS) / (FULL_DECIBELS - PALE_DECIBELS)


def _ratio_cell(comparison: Comparison, pair: PairResult) -> tuple[str, float]:
    first, second = comparison.side(pair.first).times, comparison.side(pair.second).times
    if first is None or second is None or not first.seconds or not second.seconds:
        return "", 0.0
    factor = ratio(second, first).median
    # as far from even as tenfold has the full tint
    return f"{factor:.2f}", abs(math.log10(factor)) if factor > 0 else 0.0
