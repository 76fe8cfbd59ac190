"""Contrast of a layer by two handles, without the editor of transfer functions."""

from __future__ import annotations

import math

from PySide6.QtCore import QEvent, QSignalBlocker, Qt
from PySide6.QtWidgets import QHBoxLayout, QWidget

from volviz.model.layer_edits import contrast_of, with_contrast
from volviz.model.layer_looks import channel_window
from volviz.model.layers import ImageLayer, Layer
from volviz.model.store import Store
from volviz.model.transfer.first_look import automatic_window
from volviz.volume_data.volume import Volume
from volviz_ui.panels.range_slider import RangeSlider, color_bar
from volviz_ui.session.documents import Documents
from volviz_ui.style.theme import is_palette_change
from volviz_ui.widgets.binding import send_gesture
from volviz_ui.widgets.small import small_button

STEPS = 1000


class ContrastSlider(QWidget):
    """Where the function of an image layer begins and ends among the values of its volume.

    Parameters
    ----------
    store, documents
        Where the layer and its volume are.
    number : int
        Its place in the scene.
    """

    def __init__(
        self, store: Store, documents: Documents, number: int, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._store, self._documents, self._number = store, documents, number
        self._gesture = f"contrast {number}"
        self.slider = RangeSlider(Qt.Orientation.Horizontal, self)
        self.slider.setRange(0, STEPS)
        self.slider.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.slider.setAccessibleName(self.tr("Contrast of the layer"))
        self.slider.setToolTip(self.tr("Values at which the layer begins to be seen and is fully seen"))
        color_bar(self.slider)
        self.auto = small_button("magic-wand", self.tr("Contrast from the values of the layer"), self)
        self.reset = small_button(
            "arrow-counter-clockwise", self.tr("Contrast of the file, or all values"), self
        )
        row = QHBoxLayout(self)
        row.setContentsMargins(26, 0, 0, 2)
        row.setSpacing(4)
        row.addWidget(self.slider, 1)
        row.addWidget(self.auto)
        row.addWidget(self.reset)
        self.slider.valueChanged.connect(self._on_slider)
        self.auto.clicked.connect(self._on_auto)
        self.reset.clicked.connect(self._on_reset)
        send_gesture(self.slider.sliderPressed, self.slider.sliderReleased, store, self._gesture)
        self.hide()

    def changeEvent(self, event: QEvent) -> None:
        """Take the colours of another theme."""
        super().changeEvent(event)
        if is_palette_change(event):
            color_bar(self.slider)

    def show_layer(self, layer: Layer | None) -> None:
        """Show the contrast of a layer; nothing of one that has none."""
        window = None if layer is None else contrast_of(layer)
        limits = self._limits(layer)
        self.setVisible(window is not None and limits is not None)
        if window is None or limits is None:
            return
        low, high = limits
        places = tuple(min(max(round(STEPS * (value - low) / (high - low)), 0), STEPS) for value in window)
        with QSignalBlocker(self.slider):
            self.slider.setValue(places)
        unit = "" if self._volume is None or not self._volume.unit else f" {self._volume.unit}"
        words = self.tr("Seen from %1, fully at %2")
        self.slider.setToolTip(
            words.replace("%1", f"{window[0]:.5g}{unit}").replace("%2", f"{window[1]:.5g}{unit}")
        )

    @property
    def _layer(self) -> ImageLayer | None:
        layers = self._store.scene.layers
        layer = layers[self._number] if self._number < len(layers) else None
        return layer if isinstance(layer, ImageLayer) else None

    @property
    def _volume(self) -> Volume | None:
        return None if self._layer is None else self._documents.at_hand(self._layer.key)

    def _limits(self, layer: Layer | None) -> tuple[float, float] | None:
        volume = None if layer is None else self._documents.at_hand(layer.key)
        if volume is None:
            return None
        low, high = volume.data_range
        return (low, high) if math.isfinite(high - low) and low < high else None

    def _on_slider(self, places: tuple[int, int]) -> None:
        limits = self._limits(self._layer)
        if limits is None or places[0] >= places[1]:
            return
        low, high = limits
        first, last = (low + place / STEPS * (high - low) for place in places)
        self._set((first, last))

    def _set(self, window: tuple[float, float]) -> None:
        number = self._number
        self._store.update(
            lambda scene: with_contrast(scene, number, window),
            label=self.tr("Contrast of the layer"),
            gesture=self._gesture,
        )

    def _on_auto(self) -> None:
        if self._volume is not None:
            self._set(channel_window(self._volume))

    def _on_reset(self) -> None:
        layer, volume = self._layer, self._volume
        if layer is None or volume is None:
            return
        source = self._documents.source_of(layer.key.ref)
        known = None if source is None or layer.channel is None else source.channels[layer.channel].window
        self._set(known or automatic_window(volume))
