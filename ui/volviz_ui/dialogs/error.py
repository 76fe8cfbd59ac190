"""The error dialog: one sentence, and the details for those who ask."""

from __future__ import annotations

import traceback
from pathlib import Path

from PySide6.QtCore import QCoreApplication
from PySide6.QtGui import QFontDatabase
from PySide6.QtWidgets import QMessageBox, QTextEdit, QWidget

from volviz.errors import VolvizError
from volviz_ui.style.icons import icon


def sentence_of(error: BaseException) -> str:
    """What to tell: our own errors are sentences already, others get one."""
    if isinstance(error, VolvizError):
        text = str(error)
    elif isinstance(error, OSError) and error.filename:
        # the system's own words say what is the matter
        text = f"{Path(str(error.filename)).name}: {error.strerror}"
    else:
        words = QCoreApplication.translate("ErrorDialog", "Something unexpected happened: %1")
        text = words.replace("%1", f"{type(error).__name__}, {error}".rstrip(", "))
    # a name of a file at the beginning stays as it is written
    if text.partition(" ")[0].isalpha():
        text = text[:1].upper() + text[1:]
    return text if text.endswith((".", "!", "?")) else text + "."


def details_of(error: BaseException) -> str:
    """The traceback, for those who want to report it."""
    return "".join(traceback.format_exception(error)).strip()


def error_box(parent: QWidget, title: str, error: BaseException) -> QMessageBox:
    """A dialog with the sentence; its details are folded. Not shown yet."""
    box = QMessageBox(parent)
    box.setObjectName("error_dialog")
    box.setIconPixmap(icon("warning", "warning").pixmap(32, 32))
    box.setWindowTitle(title)
    box.setText(sentence_of(error))
    box.setDetailedText(details_of(error))
    box.setStandardButtons(QMessageBox.StandardButton.Close)
    # not "Show details", which Qt would take
    box.setDefaultButton(QMessageBox.StandardButton.Close)
    box.setEscapeButton(QMessageBox.StandardButton.Close)
    for view in box.findChildren(QTextEdit):
        view.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        view.setMinimumWidth(520)
    return box


def show_error(parent: QWidget, title: str, error: BaseException) -> QMessageBox:
    """Open the dialog without stopping the event loop; it deletes itself when closed."""
    box = error_box(parent, title, error)
    box.finished.connect(box.deleteLater)
    box.open()
    return box
