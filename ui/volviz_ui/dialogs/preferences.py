"""Preferences: theme, quality while moving, memory, questions; every choice acts at once."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QCheckBox, QDialog, QDialogButtonBox, QFormLayout, QLabel, QWidget

from volviz.volume_data.budgets import bytes_in_words
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.widgets.dialog_layout import lay_out
from volviz_ui.widgets.small import quiet_label

#: What is allowed for: main memory, and memory of textures.
BUDGETS = ("memory", "texture")
_MIB = 1 << 20
_AMOUNTS = (256, 512, 1024, 2048, 4096, 8192, 16384, 32768, 65536)


class PreferencesDialog(QDialog):
    """Lists and a check box; nothing has to be confirmed."""

    theme_chosen = Signal(str)
    quality_chosen = Signal(str)
    asking_chosen = Signal(bool)
    budget_chosen = Signal(str, object)
    """"memory" or "texture", and bytes or None."""

    def __init__(
        self,
        theme: str,
        quality: str,
        *,
        asks: bool,
        budgets: Mapping[str, int | None],
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Preferences"))
        self.theme = self._list(
            (("system", self.tr("As the system")), ("light", self.tr("Light")), ("dark", self.tr("Dark"))),
            theme,
        )
        self.theme.setToolTip(self.tr("Colours of the window"))
        self.theme.setAccessibleName(self.tr("Theme"))
        self.quality = self._list(quality_choices(self), quality)
        self.quality.setToolTip(self.tr("How much is given up while something moves"))
        self.quality.setAccessibleName(self.tr("Quality while moving"))
        self.theme.currentIndexChanged.connect(lambda: self.theme_chosen.emit(self.theme.currentData()))
        self.quality.currentIndexChanged.connect(lambda: self.quality_chosen.emit(self.quality.currentData()))
        form = QFormLayout()
        form.setHorizontalSpacing(16)
        form.setVerticalSpacing(8)
        form.addRow(self.tr("Theme"), self.theme)
        form.addRow(self.tr("Quality while moving"), self.quality)
        self.budgets: dict[str, NoWheelComboBox] = {}
        for what, words, tip in (
            ("memory", self.tr("Memory for a volume"), self.tr("Larger volumes are read at a lower resolution")),
            ("texture", self.tr("Memory for textures"), self.tr("On the graphics card; larger ones become coarser")),
        ):  # fmt: skip
            box = self.budgets[what] = self._list(_amounts(self, budgets[what]), budgets[what])
            box.setToolTip(tip)
            box.setAccessibleName(words)
            box.currentIndexChanged.connect(partial(self._on_budget, what))
            form.addRow(words, box)
        self.asks = QCheckBox(self.tr("Ask before unsaved changes are lost"), self)
        self.asks.setToolTip(self.tr("When the program is closed or another volume is opened"))
        self.asks.setChecked(asks)
        self.asks.toggled.connect(self.asking_chosen)
        form.addRow("", self.asks)
        hint: QLabel = quiet_label(
            self.tr(
                "At rest the picture is always complete; exported pictures are too. Limits of memory act on what is "
                "opened from now on."
            )
        )
        hint.setWordWrap(True)
        form.addRow(hint)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close, self)
        buttons.rejected.connect(self.reject)
        layout = lay_out(self, form, buttons, spacing=16)
        layout.insertStretch(1, 1)
        self.setMinimumWidth(400)

    def _on_budget(self, what: str, _index: int) -> None:
        self.budget_chosen.emit(what, self.budgets[what].currentData())

    def _list(self, choices: tuple[tuple[Any, str], ...], chosen: Any) -> NoWheelComboBox:
        box = NoWheelComboBox(self)
        box.setMinimumContentsLength(16)
        for value, label in choices:
            box.addItem(label, value)
        box.setCurrentIndex(max(box.findData(chosen), 0))
        return box


def _amounts(widget: QWidget, chosen: int | None) -> tuple[tuple[int | None, str], ...]:
    """Amounts of memory to choose from, and the one that is chosen."""
    counts = sorted({*(n * _MIB for n in _AMOUNTS), *([chosen] if chosen else [])})
    return ((None, widget.tr("Automatic")), *((n, bytes_in_words(n)) for n in counts))


def quality_choices(widget: QWidget) -> tuple[tuple[str, str], ...]:
    """Value and label of each quality, in the language of the window."""
    return (
        ("balanced", widget.tr("Balanced")),
        ("fast", widget.tr("Fast")),
        ("full", widget.tr("Full quality")),
    )
