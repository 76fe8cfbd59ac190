"""The QApplication as this program needs it."""

from __future__ import annotations

import signal
import sys

from PySide6.QtCore import QCoreApplication, QMessageLogContext, Qt, QtMsgType, qInstallMessageHandler
from PySide6.QtGui import QSurfaceFormat
from PySide6.QtWidgets import QApplication

from volviz_ui.style.app_icon import app_icon

SWITCH_SECONDS = 0.0005
"""Time after which a worker hands over the interpreter's lock to the window."""


def prepare_opengl() -> None:
    """Say which OpenGL all windows use; before the application object exists.

    Contexts share, or a floating dock would lose its image. The format is the one that pyvistaqt sets later
    by itself: set now, the shared context has it too.
    """
    QCoreApplication.setAttribute(Qt.ApplicationAttribute.AA_ShareOpenGLContexts)
    wanted = QSurfaceFormat()
    wanted.setRenderableType(QSurfaceFormat.RenderableType.OpenGL)
    wanted.setProfile(QSurfaceFormat.OpenGLContextProfile.CoreProfile)
    wanted.setVersion(3, 2)
    wanted.setSwapBehavior(QSurfaceFormat.SwapBehavior.DoubleBuffer)
    wanted.setAlphaBufferSize(8)
    wanted.setDepthBufferSize(8)
    wanted.setStencilBufferSize(0)
    # several samples for each pixel make volume rendering on a processor 1.6 times slower
    wanted.setSamples(0)
    QSurfaceFormat.setDefaultFormat(wanted)


def show_message(_kind: QtMsgType, _context: QMessageLogContext, text: str) -> None:
    """Pass Qt's messages on to stderr, but for one that every viewport causes and that means nothing."""
    if "Setting a new default format" not in text:
        print(text, file=sys.stderr)


def make_application() -> QApplication:
    """The application object, with name and icon."""
    prepare_opengl()
    # the window takes the interpreter's lock back after every call of Qt: while a worker imports or compiles kernels,
    # with the usual 5 ms each a repaint of a few dozen calls would take a fifth of a second
    sys.setswitchinterval(SWITCH_SECONDS)
    qInstallMessageHandler(show_message)
    application = QApplication(["volviz"])
    application.setApplicationName("VolViz")
    application.setOrganizationName("VolViz")
    application.setApplicationDisplayName("VolViz")
    application.setDesktopFileName("volviz")
    application.setWindowIcon(app_icon())
    # Ctrl+C in the terminal ends the program: Qt's loop would never let Python see it
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return application
