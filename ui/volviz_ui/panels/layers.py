"""The list of layers: which are seen, in which colour and how strongly, and which one the other panels act on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QAction, QColor
from PySide6.QtWidgets import (
    QApplication,
    QHBoxLayout,
    QMenu,
    QSizePolicy,
    QSlider,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from volviz.custom_gl.scene_techniques import current_technique
from volviz.model.layer_edits import (
    as_labels,
    can_remove,
    duplicated,
    moved,
    recolored,
    shown_color,
    with_layer_at,
    with_only,
    without_layer,
)
from volviz.model.layers import ImageLayer, LabelLayer, Layer
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz_ui.dialogs.place_layer import PlaceLayerDialog
from volviz_ui.editors.simple import ColorButton, chosen_color
from volviz_ui.panels.contrast import ContrastSlider
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene, words_on_layers
from volviz_ui.session.opening import has_channels
from volviz_ui.style.icons import set_icon
from volviz_ui.widgets.binding import show_value
from volviz_ui.widgets.small import quiet_label, small_button

GESTURE = "layer opacity"


class LayerRow(QWidget):
    """One layer: eye, colour, name, opacity, remove.

    Attributes
    ----------
    labels_requested : signal (int)
        The name of a layer of labels was clicked: its number.

    Parameters
    ----------
    store : Store
        Where the layer is.
    number : int
        Its place in the scene.
    """

    labels_requested = Signal(int)

    def __init__(
        self, store: Store, documents: Documents, number: int, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._store, self._documents, self._number = store, documents, number
        self.eye = small_button("eye", self.tr("Show or hide this layer; with Alt, show it alone"), self)
        self.eye.setCheckable(True)
        self.eye.clicked.connect(self._on_eye)
        self.color = ColorButton(self, with_name=False)
        self.color.setIconSize(QSize(14, 14))
        self.color.setFlat(True)
        self.color.setMaximumWidth(24)
        self.color.setToolTip(self.tr("Show this layer in one colour"))
        self.color.setAccessibleName(self.tr("Colour of the layer"))
        self.color.clicked.connect(self._on_color)
        self.name = QToolButton(self)
        self.name.setCheckable(True)
        self.name.setAutoRaise(True)
        self.name.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.name.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
        self.name.clicked.connect(self._on_name)
        self.opacity = QSlider(Qt.Orientation.Horizontal, self)
        self.opacity.setRange(0, 100)
        self.opacity.setFixedWidth(64)
        self.opacity.setToolTip(self.tr("Opacity of the layer"))
        self.opacity.setAccessibleName(self.tr("Opacity of the layer"))
        self.opacity.sliderPressed.connect(lambda: store.begin_gesture(GESTURE))
        self.opacity.sliderReleased.connect(lambda: store.end_gesture(GESTURE))
        self.opacity.valueChanged.connect(self._on_opacity)
        self.remove = small_button("x", self.tr("Remove this layer"), self)
        self.remove.clicked.connect(self._on_remove)
        self.more = small_button("dots-three-vertical", self.tr("Order, place, copies of this layer"), self)
        self.more.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.more.setStyleSheet("QToolButton::menu-indicator { image: none; }")
        self.menu = QMenu(self)
        self.menu.setToolTipsVisible(True)
        self.menu.aboutToShow.connect(self._fill_menu)
        self.more.setMenu(self.menu)
        row = QHBoxLayout()
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        for widget, stretch in (
            (self.eye, 0), (self.color, 0), (self.name, 1), (self.opacity, 0), (self.more, 0), (self.remove, 0),
        ):  # fmt: skip
            row.addWidget(widget, stretch)
        self.contrast = ContrastSlider(store, documents, number, self)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addLayout(row)
        column.addWidget(self.contrast)

    def show_layer(self, layer: Layer, *, is_active: bool, removable: bool, several: bool) -> None:
        """Show the values of a layer; one of several has its contrast here."""
        self.contrast.show_layer(layer if several else None)
        self.eye.setChecked(layer.visible)
        set_icon(self.eye, "eye" if layer.visible else "eye-slash", "quiet")
        color = shown_color(layer)
        self.color.setVisible(color is not None)
        if color is not None:
            self.color.set_color(QColor.fromRgbF(*color))
        words = layer.name or self.tr("Layer %1").replace("%1", str(self._number + 1))
        self.name.setText(words)
        is_image = isinstance(layer, ImageLayer)
        self.name.setToolTip(
            self.tr("%1: click to edit its colours and see its histogram").replace("%1", words)
            if is_image
            else self.tr("%1: labels, shown as surfaces; click to list them").replace("%1", words)
        )
        self.name.setChecked(is_active)
        self.opacity.blockSignals(True)
        if not self.opacity.isSliderDown():
            self.opacity.setValue(round(100 * layer.opacity))
        self.opacity.blockSignals(False)
        self.remove.setEnabled(removable)

    def _change(self, words: str, **changes: Any) -> None:
        number = self._number
        self._store.update(lambda scene: with_layer_at(scene, number, **changes), label=words)

    def _on_eye(self, visible: bool) -> None:
        number = self._number
        if QApplication.keyboardModifiers() & Qt.KeyboardModifier.AltModifier:
            self._store.update(lambda scene: with_only(scene, number), label=self.tr("Show one layer"))
        else:
            self._change(self.tr("Show layer") if visible else self.tr("Hide layer"), visible=visible)

    def _on_color(self) -> None:
        color = chosen_color(self, self.color.color, self.tr("Colour of the layer"))
        if color is not None:
            self.set_color((color.redF(), color.greenF(), color.blueF()))

    def set_color(self, color: tuple[float, float, float]) -> None:
        """Show the layer in one colour."""
        layer = self._store.scene.layers[self._number]
        if isinstance(layer, ImageLayer) and layer.transfer_function is not None:
            function = recolored(layer.transfer_function, color)
            self._change(self.tr("Colour of the layer"), transfer_function=function)

    def _on_name(self) -> None:
        number = self._number
        if isinstance(self._store.scene.layers[number], LabelLayer):
            self.name.setChecked(False)
            self.labels_requested.emit(number)
            return
        self._store.update(
            lambda scene: scene.with_active_layer(number), label=self.tr("Active layer"), record=False
        )
        self.name.setChecked(True)

    def _on_opacity(self, percent: int) -> None:
        number = self._number
        self._store.update(
            lambda scene: with_layer_at(scene, number, opacity=percent / 100.0),
            label=self.tr("Opacity of the layer"),
            gesture=GESTURE if self.opacity.isSliderDown() else None,
        )

    def _fill_menu(self) -> None:
        self.menu.clear()
        tr, number, scene = self.tr, self._number, self._store.scene
        layer = scene.layers[number]
        volume = self._documents.shown.volumes.get(layer.key)

        def entry(words: str, tip: str, change: Callable[[Scene], Scene], *, enabled: bool = True) -> QAction:
            action = self.menu.addAction(words, lambda: self._store.update(change, label=words))
            action.setToolTip(tip)
            action.setEnabled(enabled)
            return action

        order = tr("The order in the list; the picture stays the same")
        entry(tr("Move up"), order, lambda scene: moved(scene, number, -1), enabled=number > 0)
        entry(
            tr("Move down"),
            order,
            lambda scene: moved(scene, number, 1),
            enabled=number < len(scene.layers) - 1,
        )
        entry(tr("Duplicate"), tr("The same data once more, to look at it in another way"),
              lambda scene: duplicated(scene, number))  # fmt: skip
        entry(
            tr("Show alone"),
            tr("Hide the other layers, or show them again"),
            lambda scene: with_only(scene, number),
        )
        self.menu.addSeparator()
        place = self.menu.addAction(tr("Place…"), self.show_place)
        place.setToolTip(tr("Move and turn the layer, to register it with another one"))
        place.setEnabled(volume is not None)
        if isinstance(layer, ImageLayer):
            linked = entry(
                tr("Link function"), tr("All linked layers get the same colours and opacities"),
                lambda scene: with_layer_at(scene, number, linked=not layer.linked),
            )  # fmt: skip
            linked.setCheckable(True)
            linked.setChecked(layer.linked)
            whole = volume is not None and volume.array.dtype.kind in "iu"
            source = self._documents.source_of(layer.key.ref)
            table = () if source is None else source.labels
            entry(
                tr("Show as labels"), tr("Each whole number is a label with a surface of its own"),
                lambda scene: as_labels(scene, number, table), enabled=whole and can_remove(scene, number),
            )  # fmt: skip

    def show_place(self) -> PlaceLayerDialog | None:
        """Let the layer be moved and turned."""
        layer = self._store.scene.layers[self._number]
        volume = self._documents.shown.volumes.get(layer.key)
        if volume is None:
            return None
        dialog = PlaceLayerDialog(layer.name or volume.name, volume, layer.transform, self.window())
        dialog.transform_changed.connect(
            lambda transform: self._change(self.tr("Place of the layer"), transform=transform)
        )
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def _on_remove(self) -> None:
        number = self._number
        self._store.update(lambda scene: without_layer(scene, number), label=self.tr("Remove layer"))


class LayerList(QWidget):
    """All layers of the scene, and a button that adds one.

    Attributes
    ----------
    add_requested : signal
        The button was pressed.
    labels_requested : signal (int)
        The labels of a layer, given by its number, are to be listed.
    """

    add_requested = Signal()
    labels_requested = Signal(int)

    def __init__(self, store: Store, documents: Documents, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._store, self._documents = store, documents
        self.rows: list[LayerRow] = []
        self.column = QVBoxLayout(self)
        self.column.setContentsMargins(0, 0, 0, 0)
        self.column.setSpacing(2)
        self.words = quiet_label(parent=self)
        self.words.setWordWrap(True)
        self.add_button = QToolButton(self)
        self.add_button.setText(self.tr("Add layer…"))
        self.add_button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.add_button.setAutoRaise(True)
        self.add_button.setToolTip(self.tr("Show another file in the same picture"))
        set_icon(self.add_button, "plus", "quiet")
        self.add_button.clicked.connect(self.add_requested)
        self.channels_button = QToolButton(self)
        self.channels_button.setText(self.tr("All channels"))
        self.channels_button.setAutoRaise(True)
        self.channels_button.setToolTip(
            self.tr("Show every channel of this file as a layer, each in its colour")
        )
        self.channels_button.clicked.connect(documents.show_all_channels)
        buttons = QHBoxLayout()
        buttons.setContentsMargins(0, 0, 0, 0)
        buttons.addWidget(self.add_button)
        buttons.addWidget(self.channels_button)
        buttons.addStretch(1)
        self.column.addWidget(self.words)
        self.column.addLayout(buttons)
        show_value(store, _layers_shown, self._show)
        show_value(documents, _active_layer, self._show_channels)

    def _show_channels(self, _active: object) -> None:
        self.channels_button.setVisible(has_channels(self._documents.source))

    def _show(self, shown: tuple[tuple[Layer, ...], int | None, str]) -> None:
        layers, active, words = shown
        while len(self.rows) > len(layers):
            row = self.rows.pop()
            self.column.removeWidget(row)
            row.hide()
            row.deleteLater()
        while len(self.rows) < len(layers):
            row = LayerRow(self._store, self._documents, len(self.rows), self)
            row.labels_requested.connect(self.labels_requested)
            self.column.insertWidget(len(self.rows), row)
            self.rows.append(row)
        scene = self._store.scene
        for number, (row, layer) in enumerate(zip(self.rows, layers, strict=True)):
            row.show_layer(
                layer,
                is_active=number == active,
                removable=can_remove(scene, number),
                several=len(layers) > 1,
            )
        self.words.setText(words)
        self.words.setVisible(bool(words))
        self.add_button.setEnabled(bool(layers))


def _active_layer(shown: LoadedScene) -> object:
    return shown.scene.layer


def _layers_shown(scene: Scene) -> tuple[tuple[Layer, ...], int | None, str]:
    words = words_on_layers(scene)
    if not words and len(scene.layers) > 1 and current_technique(scene).draws_layers:
        words = LayerList.tr("Visible layers are drawn in one picture; their order changes nothing.")
    return scene.layers, scene.layer_index, words
