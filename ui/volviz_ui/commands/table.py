"""All commands of the window as actions of Qt, each made once and kept true."""

from __future__ import annotations

from collections.abc import Iterator

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QAction, QActionGroup
from PySide6.QtWidgets import QMainWindow

from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Command, Menu, State, keys_in_words, plain
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.style.icons import set_icon


class CommandTable(QObject):
    """The menus, and one action for each command in them.

    Parameters
    ----------
    context : AppContext
        What the state of the commands is read from.
    """

    refreshed = Signal()

    def __init__(self, context: AppContext) -> None:
        super().__init__(context.window)
        self._context = context
        self.menus: list[Menu] = []
        self._commands: dict[str, Command] = {}
        self._times = (1, False)
        self._actions: dict[str, QAction] = {}
        self._groups: dict[str, QActionGroup] = {}
        context.store.history_changed.connect(self.refresh)
        context.surface.summary_changed.connect(self.refresh)
        context.documents.changed.connect(self._on_shown_changed)
        for dock in context.docks.all:
            dock.toggleViewAction().toggled.connect(self.refresh)
        context.store.changed.connect(self.refresh)
        context.player.changed.connect(self._on_time_changed)
        context.tool.changed.connect(self.refresh)

    def add(self, menu: Menu) -> Menu:
        """Make the commands of a menu."""
        self.menus.append(menu)
        self._make_all(menu, self._context.window)
        self.refresh()
        return menu

    def __getitem__(self, ident: str) -> QAction:
        return self._actions[ident]

    @property
    def state(self) -> State:
        """The present state."""
        context = self._context
        summary = context.surface.summary
        shown = set(context.views.shown_names)
        shown |= {f"panel.{name}" for name in context.docks.names if context.docks[name].is_open}
        if context.window.isFullScreen():
            shown.add("full_screen")
        if context.views.is_presented:
            shown.add("presentation")
        if context.player.is_playing:
            shown.add("playing")
        if context.tool.kind is not None:
            shown.add(f"tool.{context.tool.kind}")
        return State(
            context.store.scene,
            context.store.undo_label,
            context.store.redo_label,
            context.documents.volume is not None,
            0 if summary is None else summary.metrics.faces,
            context.player.count,
            frozenset(shown),
        )

    def walk(self) -> Iterator[tuple[tuple[str, ...], Command]]:
        """All commands, each once, with the titles of the menus that lead to it."""
        seen: set[str] = set()
        for menu in self.menus:
            for path, command in menu.walk():
                if command.id not in seen:
                    seen.add(command.id)
                    yield path, command

    def run(self, command: Command) -> bool:
        """Run a command, if it can run now; gives whether it could."""
        ran = command.execute(self.state)
        self.refresh()
        return ran

    def action(self, command: Command, owner: QObject) -> QAction:
        """The action of a command; one that is not in the table, as of a menu that changes, belongs to `owner`."""
        known = self._actions.get(command.id)
        if known is not None:
            return known
        action = QAction(command.words(self.state), owner)
        action.setToolTip(command.tip)
        action.setEnabled(command.enabled(self.state))
        action.triggered.connect(lambda _on: self.run(command))
        return action

    # ------------------------------------------------------------------ keeping them true

    def refresh(self, *_what: object) -> None:
        """Show what can be run and what is switched on."""
        state = self.state
        for ident, command in self._commands.items():
            action = self._actions[ident]
            action.setEnabled(command.enabled(state))
            if command.checked is not None:
                action.setChecked(command.checked(state))
            if callable(command.text):
                self._show_text(action, command, state)
        self.refreshed.emit()

    def _show_text(self, action: QAction, command: Command, state: State) -> None:
        words = command.words(state)
        action.setText(words)
        tip = command.tip if isinstance(command.text, str) else plain(words)
        keys = keys_in_words(command).split(",  ")[0]
        action.setToolTip(f"{tip} ({keys})" if keys else tip)

    def _on_shown_changed(self, old: LoadedScene, new: LoadedScene) -> None:
        if old.volume is not new.volume:
            self.refresh()

    def _on_time_changed(self) -> None:
        times = self._context.player.count, self._context.player.is_playing
        if times != self._times:
            self._times = times
            self.refresh()

    # ------------------------------------------------------------------ making them

    def _make_all(self, menu: Menu, window: QMainWindow) -> None:
        if callable(menu.entries):
            return
        for entry in menu.entries:
            if isinstance(entry, Menu):
                self._make_all(entry, window)
            elif isinstance(entry, Command) and entry.id not in self._commands:
                self._commands[entry.id] = entry
                self._actions[entry.id] = self._made(entry, window)

    def _made(self, command: Command, window: QMainWindow) -> QAction:
        action = QAction(window)
        action.setObjectName(command.id)
        action.setShortcuts(command.sequences())
        action.setStatusTip("")
        self._show_text(action, command, self.state)
        if command.icon:
            set_icon(action, command.icon)
        if command.checked is not None:
            action.setCheckable(True)
            # with an icon the menu would not show whether it is switched on
            action.setIconVisibleInMenu(False)
        if command.group:
            group = self._groups.setdefault(command.group, QActionGroup(self))
            group.addAction(action)
        action.triggered.connect(lambda on: self._on_triggered(command, on))
        # the window must know the action even when no menu shows it: its keys act everywhere
        place = self._context.views if command.only_in_views else window
        place.addAction(action)
        if command.only_in_views:
            action.setShortcutContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        return action

    def _on_triggered(self, command: Command, on: bool) -> None:
        if command.checked is not None and not command.group:
            command.run(on)
        else:
            command.run()
        self.refresh()
