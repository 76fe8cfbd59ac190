"""Whether the scene holds something that is in no file."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from volviz.model.comparison import Comparison
from volviz.model.scene import Scene
from volviz.model.store import Store

REMEMBERED = 8
"""Of as many volumes the opened or saved state is known again when undo comes back to them."""


class UnsavedChanges(QObject):
    """Compares the scene with those that were opened and saved; from where one looks is no change.

    Parameters
    ----------
    store : Store
        The scene.
    """

    changed = Signal(bool)
    """Whether there are unsaved changes now."""

    def __init__(self, store: Store, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._store = store
        self._kept: dict[Hashable, tuple[Scene, Path | None]] = {}
        self.there_are = False
        store.changed.connect(self._on_changed)

    def keep(self, path: Path | None = None) -> None:
        """The present scene needs no saving: it was just opened, or saved in a session file."""
        scene = self._store.scene
        volumes = _volumes(scene)
        self._kept.pop(volumes, None)
        self._kept[volumes] = _content(scene), path
        if len(self._kept) > REMEMBERED:
            del self._kept[next(iter(self._kept))]
        self._on_changed(scene, scene)

    @property
    def path(self) -> Path | None:
        """The session file that the present volumes were last opened from or saved in."""
        return self._kept.get(_volumes(self._store.scene), (None, None))[1]

    def close(self) -> None:
        """Stop listening."""
        self._store.changed.disconnect(self._on_changed, missing_ok=True)

    def _on_changed(self, _old: Scene, new: Scene) -> None:
        there_are = bool(new.layers) and _content(new) != self._kept.get(_volumes(new), (None, None))[0]
        if there_are != self.there_are:
            self.there_are = there_are
            self.changed.emit(there_are)


def _content(scene: Scene) -> Scene:
    """What of a scene is worth a question: all but where one looks from, and at which views."""
    views = tuple(replace(view, camera=None) for view in scene.views)
    return replace(scene, views=views, active=0, comparison=Comparison(), cursor=None)


def _volumes(scene: Scene) -> Hashable:
    return tuple(layer.key.ref for layer in scene.layers)
