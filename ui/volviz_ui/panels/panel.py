"""What all panels are made of: a body that scrolls, sections that fold, rows of label and editor."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import (
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QScrollArea,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from volviz_ui.style.icons import set_icon


class Panel(QScrollArea):
    """A column of widgets that scrolls rather than squeezes."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("panel_scroll")
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.body = QWidget()
        self.body.setObjectName("panel_body")
        self.column = QVBoxLayout(self.body)
        self.column.setContentsMargins(12, 8, 12, 12)
        self.column.setSpacing(4)
        self.column.addStretch(1)
        self.setWidget(self.body)

    def add(self, widget: QWidget) -> None:
        """Append a widget above the stretch at the end."""
        if self.column.count() == 1 and isinstance(widget, Section):
            widget.line.hide()  # the title of the dock is line enough
        self.column.insertWidget(self.column.count() - 1, widget)

    def sizeHint(self) -> QSize:
        """As narrow as the contents allow."""
        return QSize(max(self.minimumSizeHint().width(), 264), 400)

    def minimumSizeHint(self) -> QSize:
        """The width of the contents and of a scroll bar beside them: nothing is cut off."""
        bar = self.verticalScrollBar().sizeHint().width()
        return QSize(self.body.minimumSizeHint().width() + bar, 120)


class Section(QWidget):
    """A group with a heading that folds it."""

    folded = Signal(str, bool)

    def __init__(self, title: str, *, open_: bool = True, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.title = title
        self.header = QToolButton(self)
        self.header.setObjectName("section_header")
        self.header.setText(title)
        self.header.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.header.setIconSize(QSize(12, 12))
        self.header.setCheckable(True)
        self.header.setChecked(open_)
        self.header.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.header.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.header.setMinimumHeight(self.header.sizeHint().height())
        self.header.setToolTip(self.tr("Fold or unfold this group"))
        self.line = line = QFrame(self)
        line.setObjectName("section_line")
        line.setFixedHeight(1)
        self.content = QWidget(self)
        self.rows = QGridLayout(self.content)
        self.rows.setContentsMargins(2, 2, 0, 8)
        self.rows.setHorizontalSpacing(8)
        self.rows.setVerticalSpacing(6)
        self.rows.setColumnStretch(1, 1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 2, 0, 0)
        layout.setSpacing(2)
        layout.addWidget(line)
        layout.addWidget(self.header)
        layout.addWidget(self.content)
        self.header.toggled.connect(self._on_toggled)
        self._on_toggled(open_)

    def set_open(self, open_: bool) -> None:
        """Fold or unfold."""
        self.header.setChecked(open_)

    def _on_toggled(self, open_: bool) -> None:
        self.content.setVisible(open_)
        set_icon(self.header, "caret-down" if open_ else "caret-right", "quiet")
        self.folded.emit(self.title, open_)

    def add_row(
        self,
        label: str,
        widget: QWidget,
        *,
        tail: QWidget | None = None,
        wide: bool = False,
        tooltip: str = "",
    ) -> QLabel:
        """One line: label, widget, small button at the end. A wide widget takes a line of its own below."""
        words = QLabel(label, self.content)
        words.setBuddy(widget)
        words.setToolTip(tooltip or widget.toolTip())
        row = self.rows.rowCount()
        alignment = Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft
        if wide:
            head = QHBoxLayout()
            head.setContentsMargins(0, 0, 0, 0)
            head.addWidget(words, 1)
            if tail is not None:
                head.addWidget(tail)
            self.rows.addLayout(head, row, 0, 1, 3)
            self.rows.addWidget(widget, row + 1, 0, 1, 3)
        else:
            self.rows.addWidget(words, row, 0, alignment)
            self.rows.addWidget(widget, row, 1)
            if tail is not None:
                self.rows.addWidget(tail, row, 2)
        return words

    def add_wide(self, widget: QWidget) -> None:
        """A widget over the whole width."""
        self.rows.addWidget(widget, self.rows.rowCount(), 0, 1, 3)
