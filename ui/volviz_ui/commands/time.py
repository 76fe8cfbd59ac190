"""The commands of data with several time points."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QObject

from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Command, Menu, State


class TimeCommands(QObject):
    """Steps through time points, and lets time run."""

    def __init__(self, context: AppContext) -> None:
        super().__init__(context.window)
        self._player = context.player

    def menu(self) -> Menu:
        """The table of its commands."""
        tr, player = self.tr, self._player
        return Menu(
            tr("&Time"),
            [
                Command(
                    "time.play", tr("&Play"), tr("Let time run, or let it stand still"), self.set_playing,
                    keys=("K",), icon="play", enabled=has_times, checked=lambda state: "playing" in state.shown,
                ),
                Command(
                    "time.back", tr("Pre&vious time point"), tr("One time point back"), partial(player.step, -1),
                    keys=(",",), icon="skip-back", enabled=has_times,
                ),
                Command(
                    "time.forward", tr("&Next time point"), tr("One time point on"), partial(player.step, 1),
                    keys=(".",), icon="skip-forward", enabled=has_times,
                ),
                Command(
                    "time.first", tr("&First time point"), tr("Back to the beginning"), partial(player.show, 0),
                    enabled=has_times,
                ),
            ],
        )  # fmt: skip

    def set_playing(self, on: bool) -> None:
        """Play or pause."""
        if on:
            self._player.play()
        else:
            self._player.pause()


def has_times(state: State) -> bool:
    """Whether there are several time points."""
    return state.times > 1
