"""What the parts of the program share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from PySide6.QtWidgets import QMainWindow

from volviz.model.store import Store
from volviz_ui.measuring.tool import MeasureTool
from volviz_ui.session.documents import Documents
from volviz_ui.session.mesh_summary import ShownMesh
from volviz_ui.session.preferences import Preferences
from volviz_ui.session.time_player import TimePlayer
from volviz_ui.session.workers import Workers
from volviz_ui.style.theme import Theme
from volviz_ui.views.view_grid import ViewGrid
from volviz_ui.widgets.docks import Docks


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
    store, documents, workers, player, preferences, theme
        One of each in the program.
    views : ViewGrid
        The middle of the window.
    docks : Docks
        The panels around it.
    surface : ShownMesh
        The mesh in the active view.
    tool : MeasureTool
        What places points in the views.
    messages : Messages
        Status line and dialogs of errors.
    """

    window: QMainWindow
    store: Store
    documents: Documents
    workers: Workers
    player: TimePlayer
    preferences: Preferences
    theme: Theme
    views: ViewGrid
    docks: Docks
    surface: ShownMesh
    tool: MeasureTool
    messages: Messages
