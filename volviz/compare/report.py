"""Reports of comparisons: one self-contained HTML page, or the figures as JSON or CSV."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from volviz.compare.convergence import LEVELS
from volviz.compare.report_page import page
from volviz.compare.results import Comparison, pair_dict, side_dict
from volviz.errors import InputError, VolvizError

#: File types of reports.
SUFFIXES = (".html", ".json", ".csv")


def save_report(comparison: Comparison, path: str | Path) -> None:
    """Write a report; the ending of the name chooses the kind.

    Parameters
    ----------
    comparison : Comparison
    path : str or path
        .html, .json or .csv.

    Raises
    ------
    InputError
        Another ending.
    VolvizError
        The file cannot be written.
    """
    save_reports([comparison], path)


def save_reports(comparisons: Sequence[Comparison], path: str | Path, notes: Sequence[str] = ()) -> None:
    """Write several comparisons, as of a suite, into one report; see `save_report`.

    `notes` are sentences on what is missing; they stand on the page.
    """
    target = check_report_name(path)
    kind = target.suffix.lower()
    if kind == ".html":
        text = html_report(comparisons, notes)
    else:
        text = {".json": json_report, ".csv": csv_report}[kind](comparisons)
    # a name of a file need not be text: what is none becomes a replacement character
    text = text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
    try:
        # csv brings its own line ends
        target.write_text(text, encoding="utf-8", newline="" if kind == ".csv" else None)
    except OSError as error:
        raise VolvizError(f"{path}: the report cannot be written ({error.strerror or error}).") from None


def check_report_name(path: str | Path) -> Path:
    """The path, once it is clear that a report can be written there.

    Raises
    ------
    InputError
        An unknown ending, or a folder that is not there.
    """
    target = Path(path).expanduser()
    if target.suffix.lower() not in SUFFIXES:
        raise InputError(f"{path}: a report is called something.html, .json or .csv.")
    if not target.absolute().parent.is_dir():
        raise InputError(f"{path}: there is no folder {target.parent}; make it first.")
    return target


def html_report(comparisons: Sequence[Comparison], notes: Sequence[str] = ()) -> str:
    """One page with images, differences, tables and plots; nothing outside it is needed."""
    return page(comparisons, notes)


def json_report(comparisons: Sequence[Comparison]) -> str:
    """The figures as JSON: an object, or a list of them for several comparisons.

    Numbers that JSON cannot hold are null: the PSNR of equal images is infinite.
    """
    data: Any = [comparison.to_dict() for comparison in comparisons]
    return json.dumps(data[0] if len(data) == 1 else data, indent=2, ensure_ascii=False) + "\n"


def csv_report(comparisons: Sequence[Comparison]) -> str:
    """The figures as a table with one figure a row: volume, kind, side, other side, figure, value."""
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(("volume", "kind", "side", "other", "figure", "value"))
    for comparison in comparisons:
        name = comparison.volume["name"]
        writer.writerows((name, *row) for row in _rows(comparison))
    return text.getvalue()


def _rows(comparison: Comparison) -> Iterator[tuple[str, str, str, str, Any]]:
    for side in comparison.sides:
        data = side_dict(side)
        for kind in ("times", "samples_per_ray", "mesh", "settings"):
            for metric, value in _flat(data[kind] or {}):
                yield kind, side.name, "", metric, value
    for pair in comparison.pairs:
        data = pair_dict(comparison, pair)
        for metric, value in _flat(
            {k: v for k, v in data.items() if k not in ("first", "second", "differences")}
        ):
            yield "pair", pair.first, pair.second, metric, value
        for sentence in pair.differences:
            yield "difference", pair.first, pair.second, "", sentence
    for found in comparison.convergence:
        rows = zip(found.values, found.distances, found.errors, found.max_errors, strict=True)
        for value, distance, error, largest in rows:
            what = f"{found.parameter}={value:g}"
            yield "convergence", found.name, what, "distance", distance
            yield (
                "convergence",
                found.name,
                what,
                "rms_error" if found.unit == LEVELS else "mean_distance",
                error,
            )
            yield "convergence", found.name, what, "max_error", largest
        yield "convergence", found.name, "", "slope", found.slope
        yield "convergence", found.name, "", "converged", found.reference
    for sentence in comparison.without_curve:
        yield "convergence", "", "", "", sentence
    for sentence in comparison.notes:
        yield "note", "", "", "", sentence
    for group in ("machine", "versions"):
        for metric, value in getattr(comparison, group).items():
            yield group, "", "", metric, value
    yield "command", "", "", "", comparison.command


def _flat(data: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in data.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{key}.")
        elif isinstance(value, list):
            yield prefix + key, " ".join(map(str, value))
        else:
            yield prefix + key, "" if value is None else value
