"""Channel and time point that are shown, of data that has several."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QSpinBox, QWidget

from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.volume_data.source import VolumeSource
from volviz_ui.editors.number import FIELD_WIDTH, NoWheelSlider
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.widgets.binding import send_gesture, send_value, show_value
from volviz_ui.widgets.small import quiet_label

GESTURE = "time point"


class PartChooser(QWidget):
    """A list of channels, and a slider with a field for time; hidden for data with one of each.

    What is chosen is read in the background: the old picture stays until the new values are there. The transfer
    function stays, too.
    """

    channel_changed = Signal(object)
    time_changed = Signal(int)
    needed = Signal(bool)
    """There is something to choose from, or not."""

    def __init__(self, store: Store, documents: Documents, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._store = store
        self._documents = documents
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(6)
        grid.setColumnStretch(1, 1)

        self.channel = NoWheelComboBox(self)
        self.channel.setAccessibleName(self.tr("Channel"))
        self.channel.setToolTip(self.tr("Which of the measured quantities is shown"))
        self._channel_label = QLabel(self.tr("Channel"), self)
        grid.addWidget(self._channel_label, 0, 0)
        grid.addWidget(self.channel, 0, 1, 1, 2)

        self.time = NoWheelSlider(self)
        self.time_field = QSpinBox(self)
        self.time_field.setKeyboardTracking(False)
        self.time_field.setFixedWidth(FIELD_WIDTH)
        for widget in (self.time, self.time_field):
            widget.setAccessibleName(self.tr("Time point"))
            widget.setToolTip(self.tr("Which time point is shown, counted from 0"))
        self._time_label = QLabel(self.tr("Time point"), self)
        self.seconds: QLabel = quiet_label()
        self.seconds.setToolTip(self.tr("When this time point was measured"))
        grid.addWidget(self._time_label, 1, 0)
        grid.addWidget(self.time, 1, 1)
        grid.addWidget(self.time_field, 1, 2)
        grid.addWidget(self.seconds, 2, 1, 1, 2)

        self.channel.activated.connect(self._on_channel)
        self.time.valueChanged.connect(self._on_time)
        self.time_field.valueChanged.connect(self._on_time)
        send_value(self.channel_changed, store, _with_channel, label=self.tr("Channel"))
        send_value(self.time_changed, store, _with_time, label=self.tr("Time point"), gesture=GESTURE)
        send_gesture(self.time.sliderPressed, self.time.sliderReleased, store, GESTURE)
        show_value(documents, _data_of, self._show_data)
        show_value(store, _part_of, self.show_part)

    def _show_data(self, _key: object) -> None:
        """Another file is shown: other channels, another number of time points."""
        source = self._documents.source
        channels, times = _channels_of(source), 1 if source is None else source.sizes.get("t", 1)
        with QSignalBlocker(self.channel):
            self.channel.clear()
            for number, words in channels:
                self.channel.addItem(words, number)
        for widget in (self.time, self.time_field):
            with QSignalBlocker(widget):
                widget.setRange(0, times - 1)
        self.time_field.setSuffix(f" / {times - 1}")
        for widget in (self.channel, self._channel_label):
            widget.setVisible(len(channels) > 1)
        for widget in (self.time, self.time_field, self._time_label):
            widget.setVisible(times > 1)
        self.show_part(_part_of(self._store.scene))
        is_needed = len(channels) > 1 or times > 1
        # the section around it follows, which must hear it while the signals of this one are blocked
        blocked = self.blockSignals(False)
        self.needed.emit(is_needed)
        self.blockSignals(blocked)

    def show_part(self, part: tuple[int | None, int]) -> None:
        """Show what the scene shows, or waits for."""
        channel, time = part
        with QSignalBlocker(self.channel):
            self.channel.setCurrentIndex(self.channel.findData(channel))
        for widget in (self.time, self.time_field):
            with QSignalBlocker(widget):
                widget.setValue(time)
        source = self._documents.source
        times = None if source is None else source.times
        words = f"{times[time]:.6g} s" if times is not None and time < len(times) else ""
        self.seconds.setText(words)
        self.seconds.setVisible(bool(words))

    def _on_channel(self, _index: int) -> None:
        self.channel_changed.emit(self.channel.currentData())

    def _on_time(self, time: int) -> None:
        self.time_changed.emit(time)


def _channels_of(source: VolumeSource | None) -> list[tuple[int | None, str]]:
    """Numbers and words of what can be chosen; of colours their brightness first."""
    if source is None or "c" not in source.axes:
        return []
    found: list[tuple[int | None, str]] = [(None, "Brightness")] if source.is_colour else []
    for number, channel in enumerate(source.channels):
        if source.is_colour:
            found.append((number, channel.name[:1].upper() + channel.name[1:]))
        else:
            found.append((number, f"{channel.name} ({number})" if channel.name else f"Channel {number}"))
    return found


def _data_of(shown: LoadedScene) -> object:
    """What says that another file is shown."""
    return None if shown.scene.layer is None else shown.scene.layer.key.ref


def _part_of(scene: Scene) -> tuple[int | None, int]:
    return (None, 0) if scene.layer is None else (scene.layer.channel, scene.layer.time)


def _with_channel(scene: Scene, channel: int | None) -> Scene:
    return scene if scene.layer is None else scene.with_layer(channel=channel)


def _with_time(scene: Scene, time: int) -> Scene:
    """All layers of the file, so that its channels are of one time."""
    active = scene.layer
    if active is None:
        return scene
    return replace(
        scene,
        layers=tuple(
            replace(layer, time=time) if layer.volume == active.volume else layer for layer in scene.layers
        ),
    )
