"""How two views are laid over each other: mode, and what belongs to it."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QCheckBox, QLabel, QWidget

from volviz.model.comparison import LIMITS, PERIODS, Comparison
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz_ui.commands.compare import CompareCommands
from volviz_ui.editors.number import NumberField
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.panels.panel import Section
from volviz_ui.views.sides import LETTERS, SideBox
from volviz_ui.widgets.binding import show_value
from volviz_ui.widgets.small import quiet_label, small_button

FIRST_LIMIT = 16.0


class LookSection(Section):
    """Shows and changes the `Comparison` of the scene."""

    def __init__(self, title: str, store: Store, commands: CompareCommands, parent: QWidget) -> None:
        super().__init__(title, parent=parent)
        self._commands = commands
        self._rows: dict[str, tuple[QLabel, QWidget]] = {}
        self.sides = [SideBox(store, side, self) for side in range(2)]
        self.swap_button = small_button("arrows-down-up", self.tr("Let A and B change places"), self)
        self.swap_button.clicked.connect(commands.swap)
        for side, box in enumerate(self.sides):
            tail = self.swap_button if side else None
            self._rows[LETTERS[side]] = (self.add_row(LETTERS[side], box, tail=tail), box)
        self.seen = quiet_label("", self)
        self.seen.setWordWrap(True)
        self.add_wide(self.seen)
        self.mode = self._choice(
            "mode",
            self.tr("Mode"),
            self.tr(
                "How the views are looked at together (F6 to F9); all but the first mode show A and B only"
            ),
            [
                ("side_by_side", self.tr("Side by side")),
                ("wipe", self.tr("Wipe")),
                ("blink", self.tr("Blink")),
                ("difference", self.tr("Difference")),
            ],
        )
        self.period = NumberField(parent=self)
        self.period.setRange(*PERIODS)
        self.period.setSingleStep(0.1)
        self.period.setSuffix(self.tr(" s"))
        self.period.setToolTip(self.tr("How long one picture stays before it blinks to the other"))
        self.period.setAccessibleName(self.tr("Period"))
        self.period.valueChanged.connect(lambda value: self._commands.change(period=value))
        self._rows["period"] = (self.add_row(self.tr("Period"), self.period), self.period)
        self.map = self._choice(
            "map",
            self.tr("Show"),
            self.tr("What the difference shows: B minus A, its size, or how alike the structure is"),
            [
                ("signed", self.tr("Signed difference")),
                ("absolute", self.tr("Absolute difference")),
                ("ssim", self.tr("Structural similarity")),
            ],
        )
        self.channel = self._choice(
            "channel",
            self.tr("Of"),
            self.tr("Brightness, all three channels, or one of them"),
            [
                ("luminance", self.tr("Luminance")),
                ("rgb", self.tr("Red, green and blue")),
                ("red", self.tr("Red")),
                ("green", self.tr("Green")),
                ("blue", self.tr("Blue")),
            ],
        )
        self.automatic = QCheckBox(self.tr("Scale by the largest"), self)
        self.automatic.setToolTip(
            self.tr("Let the strongest colour stand for the largest difference there is")
        )
        self.automatic.setAccessibleName(self.automatic.text())
        self.automatic.toggled.connect(
            lambda on: self._commands.change(limit=None if on else self.limit.value())
        )
        self.add_wide(self.automatic)
        self.limit = NumberField(parent=self)
        self.limit.setRange(*LIMITS)
        self.limit.setValue(FIRST_LIMIT)
        self.limit.setToolTip(self.tr("Difference in levels of 0 to 255 that gets the strongest colour"))
        self.limit.setAccessibleName(self.tr("Scale"))
        self.limit.valueChanged.connect(self._on_limit_changed)
        self._rows["limit"] = (self.add_row(self.tr("Scale"), self.limit), self.limit)
        show_value(store, lambda scene: scene.comparison, self.show_comparison)
        show_value(store, _seen, self._show_seen)

    def _show_seen(self, seen: tuple[int, int]) -> None:
        count, shown = seen
        for letter in LETTERS:
            self._show(letter, count > 1)
        self.swap_button.setVisible(count > 1)
        self.seen.setVisible(count > shown)
        self.seen.setText(self.tr("Only A and B are seen, two of %1 views.").replace("%1", str(count)))

    def show_comparison(self, comparison: Comparison) -> None:
        """Show how views are compared."""
        for box, value in (
            (self.mode, comparison.mode),
            (self.map, comparison.map),
            (self.channel, comparison.channel),
        ):
            box.setCurrentIndex(box.findData(value))
        widgets = (self.period, self.automatic, self.limit)
        blockers = [QSignalBlocker(widget) for widget in widgets]
        self.period.setValue(comparison.period)
        self.automatic.setChecked(comparison.limit is None)
        if comparison.limit is not None:
            self.limit.setValue(comparison.limit)
        for blocker in blockers:
            blocker.unblock()
        difference = comparison.mode == "difference"
        levels = difference and comparison.map != "ssim"
        self._show("period", comparison.mode == "blink")
        self._show("map", difference)
        self._show("channel", levels)
        self.automatic.setVisible(levels)
        self._show("limit", levels and comparison.limit is not None)

    def _on_limit_changed(self, value: float) -> None:
        self._commands.change(limit=value)

    def _choice(self, name: str, label: str, tooltip: str, entries: list[tuple[str, str]]) -> NoWheelComboBox:
        box = NoWheelComboBox(self)
        box.setToolTip(tooltip)
        box.setAccessibleName(label)
        for value, words in entries:
            box.addItem(words, value)
        if name == "mode":
            box.activated.connect(lambda index: self._commands.set_mode(box.itemData(index)))
        else:
            box.activated.connect(lambda index: self._commands.change(**{name: box.itemData(index)}))
        self._rows[name] = (self.add_row(label, box), box)
        return box

    def _show(self, name: str, shown: bool) -> None:
        for part in self._rows[name]:
            part.setVisible(shown)


def _seen(scene: Scene) -> tuple[int, int]:
    """How many views there are, and how many of them are to be seen."""
    return len(scene.views), len(scene.seen)
