"""The presets as images, in a window that opens below its button."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QPoint, QSize, Qt, QTimer, Signal, SignalInstance
from PySide6.QtGui import QIcon, QImage, QKeyEvent, QPixmap
from PySide6.QtWidgets import (
    QFrame,
    QLabel,
    QListView,
    QListWidget,
    QListWidgetItem,
    QMenu,
    QVBoxLayout,
    QWidget,
)

from volviz.custom_gl.registry import techniques
from volviz.model.transfer.presets import Preset, preset_for, presets
from volviz_ui.library_words import translated
from volviz_ui.transfer_editor.painting import thumbnail

if TYPE_CHECKING:
    from volviz.model.transfer.function import TransferFunction
    from volviz.model.transfer.own_presets import OwnPresets
    from volviz.volume_data.volume import Volume

#: Renders a preset on the user's volume when the program is idle and hands the image over; the function is the
#: preset's in the units of the volume.
ThumbnailProvider = Callable[[Preset, "TransferFunction", Callable[[QImage], None]], None]

WIDTH, HEIGHT = 104, 72
_PRESET = Qt.ItemDataRole.UserRole


class PresetList(QListWidget):
    """Presets as a grid of images with their names."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setViewMode(QListView.ViewMode.IconMode)
        self.setResizeMode(QListView.ResizeMode.Adjust)
        self.setMovement(QListView.Movement.Static)
        self.setUniformItemSizes(True)
        self.setWordWrap(True)
        self.setIconSize(QSize(WIDTH, HEIGHT))
        self.setGridSize(QSize(WIDTH + 16, HEIGHT + 30))
        self.setSpacing(4)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setItemAlignment(Qt.AlignmentFlag.AlignCenter)

    def add(self, preset: Preset) -> QListWidgetItem:
        """Append a preset."""
        item = QListWidgetItem(translated(preset.label), self)
        item.setData(_PRESET, preset)
        about = translated(preset.description or preset.label)
        if preset.technique:
            known = techniques()
            label = known[preset.technique].label if preset.technique in known else preset.technique
            about += "\n" + self.tr("Brings its technique: %1").replace("%1", translated(label))
        item.setToolTip(about)
        item.setTextAlignment(Qt.AlignmentFlag.AlignCenter)
        return item


