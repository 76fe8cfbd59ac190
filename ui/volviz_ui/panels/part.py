"""The channel that is shown, of data that has several."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QWidget

from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.volume_data.source import VolumeSource
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.widgets.binding import send_value, show_value


class PartChooser(QWidget):
    """A list of channels; hidden for data with one.

    What is chosen is read in the background: the old picture stays until the new values are there. The transfer
    function stays, too.
    """

    channel_changed = Signal(object)
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

        self.channel.activated.connect(self._on_channel)
        send_value(self.channel_changed, store, _with_channel, label=self.tr("Channel"))
        show_value(documents, _data_of, self._show_data)
        show_value(store, _channel_of, self.show_channel)

    def _show_data(self, _key: object) -> None:
        """Another file is shown: other channels, another number of time points."""
        channels = _channels_of(self._documents.source)
        with QSignalBlocker(self.channel):
            self.channel.clear()
            for number, words in channels:
                self.channel.addItem(words, number)
        for widget in (self.channel, self._channel_label):
            widget.setVisible(len(channels) > 1)
        self.show_channel(_channel_of(self._store.scene))
        is_needed = len(channels) > 1
        # the section around it follows, which must hear it while the signals of this one are blocked
        blocked = self.blockSignals(False)
        self.needed.emit(is_needed)
        self.blockSignals(blocked)

    def show_channel(self, channel: int | None) -> None:
        """Show what the scene shows, or waits for."""
        with QSignalBlocker(self.channel):
            self.channel.setCurrentIndex(self.channel.findData(channel))

    def _on_channel(self, _index: int) -> None:
        self.channel_changed.emit(self.channel.currentData())


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


def _channel_of(scene: Scene) -> int | None:
    return None if scene.layer is None else scene.layer.channel


def _with_channel(scene: Scene, channel: int | None) -> Scene:
    return scene if scene.layer is None else scene.with_layer(channel=channel)
