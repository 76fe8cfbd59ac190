"""What must be set before VTK, PyVista, Qt or numba are imported, and what kind of display there is.

Only the standard library is imported here, so that these functions can run before anything else. Each setting
is a default: a value that the user has put into the environment stays.
"""

from __future__ import annotations

import ctypes
import os
import sys

__all__ = [
    "display_answers",
    "has_display",
    "is_linux",
    "prepare",
    "prepare_numba",
    "prepare_qt",
    "prepare_vtk",
]


def has_display() -> bool:
    """Whether a window can be asked for at all.

    On Linux that takes DISPLAY or WAYLAND_DISPLAY; macOS and Windows always have one.
    """
    if not is_linux():
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def display_answers() -> bool:
    """Whether the display can really be opened.

    A DISPLAY that nobody listens to makes Qt abort the process with a misleading message, so it is tried
    first. On Linux this asks the X server through libxcb, which Qt's own platform plugin needs too; it takes
    a millisecond.
    """
    if not is_linux():
        return True
    if not os.environ.get("DISPLAY"):
        return bool(os.environ.get("WAYLAND_DISPLAY"))
    try:
        xcb = ctypes.CDLL("libxcb.so.1")
    except OSError:
        return False
    xcb.xcb_connect.restype = ctypes.c_void_p
    xcb.xcb_connect.argtypes = [ctypes.c_char_p, ctypes.c_void_p]
    xcb.xcb_connection_has_error.argtypes = [ctypes.c_void_p]
    xcb.xcb_disconnect.argtypes = [ctypes.c_void_p]
    connection = xcb.xcb_connect(None, None)
    # xcb_connect never returns NULL; a failed connection is an object that carries its error.
    answers = bool(xcb.xcb_connection_has_error(connection) == 0)
    xcb.xcb_disconnect(connection)
    return answers


def prepare() -> None:
    """Set everything below; a second call changes nothing.

    Call it before the first import of VTK, PyVista, Qt or numba.
    """
    prepare_vtk()
    prepare_qt()
    prepare_numba()


def prepare_vtk() -> None:
    """Set what VTK and PyVista read while they are imported.

    PyVista takes a fork of VTK where one is installed; ours is tested with VTK itself. Without a display
    VTK's default window prints warnings and tries GLX first: the EGL window draws in silence, and 0.4 s
    sooner.
    """
    os.environ.setdefault("PYVISTA_VTK_BACKEND", "vtk")
    if is_linux() and not (os.environ.get("DISPLAY") and display_answers()):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")


def prepare_qt() -> None:
    """Set what Qt and its wrappers read before the application object exists.

    On a Wayland desktop that also offers X, X is used: VTK's own windows speak X only, and one process must
    not mix both.
    """
    os.environ.setdefault("QT_API", "pyside6")
    if is_linux() and os.environ.get("DISPLAY"):
        os.environ.setdefault("QT_QPA_PLATFORM", "xcb")


def prepare_numba() -> None:
    """Prefer OpenMP for parallel kernels.

    numba's own "workqueue" layer ends the process when two threads run parallel kernels at once.
    """
    os.environ.setdefault("NUMBA_THREADING_LAYER_PRIORITY", "omp tbb workqueue")


def is_linux() -> bool:
    """Whether this is Linux, the one system where display and libraries are anybody's guess."""
    return sys.platform.startswith("linux")
