"""The cross-hair of slices: where the other planes cut this one; their outlines in three dimensions; what is where."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyvista as pv
from vtkmodules.vtkRenderingCore import (
    vtkActor2D,
    vtkCoordinate,
    vtkPolyDataMapper2D,
    vtkTextActor,
)

from volviz.custom_gl.scene_techniques import current_settings, faced
from volviz.kernels.slices import crop_corners, slice_polygons
from volviz.model.cursor import cursor_of
from volviz.model.scene import Scene
from volviz.volume_data.volume import Volume
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.style.plane_colors import COLORS
from volviz_ui.views.viewport import Viewport

#: Formats of medicine, whose world axes are those of a patient.
ANATOMICAL = frozenset({"DICOM", "NIfTI", "NRRD", "MetaImage", "MGH", "MINC", "AFNI", "PAR/REC", "GIPL"})
#: Letters of the directions x, y and z, towards lower and higher values: right and left, front and back, feet and head.
LETTERS = (("R", "L"), ("A", "P"), ("I", "S"))
#: A direction gets a second letter when it leans by more than this share towards another axis.
LEANING = 0.35
TEXT = (0.86, 0.89, 0.92)
SHADE = (0.05, 0.06, 0.08)


class CrossHair:
    """Draws over one view; nothing where the scene has no slices that are faced.

    Parameters
    ----------
    viewport : Viewport
        Over which it is drawn.
    view : int
        Number of the view.
    """

    def __init__(self, viewport: Viewport, view: int) -> None:
        self._viewport = viewport
        self._view = view
        self._on = True
        self._shown = LoadedScene()
        self._lines: list[vtkActor2D] = []
        self._letters: list[vtkTextActor] = []
        self._key: object = None

    def show(self, on: bool) -> None:
        """Switch lines and letters on or off."""
        self._on = on
        self._update()

    def show_change(self, shown: LoadedScene) -> None:
        """Follow the scene."""
        self._shown = shown
        self._update()

    def _update(self) -> None:
        scene, volume = self._shown.scene, self._shown.volume
        lines, letters = [], ()
        if self._on and volume is not None:
            lines = plane_lines(scene, volume, self._view)
            own = faced(scene, self._view)
            letters = edge_letters(*own, is_anatomical=is_anatomical(volume)) if own is not None else ()
        key = ([(color, points.tobytes()) for color, points in lines], letters)
        if key == self._key:
            return
        self._key = key
        for actor in (*self._lines, *self._letters):
            self._viewport.renderer.RemoveViewProp(actor)
        # dark below bright, so that they are seen on any slice
        self._lines = [
            _line(points, shade, width)
            for color, points in lines
            for shade, width in ((SHADE, 3.0), (color, 1.25))
        ]
        self._letters = [_letter(words, place) for words, place in letters]
        for actor in (*self._lines, *self._letters):
            self._viewport.renderer.AddViewProp(actor)
        self._viewport.render()


def plane_lines(
    scene: Scene, volume: Volume, view: int
) -> list[tuple[tuple[float, float, float], np.ndarray]]:
    """Colours and world points (N, 3), joined by lines, of what a view shows of the planes of others.

    A view that faces a plane shows where the others cut it, all others their outlines.
    """
    cursor, own = np.asarray(cursor_of(scene, volume)), faced(scene, view)
    reach = float(np.linalg.norm(volume.extent))
    found = []
    for number in range(len(scene.views)):
        other = faced(scene, number)
        if other is None or number == view:
            continue
        color = COLORS[current_settings(scene, number).plane]
        normal = np.asarray(other[0])
        if own is None:
            corners = crop_corners(volume.index_to_world, None, volume.dimensions)
            vertices, counts = slice_polygons(corners, normal, [normal @ cursor])
            if counts[0]:
                outline = vertices[0, : counts[0]]
                found.append((color, np.concatenate([outline, outline[:1]])))
            continue
        along = np.cross(normal, own[0])
        length = float(np.linalg.norm(along))
        if length > 1e-6:
            found.append((color, cursor + np.outer((-reach, reach), along / length)))
    return found


def edge_letters(
    normal: Sequence[float], up: Sequence[float], *, is_anatomical: bool
) -> tuple[tuple[str, tuple[float, float]], ...]:
    """What lies at the right, left, upper and lower edge of a faced plane, and where it is written (0..1)."""
    right = np.cross(up, normal)
    places = (
        (right, (0.975, 0.5)), (-right, (0.025, 0.5)), (np.asarray(up), (0.5, 0.96)), (-np.asarray(up), (0.5, 0.04)),
    )  # fmt: skip
    return tuple((direction_words(axis, is_anatomical=is_anatomical), place) for axis, place in places)


def direction_words(direction: np.ndarray, *, is_anatomical: bool) -> str:
    """A direction in the world as letters of anatomy, "LA" where it leans, or as an axis with its sign."""
    strength = np.abs(direction)
    order = [int(axis) for axis in np.argsort(-strength, kind="stable") if strength[axis] >= LEANING]
    order = order or [int(np.argmax(strength))]
    if is_anatomical:
        return "".join(LETTERS[axis][int(direction[axis] > 0)] for axis in order)
    first = order[0]
    return ("+" if direction[first] > 0 else "−") + "xyz"[first]


def is_anatomical(volume: Volume) -> bool:
    """Whether the world axes of a volume are those of a patient, as far as the kind of its file says so."""
    return volume.metadata.get("format") in ANATOMICAL


def _line(points: np.ndarray, color: tuple[float, float, float], width: float) -> vtkActor2D:
    mesh = pv.PolyData(np.asarray(points, float), lines=np.array([len(points), *range(len(points))]))
    world = vtkCoordinate()
    world.SetCoordinateSystemToWorld()
    mapper = vtkPolyDataMapper2D()
    mapper.SetInputData(mesh)
    mapper.SetTransformCoordinate(world)
    actor = vtkActor2D()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*color)
    actor.GetProperty().SetLineWidth(width)
    actor.GetProperty().SetOpacity(0.85)
    actor.PickableOff()
    return actor


def _letter(words: str, place: tuple[float, float]) -> vtkTextActor:
    actor = vtkTextActor()
    actor.SetInput(words)
    text = actor.GetTextProperty()
    text.SetColor(*TEXT)
    text.SetFontSize(14)
    text.SetBold(True)
    text.SetShadow(True)
    text.SetJustificationToCentered()
    text.SetVerticalJustificationToCentered()
    actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    actor.SetPosition(*place)
    actor.PickableOff()
    return actor
