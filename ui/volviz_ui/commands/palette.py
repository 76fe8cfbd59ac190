"""The command palette: every command by a few letters of its name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from PySide6.QtCore import (
    QAbstractListModel,
    QEvent,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QPoint,
    QRect,
    QSize,
    Qt,
)
from PySide6.QtGui import QKeyEvent, QPainter, QPalette
from PySide6.QtWidgets import (
    QFrame,
    QLabel,
    QLineEdit,
    QListView,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QVBoxLayout,
    QWidget,
)

from volviz_ui.commands.command import Command, keys_in_words, plain
from volviz_ui.commands.fuzzy import match_score
from volviz_ui.commands.table import CommandTable
from volviz_ui.session.preferences import Preferences
from volviz_ui.widgets.small import quiet_label

WIDTH, ROWS, MARGIN, ROW_MARGIN = 640, 12, 24, 12
"""Width in pixels and rows at most, distance from the edges of the window, air in a row."""
SHOWN = "✓"
USED_BONUS = 8.0
"""Points for what was used before; decides between names that fit about as well."""
ENTRY = Qt.ItemDataRole.UserRole
Index = QModelIndex | QPersistentModelIndex


@dataclass(frozen=True)
class Entry:
    """A command as the palette shows it."""

    command: Command
    path: str
    text: str
    keys: str
    enabled: bool
    checked: bool


class _Entries(QAbstractListModel):
    """The entries that fit, the best one first."""

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._entries: list[Entry] = []

    def show(self, entries: list[Entry]) -> None:
        """Show other entries."""
        self.beginResetModel()
        self._entries = entries
        self.endResetModel()

    def rowCount(self, parent: Index | None = None) -> int:
        """How many there are."""
        return 0 if parent is not None and parent.isValid() else len(self._entries)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """What is shown, read out, and told by the tooltip."""
        entry = self._entries[index.row()]
        if role == ENTRY:
            return entry
        if role == Qt.ItemDataRole.DisplayRole:
            return entry.text
        if role == Qt.ItemDataRole.ToolTipRole:
            return entry.command.tip
        if role == Qt.ItemDataRole.AccessibleTextRole:
            state = [self.tr("switched on")] if entry.checked else []
            state += [] if entry.enabled else [self.tr("not possible now")]
            return ", ".join(part for part in (entry.text, entry.path, entry.keys, *state) if part)
        return None


class _Row(QStyledItemDelegate):
    """Name, menu and keys in one line."""

    def sizeHint(self, option: QStyleOptionViewItem, _index: Index) -> QSize:
        return QSize(200, option.fontMetrics.height() + ROW_MARGIN)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        entry: Entry = index.data(ENTRY)
        role, palette, metrics = QPalette.ColorRole, option.palette, option.fontMetrics
        group = QPalette.ColorGroup.Normal if entry.enabled else QPalette.ColorGroup.Disabled
        chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        strong = palette.color(group, role.HighlightedText if chosen else role.Text)
        quiet = strong if chosen else palette.color(group, role.PlaceholderText)
        painter.save()
        painter.setFont(option.font)
        if chosen:
            painter.fillRect(option.rect, palette.color(group, role.Highlight))
        line = QRect(option.rect.adjusted(10, 0, -12, 0))
        middle = Qt.AlignmentFlag.AlignVCenter
        painter.setPen(quiet)
        painter.drawText(line, middle | Qt.AlignmentFlag.AlignRight, entry.keys)
        line.setRight(line.right() - metrics.horizontalAdvance(entry.keys) - 16)
        painter.setPen(strong)
        if entry.checked:
            painter.drawText(line, middle, SHOWN)
        line.setLeft(line.left() + metrics.horizontalAdvance(SHOWN) + 8)
        text = metrics.elidedText(entry.text, Qt.TextElideMode.ElideRight, line.width())
        painter.drawText(line, middle, text)
        line.setLeft(line.left() + metrics.horizontalAdvance(text) + 14)
        painter.setPen(quiet)
        painter.drawText(
            line, middle, metrics.elidedText(entry.path, Qt.TextElideMode.ElideRight, max(line.width(), 0))
        )
        painter.restore()


class CommandPalette(QFrame):
    """Finds a command while one types; Enter runs it, the arrows choose another, Escape closes.

    Parameters
    ----------
    table : CommandTable
        What there is.
    preferences : Preferences
        Where the commands used last are remembered.
    window : QWidget
        Over which it opens.
    """

    def __init__(self, table: CommandTable, preferences: Preferences, window: QWidget) -> None:
        super().__init__(window, Qt.WindowType.Popup)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setObjectName("palette")
        self.setAccessibleName(self.tr("Command palette"))
        self._table = table
        self._preferences = preferences
        self._used = preferences.used_commands
        self._all = self._entries()
        self.line = QLineEdit(self)
        self.line.setObjectName("palette_line")
        self.line.setPlaceholderText(self.tr("Type a few letters of a command, technique, sample or preset"))
        self.line.setAccessibleName(self.tr("Find a command"))
        self.line.setClearButtonEnabled(True)
        self.line.installEventFilter(self)
        self.line.textChanged.connect(self._show_fitting)
        self.model = _Entries(self)
        self.list = QListView(self)
        self.list.setModel(self.model)
        self.list.setItemDelegate(_Row(self.list))
        self.list.setUniformItemSizes(True)
        self.list.setFrameShape(QFrame.Shape.NoFrame)
        self.list.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.list.setAccessibleName(self.tr("Commands"))
        self.list.clicked.connect(self._run)
        self.list.selectionModel().currentChanged.connect(self._show_tip)
        self.tip: QLabel = quiet_label("", self)
        self.tip.setAccessibleName(self.tr("What the command does"))
        self.tip.setMargin(4)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 4)
        layout.setSpacing(6)
        layout.addWidget(self.line)
        layout.addWidget(self.list, 1)
        layout.addWidget(self.tip)

    def open(self) -> None:
        """Show it over the upper middle of the window."""
        window = self.parentWidget()
        width = min(WIDTH, window.width() - 2 * MARGIN)
        self.setFixedWidth(width)
        self.move(window.mapToGlobal(QPoint((window.width() - width) // 2, 2 * MARGIN)))
        self.line.ensurePolished()
        self._show_fitting("")
        self.show()
        self.line.setFocus(Qt.FocusReason.PopupFocusReason)

    def _fit_height(self) -> None:
        """As many rows as there are, as far as the window has room for them."""
        row = self.list.fontMetrics().height() + ROW_MARGIN
        frame = self.line.sizeHint().height() + self.tip.sizeHint().height() + 30
        room = (self.parentWidget().height() - 4 * MARGIN - frame) // row
        self.list.setFixedHeight(row * max(min(self.model.rowCount(), ROWS, room), 1))
        self.setFixedHeight(self.sizeHint().height())

    # ------------------------------------------------------------------ what fits

    def _entries(self) -> list[Entry]:
        state = self._table.state
        return [
            Entry(
                command, " › ".join(path), plain(command.words(state)), keys_in_words(command), command.enabled(state),
                command.checked is not None and command.checked(state),
            )
            for path, command in self._table.walk()
        ]  # fmt: skip

    def _show_fitting(self, wanted: str) -> None:
        rank = {ident: place for place, ident in enumerate(self._used)}
        scored = []
        for number, entry in enumerate(self._all):
            # a word of the menu may be typed too, but the name counts
            named = match_score(wanted, entry.text)
            points = match_score(wanted, f"{entry.text} {entry.path}")
            if points is not None:
                place = rank.get(entry.command.id)
                points += (0.0 if named is None else named) + (0.0 if place is None else USED_BONUS)
                scored.append((-points, len(rank) if place is None else place, number, entry))
        self.model.show(
            [entry for _points, _place, _number, entry in sorted(scored, key=lambda row: row[:3])]
        )
        if scored:
            self.list.setCurrentIndex(self.model.index(0))
        else:
            self.tip.setText(self.tr("Nothing is called like that"))
        self.list.scrollToTop()
        self._fit_height()

    def _show_tip(self, index: Index) -> None:
        if not index.isValid():
            return
        entry: Entry = index.data(ENTRY)
        words = entry.command.tip.splitlines()[0]
        if not entry.enabled:
            words = self.tr("Not possible now: %1").replace("%1", words)
        width = self.width() - 2 * MARGIN
        self.tip.setText(self.tip.fontMetrics().elidedText(words, Qt.TextElideMode.ElideRight, width))

    # ------------------------------------------------------------------ keys

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """The arrows move in the list while the letters go into the line."""
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress:
            key = event.key()
            if key in (Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_PageUp, Qt.Key.Key_PageDown):
                self._move(key)
                return True
            if key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
                self._run(self.list.currentIndex())
                return True
            if key == Qt.Key.Key_Escape:
                self.close()
                return True
        return super().eventFilter(watched, event)

    def _move(self, key: int) -> None:
        count, row = self.model.rowCount(), self.list.currentIndex().row()
        if not count:
            return
        if key in (Qt.Key.Key_Up, Qt.Key.Key_Down):
            row = (row + (1 if key == Qt.Key.Key_Down else -1)) % count
        else:
            row = min(max(row + (ROWS if key == Qt.Key.Key_PageDown else -ROWS), 0), count - 1)
        self.list.setCurrentIndex(self.model.index(row))

    def _run(self, index: Index) -> None:
        if not index.isValid():
            return
        entry: Entry = index.data(ENTRY)
        if entry.enabled:
            self._preferences.add_used_command(entry.command.id)
            self.close()
            self._table.run(entry.command)
