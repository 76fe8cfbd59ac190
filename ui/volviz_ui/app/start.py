"""Starting the desktop program."""

from __future__ import annotations

import sys
from typing import Any

from volviz.environment import prepare


def main(source: str | None = None, **hints: Any) -> int:
    """Open the window and stay until it is closed.

    Parameters
    ----------
    source : str, optional
        File, folder or ``sample:<id>``; without one a bundled sample is shown.
    **hints
        How to read it, time point and channel, as for `volviz.load`.

    Returns
    -------
    int
        Exit status.
    """
    prepare()
    # Everything below needs the environment above. PyVista comes before Qt: PySide looks into
    # the source of every module that is imported after it, which PyVista's thousand feel.
    import pyvista.plotting  # noqa: F401
    from PySide6.QtCore import QTimer

    from volviz_ui.app.application import make_application

    application = make_application()
    from volviz.volume_data.budgets import budgets, set_budgets
    from volviz_ui.app.main_window import MainWindow
    from volviz_ui.commands.session import autosave_folder
    from volviz_ui.session.memory import spare_lasting_objects
    from volviz_ui.session.preferences import Preferences
    from volviz_ui.style.theme import Theme

    preferences = Preferences()
    # what the command line allows goes before
    chosen = budgets()
    set_budgets(
        memory=chosen.memory or preferences.budget("memory"),
        texture=chosen.texture or preferences.budget("texture"),
    )
    folder = autosave_folder()
    window = MainWindow(Theme(application, preferences.theme), preferences, autosave_folder=folder)
    window.show()
    spare_lasting_objects()

    def begin() -> None:
        window.open(source or default_source(), **hints)
        window.session_commands.offer_restore(folder)

    QTimer.singleShot(0, begin)
    status = application.exec()
    window.deleteLater()
    application.processEvents()
    return int(status)


def default_source() -> str:
    """The bundled sample for a start without a file."""
    from volviz.io.samples import default_sample

    return f"sample:{default_sample().id}"


if __name__ == "__main__":
    raise SystemExit(main(*sys.argv[1:2]))
