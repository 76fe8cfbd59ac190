"""Forms of settings that were made already: a technique chosen again need not wait for its panel."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Qt, QTimer
from PySide6.QtWidgets import QApplication
from shiboken6 import delete

from volviz.custom_gl.registry import techniques
from volviz.custom_gl.technique import TechniqueInfo
from volviz.model.volume import Volume
from volviz_ui.panels.settings_form import SettingsForm

REST_MS = 2500
"""So long nothing must have been asked for before forms are made in advance."""
APART_MS = 120
"""Between two of them: each takes some 20 ms of the event loop."""


class FormShelf(QObject):
    """Keeps one form for each technique; in quiet times it makes those that nobody has asked for yet.

    Parameters
    ----------
    make : callable
        Makes a form, connected and hidden, of a technique for a volume.
    """

    builds_ahead = True

    def __init__(self, make: Callable[[TechniqueInfo, Volume | None], SettingsForm], parent: QObject) -> None:
        super().__init__(parent)
        self._make = make
        self._volume: Volume | None = None
        self._forms: dict[str, SettingsForm] = {}
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.timeout.connect(self._make_next)

    def set_volume(self, volume: Volume | None) -> None:
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
        """The form of a technique, made now if there is none."""
        if info.id not in self._forms or self._forms[info.id].info is not info:
            self._forms[info.id] = self._make(info, self._volume)
        return self._forms[info.id]

    def rest(self) -> None:
        """Somebody looks at the panel and has just got what was wanted: the others may follow."""
        if self.builds_ahead:
            self._timer.start(REST_MS)

    def stop(self) -> None:
        """Nobody looks any more."""
        self._timer.stop()

    def _make_next(self) -> None:
        missing = next((info for ident, info in techniques().items() if ident not in self._forms), None)
        if missing is not None:
            if QApplication.mouseButtons() == Qt.MouseButton.NoButton:
                self.form(missing)
            self._timer.start(APART_MS)
