"""The page of shortcuts (`?`): keys as the table of commands has them, and what the mouse does."""

from __future__ import annotations

from collections.abc import Iterable

from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QVBoxLayout,
    QWidget,
)

from volviz_ui.commands.command import Command, State, keys_in_words, plain
from volviz_ui.widgets.small import quiet_label

WORDS_WIDTH = 190


class ShortcutsDialog(QDialog):
    """Two columns: keys, and the mouse.

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
        columns = QHBoxLayout()
        columns.setSpacing(40)
        groups: dict[str, list[tuple[str, str]]] = {}
        for path, command in commands:
            if keys := keys_in_words(command):
                groups.setdefault(path[0], []).append((plain(command.words(state)), keys))
        mouse = self._mouse()
        total = sum(len(rows) + 2 for rows in [*groups.values(), mouse])
        left, right = QVBoxLayout(), QVBoxLayout()
        tables: dict[QVBoxLayout, list[QGridLayout]] = {left: [], right: []}
        used = 0
        for title, rows in groups.items():
            column = left if used < total / 2 else right
            tables[column].append(self._table(title, rows))
            used += len(rows) + 2
        tables[right].append(self._table(self.tr("Mouse in the viewport"), mouse))
        for column, grids in tables.items():
            # the keys of all groups of a column stand below one another
            widest = max(
                grid.itemAtPosition(row, 0).sizeHint().width()
                for grid in grids
                for row in range(1, grid.rowCount())
            )
            for grid in grids:
                grid.setColumnMinimumWidth(0, max(widest, WORDS_WIDTH))
                column.addLayout(grid)
            column.setSpacing(16)
            column.addStretch(1)
            columns.addLayout(column)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close, self)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(24, 20, 24, 16)
        layout.setSpacing(16)
        layout.addLayout(columns)
        layout.addWidget(buttons)

    def _mouse(self) -> list[tuple[str, str]]:
        return [
            (self.tr("Turn the volume"), self.tr("Left drag")),
            (self.tr("Push the volume"), self.tr("Shift + left drag")),
            (self.tr("Look at a place, turn about it"), self.tr("Double-click")),
            (self.tr("Zoom"), self.tr("Wheel, middle drag")),
            (self.tr("Move the light (or zoom)"), self.tr("Right drag")),
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
