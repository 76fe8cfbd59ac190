"""What the View and Technique menus do: cameras, scenery, finer and coarser sampling."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from volviz.custom_gl.scene_techniques import (
    change_setting,
    current_settings,
    current_technique,
    reset_settings,
)
from volviz.custom_gl.technique import drawn_function
from volviz.errors import SettingError
from volviz.framing import default_camera
from volviz.model.parameters import Parameter
from volviz_ui.views.camera_moves import axis_camera

if TYPE_CHECKING:
    from volviz_ui.main_window import MainWindow

FACTOR = 1.25
"""How much one press of + or - changes the number of slices, or the step."""


class ViewCommands(QObject):
    """Looks at the scene in other ways for the window."""

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self._window = window

    def reset_camera(self) -> None:
        """See all that is visible, a little from the side, as at first."""
        volume, scene = self._window.documents.volume, self._window.store.scene
        if volume is not None and scene.layer is not None:
            function = drawn_function(
                current_technique(scene), current_settings(scene), scene.layer.transfer_function
            )
            camera = default_camera(volume, self._window.viewport.pixel_size, transfer_function=function)
            self._window.display.show_camera(self._with_projection(camera))

    def show_axis_view(self, letter: str) -> None:
        """Look from anterior, posterior, left, right, superior or inferior."""
        volume = self._window.documents.volume
        if volume is not None:
            camera = axis_camera(volume, letter, self._window.viewport.aspect)
            self._window.display.show_camera(self._with_projection(camera))

    def set_parallel(self, on: bool) -> None:
        """Parallel projection or perspective; what lies at the focal point keeps its size."""
        self._window.preferences.set_shows("parallel", on)
        if self._window.documents.volume is not None:
            self._window.display.show_camera(self._with_projection(self._window.viewport.view_camera))

    def _with_projection(self, camera: object) -> object:
        on = self._window.actions_.parallel.isChecked()
        scale = camera.scale if on else None  # type: ignore[attr-defined]
        return replace(camera, parallel=on, parallel_scale=scale)  # type: ignore[type-var]

    def show_scenery(self, name: str, on: bool) -> None:
        """Switch box, axes, orientation marker or colour bar."""
        self._window.preferences.set_shows(name, on)
        self._window.views.show_scenery(name, on)

    def show_handles(self, on: bool) -> None:
        """Show or hide what can be dragged in the picture: light and cut plane."""
        self._window.preferences.set_shows("handles", on)
        self._window.views.shows_handles = on

    def set_background(self, color: tuple[float, float, float] | None, _checked: bool = False) -> None:
        """One colour behind the volume, or the usual gradient."""
        self._window.store.update(lambda scene: replace(scene, background=color), label=self.tr("Background"))

    def refine(self, direction: int) -> None:
        """More (1) or fewer (-1) slices, or smaller or larger steps."""
        parameters = {p.name: p for p in current_technique(self._window.store.scene).parameters}
        settings = current_settings(self._window.store.scene)
        if "slices" in parameters and settings.slices is not None:
            self._scale(parameters["slices"], FACTOR**direction)
        elif "step" in parameters:
            self._scale(parameters["step"], FACTOR**-direction)

    def _scale(self, parameter: Parameter, factor: float) -> None:
        value = getattr(current_settings(self._window.store.scene), parameter.name) * factor
        if parameter.kind == "int":
            value = round(value)
        if parameter.minimum is not None:
            value = max(value, parameter.minimum)
        if parameter.maximum is not None:
            value = min(value, parameter.maximum)
        try:
            change_setting(self._window.store, parameter, float(f"{value:.4g}"))
        except SettingError:
            return

    def toggle_machinery(self) -> None:
        """Switch the wireframe, or between the picture and the first view of the machinery."""
        parameters = {p.name: p for p in current_technique(self._window.store.scene).parameters}
        settings = current_settings(self._window.store.scene)
        if "wireframe" in parameters:
            change_setting(self._window.store, parameters["wireframe"], not settings.wireframe)
        elif "display" in parameters:
            values = [value for value, _label in parameters["display"].choices]
            lines = [value for value in values[1:] if "wire" in value or "slice" in value] or values[1:]
            shown = settings.display == values[0]
            if lines:
                change_setting(self._window.store, parameters["display"], lines[0] if shown else values[0])

    def reset_settings(self) -> None:
        """All settings of the technique back to their defaults."""
        reset_settings(self._window.store, self.tr("Reset settings"))
