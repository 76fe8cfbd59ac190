"""What a start must not do, and what waits until the first image is there."""

from __future__ import annotations

import subprocess
import sys
import threading
from collections.abc import Callable

import numpy as np
from PySide6.QtCore import QObject

from tests.ui.conftest import is_complete
from volviz_ui.app.main_window import MainWindow
from volviz_ui.session.workers import Gate, Workers

Wait = Callable[..., None]


def test_the_modules_of_the_window_import_nothing_that_can_wait() -> None:
    waiting = ("numba", "scipy", "SimpleITK", "pydicom", "nibabel", "h5py", "tensorstore", "imageio")
    program = f"""
import sys
from volviz.environment import prepare
prepare()
import volviz_ui.app.main_window
from volviz.custom_gl.registry import techniques
techniques()
print([name for name in {waiting} if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "[]"


def test_patient_work_begins_when_the_gate_opens(wait_for: Wait) -> None:
    owner = QObject()
    workers, gate = Workers(owner), Gate(owner)
    workers.gate = gate
    gate.shut()
    came: list[object] = []
    workers.start(lambda task: "patient", patient=True).succeeded.connect(came.append)
    cancelled = workers.start(lambda task: "cancelled", patient=True, key="one")
    cancelled.succeeded.connect(came.append)
    workers.cancel("one")
    workers.start(lambda task: "urgent").succeeded.connect(came.append)
    wait_for(lambda: bool(came))
    assert came == ["urgent"]
    gate.open()
    wait_for(lambda: len(came) == 2)
    assert came == ["urgent", "patient"]
    workers.start(lambda task: "late", patient=True).succeeded.connect(came.append)
    wait_for(lambda: len(came) == 3)
    workers.close()


def test_a_gate_opens_by_itself_after_a_while(wait_for: Wait) -> None:
    gate = Gate()
    opened: list[bool] = []
    gate.opened.connect(lambda: opened.append(True))
    gate.shut()
    assert not gate.is_open
    wait_for(lambda: gate.is_open)
    assert opened == [True]


def test_work_that_waits_at_the_gate_is_dropped_when_the_window_closes() -> None:
    owner = QObject()
    workers, gate = Workers(owner), Gate(owner)
    workers.gate = gate
    gate.shut()
    ran: list[bool] = []
    task = workers.start(lambda task: ran.append(True), patient=True)
    workers.close()
    gate.open()
    assert task.is_cancelled
    assert ran == []


def test_histograms_arrive_after_the_first_picture(window: MainWindow, wait_for: Wait) -> None:
    wait_for(lambda: is_complete(window))
    wait_for(lambda: window.gate.is_open)
    wait_for(lambda: window.data_panel.histogram.counts is not None)
    counts = window.data_panel.histogram.counts
    assert counts is not None
    assert int(np.sum(counts)) == window.documents.volume.array.size


def test_a_file_does_not_wait_for_kernels_that_are_being_compiled(
    window: MainWindow, other_file: str, wait_for: Wait
) -> None:
    go_on = threading.Event()
    for _ in range(2):
        window.compilers.start(lambda task: go_on.wait(60))
    try:
        window.open(other_file)
        wait_for(lambda: window.documents.volume.dimensions == (24, 24, 24))
        assert not go_on.is_set()
        assert window.compilers.is_busy
    finally:
        go_on.set()
