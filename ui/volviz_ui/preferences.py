"""What the program remembers between two starts."""

from __future__ import annotations

import json
from typing import Any, cast

from PySide6.QtCore import QByteArray, QSettings

from volviz.volume_data.references import VolumeRef
from volviz_ui.theme import Choice

RECENT_LIMIT = 12
USED_LIMIT = 8
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

    def shows(self, name: str, default: bool) -> bool:
        """Whether something optional is shown in the viewport."""
        return str(self._settings.value(f"shows/{name}", default)).lower() == "true"

    def set_shows(self, name: str, shown: bool) -> None:
        """Remember whether it is shown."""
        self._settings.setValue(f"shows/{name}", shown)

    @property
    def recent(self) -> list[VolumeRef]:
        """Files opened last, the newest first."""
        try:
            rows: list[dict[str, Any]] = json.loads(str(self._settings.value("recent", "[]")))
            return [VolumeRef(str(row["source"]), _hints(row.get("hints", {}))) for row in rows]
        except (ValueError, TypeError, KeyError, AttributeError):
            return []

    def add_recent(self, ref: VolumeRef) -> None:
        """Remember a file that was opened."""
        known = [r for r in self.recent if r.source != ref.source]
        rows = [{"source": r.source, "hints": dict(r.hints)} for r in [ref, *known][:RECENT_LIMIT]]
        self._settings.setValue("recent", json.dumps(rows))

    def forget_recent(self) -> None:
        """Empty the list of files opened last."""
        self._settings.remove("recent")

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


def _hints(values: dict[str, Any]) -> tuple[tuple[str, Any], ...]:
    return tuple((key, tuple(v) if isinstance(v, list) else v) for key, v in values.items())
