"""Progress of an image on its way to a file or the clipboard, with a button that gives it up."""

from __future__ import annotations

from typing import Protocol

from PySide6.QtCore import SignalInstance
from PySide6.QtWidgets import QProgressDialog, QWidget

STEPS = 1000
"""Of the bar."""
QUICK_MS = 400
"""What is done sooner shows no progress."""


class Job(Protocol):
    """Work that tells how far it is."""

    progressed: SignalInstance
    ended: SignalInstance

    def cancel(self) -> None:
        """Give it up."""


def show_job(parent: QWidget, job: Job, title: str, words: str) -> QProgressDialog:
    """Open the dialog of a job; it goes when the job has ended, and the window can be used meanwhile."""
    dialog = QProgressDialog(parent)
    dialog.setWindowTitle(title)
    dialog.setLabelText(words)
    dialog.setCancelButtonText(dialog.tr("Cancel"))
    dialog.setAccessibleName(dialog.tr("Progress: %1").replace("%1", title))
    dialog.setRange(0, STEPS)
    dialog.setAutoClose(False)
    dialog.setAutoReset(False)
    dialog.setMinimumDuration(QUICK_MS)
    dialog.setValue(0)
    dialog.canceled.connect(job.cancel)
    job.progressed.connect(lambda part: dialog.setValue(round(part * STEPS)))

    def close() -> None:
        dialog.canceled.disconnect(job.cancel)
        dialog.close()
        dialog.deleteLater()

    job.ended.connect(close)
    return dialog
