"""The page of shortcuts (`?`): keys as the table of commands has them, and what the mouse does."""

from __future__ import annotations

from collections.abc import Iterable

from PySide6.QtCore import QSize
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from volviz_ui.commands.command import Command, State, keys_in_words, plain
from volviz_ui.widgets.dialog_layout import lay_out
from volviz_ui.widgets.small import quiet_label

COLUMNS = 3
PART_OF_SCREEN = 0.8
"""As much of it the page takes at most; beyond, it scrolls."""


class ShortcutsDialog(QDialog):
    """Keys menu by menu, then the mouse.

    Parameters
    ----------
    commands : iterable of (path, Command)
        All commands, each with the titles of the menus that lead to it; those without a key are left out.
    state : State
        For texts that follow it.
    """

    def __init__(
        self,
        commands: Iterable[tuple[tuple[str, ...], Command]],
        state: State,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Shortcuts"))
        groups: dict[str, list[tuple[str, str]]] = {}
        for path, command in commands:
            if keys := keys_in_words(command):
                groups.setdefault(path[0], []).append((plain(command.words(state)), keys))
        groups[self.tr("Mouse in the viewport")] = self._mouse()
        body = QWidget(self)
        columns = QHBoxLayout(body)
        columns.setContentsMargins(0, 0, 0, 0)
        columns.setSpacing(32)
        for titles in _shared_out({title: len(rows) + 2 for title, rows in groups.items()}):
            column = QVBoxLayout()
            column.setSpacing(16)
            grids = [self._table(title, groups[title]) for title in titles]
            # the keys of all groups of a column stand below one another
            widest = max(
                grid.itemAtPosition(row, 0).widget().sizeHint().width()
                for grid in grids
                for row in _rows(grid)
            )
            for grid in grids:
                grid.setColumnMinimumWidth(0, widest)
                column.addLayout(grid)
            column.addStretch(1)
            columns.addLayout(column)
        scrolls = QScrollArea(self)
        scrolls.setWidgetResizable(True)
        scrolls.setFrameShape(QFrame.Shape.NoFrame)
        scrolls.setWidget(body)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close, self)
        buttons.rejected.connect(self.reject)
        layout = lay_out(self, scrolls, buttons, spacing=16)
        layout.setStretchFactor(scrolls, 1)
        bar = scrolls.verticalScrollBar().sizeHint().width()
        whole = body.sizeHint() + QSize(bar, 0)
        scrolls.setMinimumSize(whole.boundedTo(self.screen().availableSize() * PART_OF_SCREEN))

    def _mouse(self) -> list[tuple[str, str]]:
        return [
            (self.tr("Rotate"), self.tr("Left drag, arrow keys")),
            (self.tr("Pan"), self.tr("Shift + left drag or arrow keys")),
            (self.tr("Rotate about the point under the pointer"), self.tr("Double-click")),
            (self.tr("Zoom to the pointer, or to the middle"), self.tr("Wheel, middle drag")),
            (self.tr("Move the light (zoom where nothing is lit)"), self.tr("Right drag")),
            (self.tr("Move light or cut plane"), self.tr("Drag its knob")),
            (self.tr("Distance of the light"), self.tr("Ctrl + wheel")),
            (self.tr("Shift and stretch the colours"), self.tr("Ctrl + left drag")),
            (self.tr("Slider back to its default"), self.tr("Double-click")),
            (self.tr("Open a file or folder"), self.tr("Drop it on the window")),
        ]

    def _table(self, title: str, rows: list[tuple[str, str]]) -> QGridLayout:
        grid = QGridLayout()
        grid.setHorizontalSpacing(24)
        grid.setVerticalSpacing(4)
        heading = QLabel(f"<b>{title}</b>")
        grid.addWidget(heading, 0, 0, 1, 2)
        for number, (words, keys) in enumerate(rows, start=1):
            grid.addWidget(QLabel(words), number, 0)
            grid.addWidget(quiet_label(keys), number, 1)
        grid.setColumnMinimumWidth(1, 130)
        grid.setColumnStretch(1, 1)
        return grid


def _shared_out(heights: dict[str, int]) -> list[list[str]]:
    """Titles of the groups of each column, in their order, so that the columns are about equally high."""
    columns: list[list[str]] = [[]]
    target, used = sum(heights.values()) / COLUMNS, 0.0
    for title, height in heights.items():
        if columns[-1] and used + height / 2 > target and len(columns) < COLUMNS:
            columns.append([])
            used = 0.0
        columns[-1].append(title)
        used += height
    return columns


def _rows(grid: QGridLayout) -> range:
    """Rows of a table below its heading."""
    return range(1, grid.rowCount())
