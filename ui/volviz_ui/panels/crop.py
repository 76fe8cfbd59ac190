"""The crop box: a range of voxels along each axis of the volume."""

from __future__ import annotations

import dataclasses

from PySide6.QtCore import QEvent, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QHideEvent
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QSpinBox, QWidget

from volviz.model.clipping import Crop
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.volume_data.volume import Volume
from volviz_ui.panels.range_slider import RangeSlider, color_bar
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene, volume_of
from volviz_ui.style.theme import is_palette_change
from volviz_ui.widgets.binding import send_gesture, send_value, show_value

GESTURE = "crop box"


class CropBox(QWidget):
    """A range slider with two fields for each of x, y and z."""

    crop_changed = Signal(object)

    def __init__(self, store: Store, documents: Documents, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._store = store
        self._documents = documents
        self.sliders: list[RangeSlider] = []
        self._dimensions: tuple[int, int, int] | None = None
        self.fields: list[tuple[QSpinBox, QSpinBox]] = []
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(4)
        for row, axis in enumerate("xyz"):
            tooltip = self.tr("Voxels along %1 that are shown, first and last").replace("%1", axis)
            slider = RangeSlider(Qt.Orientation.Horizontal, self)
            slider.setMinimumWidth(56)
            slider.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            color_bar(slider)
            slider.setToolTip(tooltip)
            slider.setAccessibleName(tooltip)
            low, high = QSpinBox(self), QSpinBox(self)
            for field in (low, high):
                field.setKeyboardTracking(False)
                field.setButtonSymbols(QSpinBox.ButtonSymbols.NoButtons)
                field.setAlignment(Qt.AlignmentFlag.AlignRight)
                field.setFixedWidth(46)
                field.setToolTip(tooltip)
                field.setAccessibleName(tooltip)
                field.valueChanged.connect(self._on_field)
            slider.valueChanged.connect(self._on_slider)
            send_gesture(slider.sliderPressed, slider.sliderReleased, store, GESTURE)
            grid.addWidget(QLabel(axis, self), row, 0)
            grid.addWidget(low, row, 1)
            grid.addWidget(slider, row, 2)
            grid.addWidget(high, row, 3)
            self.sliders.append(slider)
            self.fields.append((low, high))
        grid.setColumnStretch(2, 1)
        self.whole = QPushButton(self.tr("Whole volume"), self)
        self.whole.setToolTip(self.tr("Show all voxels again"))
        self.whole.clicked.connect(self._on_whole)
        grid.addWidget(self.whole, 3, 1, 1, 3)
        self.full = QPushButton(self)
        self.full.clicked.connect(self._on_full)
        grid.addWidget(self.full, 4, 1, 1, 3)
        send_value(self.crop_changed, store, _with_crop, label=self.tr("Crop"), gesture=GESTURE)
        show_value(documents, volume_of, self._show_volume)
        show_value(documents, _crop_of, self.show_crop)
        show_value(documents, lambda shown: shown.scene.layer, self._show_part)

    def hideEvent(self, event: QHideEvent) -> None:
        """Sliders that are not seen do not hear that the button is up."""
        self._store.end_gesture(GESTURE)
        super().hideEvent(event)

    def changeEvent(self, event: QEvent) -> None:
        """Take the colours of another theme."""
        super().changeEvent(event)
        if is_palette_change(event):
            for slider in self.sliders:
                color_bar(slider)

    def _show_volume(self, volume: Volume | None) -> None:
        self._dimensions = None if volume is None else volume.dimensions
        self.setEnabled(volume is not None)
        for (low, high), slider, n in zip(
            self.fields, self.sliders, self._dimensions or (2, 2, 2), strict=True
        ):
            with QSignalBlocker(slider), QSignalBlocker(low), QSignalBlocker(high):
                slider.setRange(0, n - 1)
                low.setRange(0, n - 2)
                high.setRange(1, n - 1)
        self.show_crop(_crop_of(self._documents.shown))

    def show_crop(self, crop: Crop | None) -> None:
        """Show a crop box."""
        if self._dimensions is None:
            return
        self.whole.setEnabled(crop is not None)
        self.full.setEnabled(crop is not None or self._documents.shows_box)
        for axis, n in enumerate(self._dimensions):
            bounds = (0, n - 1) if crop is None else (round(crop[2 * axis]), round(crop[2 * axis + 1]))
            bounds = (min(max(bounds[0], 0), n - 2), min(max(bounds[1], 1), n - 1))
            low, high = self.fields[axis]
            slider = self.sliders[axis]
            with QSignalBlocker(slider), QSignalBlocker(low), QSignalBlocker(high):
                if tuple(slider.value()) != bounds:
                    slider.setValue(bounds)
                low.setValue(bounds[0])
                high.setValue(bounds[1])

    def _show_part(self, _layer: object) -> None:
        """Offer the box at a finer level, or the way back from it."""
        shows_box = self._documents.shows_box
        self.full.setVisible(shows_box or self._documents.finer_box)
        if shows_box:
            self.full.setText(self.tr("Back to all of the file"))
            self.full.setToolTip(self.tr("Show the whole volume again, cropped to this box"))
        else:
            self.full.setText(self.tr("This box in full"))
            self.full.setToolTip(
                self.tr("Read what the box holds at the finest resolution that fits into memory")
            )
        self.full.setEnabled(shows_box or _crop_of(self._documents.shown) is not None)

    def _on_full(self) -> None:
        if self._documents.shows_box:
            self._documents.show_whole_again()
        else:
            self._documents.show_box_in_full()

    def _on_whole(self) -> None:
        self.crop_changed.emit(None)

    def _on_slider(self) -> None:
        self._send([tuple(slider.value()) for slider in self.sliders])

    def _on_field(self) -> None:
        self._send([(low.value(), high.value()) for low, high in self.fields])

    def _send(self, ranges: list[tuple[int, int]]) -> None:
        if self._dimensions is None or not self._documents.is_current:
            return
        limits: list[float] = []
        for (low, high), n in zip(ranges, self._dimensions, strict=True):
            # one cell at least: a box without thickness shows nothing
            first = min(low, n - 2)
            limits += [float(first), float(max(high, first + 1))]
        full = [v for n in self._dimensions for v in (0.0, float(n - 1))]
        self.crop_changed.emit(None if limits == full else tuple(limits))


def _crop_of(shown: LoadedScene) -> Crop | None:
    return shown.scene.clipping.crop


def _with_crop(scene: Scene, crop: Crop | None) -> Scene:
    return dataclasses.replace(scene, clipping=dataclasses.replace(scene.clipping, crop=crop))
