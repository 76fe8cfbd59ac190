"""The labels of a layer as a table of Qt: a hundred thousand rows without a widget for any of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QAbstractTableModel, QModelIndex, QObject, QPersistentModelIndex, Qt, Signal
from PySide6.QtGui import QColor, QFont

from volviz.measure.label_table import LabelTable
from volviz.model.label_palette import LabelLook
from volviz.model.layers import LabelLayer

Index = QModelIndex | QPersistentModelIndex
NAME, LABEL, VOXELS, VOLUME, MEAN, DEVIATION, MINIMUM, MAXIMUM = range(8)
#: Columns that there are without an image whose values are told.
WITHOUT_VALUES = 4


@dataclass(frozen=True, eq=False)
class Rows:
    """What the table shows, one row a label.

    Attributes
    ----------
    table : LabelTable
        Numbers, voxels, volumes, and values under the labels where they have been counted.
    names : mapping from label to str
    palette : ndarray of shape (n, 4)
        Colour, and opacity: 0 of those that are hidden.
    """

    table: LabelTable
    names: dict[int, str] = field(default_factory=dict)
    palette: npt.NDArray[np.float32] = field(default_factory=lambda: np.zeros((0, 4), np.float32))

    @classmethod
    def of(cls, layer: LabelLayer, table: LabelTable) -> Rows:
        """The rows of a layer whose voxels have been counted."""
        look = LabelLook(layer.colors, layer.hidden, 1.0, layer.opacities)
        return cls(table, dict(layer.names), look.palette(np.append(0, table.labels))[1:])

    def name(self, row: int) -> str:
        """What a label is called; its number where it has no name."""
        label = int(self.table.labels[row])
        return self.names.get(label, "")


class LabelModel(QAbstractTableModel):
    """The rows in the order and with the filter that were chosen.

    Attributes
    ----------
    switched : signal (int, bool)
        The box of a label was ticked: its number, and whether it is to be seen.
    renamed : signal (int, str)
        A label was given another name.
    """

    switched = Signal(int, bool)
    renamed = Signal(int, str)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.rows: Rows | None = None
        self._order = np.zeros(0, np.int64)
        self._filter = ""
        self._sorted: tuple[int, bool] = (LABEL, False)

    # ------------------------------------------------------------------ what is shown

    def show_rows(self, rows: Rows | None) -> None:
        """Show other rows; as long as they are the same labels, the view keeps its place and choice."""
        before, self.rows = self.rows, rows
        same = before is not None and rows is not None and before.table is rows.table
        if same and rows is not None and before is not None and before.names == rows.names:
            last = self.index(self.rowCount() - 1, self.columnCount() - 1)
            self.dataChanged.emit(self.index(0, 0), last)
        else:
            self._arrange()

    def set_filter(self, words: str) -> None:
        """Show labels alone whose name or number holds these words."""
        self._filter = words.strip().lower()
        self._arrange()

    def sort(self, column: int, order: Qt.SortOrder = Qt.SortOrder.AscendingOrder) -> None:
        """Sort by a column."""
        self._sorted = column, order == Qt.SortOrder.DescendingOrder
        self._arrange()

    def _arrange(self) -> None:
        self.beginResetModel()
        if self.rows is None:
            self._order = np.zeros(0, np.int64)
        else:
            keys = self._keys(self._sorted[0])
            order = np.argsort(keys, kind="stable")
            if self._sorted[1]:
                order = order[::-1]
            if self._filter:
                labels, names = self.rows.table.labels, self.rows.names
                kept = [
                    self._filter in names.get(label, "").lower() or self._filter in str(label)
                    for label in labels[order].tolist()
                ]
                order = order[np.array(kept, bool)]
            self._order = order
        self.endResetModel()

    def _keys(self, column: int) -> npt.NDArray[Any]:
        assert self.rows is not None
        table, values = self.rows.table, self.rows.table.values
        if column == NAME:
            # what has no name comes last
            return np.array([(self.rows.names.get(n) or "\uffff").lower() for n in table.labels.tolist()])
        if values is not None and column >= WITHOUT_VALUES:
            return (values.means, values.deviations, values.minima, values.maxima)[column - MEAN]
        return (table.labels, table.labels, table.counts, table.volumes)[min(column, VOLUME)]

    def labels_at(self, rows: list[int]) -> list[int]:
        """The labels in some rows of the view."""
        if self.rows is None:
            return []
        return [int(label) for label in self.rows.table.labels[self._order[rows]]]

    def row_of(self, label: int) -> int | None:
        """The row of the view in which a label stands; None where it does not."""
        if self.rows is None:
            return None
        found = np.flatnonzero(self.rows.table.labels[self._order] == label)
        return int(found[0]) if len(found) else None

    # ------------------------------------------------------------------ for Qt

    def rowCount(self, parent: Index | None = None) -> int:
        """As many as the filter leaves."""
        return 0 if parent is not None and parent.isValid() else len(self._order)

    def columnCount(self, _parent: Index | None = None) -> int:
        """More with values of an image."""
        return WITHOUT_VALUES if self.rows is None or self.rows.table.values is None else MAXIMUM + 1

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = 0) -> Any:
        """Titles of the columns, with units."""
        if orientation != Qt.Orientation.Horizontal:
            return None
        table = None if self.rows is None else self.rows.table
        values = None if table is None else table.values
        unit = f" ({values.unit})" if values is not None and values.unit else ""
        cubic = f" ({table.length_unit}³)" if table is not None and table.length_unit else ""
        tr = self.tr
        if role == Qt.ItemDataRole.DisplayRole:
            return (
                tr("Name"), tr("Label"), tr("Voxels"), tr("Volume") + cubic, tr("Mean") + unit,
                tr("Deviation") + unit, tr("Minimum") + unit, tr("Maximum") + unit,
            )[section]  # fmt: skip
        if role == Qt.ItemDataRole.ToolTipRole:
            name = "" if values is None else values.name
            return (
                tr("Tick what is to be seen; double-click a name to change it"),
                tr("Number in the file"),
                tr("Voxels with this label"),
                tr("Volume of all its voxels"),
                *(
                    words.replace("%1", name)
                    for words in (
                        tr("Mean of %1 under the label"),
                        tr("Standard deviation of %1 under the label"),
                        tr("Lowest value of %1 under the label"),
                        tr("Highest value of %1 under the label"),
                    )
                ),
            )[section]
        return None

    def data(self, index: Index, role: int = 0) -> Any:
        """What stands in a cell."""
        if self.rows is None or not index.isValid():
            return None
        row, column = int(self._order[index.row()]), index.column()
        if role == Qt.ItemDataRole.DisplayRole:
            return self._text(row, column)
        if role == Qt.ItemDataRole.TextAlignmentRole and column != NAME:
            return int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        if column != NAME:
            return None
        red, green, blue, opacity = (float(v) for v in self.rows.palette[row])
        if role == Qt.ItemDataRole.EditRole:
            return self.rows.name(row)
        if role == Qt.ItemDataRole.CheckStateRole:
            return Qt.CheckState.Checked if opacity > 0 else Qt.CheckState.Unchecked
        if role == Qt.ItemDataRole.DecorationRole:
            return QColor.fromRgbF(red, green, blue)
        if role == Qt.ItemDataRole.FontRole and not self.rows.name(row):
            font = QFont()
            font.setItalic(True)
            return font
        return None

    def _text(self, row: int, column: int) -> str:
        assert self.rows is not None
        table = self.rows.table
        if column == NAME:
            return self.rows.name(row) or self.tr("without a name")
        if column == LABEL:
            return str(int(table.labels[row]))
        if column == VOXELS:
            return f"{int(table.counts[row]):,}".replace(",", " ")
        if column == VOLUME:
            return f"{table.volumes[row]:.5g}"
        assert table.values is not None
        value = float(self._keys(column)[row])
        return "–" if np.isnan(value) else f"{value:.5g}"

    def setData(self, index: Index, value: Any, role: int = 0) -> bool:
        """A tick or a new name; the scene changes, and the table follows it."""
        if self.rows is None or index.column() != NAME:
            return False
        label = int(self.rows.table.labels[self._order[index.row()]])
        if role == Qt.ItemDataRole.CheckStateRole:
            self.switched.emit(label, Qt.CheckState(value) == Qt.CheckState.Checked)
            return True
        if role == Qt.ItemDataRole.EditRole:
            self.renamed.emit(label, str(value))
            return True
        return False

    def flags(self, index: Index) -> Qt.ItemFlag:
        """Rows are chosen; names are ticked and edited."""
        usual = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        if index.column() != NAME:
            return usual
        return usual | Qt.ItemFlag.ItemIsUserCheckable | Qt.ItemFlag.ItemIsEditable
