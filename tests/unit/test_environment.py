"""What is set before VTK, Qt and numba are imported, and how a display is recognised."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from volviz import environment

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="only Linux leaves display and windows open")

NAMES = (
    "DISPLAY",
    "NUMBA_THREADING_LAYER_PRIORITY",
    "PYVISTA_VTK_BACKEND",
    "QT_API",
    "QT_QPA_PLATFORM",
    "VTK_DEFAULT_OPENGL_WINDOW",
    "WAYLAND_DISPLAY",
)


@pytest.fixture
def empty(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """An environment without any of the names, restored afterwards."""
    for name in NAMES:
        monkeypatch.setenv(name, "")
        monkeypatch.delenv(name)
    return monkeypatch


def test_without_a_display_vtk_draws_through_egl(empty: pytest.MonkeyPatch) -> None:
    environment.prepare()
    assert os.environ["VTK_DEFAULT_OPENGL_WINDOW"] == "vtkEGLRenderWindow"
    assert os.environ["PYVISTA_VTK_BACKEND"] == "vtk"
    assert "QT_QPA_PLATFORM" not in os.environ


def test_a_display_that_nobody_listens_to_counts_as_none(empty: pytest.MonkeyPatch) -> None:
    empty.setenv("DISPLAY", ":4711")
    assert environment.has_display()
    assert not environment.display_answers()
    environment.prepare_vtk()
    assert os.environ["VTK_DEFAULT_OPENGL_WINDOW"] == "vtkEGLRenderWindow"


def test_what_the_user_has_set_stays(empty: pytest.MonkeyPatch) -> None:
    own = {
        "PYVISTA_VTK_BACKEND": "cvista",
        "QT_API": "pyqt6",
        "VTK_DEFAULT_OPENGL_WINDOW": "vtkOSOpenGLRenderWindow",
        "NUMBA_THREADING_LAYER_PRIORITY": "tbb",
    }
    for name, value in own.items():
        empty.setenv(name, value)
    environment.prepare()
    assert {name: os.environ[name] for name in own} == own


def test_a_wayland_desktop_with_x_uses_x(empty: pytest.MonkeyPatch) -> None:
    empty.setenv("WAYLAND_DISPLAY", "wayland-0")
    environment.prepare_qt()
    assert "QT_QPA_PLATFORM" not in os.environ
    empty.setenv("DISPLAY", ":0")
    environment.prepare_qt()
    assert os.environ["QT_QPA_PLATFORM"] == "xcb"


def test_importing_volviz_loads_neither_qt_nor_vtk_nor_opengl() -> None:
    heavy = ("PySide6", "qtpy", "vtkmodules", "vtk", "pyvista", "moderngl", "numba", "numpy")
    code = f"import sys, volviz; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "[]"
