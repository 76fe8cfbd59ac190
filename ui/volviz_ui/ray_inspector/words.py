"""What the ray inspector says in words; the numbers come from `volviz.ray_inspection`."""

from __future__ import annotations

from collections.abc import Callable

from volviz.custom_gl.registry import techniques
from volviz.ray_inspection import RayInspection
from volviz_ui.library_words import translated

Translate = Callable[[str], str]


def fill(text: str, *values: str) -> str:
    """`text` with %1, %2, … replaced."""
    for number, value in enumerate(values, start=1):
        text = text.replace(f"%{number}", value)
    return text


def end_words(found: RayInspection, length_unit: str, tr: Translate) -> str:
    """One sentence on where the ray ends and why."""
    if found.ends == "missed":
        return tr("This ray misses what is shown of the volume.")
    length = f"{found.span.exit - found.span.entry:.4g} {length_unit}".strip()
    if found.ends == "opacity":
        gone = f"{found.profile.distances[-1]:.4g}"
        text = tr("Ends after %1 of %2: enough opacity has gathered (early termination at %3 %).")
        return fill(text, gone, length, f"{100 * found.profile.color[3]:.1f}")
    reasons = {
        "box": tr("leaves the volume"),
        "crop": tr("leaves the crop box"),
        "plane": tr("meets a clip plane"),
        "mesh": tr("meets opaque geometry"),
        "far": tr("reaches the far end of the view"),
    }
    return fill(tr("Runs through %1 and ends where it %2."), length, reasons[found.ends])


def notes(found: RayInspection, tr: Translate) -> list[str]:
    """What one should know before comparing the numbers with the image."""
    said = []
    if not found.exact:
        known = techniques()
        label = translated(known[found.technique].label) if found.technique in known else found.technique
        text = tr("%1 does not gather samples like this; shown is what ray casting would gather.")
        if found.crossings:
            first = found.crossings[0]
            text = fill(
                tr("%1 shows surfaces: this ray meets the first one, of value %2, at %3. The samples are what ray casting would gather."),  # noqa: E501
                "%1", f"{first.isovalue:.6g}", f"{first.distance:.4g}",
            )  # fmt: skip
        said.append(fill(text, label))
    if found.acts_on_scalar:
        said.append(
            tr(
                "The mode makes one value of all samples and classifies that; the line steps where it changes."
            )
        )
    if found.shows_debug_view:
        said.append(tr("The picture shows how the technique works; these are the samples of the volume."))
    if found.reduced:
        said.append(tr("Mipmaps are on: the picture may be drawn from smoothed data, these samples are not."))
    if found.preintegrated:
        said.append(tr("Pre-integrated: each piece of ray is classified by the values at both its ends."))
    return said


def sample_words(found: RayInspection, index: int, unit: str, length_unit: str, tr: Translate) -> str:
    """One sample in one line: number, distance, value, opacity, what it adds and what has gathered."""
    profile = found.profile
    before = 0.0 if index == 0 else float(profile.accumulated[index - 1, 3])
    after = float(profile.accumulated[index, 3])
    return fill(
        tr("%1 / %2  ·  %3  ·  %4  ·  opacity %5  ·  adds %6  ·  gathered %7"),
        str(index + 1),
        str(len(profile.values)),
        f"{profile.distances[index]:.4g} {length_unit}".strip(),
        f"{profile.values[index]:.5g} {unit}".strip(),
        f"{profile.opacities[index]:.3g}",
        f"{after - before:.2g}",
        f"{after:.3f}",
    )
