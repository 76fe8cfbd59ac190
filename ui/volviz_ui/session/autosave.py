"""Nothing made is lost in a crash: the scene is written now and then, and offered at the next start."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from PySide6.QtCore import QObject, QTimer

from volviz.errors import VolvizError
from volviz.model.scene import Scene
from volviz.model.session import save_session
from volviz.model.store import Store

DELAY_MS = 5000
"""Changes within this time are written together."""

PREFIX, SUFFIX = "autosave-", ".volviz.json"


class Autosave(QObject):
    """Writes the scene a little after each change; nothing runs while nothing changes.

    Parameters
    ----------
    store : Store
        Whose scene it is.
    folder : Path
        Where to write; each running program has a file of its own.
    """

    def __init__(self, store: Store, folder: Path, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._store = store
        self.path = folder / f"{PREFIX}{os.getpid()}{SUFFIX}"
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(DELAY_MS)
        self._timer.timeout.connect(self.write)
        store.changed.connect(self._on_changed)

    def write(self) -> None:
        """Write now; what cannot be written is no reason to disturb anybody."""
        layer = self._store.scene.layer
        if layer is None or (self._store.undo_label is None and layer.volume.source.startswith("sample:")):
            return  # nothing that anybody made
        with suppress(VolvizError, OSError):
            self.path.parent.mkdir(parents=True, exist_ok=True)
            save_session(self._store.scene, self.path)

    def close(self) -> None:
        """The program ends as it should: nothing has to be restored."""
        self._timer.stop()
        self._store.changed.disconnect(self._on_changed, missing_ok=True)
        self.path.unlink(missing_ok=True)

    def _on_changed(self, _old: Scene, _new: Scene) -> None:
        if not self._timer.isActive():
            self._timer.start()


def left_behind(folder: Path) -> Path | None:
    """The newest scene of a program that no longer runs, None when there is none."""
    found = []
    for path in folder.glob(f"{PREFIX}*{SUFFIX}"):
        number = path.name.removeprefix(PREFIX).removesuffix(SUFFIX)
        if number.isdigit() and int(number) != os.getpid() and not _runs(int(number)):
            found.append(path)
    return max(found, key=lambda path: path.stat().st_mtime, default=None)


def _runs(process: int) -> bool:
    """Whether a process of that number runs; in doubt it does, and its file is left alone."""
    if os.name == "nt":
        import ctypes

        handle = ctypes.windll.kernel32.OpenProcess(0x1000, False, process)  # type: ignore[attr-defined]
        if handle:
            ctypes.windll.kernel32.CloseHandle(handle)  # type: ignore[attr-defined]
        return bool(handle)
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
