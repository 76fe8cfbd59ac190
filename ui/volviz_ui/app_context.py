"""What the parts of the program share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from PySide6.QtWidgets import QMainWindow

from volviz.model.store import Store
from volviz_ui.docks import Docks
from volviz_ui.documents import Documents
from volviz_ui.preferences import Preferences
from volviz_ui.surface import Surface
from volviz_ui.theme import Theme
from volviz_ui.views.view_area import ViewArea
from volviz_ui.workers import Workers


class Messages(Protocol):
    """How the user is told something."""

    def show_status(self, words: str, milliseconds: int = 5000) -> None:
        """A sentence in the status line that goes away by itself."""

    def show_error(self, title: str, error: BaseException) -> object:
        """A dialog with one sentence on what went wrong, and details for those who ask."""


@dataclass(frozen=True)
class AppContext:
    """The scene, what belongs to it, and the ways to the user; given to whoever needs several of them.

    Attributes
    ----------
    window : QMainWindow
        Parent of dialogs. Whoever wants something of it asks one of the others.
    store, documents, workers, preferences, theme
        One of each in the program.
    views : ViewArea
        The middle of the window.
    docks : Docks
        The panels around it.
    surface : Surface
        The mesh in the active view.
    messages : Messages
        Status line and dialogs of errors.
    """

    window: QMainWindow
    store: Store
    documents: Documents
    workers: Workers
    preferences: Preferences
    theme: Theme
    views: ViewArea
    docks: Docks
    surface: Surface
    messages: Messages
