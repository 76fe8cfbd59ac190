"""What may stand around the volume in a view, by the one list of what belongs into a picture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pyvista as pv
from PySide6.QtCore import QPointF

from volviz.annotations.background import BOTTOM, GROUND, TOP
from volviz.annotations.picture import shapes_around
from volviz.annotations.planes import subject_of_view
from volviz.annotations.projection import Projection
from volviz.annotations.shapes import Shape
from volviz.annotations.style import Style
from volviz.annotations.subject import Subject, surface_bar
from volviz.custom_gl.resolve import ResolvedSpec
from volviz.measure.readings import words_beside
from volviz.model.measurements import Measurement
from volviz.model.picture import SWITCHES, PictureContents
from volviz.model.surface_values import SurfaceColors
from volviz.volume_data.volume import Volume
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.views import tilt_handles
from volviz_ui.views.overlay import Overlay
from volviz_ui.views.viewport import Viewport

"""Colours of the background: dark in both themes, since light is added up in front of it."""

_EDGES = [(a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit]


class Annotations:
    """Shows over a view what the user switches on; the box lies in the scene, all else on a sheet above.

    Parameters
    ----------
    viewport : Viewport
        What the view is shown in.
    view : int
        Number of the view.
    resolved : callable
        What the view draws now; None for nothing.
    """

    def __init__(self, viewport: Viewport, view: int, resolved: Callable[[], ResolvedSpec | None]) -> None:
        self._viewport, self._view, self._resolved = viewport, view, resolved
        self._loaded = LoadedScene()
        self._contents = PictureContents()
        self._box: Any = None
        self._values: SurfaceColors | None = None
        self._unit = ""
        self._note = ""
        self._pending: Measurement | None = None
        self._scale = 1.0
        self._told: tuple[object, Subject] | None = None
        self._laid_out: tuple[object, tuple[Shape, ...]] | None = None
        self.overlay = Overlay(self._shapes, viewport)
        viewport.render_asked.connect(self.overlay.refresh)
        viewport.set_background(BOTTOM, top=TOP)

    # ------------------------------------------------------------------ what is shown

    @property
    def contents(self) -> PictureContents:
        """What stands around the volume now: values on a surface are explained in any case."""
        return replace(self._contents, bar=self._contents.bar or self._values is not None)

    @property
    def scale(self) -> float:
        """Size of letters and lines, 1 as usual."""
        return self._scale

    @scale.setter
    def scale(self, scale: float) -> None:
        self._scale = scale
        self._viewport.render()

    def is_shown(self, name: str) -> bool:
        """Whether one of `volviz.model.picture.SWITCHES` is on."""
        return name in self._contents.names

    def show(self, name: str, on: bool) -> None:
        """Switch one of `volviz.model.picture.SWITCHES` on or off."""
        if name not in SWITCHES:
            raise ValueError(name)
        self._contents = replace(self._contents, **{name: on})
        if name == "box":
            self._show_box()
        self._viewport.render()

    def show_change(self, old: LoadedScene, new: LoadedScene) -> None:
        """Stand around another volume, in other colours, before another background."""
        self._loaded = new
        color = new.scene.background
        if color != old.scene.background:
            if color is None:
                self._viewport.set_background(BOTTOM, top=TOP)
            else:
                self._viewport.set_background(color)
        if new.volume is not old.volume or color != old.scene.background:
            self._show_box()
        self._viewport.render()

    def show_pending(self, pending: Measurement | None) -> None:
        """Draw a measurement that is not yet in the scene, None for none."""
        if pending != self._pending:
            self._pending = pending
            self._told = None
            # nothing of the volume changes
            self.overlay.refresh()

    def show_values(self, colors: SurfaceColors | None, unit: str = "", note: str = "") -> None:
        """Explain the colours of a surface by a bar, in the place of that of the transfer function.

        Parameters
        ----------
        colors : SurfaceColors or None
            None for the usual bar.
        unit : str
            Of the values.
        note : str
            A line at the lower edge.
        """
        if (colors, unit, note) != (self._values, self._unit, self._note):
            self._values, self._unit, self._note = colors, unit, note
            self._told = None
            self._viewport.render()

    # ------------------------------------------------------------------ shapes

    def subject(self) -> Subject | None:
        """What is told of; None while nothing is drawn."""
        shown, scene = self._resolved(), self._loaded.scene
        if shown is None or self._loaded.volume is None:
            return None
        key = (shown, scene)
        if self._told is None or self._told[0] != key:
            subject = subject_of_view(scene, self._view, shown, self._loaded.volumes)
            if self._values is not None:
                subject = replace(subject, bar=surface_bar(self._values, self._unit))
            if self._pending is not None:
                named = bool(self._pending.name)
                words = words_beside(self._pending, self._loaded.volume) if named else ""
                measured = (*subject.measurements, (self._pending, words))
                subject = replace(subject, measurements=measured)
            self._told = (key, replace(subject, note=self._note))
        return self._told[1]

    def is_on_knob(self, position: QPointF) -> bool:
        """Whether a knob that turns slices lies at a place of the viewport."""
        subject = self.subject()
        if subject is None or not self._contents.cross_hair:
            return False
        return tilt_handles.is_on_knob(subject, self._projection, (position.x(), position.y()))

    @property
    def _projection(self) -> Projection:
        size = (max(self._viewport.width(), 1), max(self._viewport.height(), 1))
        return Projection(self._viewport.view_camera, size)

    def _shapes(self) -> tuple[Shape, ...]:
        size = (max(self._viewport.width(), 1), max(self._viewport.height(), 1))
        subject = self.subject()
        if subject is None:
            return ()
        contents = replace(self.contents, box=False)
        camera = self._viewport.view_camera
        key = (contents, subject, camera, size, self._scale)
        if self._laid_out is None or self._laid_out[0] != key:
            ground = self._loaded.scene.background or GROUND
            shapes = shapes_around(contents, subject, camera, size, background=ground, scale=self._scale)
            if contents.cross_hair:
                shapes = (*shapes, *tilt_handles.shapes(subject, Projection(camera, size)))
            self._laid_out = (key, shapes)
        return self._laid_out[1]

    def _show_box(self) -> None:
        volume: Volume | None = self._loaded.volume
        if self._box is not None:
            self._viewport.remove_actor(self._box, reset_camera=False, render=False)
            self._box = None
        if self._contents.box and volume is not None:
            lines = np.array([(2, a, b) for a, b in _EDGES]).ravel()
            mesh = pv.PolyData(np.asarray(volume.corners, float), lines=lines)
            self._box = self._viewport.add_mesh(
                mesh,
                color=Style(ground=self._loaded.scene.background or GROUND).quiet,
                line_width=1.0,
                lighting=False,
                reset_camera=False,
                render=False,
                pickable=False,
            )
