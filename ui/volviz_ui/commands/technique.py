"""The Technique menu: which technique draws, how finely it samples, its debug view."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QObject

from volviz.custom_gl.scene_techniques import (
    change_setting,
    choose_technique,
    counterparts,
    current_settings,
    current_technique,
    drawing_techniques,
    reset_settings,
)
from volviz.custom_gl.technique import TechniqueInfo
from volviz.errors import SettingError
from volviz.model.parameters import Parameter
from volviz.model.scene import Scene
from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Command, Menu
from volviz_ui.library_words import translated

FACTOR = 1.25
"""How much one press of + or - changes the number of slices, or the step."""


class TechniqueCommands(QObject):
    """Chooses the technique of the active view and changes its sampling."""

    def __init__(self, context: AppContext) -> None:
        super().__init__(context.window)
        self._store = context.store

    def menu(self) -> Menu:
        """The table of its commands."""
        tr = self.tr
        return Menu(
            tr("&Technique"),
            [
                *(self._choice(number, info) for number, info in enumerate(drawing_techniques(), start=1)),
                Menu(tr("For c&omparison"), [self._choice(None, info) for info in counterparts()]),
                None,
                Command(
                    "technique.finer", tr("&More slices, smaller steps"), tr("Sample the volume more finely"),
                    partial(self.refine, 1), keys=("+", "="), enabled=lambda state: is_sampled(state.scene),
                ),
                Command(
                    "technique.coarser", tr("&Fewer slices, larger steps"), tr("Sample the volume more coarsely"),
                    partial(self.refine, -1), keys=("-",), enabled=lambda state: is_sampled(state.scene),
                ),
                Command(
                    "technique.machinery", tr("Show ho&w it works"),
                    tr("Wireframe, or what else the technique can show"), self.toggle_debug_view, keys=("W",),
                    enabled=lambda state: bool({"wireframe", "display"} & _parameters(state.scene).keys()),
                ),
                Command(
                    "technique.reset", tr("&Reset settings"),
                    tr("All settings of this technique back to their defaults"), self.reset_settings,
                ),
            ],
        )  # fmt: skip

    def _choice(self, number: int | None, info: TechniqueInfo) -> Command:
        return Command(
            f"technique.use.{info.id}", translated(info.label), translated(info.summary),
            partial(choose_technique, self._store, info.id),
            keys=(str(number),) if number is not None and number <= 9 else (), group="technique",
            checked=lambda state: current_technique(state.scene).id == info.id,
        )  # fmt: skip

    def refine(self, direction: int) -> None:
        """More (1) or fewer (-1) slices, or smaller or larger steps."""
        parameters = _parameters(self._store.scene)
        settings = current_settings(self._store.scene)
        if "slices" in parameters and settings.slices is not None:
            self._scale(parameters["slices"], FACTOR**direction)
        elif "step" in parameters:
            self._scale(parameters["step"], FACTOR**-direction)

    def _scale(self, parameter: Parameter, factor: float) -> None:
        value = getattr(current_settings(self._store.scene), parameter.name) * factor
        if parameter.kind == "int":
            value = round(value)
        if parameter.minimum is not None:
            value = max(value, parameter.minimum)
        if parameter.maximum is not None:
            value = min(value, parameter.maximum)
        try:
            change_setting(self._store, parameter, float(f"{value:.4g}"))
        except SettingError:
            return

    def toggle_debug_view(self) -> None:
        """Switch the wireframe, or between the image and the first debug view."""
        parameters = _parameters(self._store.scene)
        settings = current_settings(self._store.scene)
        if "wireframe" in parameters:
            change_setting(self._store, parameters["wireframe"], not settings.wireframe)
        elif "display" in parameters:
            values = [value for value, _label in parameters["display"].choices]
            lines = [value for value in values[1:] if "wire" in value or "slice" in value] or values[1:]
            shown = settings.display == values[0]
            if lines:
                change_setting(self._store, parameters["display"], lines[0] if shown else values[0])

    def reset_settings(self) -> None:
        """All settings of the technique back to their defaults."""
        reset_settings(self._store, self.tr("Reset settings"))


def is_sampled(scene: Scene) -> bool:
    """Whether the technique of the active view takes samples whose number can be changed."""
    parameters = _parameters(scene)
    return "step" in parameters or ("slices" in parameters and current_settings(scene).slices is not None)


def _parameters(scene: Scene) -> dict[str, Parameter]:
    return {parameter.name: parameter for parameter in current_technique(scene).parameters}
