"""All that stands around the volume in one picture."""

from __future__ import annotations

from volviz.annotations import margins, space
from volviz.annotations.measures import measures
from volviz.annotations.projection import Projection
from volviz.annotations.shapes import Color, Shape
from volviz.annotations.style import Style
from volviz.annotations.subject import Subject
from volviz.model.camera import Camera
from volviz.model.picture import PictureContents

#: Edge of a picture, the shorter one, whose letters have the size that they have on a screen.
USUAL_EDGE = 600.0


def usual_scale(size: tuple[int, int]) -> float:
    """Pixels for each of a screen's that letters and lines of a picture get where nobody says otherwise."""
    return max(min(size) / USUAL_EDGE, 0.75)


def shapes_around(
    contents: PictureContents,
    subject: Subject,
    camera: Camera,
    size: tuple[int, int],
    *,
    background: Color | None = None,
    scale: float | None = None,
) -> tuple[Shape, ...]:
    """What stands around the volume, as shapes in pixels, those behind others first.

    Parameters
    ----------
    contents : PictureContents
        What is wanted.
    subject : Subject
        What is told of.
    camera : Camera
        From where the picture is seen.
    size : tuple of 2 ints
        Width and height in pixels.
    background : tuple of 3 floats, optional
        What lies behind the volume; None for transparent pictures.
    scale : float, optional
        Size of letters and lines, 1 as on a screen; the default follows the size of the picture.
    """
    style = Style(usual_scale(size) if scale is None else scale, background)
    projection = Projection(camera, size)
    faces = contents.letters and subject.facing is not None
    # letters and numbers at the edges make room for one another
    letters = list(margins.letters(subject, projection, style)) if faces else []
    shapes: list[Shape] = []
    if contents.box:
        shapes += space.box(subject, projection, style)
    if contents.axes:
        shapes += space.axes(subject, projection, style, letters)
    if contents.cross_hair:
        shapes += space.cross_hair(subject, projection, style)
    if contents.measurements:
        shapes += measures(subject, projection, style)
    if contents.marker and not faces:
        shapes += space.marker(subject, projection, style)
    shapes += letters
    if contents.bar and subject.bar is not None:
        shapes += margins.bar(subject.bar, size, style, edge=2.4 * style.em if faces else 0.0)
    if contents.scale:
        shapes += margins.scale_bar(subject, projection, style)
    if contents.legend:
        shapes += margins.legend(subject.legend, style)
    if contents.title:
        shapes += margins.title(contents.title, size, style)
    if subject.note:
        shapes += margins.note(subject.note, size, style)
    return tuple(shapes)
