"""The Measure menu: tools that place points, and what is done with all measurements."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import QObject, Qt
from PySide6.QtWidgets import QFileDialog

from volviz.errors import LoadError
from volviz.measure.readings import to_csv, to_json
from volviz.model.manipulators import as_vector
from volviz.model.measurement_edits import without_measurements
from volviz.model.measurements import Kind
from volviz.new_files import written_beside
from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Command, Menu, State, has_volume
from volviz_ui.commands.view import ViewCommands
from volviz_ui.measuring.panel import MeasurementsPanel, volumes_of
from volviz_ui.measuring.tool import MeasureTool

#: What to do next is told so long; then the line tells again what is under the pointer.
HINT_MS = 6000


class MeasureCommands(QObject):
    """Takes up tools, exports, and looks at single measurements."""

    def __init__(
        self, context: AppContext, tool: MeasureTool, panel: MeasurementsPanel, views: ViewCommands
    ) -> None:
        super().__init__(context.window)
        self._context, self._tool, self._panel, self._views = context, tool, panel, views
        panel.chosen.connect(self.look_at)
        panel.export_requested.connect(self.export)
        tool.hinted.connect(self._hint)
        tool.finished.connect(self._on_finished)

    def menu(self) -> Menu:
        """The table of its commands."""
        tr = self.tr
        return Menu(
            tr("&Measure"),
            [
                self._tool_command("distance", tr("&Distance"), tr("From one point to another"), "Shift+D", "ruler"),
                self._tool_command("polyline", tr("&Line with corners"), tr("Length through points"), "Shift+L"),
                self._tool_command("angle", tr("&Angle"), tr("At the second of three points"), "Shift+A"),
                self._tool_command("polygon", tr("&Polygon"), tr("Area, perimeter and statistics"), "Shift+P"),
                self._tool_command("ellipse", tr("&Ellipse"), tr("Area, perimeter and statistics"), "Shift+E"),
                self._tool_command("profile", tr("Pro&file"), tr("Values along a line"), "Shift+R"),
                None,
                self._tool_command("point", tr("&Mark a point"), tr("Its name stands beside it"), "Shift+O"),
                self._tool_command("arrow", tr("Arrow &with text"), tr("Point at something"), "Shift+W"),
                None,
                Command(
                    "measure.none", tr("Put the tool awa&y"), tr("Clicks mean what they meant before"),
                    partial(self._tool.hold, None), enabled=lambda state: _held(state) != "",
                ),
                Command(
                    "measure.export", tr("E&xport measurements…"), tr("Write all of them into a table or JSON"),
                    self.export, enabled=_has_measurements,
                ),
                Command(
                    "measure.delete_all", tr("Delete all"), tr("Delete all but those that are locked"),
                    self.delete_all, enabled=_has_measurements,
                ),
            ],
        )  # fmt: skip

    def _tool_command(self, kind: Kind, words: str, tip: str, key: str, icon: str = "") -> Command:
        return Command(
            f"measure.{kind}", words, tip, partial(self.hold, kind), keys=(key,), icon=icon, enabled=has_volume,
            checked=lambda state: _held(state) == kind,
        )  # fmt: skip

    def hold(self, kind: Kind, on: bool) -> None:
        """Take up a tool, or put it away."""
        self._tool.hold(kind if on else None)
        if on and "measurements" not in self._context.views.shown_names:
            self._views.show_annotations("measurements", True)

    def look_at(self, number: int) -> None:
        """Let cross-hair and slices stand in the middle of a measurement."""
        scene = self._context.store.scene
        if number < len(scene.measurements):
            places = [point.position for point in scene.measurements[number].points]
            middle = as_vector(np.mean(places, axis=0))
            self._context.store.update(
                lambda scene: replace(scene, cursor=middle), label=self.tr("Look at a measurement")
            )

    def delete_all(self) -> None:
        """Delete all measurements that are not locked."""
        self._context.store.update(
            lambda scene: without_measurements(scene, set(range(len(scene.measurements)))),
            label=self.tr("Delete measurements"),
        )

    def export(self) -> None:
        """Ask for a file and write all measurements into it."""
        path, _filter = QFileDialog.getSaveFileName(
            self._context.window, self.tr("Export measurements"),
            str(Path(self._context.preferences.folder) / "measurements.csv"),
            self.tr("Table (*.csv);;JSON (*.json)"),
        )  # fmt: skip
        if path:
            try:
                self.write(Path(path))
            except LoadError as error:
                self._context.messages.show_error(self.tr("Export measurements"), error)

    def write(self, path: Path) -> None:
        """Write all measurements; the suffix says how."""
        shown = self._context.documents.shown
        make = to_json if path.suffix.lower() == ".json" else to_csv
        text = make(shown.scene.measurements, volumes_of(shown))
        with written_beside(path) as beside:
            beside.write_text(text, encoding="utf-8")

    def _hint(self, words: str) -> None:
        self._context.messages.show_status(words, HINT_MS)

    def _on_finished(self, number: int) -> None:
        self._context.docks.show("measurements")
        self._panel.choose(number)
        if self._context.store.scene.measurements[number].kind in ("point", "arrow"):
            # the text is what it is for
            self._panel.list.setFocus(Qt.FocusReason.OtherFocusReason)
            self._panel.list.editItem(self._panel.list.topLevelItem(number), 0)


def _held(state: State) -> str:
    """The tool that is held, empty for none."""
    return next((name.removeprefix("tool.") for name in state.shown if name.startswith("tool.")), "")


def _has_measurements(state: State) -> bool:
    return bool(state.scene.measurements)
