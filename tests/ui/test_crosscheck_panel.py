"""The cross-check in the window: started by a click, given up, copied, saved."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from volviz.compare import crosscheck as module
from volviz.compare.crosscheck import crosscheck
from volviz.custom_gl.scene_techniques import choose_technique
from volviz.errors import Cancelled
from volviz_ui.app.main_window import MainWindow
from volviz_ui.compare.crosscheck import CrosscheckPanel

Wait = Callable[..., None]


@pytest.fixture
def panel(window: MainWindow) -> CrosscheckPanel:
    """The dock, shown by its entry in the menu."""
    assert window.docks["crosscheck"].isHidden()
    window.docks["crosscheck"].toggleViewAction().trigger()
    assert not window.docks["crosscheck"].isHidden()
    return window.crosscheck_panel


def test_a_click_compares_with_vtk_and_the_report_can_be_taken_along(
    window: MainWindow, panel: CrosscheckPanel, wait_for: Wait, tmp_path: Path
) -> None:
    assert panel.report is None
    assert not panel.copy.isEnabled()
    panel.isovalue.setValue(99.5)
    QTest.mouseClick(panel.run, Qt.MouseButton.LeftButton)
    assert panel.is_running
    assert not panel.run.isEnabled()
    wait_for(lambda: not panel.is_running)
    report = panel.report
    assert report is not None
    assert window.documents.volume is not None
    wanted = crosscheck(window.documents.volume, 99.5, repeats=1)
    assert report.cleaned == wanted.cleaned
    titles = [panel.table.horizontalHeaderItem(x).text().replace("\n", " ") for x in range(4)]
    assert titles == ["ours", "vtkMarchingCubes", "vtkFlyingEdges3D", "vtkFlyingEdges3D, threaded"]
    rows = {panel.table.verticalHeaderItem(y).text(): y for y in range(panel.table.rowCount())}
    shown = [panel.table.item(rows["Triangles, cleaned"], x).text() for x in range(4)]
    assert shown == [f"{wanted.cleaned.faces:,}"] * 4
    assert panel.table.item(rows["Time, ours = 1"], 0).text() == "1.00"
    words = panel.words.toPlainText()
    assert report.verdict in words
    assert "other diagonals" in words
    QTest.mouseClick(panel.copy, Qt.MouseButton.LeftButton)
    assert QApplication.clipboard().text() == report.format()
    panel.save_report(str(tmp_path / "report.json"))
    panel.save_report(str(tmp_path / "report.txt"))
    assert json.loads((tmp_path / "report.json").read_text())["isovalue"] == 99.5
    assert (tmp_path / "report.txt").read_text() == report.format()


def test_a_cross_check_is_given_up_by_a_click(
    window: MainWindow, panel: CrosscheckPanel, wait_for: Wait, monkeypatch: pytest.MonkeyPatch
) -> None:
    def endless(*_: Any, progress: Any, cancel: Any) -> Any:
        while not cancel():
            progress(0.5)
            QTest.qSleep(2)
        raise Cancelled("The cross-check was cancelled.")

    monkeypatch.setattr(module, "crosscheck", endless)
    panel.start()
    wait_for(lambda: panel.bar.value() == 500)
    QTest.mouseClick(panel.stop, Qt.MouseButton.LeftButton)
    assert not panel.is_running
    assert panel.run.isEnabled()
    wait_for(lambda: not window.workers.is_busy)
    assert panel.report is None


def test_isovalue_and_method_are_those_of_the_technique(window: MainWindow, panel: CrosscheckPanel) -> None:
    choose_technique(window.store, "marching_tetrahedra")
    assert panel.method.currentData() == "tetrahedra"
    choose_technique(window.store, "raycast")
    assert panel.method.currentData() == "lorensen"
