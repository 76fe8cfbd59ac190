"""Nothing made is lost in a crash: the scene is written now and then, and offered at the next start."""

from __future__ import annotations

import json
import os
import time
from collections import deque
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from PySide6.QtCore import QObject, QTimer

from volviz.errors import VolvizError
from volviz.model.scene import Scene
from volviz.model.session import SUFFIX, save_session
from volviz.model.store import Store
from volviz.volume_data.references import SAMPLE_PREFIX

DELAY_MS = 5000
"""Changes within this time are written together."""

PREFIX = "autosave-"
GENERATIONS = 3
GENERATION_SECONDS = 600.0
"""So long a file is written anew; then it stays as it is and another one is begun."""


class Autosave(QObject):
    """Writes the scene a little after each change; nothing runs while nothing changes.

    The last few generations stay, in files that are named by the process and by the time in milliseconds when
    they were begun.

    Parameters
    ----------
    store : Store
        Whose scene it is.
    folder : Path
        Where to write; each running program has files of its own.
    """

    def __init__(self, store: Store, folder: Path, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._store = store
        self._folder = folder
        self._begun = 0.0
        self.paths: deque[Path] = deque()
        """What was written, the oldest first."""
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(DELAY_MS)
        self._timer.timeout.connect(self.write)
        store.changed.connect(self._on_changed)

    def write(self) -> None:
        """Write now; what cannot be written is no reason to disturb anybody."""
        layer = self._store.scene.layer
        if layer is None or (self._store.undo_label is None and _is_sample(layer.key.ref.source)):
            return  # nothing that anybody made
        with suppress(VolvizError, OSError):
            self._folder.mkdir(parents=True, exist_ok=True)
            now = time.time()
            if not self.paths or now - self._begun >= GENERATION_SECONDS:
                self._begun = now
                self.paths.append(self._folder / f"{PREFIX}{os.getpid()}-{round(1000 * now)}{SUFFIX}")
            save_session(self._store.scene, self.paths[-1])
            while len(self.paths) > GENERATIONS:
                self.paths.popleft().unlink(missing_ok=True)

    def close(self) -> None:
        """The program ends as it should: nothing has to be restored."""
        self._timer.stop()
        self._store.changed.disconnect(self._on_changed, missing_ok=True)
        for path in self.paths:
            path.unlink(missing_ok=True)
        self.paths.clear()

    def _on_changed(self, _old: Scene, _new: Scene) -> None:
        if not self._timer.isActive():
            self._timer.start()


def _is_sample(source: str) -> bool:
    return source.startswith(SAMPLE_PREFIX)


@dataclass(frozen=True)
class Left:
    """What a program that ended without closing has left behind.

    Attributes
    ----------
    path : Path
        The file.
    name : str
        The volume that was shown, empty where the file does not say it.
    when : datetime
        When it was written, local time.
    """

    path: Path
    name: str
    when: datetime


def left_behind(folder: Path) -> list[Left]:
    """Scenes of programs that no longer run, the newest first."""
    found = []
    for path in folder.glob(f"{PREFIX}*{SUFFIX}"):
        number = path.name.removeprefix(PREFIX).removesuffix(SUFFIX).partition("-")[0]
        if number.isdigit() and int(number) != os.getpid() and not _runs(int(number)):
            with suppress(OSError):
                when = datetime.fromtimestamp(path.stat().st_mtime)
                found.append(Left(path, _volume_name(path), when))
    return sorted(found, key=lambda left: left.when, reverse=True)


def _volume_name(path: Path) -> str:
    """Name of the volume in a session file; its file's name where it has none, empty for a damaged file."""
    try:
        layer = json.loads(path.read_text(encoding="utf-8"))["layers"][0]
        return str(layer.get("name") or Path(layer["volume"]["source"]).name)
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return ""


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
