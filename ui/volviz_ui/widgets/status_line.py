"""The line at the foot of the window: what is under the pointer, how the image was drawn, what it shows."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import QLabel, QSizePolicy, QStatusBar, QWidget

from volviz.volume_data.brick_cache.cache import BrickStatus
from volviz.volume_data.volume import Volume

#: While images are on their way, what the line says of them changes no more often than this.
UNFINISHED_MS = 150


class StatusLine(QStatusBar):
    """Four fields of fixed width, so that nothing jumps while numbers change."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setSizeGripEnabled(False)
        self._technique = ""
        self._status: Any = None
        self._status_timer = QTimer(self)
        self._status_timer.setSingleShot(True)
        self._status_timer.setInterval(UNFINISHED_MS)
        self._status_timer.timeout.connect(self._write_status)
        self.pointer = self._field(
            "(000, 000, 000)   −000.0, −000.0, −000.0 mm   −00000 unit",
            self.tr("Voxel under the pointer, its place in the world and the values there"),
        )
        self._pointer_tip = self.pointer.toolTip()
        self.drawing = self._field(
            self.tr("Marching tetrahedra, full quality 000 %"), self.tr("Technique, and resolution now shown")
        )
        self._drawing_tip = self.drawing.toolTip()
        self.time = self._field("0000 ms", self.tr("Time that drawing this picture took"))
        self.volume = self._field("", self.tr("Data set and its size in voxels"))
        for field in (self.pointer, self.drawing, self.time):
            self.addWidget(field)
        self.addPermanentWidget(self.volume)

    def show_picked(self, voxel: tuple[int, int, int] | None, place: str = "", values: str = "") -> None:
        """Show what is under the pointer.

        Parameters
        ----------
        voxel : tuple of 3 ints or None
            Index (i, j, k); None for nothing.
        place : str
            Where it lies in the world.
        values : str
            Its value, or those of all layers.
        """
        if voxel is None:
            self.pointer.setText("")
            self.pointer.setToolTip(self._pointer_tip)
            return
        i, j, k = voxel
        words = f"({i}, {j}, {k})   {place}   {values}"
        # whatever has no room is in the tooltip
        room = self.pointer.width() - 18
        self.pointer.setText(self.fontMetrics().elidedText(words, Qt.TextElideMode.ElideRight, room))
        self.pointer.setToolTip(words)

    def show_technique(self, label: str) -> None:
        """Show how the volume is drawn."""
        self._technique = label
        self.drawing.setText(label)

    def show_status(self, status: Any) -> None:
        """Show what the host says about the image; unfinished ones a little later, once for several."""
        self._status = status
        if status.complete:
            self._status_timer.stop()
            self._write_status()
        elif not self._status_timer.isActive():
            self._status_timer.start()

    def _write_status(self) -> None:
        status = self._status
        if status.complete and status.resolution >= 1:
            words = self.tr("full quality")
        elif status.resolution >= 1:
            words = self.tr("full resolution")
        else:
            percent = max(1, round(100 * status.resolution))
            words = self.tr("%1 % of the resolution").replace("%1", str(percent))
        if status.bricks is not None:
            words += ", " + self._words_on_bricks(status.bricks)
        notice = getattr(status, "notice", "")
        if notice:
            # the first clause; all of it is in the tooltip
            words += "  \N{WARNING SIGN} " + notice.split(":")[0].rstrip(".")
        self.drawing.setToolTip(notice or self._drawing_tip)
        self.drawing.setText(f"{self._technique}, {words}")
        seconds = status.seconds
        self.time.setText(f"{1000 * seconds:.0f} ms" if seconds < 10 else f"{seconds:.1f} s")

    def _words_on_bricks(self, bricks: BrickStatus) -> str:
        """Which level a volume larger than memory is seen at, and how much of it is there; level 0 is the finest."""
        share = 100 * (bricks.present + bricks.failed) // max(bricks.needed, 1)
        words = self.tr("level %1 of %2, %3 % of the needed bricks, %4 MB")
        numbers = (bricks.level, bricks.level_count, share, round(bricks.held_bytes / 1e6))
        for place, number in enumerate(numbers, start=1):
            words = words.replace(f"%{place}", str(number), 1)
        return words

    def show_volume(self, volume: Volume | None) -> None:
        """Show what is loaded."""
        if volume is None:
            self._status_timer.stop()
            for field in (self.volume, self.pointer, self.drawing, self.time):
                field.setText("")
            return
        size = " × ".join(str(n) for n in volume.dimensions)
        name = self.fontMetrics().elidedText(volume.name, Qt.TextElideMode.ElideMiddle, 260)
        self.volume.setText(f"{name}   {size}")

    def _field(self, widest: str, tooltip: str) -> QLabel:
        label = QLabel(self)
        label.setToolTip(tooltip)
        label.setContentsMargins(8, 1, 8, 1)
        if widest:
            label.setMinimumWidth(self.fontMetrics().horizontalAdvance(widest) + 16)
            label.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Preferred)
        return label
