"""Starting the desktop program."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from volviz.environment import prepare

USAGE = """usage: volviz [FILE]

Opens the desktop program with a volume: a file, a DICOM folder, or sample:NAME. Without FILE a bundled
sample is shown."""


def main(argv: Sequence[str] | None = None) -> int:
    """Open the window and stay until it is closed.

    Parameters
    ----------
    argv : sequence of str, optional
        What follows the name of the program: at most one file, folder or ``sample:<id>``.

    Returns
    -------
    int
        Exit status: 0, or 2 for arguments that make no sense.
    """
    arguments = list(sys.argv[1:] if argv is None else argv)
    if any(argument in ("-h", "--help") for argument in arguments):
        print(USAGE)
        return 0
    if len(arguments) > 1:
        print("volviz: one file at a time; see volviz --help", file=sys.stderr)
        return 2
    prepare()
    # everything below needs the environment above
    from PySide6.QtCore import QTimer

    from volviz_ui.app.application import make_application

    application = make_application()
    from volviz_ui.app.main_window import MainWindow
    from volviz_ui.commands.session import autosave_folder
    from volviz_ui.session.memory import spare_lasting_objects
    from volviz_ui.session.preferences import Preferences
    from volviz_ui.style.theme import Theme

    preferences = Preferences()
    folder = autosave_folder()
    window = MainWindow(Theme(application, preferences.theme), preferences, autosave_folder=folder)
    window.show()
    spare_lasting_objects()
    source = arguments[0] if arguments else default_source()

    def begin() -> None:
        window.open(source)
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
    raise SystemExit(main())