class PresetPopup(QFrame):
    """Own presets above, bundled ones below; a click or Enter takes one.

    Parameters
    ----------
    own : OwnPresets
        Where the user's presets lie.
    parent : QWidget
        Owner.
    """

    chosen = Signal(object)
    rename_asked = Signal(str)
    delete_asked = Signal(str)
    """Labels of own presets."""

    def __init__(self, own: OwnPresets, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Popup)
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.setAccessibleName(self.tr("Presets"))
        self.provider: ThumbnailProvider | None = None
        self._own_presets = own
        self._volume: Volume | None = None
        self._images: dict[tuple[object, ...], QImage] = {}
        self._waiting: list[QListWidgetItem] = []
        self._round = 0
        self.own_caption = QLabel(self.tr("Own presets"), self)
        self.own_caption.setProperty("quiet", True)
        self.own_list = PresetList(self)
        self.own_list.setAccessibleName(self.tr("Own presets"))
        self.caption = QLabel(self.tr("Presets"), self)
        self.caption.setProperty("quiet", True)
        self.list = PresetList(self)
        self.list.setAccessibleName(self.tr("Bundled presets"))
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 8)
        layout.setSpacing(4)
        for widget in (self.own_caption, self.own_list, self.caption, self.list):
            layout.addWidget(widget)
        for each in (self.own_list, self.list):
            each.itemClicked.connect(self._on_taken)
            each.itemActivated.connect(self._on_taken)
            each.installEventFilter(self)
            each.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
            each.customContextMenuRequested.connect(partial(self._show_menu, each))
        self._idle = QTimer(self)
        self._idle.setSingleShot(True)
        self._idle.setInterval(0)
        self._idle.timeout.connect(self._next_image)

    def set_volume(self, volume: Volume | None) -> None:
        """The volume on which thumbnails are shown."""
        if volume is not self._volume:
            self._volume = volume
            self._images.clear()

    def open_below(self, button: QWidget, current: str = "") -> None:
        """Fill the lists and show them at a button: below it, or above where there is no room.

        Parameters
        ----------
        button : QWidget
        current : str
            Name of the function that is shown now; its preset is marked.
        """
        self.fill(current)
        columns = 6
        width = columns * (WIDTH + 16) + 44
        rows = -(-self.list.count() // columns)
        own_rows = min(-(-self.own_list.count() // columns), 2)
        row = HEIGHT + 30
        self.own_list.setFixedHeight(own_rows * row + 8)
        self.resize(width, 60 + rows * row + (own_rows * row + 30 if own_rows else 0))
        screen = button.screen().availableGeometry()
        below = button.mapToGlobal(QPoint(0, button.height() + 2))
        above = button.mapToGlobal(QPoint(0, -self.height() - 2))
        top = below if below.y() + self.height() <= screen.bottom() else above
        top.setX(max(min(top.x(), screen.right() - self.width()), screen.left()))
        top.setY(max(top.y(), screen.top()))
        self.move(top)
        self.show()
        self.list.setFocus()

    def fill(self, current: str = "") -> None:
        """Read the presets again, mark the current one, and begin to draw their images."""
        self._round += 1
        self._waiting = []
        for each, found in ((self.own_list, self._own_presets.all()), (self.list, presets())):
            each.clear()
            for preset in found.values():
                item = each.add(preset)
                self._show_image(item, preset)
                if preset.transfer_function.name == current:
                    each.setCurrentItem(item)
        has_own = self.own_list.count() > 0
        self.own_caption.setVisible(has_own)
        self.own_list.setVisible(has_own)
        if self._waiting and self.provider is not None and self._volume is not None:
            self._idle.start()

    def _show_menu(self, shown: PresetList, at: QPoint) -> None:
        """What can be done with the preset under the pointer; bundled ones can be taken only."""
        item = shown.itemAt(at)
        if item is None:
            return
        menu = QMenu(self)
        menu.addAction(self.tr("Use")).triggered.connect(lambda: self._on_taken(item))
        if shown is self.own_list:
            label = item.data(_PRESET).label
            for words, signal in (
                (self.tr("Rename…"), self.rename_asked),
                (self.tr("Delete…"), self.delete_asked),
            ):
                menu.addAction(words).triggered.connect(partial(self._leave_for, signal, label))
        menu.aboutToHide.connect(menu.deleteLater)
        menu.popup(shown.viewport().mapToGlobal(at))

    def _leave_for(self, signal: SignalInstance, label: str) -> None:
        self.close()
        signal.emit(label)

    def hideEvent(self, event: QEvent) -> None:
        """Closed: nobody waits for images any more."""
        self._idle.stop()
        super().hideEvent(event)  # type: ignore[arg-type]

    def eventFilter(self, watched: QWidget, event: QEvent) -> bool:  # type: ignore[override]
        """Enter takes the preset; up and down lead from one list to the other."""
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress:
            current = watched.currentItem()  # type: ignore[attr-defined]
            if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and current is not None:
                self._on_taken(current)
                return True
            if event.key() == Qt.Key.Key_Escape:
                self.close()
                return True
            if self._leads_across(watched, event.key()):
                return True
        return super().eventFilter(watched, event)

    def _leads_across(self, watched: QWidget, key: int) -> bool:
        """Up from the top row of the lower list, and down from the last row of the upper one."""
        columns = max((self.width() - 24) // (WIDTH + 16), 1)
        row = watched.currentRow()  # type: ignore[attr-defined]
        upwards = watched is self.list and key == Qt.Key.Key_Up and row < columns
        last = (self.own_list.count() - 1) // columns
        downwards = watched is self.own_list and key == Qt.Key.Key_Down and row // columns >= last
        if not (upwards and self.own_list.count()) and not downwards:
            return False
        other = self.own_list if upwards else self.list
        other.setFocus()
        if other.currentRow() < 0:
            other.setCurrentRow(0)
        return True

    def function_of(self, preset: Preset) -> TransferFunction:
        """The preset's function in the units of the volume."""
        return preset.transfer_function if self._volume is None else preset_for(preset, self._volume)

    def _show_image(self, item: QListWidgetItem, preset: Preset) -> None:
        function = self.function_of(preset)
        image = self._images.get(_key(preset, function))
        if image is None:
            data_range = (0.0, 1.0) if self._volume is None else self._volume.range
            if self._volume is None and function.domain == "data":
                data_range = (function.points[0].value, function.points[-1].value)
            image = thumbnail(function, data_range, WIDTH, HEIGHT, self.devicePixelRatioF())
            self._waiting.append(item)
        item.setIcon(_untinted(image))

    def _next_image(self) -> None:
        if not self._waiting or self.provider is None or not self.isVisible():
            return
        item = self._waiting.pop(0)
        preset = item.data(_PRESET)
        function = self.function_of(preset)
        key, current = _key(preset, function), self._round

        def deliver(image: QImage) -> None:
            self._images[key] = image
            # The lists may have been filled anew meanwhile; the old items are gone then.
            if current == self._round and not image.isNull():
                item.setIcon(_untinted(image))
            if self.isVisible():
                self._idle.start()

        self.provider(preset, function, deliver)

    def _on_taken(self, item: QListWidgetItem) -> None:
        preset = item.data(_PRESET)
        self.close()
        self.chosen.emit(preset)


def _key(preset: Preset, function: TransferFunction) -> tuple[object, ...]:
    """What decides how the image of a preset looks."""
    settings = tuple(sorted((name, repr(value)) for name, value in (preset.settings or {}).items()))
    return function.points, function.opacity, function.by_gradient, preset.technique, settings


def _untinted(image: QImage) -> QIcon:
    """An icon that keeps its colours when its item is chosen."""
    pixmap = QPixmap.fromImage(image)
    icon = QIcon(pixmap)
    icon.addPixmap(pixmap, QIcon.Mode.Selected)
    return icon
