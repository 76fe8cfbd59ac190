"""The panel *Measurements*: a list of what was measured, all numbers of the chosen one, what can be done with it."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QColor, QIcon, QPixmap
from PySide6.QtWidgets import (
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QToolButton,
    QTreeWidget,
    QTreeWidgetItem,
    QWidget,
)

from volviz.errors import InputError
from volviz.measure.profiles import profile
from volviz.measure.readings import readings, rule_words
from volviz.model.layers import ImageLayer
from volviz.model.measurement_edits import with_measurement_changed, without_measurements
from volviz.model.measurements import Measurement
from volviz.model.store import Store
from volviz.volume_data.volume import Volume
from volviz_ui.editors.simple import chosen_color
from volviz_ui.measuring.profile_plot import ProfilePlot
from volviz_ui.panels.panel import Panel
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.style.icons import set_icon
from volviz_ui.widgets.binding import show_value
from volviz_ui.widgets.small import quiet_label, small_button


class MeasurementsPanel(Panel):
    """Shows `Scene.measurements`; every edit goes through the store.

    Parameters
    ----------
    store : Store
    documents : Documents
    """

    chosen = Signal(int)
    """Number of a measurement that is to be looked at."""
    export_requested = Signal()

    def __init__(self, store: Store, documents: Documents, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._store, self._documents = store, documents
        self._filling = False
        self.list = QTreeWidget(self)
        self.list.setColumnCount(2)
        self.list.setHeaderLabels([self.tr("Name"), self.tr("Value")])
        self.list.setRootIsDecorated(False)
        self.list.setUniformRowHeights(True)
        self.list.setEditTriggers(QTreeWidget.EditTrigger.EditKeyPressed)
        self.list.setAccessibleName(self.tr("Measurements"))
        self.list.setToolTip(self.tr("Double-click looks at it, F2 renames it, the tick shows or hides it"))
        self.list.header().setSectionResizeMode(0, QHeaderView.ResizeMode.Interactive)
        self.list.setMinimumHeight(140)
        self.hint = quiet_label(
            self.tr(
                "Nothing is measured yet. Choose what to measure in the menu Measure, then click in a picture."
            )
        )
        self.hint.setWordWrap(True)
        self.details = QLabel(self)
        self.details.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.details.setWordWrap(True)
        self.plot = ProfilePlot(self)
        self.plot.hide()
        buttons = QWidget(self)
        row = QHBoxLayout(buttons)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(2)
        self.go = self._button(
            "crosshair", self.tr("Look at it: slices and cross-hair move there"), self._look
        )
        self.color = self._button("palette", self.tr("Another colour"), self._recolor)
        self.lock = self._button("lock-simple", self.tr("Lock it: it cannot be moved or deleted"), self._lock)
        self.lock.setCheckable(True)
        self.delete = self._button("trash", self.tr("Delete it"), self._delete)
        self.export = self._button(
            "export", self.tr("Write all into a table or JSON"), self.export_requested.emit
        )
        for button in (self.go, self.color, self.lock, self.delete):
            row.addWidget(button)
        row.addStretch(1)
        row.addWidget(self.export)
        for widget in (self.hint, self.list, buttons, self.details, self.plot):
            self.add(widget)
        note = quiet_label(self.tr("± holds the true value in 95 of 100 cases. Not for diagnosis."))
        note.setWordWrap(True)
        self.add(note)
        self.list.itemChanged.connect(self._on_item_changed)
        self.list.itemDoubleClicked.connect(lambda _item, _column: self._look())
        self.list.currentItemChanged.connect(lambda _now, _before: self._show_details())
        show_value(documents, _listed, self._fill)

    # ------------------------------------------------------------------ the list

    @property
    def volumes(self) -> list[Volume]:
        """Of the image layers that are seen, the active one first."""
        return volumes_of(self._documents.shown)

    @property
    def number(self) -> int | None:
        """Which one is chosen."""
        row = self.list.indexOfTopLevelItem(self.list.currentItem()) if self.list.currentItem() else -1
        return row if 0 <= row < len(self._store.scene.measurements) else None

    def choose(self, number: int) -> None:
        """Choose one of the list."""
        item = self.list.topLevelItem(number)
        if item is not None:
            self.list.setCurrentItem(item)

    def _fill(self, listed: tuple[tuple[Measurement, ...], list[Volume]]) -> None:
        measurements, volumes = listed
        before = self.number
        self._filling = True
        while self.list.topLevelItemCount() > len(measurements):
            self.list.takeTopLevelItem(self.list.topLevelItemCount() - 1)
        for number, each in enumerate(measurements):
            item = self.list.topLevelItem(number)
            if item is None:
                item = QTreeWidgetItem(self.list)
            item.setFlags(item.flags() | Qt.ItemFlag.ItemIsUserCheckable | Qt.ItemFlag.ItemIsEditable)
            item.setText(0, each.name)
            item.setCheckState(0, Qt.CheckState.Checked if each.visible else Qt.CheckState.Unchecked)
            item.setIcon(0, _swatch(each))
            item.setText(1, _main(each, volumes))
        self._filling = False
        self.list.resizeColumnToContents(0)
        self.hint.setVisible(not measurements)
        self.list.setVisible(bool(measurements))
        if measurements and before is None:
            self.choose(len(measurements) - 1)
        self._show_details()

    def _on_item_changed(self, item: QTreeWidgetItem, column: int) -> None:
        number = self.list.indexOfTopLevelItem(item)
        if self._filling or number < 0:
            return
        if column == 1:
            # numbers are measured, not written
            self._fill(_listed(self._documents.shown))
            return
        visible = item.checkState(0) == Qt.CheckState.Checked
        self._change(self.tr("Name or show a measurement"), number, name=item.text(0), visible=visible)

    def _change(self, label: str, number: int | None, **changes: object) -> None:
        if number is not None:
            self._store.update(lambda scene: with_measurement_changed(scene, number, **changes), label=label)

    # ------------------------------------------------------------------ buttons

    def _button(self, icon: str, tip: str, run: object) -> QToolButton:
        button = small_button(icon, tip, self)
        button.clicked.connect(lambda _checked=False: run())  # type: ignore[operator]
        return button

    def _look(self) -> None:
        if self.number is not None:
            self.chosen.emit(self.number)

    def _recolor(self) -> None:
        number = self.number
        if number is None:
            return
        before = QColor.fromRgbF(*self._store.scene.measurements[number].color)
        color = chosen_color(self, before, self.tr("Colour of the measurement"))
        if color is not None:
            rgb = (color.redF(), color.greenF(), color.blueF())
            self._change(self.tr("Colour of a measurement"), number, color=rgb)

    def _lock(self) -> None:
        self._change(self.tr("Lock a measurement"), self.number, locked=self.lock.isChecked())

    def _delete(self) -> None:
        if self.number is not None:
            self._store.update(
                partial(without_measurements, numbers={self.number}), label=self.tr("Delete a measurement")
            )

    # ------------------------------------------------------------------ details

    def _show_details(self) -> None:
        number = self.number
        for button in (self.go, self.color, self.lock, self.delete):
            button.setEnabled(number is not None)
        self.export.setEnabled(bool(self._store.scene.measurements))
        if number is None:
            self.details.clear()
            self.plot.show_profile(None)
            return
        measurement, volumes = self._store.scene.measurements[number], self.volumes
        self.lock.setChecked(measurement.locked)
        self.delete.setEnabled(not measurement.locked)
        set_icon(self.lock, "lock-simple" if measurement.locked else "lock-simple-open")
        lines = []
        try:
            lines = [f"{words}: {found}" for words, found in readings(measurement, volumes).items()]
            along = measurement.kind == "profile" and bool(volumes)
            self.plot.show_profile(profile(*measurement.points, volumes) if along else None)
        except InputError as error:
            self.plot.show_profile(None)
            lines = [str(error)]
        rules = [point for point in measurement.points if point.rule != "placed"]
        lines += [f"{self.tr('Point')}: {rule_words(point)}" for point in rules]
        self.details.setText("\n".join(lines))


def volumes_of(shown: LoadedScene) -> list[Volume]:
    """The volumes of the image layers that are seen, the active one first."""
    active = shown.scene.layer
    others = [each for each in shown.scene.layers if isinstance(each, ImageLayer) and each.visible]
    keys = [each.key for each in (*(() if active is None else (active,)), *others)]
    return [shown.volumes[key] for key in dict.fromkeys(keys) if key in shown.volumes]


def _listed(shown: LoadedScene) -> tuple[tuple[Measurement, ...], list[Volume]]:
    return shown.scene.measurements, volumes_of(shown)


def _main(measurement: Measurement, volumes: list[Volume]) -> str:
    try:
        return str(next(iter(readings(measurement, volumes[:1]).values()), ""))
    except InputError:
        return ""


def _swatch(measurement: Measurement) -> QIcon:
    pixmap = QPixmap(QSize(12, 12))
    pixmap.fill(QColor.fromRgbF(*measurement.color))
    return QIcon(pixmap)
