"""The part of the Compare panel that colours two surfaces by their distance to each other."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QCheckBox, QLabel, QPushButton, QSizePolicy, QWidget

from volviz.compare.distance_colors import DistanceColors
from volviz.model.comparison import Comparison
from volviz.model.store import Store
from volviz.model.ticks import NARROW, number_text
from volviz_ui.commands.compare import CompareCommands
from volviz_ui.compare.surface_distances import SurfaceDistances
from volviz_ui.editors.number import NumberField
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.panels.panel import Section
from volviz_ui.widgets.binding import show_value
from volviz_ui.widgets.progress_bar import ProgressBar
from volviz_ui.widgets.small import quiet_label

LEAST, MOST = 1e-9, 1e9
"""Limits of the scale, in world units."""


class DistanceSection(Section):
    """Shows and changes how surfaces are coloured by their distance, and says what was found."""

    def __init__(self, title: str, store: Store, commands: CompareCommands, parent: QWidget) -> None:
        super().__init__(title, parent=parent)
        self._commands = commands
        self.choice = NoWheelComboBox(self)
        self.choice.setToolTip(
            self.tr(
                "Colour each of the two surfaces by the distance of its points to the other one (Shift+F9)"
            )
        )
        self.choice.setAccessibleName(self.tr("Colours of the surfaces"))
        # without Expanding, the fixed width of the field below would determine the width of the column
        self.choice.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        for words, value in (
            (self.tr("Their own"), "off"),
            (self.tr("Distance, signed"), "signed"),
            (self.tr("Distance"), "absolute"),
        ):
            self.choice.addItem(words, value)
        self.choice.activated.connect(
            lambda index: self._commands.change(distances=self.choice.itemData(index))
        )
        self.add_row(self.tr("Colours"), self.choice)
        self.automatic = QCheckBox(self.tr("Scale by the largest distance"), self)
        self.automatic.setToolTip(
            self.tr(
                "Let the strongest colour stand for the largest distance there is between the two surfaces"
            )
        )
        self.automatic.setAccessibleName(self.automatic.text())
        self.automatic.toggled.connect(self._on_automatic)
        self.add_wide(self.automatic)
        self.limit = NumberField(parent=self)
        self.limit.setRange(LEAST, MOST)
        self.limit.setValue(1.0)
        self.limit.setToolTip(self.tr("Distance that gets the strongest colour, in the unit of the volume"))
        self.limit.setAccessibleName(self.tr("Scale of the distance"))
        self.limit.valueChanged.connect(lambda value: self._commands.change(distance_limit=value))
        self._limit_words: QLabel = self.add_row(self.tr("Scale"), self.limit)
        self.state = quiet_label("", self)
        self.state.setWordWrap(True)
        self.bar = ProgressBar(self)
        self.bar.setAccessibleName(self.tr("Progress of the distance"))
        self.bar.setToolTip(self.tr("How far the distance is"))
        self.cancel_button = QPushButton(self.tr("Cancel"), self)
        self.cancel_button.setToolTip(
            self.tr("Give the distance up and show the surfaces in their own colours")
        )
        self.cancel_button.clicked.connect(lambda: self._commands.change(distances="off"))
        for widget in (self.state, self.bar, self.cancel_button):
            self.add_wide(widget)
        self.show_state("")
        show_value(store, lambda scene: scene.comparison, self.show_comparison)

    def follow(self, distances: SurfaceDistances) -> None:
        """Show what is measured from now on."""
        distances.available_changed.connect(self.setVisible)
        distances.progressed.connect(self.show_progress)
        distances.state_changed.connect(self.show_state)
        distances.found.connect(self.show_found)
        distances.sync()

    def show_comparison(self, comparison: Comparison) -> None:
        """Show how surfaces are coloured."""
        self.choice.setCurrentIndex(self.choice.findData(comparison.distances))
        blockers = [QSignalBlocker(widget) for widget in (self.automatic, self.limit)]
        self.automatic.setChecked(comparison.distance_limit is None)
        if comparison.distance_limit is not None:
            self.limit.setValue(comparison.distance_limit)
        for blocker in blockers:
            blocker.unblock()
        colored = comparison.distances != "off"
        self.automatic.setVisible(colored)
        for part in (self._limit_words, self.limit):
            part.setVisible(colored and comparison.distance_limit is not None)

    def _on_automatic(self, on: bool) -> None:
        self._commands.change(distance_limit=None if on else self.limit.value())

    def show_progress(self, fraction: float) -> None:
        """How far the distance is, 0..1."""
        self.show_state(self.tr("Measuring the distance…"))
        self.bar.show_fraction(fraction)
        self.bar.show()
        self.cancel_button.show()

    def show_state(self, words: str) -> None:
        """Nothing is being measured; say what is shown, or why not."""
        self.state.setText(words)
        self.state.setVisible(bool(words))
        self.bar.hide()
        self.cancel_button.hide()

    def show_found(self, found: DistanceColors, unit: str, sign_requested: bool) -> None:
        """Say what the colours show."""
        length = f"{number_text(found.largest, 4)}{NARROW}{unit}"
        if found.are_same:
            self.show_state(self.tr("No distance: the surfaces are the same."))
            return
        if self.automatic.isChecked():
            # what a scale of one's own begins with
            blocker = QSignalBlocker(self.limit)
            self.limit.setValue(found.largest)
            blocker.unblock()
        self.limit.setSuffix(NARROW + unit)
        if found.are_vertices_same:
            words = [
                self.tr(
                    "No distance at the vertices; up to %1 between them, where polygons are cut into triangles along "
                    "other diagonals."
                ).replace("%1", length)
            ]
        else:
            words = [
                self.tr("Largest distance, the larger one of both ways (Hausdorff): %1.").replace(
                    "%1", length
                )
            ]
        if found.is_signed:
            words.append(self.tr("Red lies outside of the other surface, blue inside."))
        elif sign_requested:
            words.append(
                self.tr("Without a sign: the triangles of one surface do not agree on which side is outside.")
            )
        self.show_state(" ".join(words))
