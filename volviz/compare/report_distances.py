"""The part of a report that tells how far surfaces lie apart: metrics each way, and both in colours."""

from __future__ import annotations

from html import escape

from volviz.compare.distance_images import DistanceImages
from volviz.compare.report_html import color_bar, figure, table
from volviz.compare.results import Comparison, PairResult


def distances(comparison: Comparison) -> list[str]:
    """A table of distances each way, and the images of the pairs that have them."""
    unit = length_unit(comparison)
    rows = []
    for pair in comparison.pairs:
        d = pair.distance
        if d is None:
            continue
        for start, end, largest, mean, rms in (
            (pair.first, pair.second, d.forward, d.forward_mean, d.forward_rms),
            (pair.second, pair.first, d.backward, d.backward_mean, d.backward_rms),
        ):
            rows.append([escape(start), escape(end), f"{largest:.4g}", f"{mean:.4g}", f"{rms:.4g}"])
    if not rows:
        return []
    heads = ["distance of", "to", f"largest ({unit})", f"mean ({unit})", f"root of the mean square ({unit})"]
    parts = [
        (
            "<p>Distances go from vertices and middles of triangles to the nearest place of the other surface. The "
            "Hausdorff distance is the larger one of the two largest.</p>"
        ),
        table(heads, rows, 2),
    ]
    for pair in comparison.pairs:
        if pair.distance_images is not None:
            parts += _images(pair, pair.distance_images, unit)
    return parts


def length_unit(comparison: Comparison) -> str:
    """The unit of lengths of the volume, as heads of tables say it."""
    return escape(str(comparison.volume.get("length_unit") or "world units"))


def _images(pair: PairResult, shown: DistanceImages, unit: str) -> list[str]:
    heading = f"<h3>Distance of {escape(pair.first)} and {escape(pair.second)}</h3>"
    low = f"\N{MINUS SIGN}{shown.limit:.3g}" if shown.is_signed else "0"
    beyond = "≥ " if shown.largest > shown.limit * (1 + 1e-9) else ""
    bar = color_bar(
        shown.table,
        ("≤ " if beyond and shown.is_signed else "") + low,
        f"{beyond}{shown.limit:.3g} {unit}",
        f"colours from {low} to {shown.limit:.3g} {unit}",
    )
    sides = ((shown.first, pair.first, pair.second), (shown.second, pair.second, pair.first))
    return [
        heading,
        f"<p>{_words(shown, unit)}</p>",
        '<div class="pictures">',
        *(
            figure(
                image,
                f"{name} in the colours of its distance to {other}",
                f"<b>{escape(name)}</b> by its distance to {escape(other)}{'' if shown.are_same else bar}",
            )
            for image, name, other in sides
        ),
        "</div>",
    ]


def _words(shown: DistanceImages, unit: str) -> str:
    if shown.are_same:
        return "No distance: the surfaces are the same."
    if shown.are_vertices_same:
        words = (
            f"No distance at the vertices; up to {shown.largest:.3g} {unit} between them, where polygons are cut into "
            "triangles along other diagonals."
        )
    else:
        words = f"Largest distance, the larger one of both ways (Hausdorff): {shown.largest:.4g} {unit}."
    if shown.is_signed:
        return f"{words} Red lies outside of the other surface, blue inside, pale on it."
    return f"{words} Without a sign: the triangles of one surface do not agree on which side is outside."
