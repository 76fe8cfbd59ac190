"""Forms of settings that were made already: a technique chosen again need not wait for its panel."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, QTimer
from shiboken6 import delete

from volviz.custom_gl.registry import techniques
from volviz.custom_gl.technique import TechniqueInfo
from volviz.model.store import Store
from volviz.volume_data.volume import Volume
from volviz_ui.panels.settings_form import SettingsForm

REST_MS = 2500
"""So long nothing must have been asked for before forms are made in advance."""
APART_MS = 40
"""Between two pieces of them."""
PIECE_SECONDS = 0.01
"""So long, and a row more, a piece takes: a whole form would hold up the event loop for 60 ms."""


class FormCache(QObject):
    """Keeps one form for each technique; in quiet times it makes those that nobody has asked for yet.

    Parameters
    ----------
    make : callable
        Makes a form, connected, hidden and still without rows, of a technique for a volume.
    store : Store
        Nothing is made in advance while something is dragged there.
    """

    builds_ahead = True

    def __init__(
        self, make: Callable[[TechniqueInfo, Volume | None], SettingsForm], store: Store, parent: QObject
    ) -> None:
        super().__init__(parent)
        self._make = make
        self._store = store
        self._volume: Volume | None = None
        self._forms: dict[str, SettingsForm] = {}
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.timeout.connect(self._make_next)

    def make_for(self, volume: Volume | None) -> None:
        """Have forms for another volume: those that name its range or unit are made anew."""
        self._volume = volume
        for ident, form in list(self._forms.items()):
            if not form.fits(volume):
                del self._forms[ident]
                form.hide()
                form.deleteLater()

    def keep_only(self, form: SettingsForm | None) -> None:
        """Let all others go, now."""
        for ident, other in list(self._forms.items()):
            if other is not form:
                del self._forms[ident]
                delete(other)

    def form(self, info: TechniqueInfo) -> SettingsForm:
        """The form of a technique, with all its rows, made now as far as it is missing."""
        form = self._begun(info)
        form.grow()
        return form

    def _begun(self, info: TechniqueInfo) -> SettingsForm:
        form = self._forms.get(info.id)
        if form is None or form.info is not info:
            form = self._forms[info.id] = self._make(info, self._volume)
        return form

    def make_more(self) -> None:
        """Somebody looks at the panel and has just got what was wanted: the others may follow."""
        if self.builds_ahead:
            self._timer.start(REST_MS)

    def stop(self) -> None:
        """Nobody looks any more."""
        self._timer.stop()

    def _make_next(self) -> None:
        missing = next((info for info in techniques().values() if not self._is_made(info)), None)
        if missing is not None:
            if not self._store.is_interacting:
                self._begun(missing).grow(PIECE_SECONDS)
            self._timer.start(APART_MS)

    def _is_made(self, info: TechniqueInfo) -> bool:
        form = self._forms.get(info.id)
        return form is not None and form.is_whole
