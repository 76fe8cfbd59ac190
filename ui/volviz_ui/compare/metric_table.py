"""Metrics of two sides beside one another: a name, a number for each."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QGridLayout, QLabel, QSizePolicy, QWidget

DASH = "\N{EN DASH}"


class MetricTable(QWidget):
    """Rows of a caption and one or two values; the columns keep their width while numbers change.

    Parameters
    ----------
    rows : sequence of (key, caption, tooltip)
        What is reported.
    columns : int
        1 for metrics of the pair, 2 for those of the sides.
    """

    def __init__(
        self, rows: list[tuple[str, str, str]], *, columns: int, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._columns = columns
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setHorizontalSpacing(8)
        self._grid.setVerticalSpacing(4)
        self._heads = [QLabel(self) for _ in range(columns)]
        self._values: dict[str, list[QLabel]] = {}
        self._captions: dict[str, QLabel] = {}
        for column, head in enumerate(self._heads):
            head.setProperty("quiet", True)
            head.setAlignment(Qt.AlignmentFlag.AlignRight)
            head.setVisible(columns > 1)
            self._grid.addWidget(head, 0, column + 1)
        for row, (key, caption, tooltip) in enumerate(rows, start=1):
            words = QLabel(caption, self)
            words.setProperty("quiet", True)
            words.setToolTip(tooltip)
            self._captions[key] = words
            self._grid.addWidget(words, row, 0)
            self._values[key] = []
            for column in range(columns):
                value = QLabel(DASH, self)
                value.setToolTip(tooltip)
                value.setAlignment(Qt.AlignmentFlag.AlignRight)
                value.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
                value.setMinimumWidth(self.fontMetrics().horizontalAdvance("00 000 000"))
                value.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
                value.setAccessibleName(caption if columns == 1 else f"{caption} {column + 1}")
                self._values[key].append(value)
                self._grid.addWidget(value, row, column + 1)

    def set_heads(self, *heads: tuple[str, str]) -> None:
        """What stands above the columns, and what it is short for."""
        for head, (words, tooltip) in zip(self._heads, heads, strict=True):
            head.setText(words)
            head.setToolTip(tooltip)

    def set_caption(self, key: str, words: str) -> None:
        """Name a row anew, with another unit say."""
        self._captions[key].setText(words)

    def set_row(self, key: str, *values: str | None) -> None:
        """Show the values of a row; None is a dash."""
        for label, value in zip(self._values[key], values, strict=True):
            label.setText(DASH if value is None else value)

    def text(self, key: str, column: int = 0) -> str:
        """What a cell says."""
        return self._values[key][column].text()

    def show_row(self, key: str, shown: bool) -> None:
        """Show or hide a row."""
        for label in (self._captions[key], *self._values[key]):
            label.setVisible(shown)

    def clear(self) -> None:
        """Dashes everywhere."""
        for key in self._values:
            self.set_row(key, *[None] * self._columns)
