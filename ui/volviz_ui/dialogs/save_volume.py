"""Saving the volume: format, which part of it, and file; written on a worker with progress and cancel."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from PySide6.QtWidgets import QFileDialog, QLabel, QWidget

from volviz.io import save
from volviz.io.writers import WRITERS, Writer, check_volume_target, losses
from volviz.model.clipping import Crop
from volviz.volume_data.description import Box
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume
from volviz_ui.dialogs.writing_dialog import WritingDialog
from volviz_ui.session.workers import Workers
from volviz_ui.widgets.small import quiet_label


class SaveVolumeDialog(WritingDialog):
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
        super().__init__(workers, self.tr("Save volume"), self.tr("The volume was not saved"), parent)
        self._source = source
        self._volume = volume
        self._channel, self._time = channel, time
        self._crop = None if crop is None else voxels_of(crop, volume.dimensions)
        self._folder = folder
        for writer in WRITERS:
            self.format.addItem(f"{writer.name} ({writer.suffixes[0]})", writer)
        self.part = self.add_choice(
            self.tr("Voxels"), self.tr("All of the volume, or what the crop box leaves")
        )
        self.part.addItem(self.tr("Whole volume"), None)
        if self._crop is not None:
            i0, i1, j0, j1, k0, k1 = self._crop
            words = self.tr("Crop box (%1 voxels)").replace("%1", f"{i1 - i0} × {j1 - j0} × {k1 - k0}")
            self.part.addItem(words, self._crop)
        self.channels = self.add_choice(
            self.tr("Channels"), self.tr("The channel that is shown, or all of them")
        )
        self.times = self.add_choice(
            self.tr("Time points"), self.tr("The time point that is shown, or all of them")
        )
        sizes = source.sizes
        for choice, axis in ((self.channels, "c"), (self.times, "t")):
            choice.addItem(self.tr("The one that is shown"), False)
            if sizes.get(axis, 1) > 1:
                choice.addItem(self.tr("All %1").replace("%1", str(sizes[axis])), True)
        self.form.addRow(self.tr("Voxels"), self.part)
        for label, choice in ((self.tr("Channels"), self.channels), (self.tr("Time points"), self.times)):
            if choice.count() > 1:
                self.form.addRow(label, choice)
            else:
                choice.hide()
        self.words: QLabel = quiet_label()
        self.words.setMinimumHeight(4 * self.fontMetrics().lineSpacing())
        self.lay_out(self.words, 460)
        for choice in self.choices:
            choice.currentIndexChanged.connect(self._show_words)
        self._show_words()

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
        if (not asked or self.writer.folder) and Path(path).exists() and not self.may_overwrite(path):
            return
        self.save(path)

    def save(self, path: str) -> None:
        """Write the volume on a worker, in the place of a file that is there; the dialog stays until that is done."""
        if self._task is not None:
            return
        writer, part = self.writer, self.chosen
        try:
            check_volume_target(Path(path), writer.id, overwrite=True)
        except Exception as error:  # noqa: BLE001 - told in the dialog's own words
            self.show_failure(error)
            return
        # what is shown is in memory; anything else is read again
        is_shown = part["channel"] == self._channel and part["time"] == self._time
        data = self._volume if is_shown and not self._is_colour else self._source
        if data is self._volume:
            part = {"box": part["box"]}
        self.write(
            path,
            lambda task: save(
                data, path, format=writer.id, overwrite=True, progress=task.report,
                cancel=lambda: task.is_cancelled, **part,
            ),
            told=lambda _notes: "",
        )  # fmt: skip

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
