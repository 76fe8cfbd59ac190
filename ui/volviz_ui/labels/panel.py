"""The panel of labels: a table to find, show, colour and measure them, in the picture and as a file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from PySide6.QtCore import QItemSelectionModel, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import (
    QAbstractItemView,
    QFileDialog,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QLineEdit,
    QMenu,
    QSlider,
    QTableView,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from volviz.errors import VolvizError
from volviz.io.label_files import read_label_file
from volviz.measure.label_table import LabelTable, label_statistics
from volviz.model.label_edits import alone, coloring, described, fading, hiding, naming
from volviz.model.layer_edits import with_layer_at
from volviz.model.layers import ImageLayer, LabelLayer
from volviz.model.store import Store
from volviz.new_files import check_target, written_beside
from volviz.volume_data.volume import Volume
from volviz_ui.dialogs.error import show_error
from volviz_ui.editors.simple import NoWheelComboBox, chosen_color
from volviz_ui.labels.model import LABEL, NAME, LabelModel, Rows
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.session.workers import Task, Workers
from volviz_ui.widgets.binding import show_value
from volviz_ui.widgets.small import quiet_label, small_button

GESTURE = "opacity of labels"
WORK = "labels"


class LabelPanel(QWidget):
    """All labels of a layer.

    Attributes
    ----------
    fly_requested : signal (object)
        Look at a label: the world box around it, as (x0, x1, y0, y1, z0, z1).
    """

    fly_requested = Signal(object)

    def __init__(
        self, store: Store, documents: Documents, workers: Workers, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._store, self._documents, self._workers = store, documents, workers
        self._tables: dict[Volume, LabelTable] = {}
        self._number: int | None = None
        tr = self.tr
        self.layer = NoWheelComboBox(self)
        self.layer.setAccessibleName(tr("Layer of labels"))
        self.layer.setToolTip(tr("Whose labels are listed"))
        self.search = QLineEdit(self)
        self.search.setPlaceholderText(tr("Find a label"))
        self.search.setClearButtonEnabled(True)
        self.search.setAccessibleName(tr("Find a label"))
        self.search.setToolTip(tr("Part of a name or number"))
        self.show_button = small_button("eye", tr("Show the chosen labels"), self)
        self.hide_button = small_button("eye-slash", tr("Hide the chosen labels"), self)
        self.alone_button = small_button("target", tr("Show the chosen labels alone"), self)
        self.all_button = small_button("squares-four", tr("Show all labels"), self)
        self.color_button = small_button("palette", tr("Colour of the chosen labels"), self)
        self.opacity = QSlider(Qt.Orientation.Horizontal, self)
        self.opacity.setRange(0, 100)
        self.opacity.setValue(100)
        self.opacity.setFixedWidth(80)
        self.opacity.setAccessibleName(tr("Opacity of the chosen labels"))
        self.opacity.setToolTip(tr("Opacity of the chosen labels"))
        self.more = small_button("dots-three-vertical", tr("Statistics, names, files"), self)
        self.more.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.more.setStyleSheet("QToolButton::menu-indicator { image: none; }")
        self.menu = QMenu(self)
        self.menu.setToolTipsVisible(True)
        self.menu.aboutToShow.connect(self._fill_menu)
        self.more.setMenu(self.menu)
        self.words: QLabel = quiet_label(parent=self)
        self.model = LabelModel(self)
        self.table = QTableView(self)
        self.table.setModel(self.model)
        self.table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.table.setSortingEnabled(True)
        self.table.sortByColumn(LABEL, Qt.SortOrder.AscendingOrder)
        self.table.setShowGrid(False)
        self.table.setAccessibleName(tr("Labels"))
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setDefaultSectionSize(24)
        self.table.verticalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        self.table.setColumnWidth(NAME, 190)
        self.table.setEditTriggers(
            QAbstractItemView.EditTrigger.EditKeyPressed | QAbstractItemView.EditTrigger.SelectedClicked
        )
        self._lay_out()
        self._connect()

    def _lay_out(self) -> None:
        bar = QHBoxLayout()
        bar.setSpacing(4)
        for widget in (
            self.layer, self.search, self.show_button, self.hide_button, self.alone_button, self.all_button,
            self.color_button, self.opacity, self.more,
        ):  # fmt: skip
            bar.addWidget(widget, 1 if widget is self.search else 0)
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 6, 8, 6)
        column.setSpacing(4)
        column.addLayout(bar)
        column.addWidget(self.table, 1)
        column.addWidget(self.words)

    def _connect(self) -> None:
        self.layer.activated.connect(lambda _index: self.show_layer(self.layer.currentData()))
        self.search.textChanged.connect(self.model.set_filter)
        self.model.switched.connect(self._on_switched)
        self.model.renamed.connect(
            lambda label, name: self._edit(
                lambda layer: naming(layer, label, name), self.tr("Name of a label")
            )
        )
        self.table.doubleClicked.connect(lambda index: self.fly_to(self.model.labels_at([index.row()])[0]))
        self.table.selectionModel().selectionChanged.connect(self._on_chosen)
        self.model.modelReset.connect(self._on_chosen)
        for button, run in (
            (self.show_button, lambda: self.set_hidden(self.chosen, hidden=False)),
            (self.hide_button, lambda: self.set_hidden(self.chosen, hidden=True)),
            (self.alone_button, self.show_alone),
            (self.all_button, self.show_all),
            (self.color_button, self._ask_color),
        ):
            button.clicked.connect(run)
        self.opacity.sliderPressed.connect(lambda: self._store.begin_gesture(GESTURE))
        self.opacity.sliderReleased.connect(lambda: self._store.end_gesture(GESTURE))
        self.opacity.valueChanged.connect(self._on_opacity)
        show_value(self._documents, _label_layers, self._show)

    # ------------------------------------------------------------------ which layer

    @property
    def label_layer(self) -> LabelLayer | None:
        """The layer whose labels are listed."""
        layers = self._documents.shown.scene.layers
        layer = layers[self._number] if self._number is not None and self._number < len(layers) else None
        return layer if isinstance(layer, LabelLayer) else None

    @property
    def _volume(self) -> Volume | None:
        layer = self.label_layer
        return None if layer is None else self._documents.shown.volumes.get(layer.key)

    def show_layer(self, number: int) -> None:
        """List the labels of another layer."""
        self._number = number
        self._show(_label_layers(self._documents.shown))

    def _show(self, found: tuple[tuple[int, LabelLayer], ...]) -> None:
        numbers = [number for number, _ in found]
        if self._number not in numbers:
            self._number = numbers[0] if numbers else None
        with QSignalBlocker(self.layer):
            self.layer.clear()
            for number, layer in found:
                self.layer.addItem(layer.name or self.tr("Layer %1").replace("%1", str(number + 1)), number)
            self.layer.setCurrentIndex(self.layer.findData(self._number))
        self.layer.setVisible(len(found) > 1)
        alive = set(self._documents.shown.volumes.values())
        self._tables = {volume: table for volume, table in self._tables.items() if volume in alive}
        layer, volume = self.label_layer, self._volume
        if layer is None or volume is None:
            self.model.show_rows(None)
        elif volume in self._tables:
            self.model.show_rows(Rows.of(layer, self._tables[volume]))
        else:
            self.model.show_rows(None)
            self._count(volume, None)
        self._say()

    # ------------------------------------------------------------------ counting

    def _count(self, volume: Volume, image: Volume | None) -> None:
        """Count voxels, and values of an image, on a worker."""
        task = self._workers.start(
            lambda task: label_statistics(volume, image, cancel=lambda: task.is_cancelled),
            label=self.tr("Counting labels"), key=WORK,
        )  # fmt: skip
        task.succeeded.connect(lambda table: self._on_counted(volume, table))
        task.failed.connect(lambda error: show_error(self, self.tr("The labels were not counted"), error))

    def _on_counted(self, volume: Volume, table: LabelTable) -> None:
        self._tables[volume] = table
        self._show(_label_layers(self._documents.shown))

    def show_statistics(self, number: int) -> None:
        """Tell the values of an image layer under each label."""
        shown, labels = self._documents.shown, self._volume
        layer, own = shown.scene.layers[number], self.label_layer
        if labels is None or own is None:
            return
        image = shown.volumes[layer.key]
        if layer.transform is not None:
            image = image.moved(layer.transform)
        placed = labels if own.transform is None else labels.moved(own.transform)
        task = self._workers.start(
            lambda task: label_statistics(placed, image, cancel=lambda: task.is_cancelled),
            label=self.tr("Counting labels"), key=WORK,
        )  # fmt: skip
        task.succeeded.connect(lambda table: self._on_counted(labels, table))
        task.failed.connect(lambda error: show_error(self, self.tr("The labels were not counted"), error))

    def _say(self) -> None:
        layer, rows = self.label_layer, self.model.rows
        if layer is None:
            words = self.tr("There are no labels; add a segmentation by File > Add layer…")
        elif rows is None:
            words = self.tr("Counting the labels…")
        else:
            labels = rows.table.labels
            hidden = int((rows.palette[:, 3] == 0.0).sum())
            words = self.tr("1 label") if len(labels) == 1 else self.tr("%1 labels")
            words = words.replace("%1", f"{len(labels):,}".replace(",", " "))
            if hidden:
                words += self.tr(", %1 of them hidden").replace("%1", f"{hidden:,}".replace(",", " "))
            if rows.table.values is not None:
                words += self.tr("; values of %1").replace("%1", rows.table.values.name)
        self.words.setText(words)

    # ------------------------------------------------------------------ choosing

    @property
    def chosen(self) -> list[int]:
        """The labels that are chosen."""
        return self.model.labels_at([index.row() for index in self.table.selectionModel().selectedRows()])

    def choose(self, label: int) -> None:
        """Choose a label, and scroll to it."""
        row = self.model.row_of(label)
        if row is None:
            return
        index = self.model.index(row, NAME)
        flags = QItemSelectionModel.SelectionFlag
        self.table.selectionModel().setCurrentIndex(index, flags.ClearAndSelect | flags.Rows)
        self.table.scrollTo(index)

    def _on_chosen(self, *_what: object) -> None:
        chosen = self.chosen
        for widget in (
            self.show_button,
            self.hide_button,
            self.alone_button,
            self.color_button,
            self.opacity,
        ):
            widget.setEnabled(bool(chosen))
        self.all_button.setEnabled(self.model.rows is not None)
        layer = self.label_layer
        if chosen and layer is not None and not self.opacity.isSliderDown():
            with QSignalBlocker(self.opacity):
                self.opacity.setValue(round(100 * dict(layer.opacities).get(chosen[0], 1.0)))

    def fly_to(self, label: int) -> None:
        """Have the views look at a label."""
        rows, volume, layer = self.model.rows, self._volume, self.label_layer
        if rows is None or volume is None or layer is None:
            return
        placed = volume if layer.transform is None else volume.moved(layer.transform)
        at = int((rows.table.labels == label).argmax())
        self.fly_requested.emit(world_box(placed, rows.table.boxes[at]))

    # ------------------------------------------------------------------ editing

    def _edit(
        self, change: Callable[[LabelLayer], dict[str, Any]], words: str, gesture: str | None = None
    ) -> None:
        number, layer = self._number, self.label_layer
        if number is not None and layer is not None:
            changes = change(layer)
            self._store.update(
                lambda scene: with_layer_at(scene, number, **changes), label=words, gesture=gesture
            )

    def _on_switched(self, label: int, shown: bool) -> None:
        # one of several that are chosen stands for all of them
        chosen = self.chosen
        self.set_hidden(chosen if label in chosen else [label], hidden=not shown)

    def set_hidden(self, labels: list[int], *, hidden: bool) -> None:
        """Hide labels, or show them again."""
        words = self.tr("Hide labels") if hidden else self.tr("Show labels")
        self._edit(lambda layer: hiding(layer, labels, hidden=hidden), words)

    def show_alone(self) -> None:
        """Hide all labels but the chosen ones."""
        rows, chosen = self.model.rows, self.chosen
        if rows is not None and chosen:
            every = rows.table.labels.tolist()
            self._edit(lambda _layer: alone(chosen, every), self.tr("Show labels alone"))

    def show_all(self) -> None:
        """Hide none."""
        self._edit(lambda _layer: {"hidden": ()}, self.tr("Show all labels"))

    def _ask_color(self) -> None:
        rows, chosen = self.model.rows, self.chosen
        if rows is None or not chosen:
            return
        at = int((rows.table.labels == chosen[0]).argmax())
        now = QColor.fromRgbF(*(float(v) for v in rows.palette[at, :3]))
        color = chosen_color(self, now, self.tr("Colour of the chosen labels"))
        if color is not None:
            self.set_color(chosen, (color.redF(), color.greenF(), color.blueF()))

    def set_color(self, labels: list[int], color: tuple[float, float, float]) -> None:
        """Show labels in a colour."""
        self._edit(lambda layer: coloring(layer, labels, color), self.tr("Colour of labels"))

    def _on_opacity(self, percent: int) -> None:
        chosen = self.chosen
        gesture = GESTURE if self.opacity.isSliderDown() else None
        self._edit(
            lambda layer: fading(layer, chosen, percent / 100.0), self.tr("Opacity of labels"), gesture
        )

    # ------------------------------------------------------------------ files

    def _fill_menu(self) -> None:
        menu, tr = self.menu, self.tr
        menu.clear()
        known = self.model.rows is not None
        for number, layer in enumerate(self._documents.shown.scene.layers):
            if isinstance(layer, ImageLayer):
                words = tr("Statistics of %1").replace(
                    "%1", layer.name or tr("Layer %1").replace("%1", str(number + 1))
                )
                action = menu.addAction(words, lambda number=number: self.show_statistics(number))
                action.setToolTip(tr("Mean, standard deviation, lowest and highest value under each label"))
                action.setEnabled(known)
        menu.addSeparator()
        for words, tip, run in (
            (tr("Names and colours from a file…"), tr("Of ITK-SNAP, FreeSurfer, 3D Slicer, BIDS, or CSV"),
             self._ask_names),
            (tr("Save table as CSV…"), tr("All columns that are shown, for a spreadsheet"), self._ask_csv),
            (tr("Save meshes…"), tr("A closed surface of each chosen label, or of all, without gaps"),
             self._ask_meshes),
        ):  # fmt: skip
            action = menu.addAction(words, run)
            action.setToolTip(tip)
            action.setEnabled(known)

    def _ask_names(self) -> None:
        path, _ = QFileDialog.getOpenFileName(
            self, self.tr("Names and colours of labels"), "",
            self.tr("Tables of labels (*.txt *.label *.ctbl *.csv *.tsv *.lut);;All files (*)"),
        )  # fmt: skip
        if path:
            self.read_names(Path(path))

    def read_names(self, path: Path) -> None:
        """Take names and colours of a file."""
        try:
            table = read_label_file(path)
        except VolvizError as error:
            show_error(self, self.tr("Names and colours were not read"), error)
            return
        self._edit(lambda layer: described(layer, table), self.tr("Names of labels"))

    def _ask_csv(self) -> None:
        path, _ = QFileDialog.getSaveFileName(
            self, self.tr("Save table"), "labels.csv", self.tr("CSV (*.csv)")
        )
        if path:
            self.save_csv(Path(path) if Path(path).suffix else Path(path).with_suffix(".csv"))

    def _ask_meshes(self) -> None:
        folder = QFileDialog.getExistingDirectory(self, self.tr("Folder for the meshes"))
        if folder:
            self.save_meshes(Path(folder))

    def save_meshes(self, folder: Path, suffix: str = ".stl") -> None:
        """Write the surfaces of the chosen labels, or of all, on a worker; files that are there are kept."""
        volume, layer, rows = self._volume, self.label_layer, self.model.rows
        if volume is None or layer is None or rows is None:
            return
        placed = volume if layer.transform is None else volume.moved(layer.transform)
        chosen, names = self.chosen or None, rows.names

        def work(task: Task) -> int:
            from volviz.meshes.label_surfaces import label_surfaces, save_label_surfaces

            surfaces = label_surfaces(placed, chosen, progress=task.report, cancel=lambda: task.is_cancelled)
            return len(save_label_surfaces(surfaces, folder, names, suffix=suffix))

        task = self._workers.start(work, label=self.tr("Saving meshes"), key="label meshes")
        task.progressed.connect(
            lambda part, _words: self.words.setText(
                self.tr("Meshes: %1 %").replace("%1", str(round(100 * part)))
            )
        )
        task.succeeded.connect(lambda count: self._say_saved(count, folder))
        task.failed.connect(lambda error: show_error(self, self.tr("The meshes were not saved"), error))

    def _say_saved(self, count: int, folder: Path) -> None:
        words = self.tr("1 mesh in %2") if count == 1 else self.tr("%1 meshes in %2")
        self.words.setText(words.replace("%1", str(count)).replace("%2", str(folder)))

    def save_csv(self, path: Path) -> None:
        """Write the table; the dialog has asked about a file that is there."""
        rows = self.model.rows
        if rows is None:
            return
        try:
            target = check_target(path, overwrite=True)
            with written_beside(target) as part:
                part.write_text(rows.table.to_csv(rows.names), encoding="utf-8")
        except (VolvizError, OSError) as error:
            show_error(self, self.tr("The table was not saved"), error)


def _label_layers(shown: LoadedScene) -> tuple[tuple[int, LabelLayer], ...]:
    return tuple(
        (number, layer) for number, layer in enumerate(shown.scene.layers) if isinstance(layer, LabelLayer)
    )


def world_box(volume: Volume, box: Any) -> tuple[float, float, float, float, float, float]:
    """World bounds of a box of voxels (i0, i1, j0, j1, k0, k1), those of i1, j1 and k1 no more."""
    i0, i1, j0, j1, k0, k1 = (float(v) for v in box)
    corners = [
        volume.index_to_world @ (i - 0.5, j - 0.5, k - 0.5, 1.0)
        for i in (i0, i1)
        for j in (j0, j1)
        for k in (k0, k1)
    ]
    columns = list(zip(*corners, strict=True))
    bounds = [limit for column in columns[:3] for limit in (min(column), max(column))]
    return bounds[0], bounds[1], bounds[2], bounds[3], bounds[4], bounds[5]
