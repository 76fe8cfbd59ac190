"""Saving the volume: format, which part of it, and file; written on a worker with progress and cancel."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QFormLayout,
    QLabel,
    QMessageBox,
    QVBoxLayout,
    QWidget,
)

from volviz.io import save
from volviz.io.writers import WRITERS, Writer, check_volume_target, losses
from volviz.model.clipping import Crop
from volviz.volume_data.description import Box
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume
from volviz_ui.dialogs.error import show_error
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.session.workers import Task, Workers
from volviz_ui.widgets.progress_bar import ProgressBar
from volviz_ui.widgets.small import quiet_label


class SaveVolumeDialog(QDialog):
    """Asks for format, part and file, writes, and closes when that is done.

    Parameters
    ----------
    source : VolumeSource
        Where the volume comes from: its other channels and time points can be written as well.
    volume : Volume
        What is shown of it.
    channel, time
        Which part of the source that is.
    crop : Crop or None
        Crop box of the scene.
    workers : Workers
        Who writes it.
    folder : str
        Where the choice of a file begins.
    """

    saved = Signal(str)
    """Path of the file that was written."""

    def __init__(
        self,
        source: VolumeSource,
        volume: Volume,
        channel: int | None,
        time: int,
        crop: Crop | None,
        workers: Workers,
        folder: str,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Save volume"))
        self._source = source
        self._volume = volume
        self._channel, self._time = channel, time
        self._crop = None if crop is None else voxels_of(crop, volume.dimensions)
        self._workers = workers
        self._folder = folder
        self._task: Task | None = None

        self.format = self._list(self.tr("Format"), self.tr("Which kind of file"))
        for writer in WRITERS:
            self.format.addItem(f"{writer.name} ({writer.suffixes[0]})", writer)
        self.part = self._list(self.tr("Voxels"), self.tr("All of the volume, or what the crop box leaves"))
        self.part.addItem(self.tr("Whole volume"), None)
        if self._crop is not None:
            i0, i1, j0, j1, k0, k1 = self._crop
            words = self.tr("Crop box (%1 voxels)").replace("%1", f"{i1 - i0} × {j1 - j0} × {k1 - k0}")
            self.part.addItem(words, self._crop)
        self.channels = self._list(self.tr("Channels"), self.tr("The channel that is shown, or all of them"))
        self.times = self._list(
            self.tr("Time points"), self.tr("The time point that is shown, or all of them")
        )
        sizes = source.sizes
        for choice, axis in ((self.channels, "c"), (self.times, "t")):
            choice.addItem(self.tr("The one that is shown"), False)
            if sizes.get(axis, 1) > 1:
                choice.addItem(self.tr("All %1").replace("%1", str(sizes[axis])), True)
        form = QFormLayout()
        form.setHorizontalSpacing(16)
        form.setVerticalSpacing(8)
        form.addRow(self.tr("Format"), self.format)
        form.addRow(self.tr("Voxels"), self.part)
        for label, choice in ((self.tr("Channels"), self.channels), (self.tr("Time points"), self.times)):
            if choice.count() > 1:
                form.addRow(label, choice)
            else:
                choice.hide()
        self.words: QLabel = quiet_label()
        self.words.setWordWrap(True)
        self.words.setMinimumHeight(4 * self.fontMetrics().lineSpacing())
        self.bar = ProgressBar(self)
        self.bar.setAccessibleName(self.tr("Progress"))
        keeps = self.bar.sizePolicy()
        keeps.setRetainSizeWhenHidden(True)
        self.bar.setSizePolicy(keeps)
        self.bar.hide()
        self.buttons = QDialogButtonBox(self)
        self.save_button = self.buttons.addButton(self.tr("Save as…"), QDialogButtonBox.ButtonRole.AcceptRole)
        self.save_button.setToolTip(self.tr("Choose a file"))
        cancel = self.buttons.addButton(QDialogButtonBox.StandardButton.Cancel)
        cancel.setToolTip(self.tr("Stop writing, or close"))
        self.buttons.accepted.connect(self.ask_where)
        self.buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(24, 20, 24, 16)
        layout.setSpacing(12)
        layout.addLayout(form)
        layout.addWidget(self.words)
        layout.addWidget(self.bar)
        layout.addWidget(self.buttons)
        self.setMinimumWidth(460)
        for choice in (self.format, self.part, self.channels, self.times):
            choice.currentIndexChanged.connect(self._show_words)
        self._show_words()

    @property
    def is_writing(self) -> bool:
        """Whether a file is being written."""
        return self._task is not None

    @property
    def writer(self) -> Writer:
        """Of the format that is chosen."""
        return WRITERS[self.format.currentIndex()]

    @property
    def chosen(self) -> dict[str, Any]:
        """Which part is written, as keywords of `volviz.save`."""
        # a volume that does not fit is shown at a coarser level, of whose voxels the crop box speaks
        levels = [level.dimensions for level in self._source.levels]
        shown = self._volume.dimensions
        return {
            "level": levels.index(shown) if shown in levels else 0,
            "channel": None if self.channels.currentData() else self._channel,
            "time": None if self.times.currentData() else self._time,
            "box": self.part.currentData(),
        }

    def ask_where(self) -> None:
        """Ask for the file, then write it."""
        ending = self.writer.suffixes[0]
        start = Path(self._folder) / f"{self._volume.name.replace('/', '-')}{ending}"
        path, _filter = QFileDialog.getSaveFileName(
            self, self.tr("Save the volume"), str(start), self.writer.dialog_filter
        )
        if not path:
            return
        asked = True
        if not path.lower().endswith(self.writer.suffixes):
            path += ending
            asked = False
        # file dialogs ask about files, and about the name that was typed
        if (not asked or self.writer.folder) and Path(path).exists() and not self._may_overwrite(path):
            return
        self.save(path)

    def _may_overwrite(self, path: str) -> bool:
        question = self.tr("%1 exists already. Replace it?").replace("%1", Path(path).name)
        return QMessageBox.question(self, self.windowTitle(), question) == QMessageBox.StandardButton.Yes

    def save(self, path: str) -> None:
        """Write the volume on a worker, in the place of a file that is there; the dialog stays until that is done."""
        if self._task is not None:
            return
        writer, part = self.writer, self.chosen
        try:
            check_volume_target(Path(path), writer.id, overwrite=True)
        except Exception as error:  # noqa: BLE001 - told in the dialog's own words
            show_error(self, self.tr("The volume was not saved"), error)
            return
        # what is shown is in memory; anything else is read again
        is_shown = part["channel"] == self._channel and part["time"] == self._time
        data = self._volume if is_shown and not self._is_colour else self._source
        if data is self._volume:
            part = {"box": part["box"]}
        self._show_writing(True)
        self._task = self._workers.start(
            lambda task: save(
                data, path, format=writer.id, overwrite=True, progress=task.report,
                cancel=lambda: task.is_cancelled, **part,
            ),
            label=self.tr("Writing %1").replace("%1", Path(path).name),
        )  # fmt: skip
        self._task.progressed.connect(lambda fraction, _text: self.bar.show_fraction(fraction))
        self._task.succeeded.connect(lambda _notes: self._on_saved(path))
        self._task.failed.connect(self._on_failed)

    @property
    def _is_colour(self) -> bool:
        """The brightness of colours is shown, and the colours are to be written."""
        return self._source.is_colour and bool(self.channels.currentData())

    def _show_words(self) -> None:
        """What the format cannot hold, or why it cannot be written."""
        writer, part = self.writer, self.chosen
        count = self._source.sizes.get("t", 1)
        if not writer.takes(self._volume.array.dtype):
            words = self.tr("%1 holds no values of type %2; choose another format.")
            words = words.replace("%1", writer.name).replace("%2", str(self._volume.array.dtype))
            is_possible = False
        elif part["time"] is None and count > 1 and not writer.time:
            words = self.tr("%1 holds one time point; choose the one that is shown, or another format.")
            words, is_possible = words.replace("%1", writer.name), False
        else:
            words, is_possible = " ".join(losses(writer, self._source, **part)), True
        self.words.setText(words or self.tr("All that is known of the volume is kept."))
        self.save_button.setEnabled(is_possible)

    def _list(self, name: str, tooltip: str) -> QComboBox:
        choice = NoWheelComboBox(self)
        choice.setAccessibleName(name)
        choice.setToolTip(tooltip)
        return choice

    def _show_writing(self, on: bool) -> None:
        self.bar.setVisible(on)
        self.bar.show_fraction(0.0)
        self.save_button.setEnabled(not on)
        for choice in (self.format, self.part, self.channels, self.times):
            choice.setEnabled(not on)

    def _on_saved(self, path: str) -> None:
        self._task = None
        self.saved.emit(path)
        self.accept()

    def _on_failed(self, error: BaseException) -> None:
        self._task = None
        self._show_writing(False)
        show_error(self, self.tr("The volume was not saved"), error)

    def reject(self) -> None:
        """Stop writing when that is under way, else close."""
        if self._task is not None:
            self._task.cancel()
            self._task = None
            self._show_writing(False)
            return
        super().reject()


def voxels_of(crop: Crop, dimensions: tuple[int, int, int]) -> Box | None:
    """The voxels whose centres lie in a crop box, None when those are all; at least two along each axis."""
    box: list[int] = []
    for low, high, count in zip(crop[::2], crop[1::2], dimensions, strict=True):
        first = min(max(math.ceil(low - 1e-6), 0), count - 2)
        last = min(max(math.floor(high + 1e-6) + 1, first + 2), count)
        box += [first, last]
    if box == [v for count in dimensions for v in (0, count)]:
        return None
    return box[0], box[1], box[2], box[3], box[4], box[5]
