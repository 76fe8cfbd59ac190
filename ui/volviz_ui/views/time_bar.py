"""The bar under the views of data with several time points: which one is seen, and how time runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtGui import QActionGroup
from PySide6.QtWidgets import QHBoxLayout, QLabel, QMenu, QSpinBox, QToolButton, QWidget

from volviz.model.time_range import TimeRange
from volviz_ui.editors.number import NoWheelSlider
from volviz_ui.session.time_player import TimePlayer
from volviz_ui.style.icons import set_icon
from volviz_ui.widgets.small import quiet_label, small_button

SPEEDS = (1.0, 2.0, 5.0, 10.0, 15.0, 24.0, 30.0, 60.0)
#: Shown slower than this part of the speed that is wanted is said.
BEHIND = 0.85


class TimeBar(QWidget):
    """Steps, play, a slider, the number of the time point and its time, and a menu of how time runs.

    The number and the time are those of the picture; the slider stands where the picture is going to be.

    Parameters
    ----------
    player : TimePlayer
        What it shows and moves.

    Attributes
    ----------
    repeat_chosen : signal (str)
        What follows the last time point was chosen.
    """

    repeat_chosen = Signal(str)

    def __init__(self, player: TimePlayer, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._player = player
        tr = self.tr
        self.back = small_button("skip-back", tr("Previous time point (,)"), self)
        self.play = small_button("play", tr("Play (K)"), self)
        self.forward = small_button("skip-forward", tr("Next time point (.)"), self)
        self.slider = NoWheelSlider(self)
        self.number = QSpinBox(self)
        self.number.setKeyboardTracking(False)
        for widget in (self.slider, self.number):
            widget.setAccessibleName(tr("Time point"))
            widget.setToolTip(tr("Which time point is shown, counted from 0"))
        self.seconds: QLabel = quiet_label(parent=self)
        self.seconds.setToolTip(tr("When this time point was measured"))
        self.options = small_button("dots-three-vertical", tr("Repeating, speed, colours"), self)
        self.options.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.menu = QMenu(self)
        self.menu.setToolTipsVisible(True)
        self.menu.aboutToShow.connect(self._fill_menu)
        self.options.setMenu(self.menu)
        self.options.setStyleSheet("QToolButton::menu-indicator { image: none; }")
        row = QHBoxLayout(self)
        row.setContentsMargins(8, 2, 8, 2)
        row.setSpacing(4)
        for widget, stretch in (
            (self.back, 0), (self.play, 0), (self.forward, 0), (self.slider, 1), (self.number, 0),
            (self.seconds, 0), (self.options, 0),
        ):  # fmt: skip
            row.addWidget(widget, stretch)
        self.back.clicked.connect(lambda: player.step(-1))
        self.forward.clicked.connect(lambda: player.step(1))
        self.play.clicked.connect(player.toggle)
        self.slider.sliderPressed.connect(player.begin_drag)
        self.slider.sliderReleased.connect(player.end_drag)
        self.slider.valueChanged.connect(self._on_slider)
        self.number.valueChanged.connect(player.show)
        player.changed.connect(self.show_time)
        self.show_time()

    def show_time(self) -> None:
        """Show where time stands."""
        player = self._player
        self.setVisible(player.count > 1)
        with QSignalBlocker(self.slider), QSignalBlocker(self.number):
            if self.slider.maximum() != player.count - 1:
                self.slider.setRange(0, player.count - 1)
                self.number.setRange(0, player.count - 1)
                self.number.setSuffix(f" / {player.count - 1}")
            self.slider.setValue(player.seen if player.is_playing else player.wanted)
            is_edited = self.number.hasFocus() and not player.is_playing
            self.number.setValue(player.wanted if is_edited else player.seen)
        times = player.times
        words = "" if times is None or player.seen >= len(times) else _seconds(times[player.seen], times)
        self.seconds.setText(words)
        self.seconds.setVisible(bool(words))
        if words:
            # the slider must not move while digits come and go
            widest = max((_seconds(t, times or ()) for t in (times or ())[-1:] + (times or ())[:1]), key=len)
            self.seconds.setMinimumWidth(self.fontMetrics().horizontalAdvance(widest) + 6)
        set_icon(self.play, "pause" if player.is_playing else "play", "quiet")
        name = self.tr("Pause (K)") if player.is_playing else self.tr("Play (K)")
        self.play.setAccessibleName(name)
        self.play.setToolTip(f"{name}\n{self._pace()}" if self._pace() else name)

    def _pace(self) -> str:
        """What is to be said of the speed."""
        player = self._player
        if not player.is_playing or player.rate is None or player.rate >= BEHIND * player.speed:
            return ""
        words = self.tr("%1 of %2 time points a second: reading and drawing take longer")
        return words.replace("%1", f"{player.rate:.1f}").replace("%2", f"{player.speed:.3g}")

    def _on_slider(self, number: int) -> None:
        self._player.show(number)

    def _fill_menu(self) -> None:
        self.menu.clear()
        tr, player = self.tr, self._player
        self._choices(
            tr("After the last time point"),
            [
                ("loop", tr("Begin again")),
                ("ping-pong", tr("Back and forth")),
                ("once", tr("Stop")),
            ],
            player.repeat,
            self.repeat_chosen.emit,
        )
        speeds = sorted({*SPEEDS, player.speed})
        self._choices(
            tr("Time points a second"),
            [(speed, f"{speed:.3g}") for speed in speeds],
            player.speed,
            self._set_speed,
        )
        self._choices(
            tr("Colours"),
            [
                ("fixed", tr("A value has one colour at all times")),
                ("widest", tr("Over the values of all time points seen")),
                ("each", tr("Over the values of each time point")),
            ],
            player.time_range,
            self._set_time_range,
        )
        if self._pace():
            self.menu.addAction(self._pace()).setEnabled(False)

    def _choices(
        self, title: str, choices: Sequence[tuple[Any, str]], chosen: object, choose: Callable[[Any], object]
    ) -> None:
        self.menu.addSection(title)
        group = QActionGroup(self.menu)
        for value, words in choices:
            action = self.menu.addAction(words)
            action.setCheckable(True)
            action.setChecked(value == chosen)
            action.triggered.connect(partial(choose, value))
            group.addAction(action)

    def _set_speed(self, speed: float, *_checked: object) -> None:
        self._player.set_speed(speed)

    def _set_time_range(self, choice: TimeRange, *_checked: object) -> None:
        self._player.set_time_range(choice)


def _seconds(seconds: float, times: Sequence[float]) -> str:
    """A time with as many digits as tell neighbours apart."""
    steps = [b - a for a, b in pairwise(times) if b > a]
    digits = 0 if not steps else max(0, min(6, -_exponent(min(steps)) + 1))
    return f"{seconds:.{digits}f} s"


def _exponent(number: float) -> int:
    return int(f"{number:e}".split("e")[1])
