"""Which views a picture is made of, and where each lies in it."""

from __future__ import annotations

from dataclasses import dataclass, field

from PySide6.QtCore import QPoint, QRect

from volviz.annotations.composition import CAPTION, TITLE
from volviz.custom_gl.scene_techniques import current_settings, current_technique, faced
from volviz.model.picture import PictureContents, PicturePart
from volviz.model.scene import Scene
from volviz_ui.library_words import translated
from volviz_ui.views.view_grid import ViewGrid
from volviz_ui.views.view_layout import GAP
from volviz_ui.views.view_widget import ViewWidget


@dataclass(frozen=True)
class PictureRequest:
    """A picture that is asked for.

    Attributes
    ----------
    size : tuple of 2 ints
        Width and height in pixels.
    transparent : bool
        Leave the background out, where the format can.
    contents : PictureContents
        What stands around the volume.
    view : int or None
        Number of the view; None for all that are seen.
    dpi : float
        Pixels to an inch of paper.
    keep_session : bool
        The file tells how it was made, where the format can.
    """

    size: tuple[int, int]
    transparent: bool = False
    contents: PictureContents = field(default_factory=PictureContents)
    view: int | None = None
    dpi: float = 96.0
    keep_session: bool = True


def size_on_screen(views: ViewGrid, view: int | None) -> tuple[int, int]:
    """Width and height of a picture of a view, or of all that are seen, as it is in the window; device pixels."""
    if view is not None or len(views.shown_view_widgets) == 1:
        return views.view_widgets[view or 0].viewport.pixel_size
    canvas, _places = _canvas(views)
    ratio = views.devicePixelRatioF()
    return round(canvas.width() * ratio), round(canvas.height() * ratio)


def parts_of(views: ViewGrid, scene: Scene, request: PictureRequest) -> list[PicturePart]:
    """The views of a picture and their places in it."""
    width, height = request.size
    if request.view is not None or len(views.shown_view_widgets) == 1:
        view = request.view or 0
        viewport = views.view_widgets[view].viewport
        return [PicturePart(view, (0, 0, width, height), (0, width), "", width / max(viewport.width(), 1))]
    canvas, places = _canvas(views)
    x = width / canvas.width()
    above = TITLE * x if request.contents.title else 0.0
    y = (height - above) / canvas.height()
    parts = []
    for view_widget, place in places:
        left, right = round(place.left() * x), round((place.left() + place.width()) * x)
        top, bottom = round(above + place.top() * y), round(above + (place.top() + place.height()) * y)
        rect = (left, top, max(right - left, 1), max(bottom - top, 1))
        seen = (left, left + rect[2])
        parts.append(PicturePart(view_widget.view, rect, seen, caption_of(scene, view_widget.view), x))
    if views.arrangement.wiped:
        first, second = parts
        border = round(scene.comparison.divider * width)
        parts = [
            PicturePart(first.view, first.place, (0, border), first.caption, x),
            PicturePart(second.view, second.place, (border, width), second.caption, x),
        ]
    return parts


def caption_of(scene: Scene, view: int) -> str:
    """What stands above a view: A or B and its technique, or its plane."""
    if faced(scene, view) is not None:
        plane = next(p for p in current_technique(scene, view).parameters if p.name == "plane")
        return translated(dict(plane.choices)[current_settings(scene, view).plane])
    side = "" if scene.pair is None or view not in scene.pair else "AB"[scene.pair.index(view)] + "  "
    return side + translated(current_technique(scene, view).label)


def _canvas(views: ViewGrid) -> tuple[QRect, list[tuple[ViewWidget, QRect]]]:
    """Size of a picture of all views that are seen, and their places in it, in pixels of the screen.

    Views that lie over one another come side by side, but for a wipe.
    """
    shown = views.shown_view_widgets
    if views.arrangement.overlaid:
        size = shown[0].viewport.size()
        if views.arrangement.wiped:
            place = QRect(QPoint(0, CAPTION), size)
            return QRect(0, 0, size.width(), size.height() + CAPTION), [(each, place) for each in shown]
        places = [QRect(QPoint(n * (size.width() + GAP), CAPTION), size) for n in range(len(shown))]
        return QRect(0, 0, places[-1].right() + 1, size.height() + CAPTION), list(
            zip(shown, places, strict=True)
        )
    found = []
    for view_widget in shown:
        corner = view_widget.viewport.mapTo(views, QPoint(0, 0))
        found.append((view_widget, QRect(corner, view_widget.viewport.size())))
    return QRect(QPoint(0, 0), views.size()), found
