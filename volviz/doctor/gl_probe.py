"""Ask OpenGL who it is and what it can do; prints one line of JSON. Started as a process by the doctor.

``offscreen`` draws with a VTK window that is never shown, as `volviz.render` does; ``window`` makes a context
through Qt on the display, as the desktop program does.
"""

from __future__ import annotations

import importlib
import json
import sys
import time
from typing import Any

from volviz.environment import prepare

LIMITS = {
    "texture_3d": "GL_MAX_3D_TEXTURE_SIZE",
    "texture_2d": "GL_MAX_TEXTURE_SIZE",
    "texture_units": "GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS",
    "samples": "GL_MAX_SAMPLES",
}


def main(kind: str) -> None:
    """Make a context of one kind and print what it says."""
    prepare()
    start = time.perf_counter()
    keep = _offscreen() if kind == "offscreen" else _window()
    import moderngl

    moderngl.init_context()
    info = moderngl.get_context().info
    answer = {
        "vendor": info["GL_VENDOR"],
        "renderer": info["GL_RENDERER"],
        "version": info["GL_VERSION"],
        "code": moderngl.get_context().version_code,
        "seconds": time.perf_counter() - start,
        "way": type(keep[0]).__name__,
        **{name: int(info.get(key) or 0) for name, key in LIMITS.items()},
    }
    sys.stdout.write(json.dumps(answer) + "\n")


def _offscreen() -> list[Any]:
    """A VTK window with an image in it. VTK is named here because only this process needs it."""
    core = importlib.import_module("vtkmodules.vtkRenderingCore")
    importlib.import_module("vtkmodules.vtkRenderingOpenGL2")
    window = core.vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetSize(64, 64)
    window.AddRenderer(core.vtkRenderer())
    window.Render()
    window.MakeCurrent()
    return [window]


def _window() -> list[Any]:
    """A context on the display. Qt is named here alone, in a process of its own: the library knows no Qt."""
    gui = importlib.import_module("PySide6.QtGui")
    wanted = gui.QSurfaceFormat()
    wanted.setVersion(3, 3)
    wanted.setProfile(gui.QSurfaceFormat.OpenGLContextProfile.CoreProfile)
    application = gui.QGuiApplication(["volviz-doctor"])
    surface = gui.QOffscreenSurface()
    surface.setFormat(wanted)
    surface.create()
    context = gui.QOpenGLContext()
    context.setFormat(wanted)
    if not context.create() or not context.makeCurrent(surface):
        sys.exit("Qt could not make an OpenGL 3.3 core context on this display.")
    return [context, surface, application]
