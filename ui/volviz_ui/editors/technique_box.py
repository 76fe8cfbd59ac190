"""The list of techniques, each with one line on what it does."""

from __future__ import annotations

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRect, QSize, Qt
from PySide6.QtGui import QFont, QFontMetrics, QPainter, QPalette
from PySide6.QtWidgets import QStyle, QStyledItemDelegate, QStyleOptionViewItem, QWidget

from volviz.custom_gl.scene_techniques import choose_technique, counterparts, drawing_techniques
from volviz.model.store import Store
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.library_words import translated
from volviz_ui.widgets.binding import show_value

SUMMARY = Qt.ItemDataRole.UserRole + 1
Index = QModelIndex | QPersistentModelIndex


class _TwoLines(QStyledItemDelegate):
    """Name in the first line, explanation in the second, wrapped never, shortened when the list is narrow."""

    def sizeHint(self, option: QStyleOptionViewItem, index: Index) -> QSize:
        metrics = QFontMetrics(option.font)
        width = metrics.horizontalAdvance(index.data(SUMMARY) or "") + 24
        return QSize(min(width, 560), 2 * metrics.height() + 10)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        painter.save()
        chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        role = QPalette.ColorRole
        if chosen:
            painter.fillRect(option.rect, option.palette.color(role.Highlight))
        rect = QRect(option.rect.adjusted(10, 4, -10, -4))
        metrics = QFontMetrics(option.font)
        bold = QFont(option.font)
        bold.setWeight(QFont.Weight.DemiBold)
        painter.setFont(bold)
        painter.setPen(option.palette.color(role.HighlightedText if chosen else role.Text))
        painter.drawText(rect, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop, index.data())
        painter.setFont(option.font)
        painter.setPen(option.palette.color(role.HighlightedText if chosen else role.PlaceholderText))
        words = metrics.elidedText(index.data(SUMMARY) or "", Qt.TextElideMode.ElideRight, rect.width())
        painter.drawText(rect, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignBottom, words)
        painter.restore()


class TechniqueBox(NoWheelComboBox):
    """Chooses the technique of a view.

    Parameters
    ----------
    store : Store
        The scene.
    view : int, optional
        Number of the view; the active one when not given.
    """

    def __init__(self, store: Store, parent: QWidget | None = None, *, view: int | None = None) -> None:
        super().__init__(parent)
        self.setItemDelegate(_TwoLines(self))
        self.setMaxVisibleItems(14)
        self.setAccessibleName(self.tr("Technique"))
        for number, info in enumerate([*drawing_techniques(), *counterparts()], start=1):
            key = f"  ({number})" if number <= 9 else ""
            summary = translated(info.summary)
            self.addItem(translated(info.label), info.id)
            self.setItemData(self.count() - 1, summary, SUMMARY)
            self.setItemData(self.count() - 1, f"{summary}{key}", Qt.ItemDataRole.ToolTipRole)
        self.setToolTip(self.tr("How the volume is drawn (keys 1 to 9)"))
        self._store = store
        self._view = view
        show_value(store, lambda scene: scene.view_at(view).technique, self.show_technique)
        self.activated.connect(self._on_activated)

    def showPopup(self) -> None:
        """Open the list wide enough for the explanations."""
        width = max(self.view().sizeHintForColumn(0) + 24, self.width())
        self.view().setMinimumWidth(width)
        super().showPopup()

    def show_technique(self, technique: str) -> None:
        """Show which technique draws."""
        self.setCurrentIndex(self.findData(technique))

    def _on_activated(self, index: int) -> None:
        choose_technique(self._store, self.itemData(index), view=self._view)
