"""The mesh in the window: its figures, its filters, giving up, and its way to a file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QMessageBox

from tests.ui.conftest import image, is_complete
from tests.waiting import join_tasks
from volviz.custom_gl.scene_techniques import (
    change_setting,
    choose_technique,
    current_settings,
    current_technique,
)
from volviz.kernels.mesh_metrics import mesh_metrics
from volviz.meshes.polydata import extract_isosurface, triangle_arrays
from volviz_ui.app.main_window import MainWindow
from volviz_ui.dialogs.export_mesh import ExportMeshDialog
from volviz_ui.panels.mesh_section import words_of

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    """These tests are about what happens in a window that is there."""
    return same_window


def change(window: MainWindow, name: str, value: Any) -> None:
    """Change a setting as its editor does."""
    parameter = next(p for p in current_technique(window.store.scene).parameters if p.name == name)
    change_setting(window.store, parameter, value)


def wait_for_summary(window: MainWindow, wait_for: Wait) -> Any:
    """The figures of the mesh that is shown now."""
    wait_for(lambda: is_complete(window))
    wait_for(lambda: window.surface.summary is not None)
    return window.surface.summary


@pytest.fixture
def meshes(window: MainWindow, wait_for: Wait) -> MainWindow:
    """The window with the ball as marching cubes at 100."""
    choose_technique(window.store, "marching_cubes")
    change(window, "isovalue", 100.0)
    wait_for(lambda: is_complete(window))
    wait_for(
        lambda: window.surface.summary is not None and window.surface.summary.mesh.request.isovalue == 100.0
    )
    return window


def test_the_figures_are_those_of_the_mesh_that_is_shown(meshes: MainWindow) -> None:
    volume = meshes.documents.volume
    assert volume is not None
    wanted = mesh_metrics(*triangle_arrays(extract_isosurface(volume, 100.0)))
    shown = meshes.technique_panel.surface
    assert not shown.isHidden()
    thousands = {
        key: label.text().replace("\N{NARROW NO-BREAK SPACE}", "") for key, label in shown.summary.items()
    }
    assert thousands["triangles"] == str(wanted.faces)
    assert thousands["vertices"] == str(wanted.vertices)
    assert float(thousands["area"].split()[0]) == pytest.approx(wanted.area, rel=1e-4)
    assert float(thousands["volume"].split()[0]) == pytest.approx(wanted.volume, rel=1e-4)
    summary = meshes.surface.summary
    # this file does not say in which unit its voxels lie
    assert summary.length_unit == ""
    words = words_of(replace(summary, length_unit="mm"))
    assert words["area"].endswith(" mm²")
    assert words["volume"].endswith(" mm³")
    assert thousands["parts"] == "1, closed"
    assert shown.work.isHidden()


def test_the_section_and_the_command_belong_to_techniques_with_triangles(
    meshes: MainWindow, wait_for: Wait
) -> None:
    assert meshes.commands["file.export_mesh"].isEnabled()
    choose_technique(meshes.store, "raycast")
    assert meshes.technique_panel.surface.isHidden()
    assert not meshes.commands["file.export_mesh"].isEnabled()
    assert meshes.file_commands.export_mesh() is None
    choose_technique(meshes.store, "marching_tetrahedra")
    assert not meshes.technique_panel.surface.isHidden()
    summary = wait_for_summary(meshes, wait_for)
    wait_for(lambda: meshes.surface.summary.mesh.request.method == "tetrahedra")
    assert summary is not None


def test_filters_change_the_mesh_and_are_steps_of_the_history(meshes: MainWindow, wait_for: Wait) -> None:
    before = meshes.surface.summary
    change(meshes, "decimation", 0.7)
    wait_for(lambda: meshes.surface.summary is not None and meshes.surface.summary is not before)
    after = meshes.surface.summary
    assert after.metrics.faces == pytest.approx(0.3 * before.metrics.faces, rel=0.1)
    assert after.metrics.is_closed
    meshes.commands["edit.undo"].trigger()
    wait_for(lambda: meshes.surface.summary is not None and meshes.surface.summary is not after)
    assert meshes.surface.summary.metrics == before.metrics


def test_work_on_the_mesh_is_shown_and_can_be_given_up(
    meshes: MainWindow, wait_for: Wait, monkeypatch: pytest.MonkeyPatch
) -> None:
    from volviz.meshes import filters

    def endless(*_: Any, progress: Any, cancel: Any, **__: Any) -> Any:
        progress(0.5)
        while not cancel():
            QTest.qSleep(2)
        raise manipulator_cancelled

    from volviz.errors import Cancelled

    manipulator_cancelled = Cancelled("The work on the mesh was cancelled.")
    monkeypatch.setattr(filters, "filter_triangles", endless)
    before, shown = meshes.surface.summary, meshes.technique_panel.surface
    change(meshes, "smoothing", 30)
    wait_for(lambda: not shown.work.isHidden() and shown.bar.value() > 500)
    QTest.mouseClick(shown.stop, Qt.MouseButton.LeftButton)
    assert current_settings(meshes.store.scene).smoothing == 0
    wait_for(lambda: is_complete(meshes))
    assert shown.work.isHidden()
    assert meshes.surface.summary.metrics == before.metrics
    meshes.commands["edit.undo"].trigger()
    assert current_settings(meshes.store.scene).smoothing == 30
    meshes.commands["edit.redo"].trigger()
    wait_for(lambda: is_complete(meshes))


def test_w_shows_the_edges_of_the_triangles(meshes: MainWindow, wait_for: Wait) -> None:
    solid = image(meshes)
    meshes.viewport.setFocus()
    QTest.keyClick(meshes.viewport, Qt.Key.Key_W)
    assert current_settings(meshes.store.scene).wireframe
    wait_for(lambda: is_complete(meshes))
    assert np.abs(image(meshes) - solid).max() > 40
    QTest.keyClick(meshes.viewport, Qt.Key.Key_W)
    wait_for(lambda: is_complete(meshes))
    assert np.abs(image(meshes) - solid).max() <= 2


# ---------------------------------------------------------------------- export


def exported(window: MainWindow) -> ExportMeshDialog:
    dialog = window.file_commands.export_mesh()
    assert dialog is not None
    return dialog


@pytest.mark.parametrize("ending", [".stl", ".glb"])
def test_a_mesh_is_exported_as_it_is_shown(
    meshes: MainWindow, wait_for: Wait, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ending: str
) -> None:
    trimesh = pytest.importorskip("trimesh")
    target = tmp_path / f"ball{ending}"
    asked: list[str] = []

    def name(_parent: Any, _title: str, start: str, filters: str) -> tuple[str, str]:
        asked.extend([start, filters])
        # without its ending, as people type it
        return str(target.with_suffix("")), ""

    monkeypatch.setattr(QFileDialog, "getSaveFileName", name)
    dialog = exported(meshes)
    dialog.format.setCurrentIndex(dialog.format.findData(ending))
    QTest.mouseClick(dialog.save_button, Qt.MouseButton.LeftButton)
    wait_for(target.exists)
    wait_for(lambda: meshes.findChild(ExportMeshDialog) is None)
    assert asked[0].endswith(ending)
    assert ending in asked[1]
    assert meshes.preferences.folder_of("mesh") == str(tmp_path)
    found = trimesh.load(target, force="mesh", process=False)
    metrics = meshes.surface.summary.metrics
    assert len(found.faces) == metrics.faces
    assert found.volume == pytest.approx(metrics.volume, rel=1e-4)


def test_an_existing_file_is_replaced_only_after_a_question(
    meshes: MainWindow, wait_for: Wait, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "ball.stl"
    target.write_bytes(b"precious")
    answers = [QMessageBox.StandardButton.No, QMessageBox.StandardButton.Yes]
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(tmp_path / "ball"), ""))
    monkeypatch.setattr(QMessageBox, "question", lambda *_: answers.pop(0))
    dialog = exported(meshes)
    dialog.ask_where()
    assert not dialog.is_writing
    assert target.read_bytes() == b"precious"
    dialog.ask_where()
    wait_for(lambda: meshes.findChild(ExportMeshDialog) is None)
    assert target.stat().st_size > 1000


def test_writing_can_be_cancelled_and_leaves_nothing(
    meshes: MainWindow, wait_for: Wait, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from volviz_ui.dialogs import export_mesh

    real = export_mesh.save_mesh

    def slow(mesh: Any, path: str, *, progress: Any, cancel: Any) -> None:
        while not cancel():
            QTest.qSleep(2)
        real(mesh, path, progress=progress, cancel=cancel)

    monkeypatch.setattr(export_mesh, "save_mesh", slow)
    dialog = exported(meshes)
    dialog.save(str(tmp_path / "ball.vtp"))
    assert dialog.is_writing
    assert not dialog.save_button.isEnabled()
    dialog.reject()
    assert dialog.isVisible()
    assert not dialog.is_writing
    assert dialog.save_button.isEnabled()
    wait_for(lambda: not meshes.workers.is_busy)
    # given up, it ends by itself and takes its unfinished file away
    join_tasks()
    assert list(tmp_path.glob("*.vtp")) == []
    dialog.reject()
    assert not dialog.isVisible()


def test_a_file_that_cannot_be_written_is_told(meshes: MainWindow, tmp_path: Path) -> None:
    dialog = exported(meshes)
    dialog.save(str(tmp_path / "nowhere" / "ball.stl"))
    boxes = dialog.findChildren(QMessageBox)
    assert len(boxes) == 1
    assert "does not exist" in boxes[0].text()
    boxes[0].close()
    dialog.reject()
