"""What the program remembers between two starts."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast, get_args

from PySide6.QtCore import QByteArray, QSettings

from volviz.volume_data.references import VolumeKey, VolumeRef
from volviz_ui.session.time_player import Repeat
from volviz_ui.style.theme import Choice

RECENT_LIMIT = 12
USED_LIMIT = 8
CORRECTIONS_LIMIT = 500
QUALITIES = ("balanced", "fast", "full")


class Preferences:
    """Typed access to Qt's settings.

    Parameters
    ----------
    settings : QSettings, optional
        Where they lie; the user's own by default.
    """

    def __init__(self, settings: QSettings | None = None) -> None:
        self._settings = settings if settings is not None else QSettings("VolViz", "VolViz")

    @property
    def theme(self) -> Choice:
        """The system's theme, or one of ours."""
        value = str(self._settings.value("theme", "system"))
        return cast("Choice", value if value in ("system", "light", "dark") else "system")

    @theme.setter
    def theme(self, value: Choice) -> None:
        self._settings.setValue("theme", value)

    @property
    def quality(self) -> str:
        """How much is given up while something moves."""
        value = str(self._settings.value("quality", QUALITIES[0]))
        return value if value in QUALITIES else QUALITIES[0]

    @quality.setter
    def quality(self, value: str) -> None:
        self._settings.setValue("quality", value)

    def budget(self, what: str) -> int | None:
        """Bytes of "memory" or "texture" that a volume may take; None leaves it to the program."""
        try:
            count = int(str(self._settings.value(f"budgets/{what}", 0)))
        except ValueError:
            return None
        return count if count > 0 else None

    def set_budget(self, what: str, count: int | None) -> None:
        """Remember it."""
        self._settings.setValue(f"budgets/{what}", count or 0)

    @property
    def repeat(self) -> Repeat:
        """What follows the last time point."""
        value = str(self._settings.value("repeat", "loop"))
        return cast("Repeat", value if value in get_args(Repeat) else "loop")

    @repeat.setter
    def repeat(self, value: Repeat) -> None:
        self._settings.setValue("repeat", value)

    @property
    def window(self) -> tuple[QByteArray, QByteArray] | None:
        """Geometry of the window and state of its docks."""
        geometry, state = self._settings.value("geometry"), self._settings.value("state")
        if isinstance(geometry, QByteArray) and isinstance(state, QByteArray):
            return geometry, state
        return None

    @window.setter
    def window(self, value: tuple[QByteArray, QByteArray]) -> None:
        self._settings.setValue("geometry", value[0])
        self._settings.setValue("state", value[1])

    @property
    def folder(self) -> str:
        """Where the last file was opened."""
        return str(self._settings.value("folder", ""))

    @folder.setter
    def folder(self, value: str) -> None:
        self._settings.setValue("folder", value)

    def folder_of(self, what: str) -> str:
        """Where files of a kind were last: "picture", "mesh", "volume", "session", "movie"; at first that of data."""
        return str(self._settings.value(f"folders/{what}", self.folder))

    def set_folder_of(self, what: str, path: str) -> None:
        """Remember the folder of a file."""
        self._settings.setValue(f"folders/{what}", str(Path(path).parent))

    @property
    def asks_about_changes(self) -> bool:
        """Whether unsaved changes are asked about before they go."""
        return str(self._settings.value("asks_about_changes", True)).lower() == "true"

    @asks_about_changes.setter
    def asks_about_changes(self, value: bool) -> None:
        self._settings.setValue("asks_about_changes", value)

    def shows(self, name: str, default: bool) -> bool:
        """Whether something optional is shown in the viewport."""
        return str(self._settings.value(f"shows/{name}", default)).lower() == "true"

    def set_shows(self, name: str, shown: bool) -> None:
        """Remember whether it is shown."""
        self._settings.setValue(f"shows/{name}", shown)

    @property
    def recent(self) -> list[VolumeKey]:
        """What was opened last, the newest first."""
        try:
            rows: list[dict[str, Any]] = json.loads(str(self._settings.value("recent", "[]")))
            return [_key(row) for row in rows]
        except (ValueError, TypeError, KeyError, AttributeError):
            return []

    def add_recent(self, key: VolumeKey) -> None:
        """Remember what was opened of which file."""
        keys = [key, *(known for known in self.recent if known.ref.source != key.ref.source)]
        rows = [
            {"source": k.ref.source, "hints": dict(k.ref.hints), "channel": k.channel, "time": k.time}
            for k in keys[:RECENT_LIMIT]
        ]
        self._settings.setValue("recent", json.dumps(rows))

    def forget_recent(self) -> None:
        """Empty the list of files opened last."""
        self._settings.remove("recent")

    def correction(self, ref: VolumeRef) -> dict[str, Any]:
        """What was corrected about a file, as hints of `volviz.open`; nothing where it has changed since then."""
        found = self._corrections.get(ref.source)
        if not isinstance(found, dict) or found.get("content") != ref.content_id:
            return {}
        hints = found.get("hints")
        return {name: _untied(value) for name, value in hints.items()} if isinstance(hints, dict) else {}

    def set_correction(self, ref: VolumeRef, hints: Mapping[str, Any]) -> None:
        """Remember it for this file as it is now; without hints, forget it."""
        others = {source: kept for source, kept in self._corrections.items() if source != ref.source}
        if hints:
            others[ref.source] = {"content": ref.content_id, "hints": dict(hints)}
        kept = dict(list(others.items())[-CORRECTIONS_LIMIT:])
        self._settings.setValue("corrections", json.dumps(kept))

    @property
    def _corrections(self) -> dict[str, Any]:
        try:
            found = json.loads(str(self._settings.value("corrections", "{}")))
        except ValueError:
            return {}
        return found if isinstance(found, dict) else {}

    @property
    def used_commands(self) -> list[str]:
        """Ids of the commands used last in the palette, the newest first."""
        try:
            return [str(ident) for ident in json.loads(str(self._settings.value("used_commands", "[]")))]
        except (ValueError, TypeError):
            return []

    def add_used_command(self, ident: str) -> None:
        """Remember a command that was used."""
        others = [other for other in self.used_commands if other != ident]
        self._settings.setValue("used_commands", json.dumps([ident, *others][:USED_LIMIT]))


def _key(row: dict[str, Any]) -> VolumeKey:
    hints = {name: _untied(value) for name, value in row.get("hints", {}).items()}
    # older programs kept channel and time among the hints
    channel, time = hints.pop("channel", None), hints.pop("time", 0)
    ref = VolumeRef(str(row["source"]), tuple(hints.items()))
    return VolumeKey(ref, row.get("channel", channel), row.get("time", time))


def _untied(value: Any) -> Any:
    """JSON knows no tuples."""
    return tuple(value) if isinstance(value, list) else value
