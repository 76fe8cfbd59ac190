"""Choosing one of the images or arrays that a file holds, from a tree of their names."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QHeaderView,
    QLabel,
    QTreeWidget,
    QTreeWidgetItem,
    QWidget,
)

from volviz.io.entries import Entry, largest_image
from volviz_ui.widgets.dialog_layout import lay_out

ENTRY = Qt.ItemDataRole.UserRole
NAME, SIZE, VALUES, MEMORY = range(4)


class ChooseEntryDialog(QDialog):
    """Shows what a file holds: name, size, type of the values and memory; the largest image is marked at first.

    Parameters
    ----------
    title : str
        Name of the file.
    entries : sequence of Entry
    """

    def __init__(self, title: str, entries: Sequence[Entry], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Choose an image"))
        heading = QLabel(
            self.tr("%1 holds several images. Which one do you want to see?").replace("%1", title), self
        )
        heading.setTextFormat(Qt.TextFormat.PlainText)
        heading.setWordWrap(True)
        self.tree = QTreeWidget(self)
        self.tree.setHeaderLabels([self.tr("Name"), self.tr("Size"), self.tr("Values"), self.tr("Memory")])
        self.tree.setAccessibleName(self.tr("Images of the file"))
        self.tree.setToolTip(self.tr("Size along each axis, as it is stored"))
        self.tree.setAlternatingRowColors(True)
        self.buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Open | QDialogButtonBox.StandardButton.Cancel, self
        )
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        layout = lay_out(self, heading, self.tree, self.buttons)
        layout.setStretchFactor(self.tree, 1)
        self.resize(620, 380)

        self._groups: dict[str, QTreeWidgetItem] = {}
        items = [self._item(entry) for entry in entries]
        self.tree.expandAll()
        header = self.tree.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(NAME, QHeaderView.ResizeMode.Stretch)
        self.tree.itemSelectionChanged.connect(self._show_choice)
        self.tree.itemActivated.connect(self._on_activated)
        self.tree.setCurrentItem(items[largest_image(entries)])
        self.tree.setFocus()

    @property
    def entry(self) -> Entry | None:
        """What is marked; None for a group."""
        item = self.tree.currentItem()
        return None if item is None else item.data(NAME, ENTRY)

    def choose(self, name: str) -> None:
        """Mark the entry of a name."""
        for item in self.tree.findItems("", Qt.MatchFlag.MatchContains | Qt.MatchFlag.MatchRecursive):
            entry = item.data(NAME, ENTRY)
            if entry is not None and entry.name == name:
                self.tree.setCurrentItem(item)

    def _item(self, entry: Entry) -> QTreeWidgetItem:
        group, _, last = entry.name.rpartition("/")
        name = f"{last}: {entry.title}" if entry.title and last.isdecimal() else last
        item = QTreeWidgetItem(
            [name or self.tr("The image itself"), " × ".join(str(n) for n in entry.sizes), entry.dtype, _memory(entry)]
        )  # fmt: skip
        if entry.is_labels:
            item.setText(NAME, self.tr("%1 (labels)").replace("%1", name))
        item.setData(NAME, ENTRY, entry)
        item.setToolTip(NAME, entry.name)
        for column in (SIZE, MEMORY):
            item.setTextAlignment(column, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self._add(item, group)
        return item

    def _add(self, item: QTreeWidgetItem, group: str) -> None:
        """Put an item into the group of a path, which is made when it is needed."""
        if not group:
            self.tree.addTopLevelItem(item)
            return
        if group not in self._groups:
            above, _, last = group.rpartition("/")
            self._groups[group] = QTreeWidgetItem([last])
            self._add(self._groups[group], above)
        self._groups[group].addChild(item)

    def _show_choice(self) -> None:
        self.buttons.button(QDialogButtonBox.StandardButton.Open).setEnabled(self.entry is not None)

    def _on_activated(self, item: QTreeWidgetItem) -> None:
        if item.data(NAME, ENTRY) is not None:
            self.accept()


def _memory(entry: Entry) -> str:
    if not entry.bytes:
        return ""
    return f"{entry.bytes / 2**30:.3g} GB" if entry.bytes >= 2**30 else f"{entry.bytes / 2**20:.3g} MB"
