"""What a command is, and what decides whether it can run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from PySide6.QtGui import QKeySequence

from volviz.model.scene import Scene

Key = str | QKeySequence.StandardKey


@dataclass(frozen=True)
class State:
    """What menus, tool bar and palette show commands by.

    Attributes
    ----------
    scene : Scene
        The present scene.
    undo, redo : str or None
        What would be taken back or done again, None when there is nothing.
    has_volume : bool
        Whether a volume is shown.
    triangles : int
        Size of the mesh that the active view shows and that can be exported, 0 without one.
    times : int
        Number of time points, 1 for data that stands still.
    shown : frozenset of str
        What is switched on outside of the scene: annotations, manipulators, "full_screen", "playing",
        "panel.<name>" for each open panel, and "tool.<kind>" for what is being measured.
    """

    scene: Scene
    undo: str | None = None
    redo: str | None = None
    has_volume: bool = False
    triangles: int = 0
    times: int = 1
    shown: frozenset[str] = frozenset()


def _always(_state: State) -> bool:
    return True


@dataclass(frozen=True)
class Command:
    """One thing that the user can have done.

    Attributes
    ----------
    id : str
        ``<menu>.<name>``, unique.
    text : str or callable
        As in the menu, with ``&`` before the letter that chooses it there; or a function of the state.
    tip : str
        What it does, in one clause.
    run : callable
        Does it. Called without arguments; that of a switch (`checked`, without `group`) with whether it is to be on.
    keys : tuple of str or QKeySequence.StandardKey
        Keys that run it; the first one stands in the menu.
    icon : str
        Name of its icon, empty for none.
    enabled : callable
        Whether it can run now.
    checked : callable, optional
        Whether it is switched on now; None for a command that is no switch.
    group : str
        Of the switches of one group exactly one is on.
    only_in_views : bool
        Its keys mean something else outside of the views: the space bar presses a button.
    """

    id: str
    text: str | Callable[[State], str]
    tip: str
    run: Callable[..., object]
    keys: tuple[Key, ...] = ()
    icon: str = ""
    enabled: Callable[[State], bool] = _always
    checked: Callable[[State], bool] | None = None
    group: str = ""
    only_in_views: bool = False

    def words(self, state: State) -> str:
        """The text in that state."""
        return self.text if isinstance(self.text, str) else self.text(state)

    def sequences(self) -> list[QKeySequence]:
        """Its keys on this system, each once."""
        found: list[QKeySequence] = []
        for key in self.keys:
            sequence = QKeySequence(key)
            if not sequence.isEmpty() and sequence not in found:
                found.append(sequence)
        return found

    def execute(self, state: State) -> bool:
        """Run it, if it can run now; gives whether it could."""
        if not self.enabled(state):
            return False
        if self.checked is not None and not self.group:
            self.run(not self.checked(state))
        else:
            self.run()
        return True


@dataclass(frozen=True)
class Menu:
    """A menu: commands, other menus, words that do nothing, and None for a separator.

    Attributes
    ----------
    text : str
        Its title, with ``&``.
    entries : sequence or callable
        What it holds; a callable is asked whenever the menu opens.
    icon : str
        Name of its icon as a submenu, empty for none.
    """

    text: str
    entries: Sequence[Entry] | Callable[[], Sequence[Entry]]
    icon: str = ""

    def now(self) -> Sequence[Entry]:
        """What it holds now."""
        return self.entries() if callable(self.entries) else self.entries

    def walk(self, above: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Command]]:
        """All commands below, each with the titles of the menus that lead to it."""
        path = (*above, plain(self.text))
        for entry in self.now():
            if isinstance(entry, Menu):
                yield from entry.walk(path)
            elif isinstance(entry, Command):
                yield path, entry


Entry = Command | Menu | str | None


def has_volume(state: State) -> bool:
    """Whether a volume is shown: what `enabled` is for commands that need one."""
    return state.has_volume


def plain(text: str) -> str:
    """A text of a menu without the marks of its letters."""
    return text.replace("&&", "\0").replace("&", "").replace("\0", "&")


def keys_in_words(command: Command) -> str:
    """The keys of a command as this system writes them, empty without any."""
    form = QKeySequence.SequenceFormat.NativeText
    return ",  ".join(sequence.toString(form) for sequence in command.sequences())
