"""Checks of system libraries, display and OpenGL."""

from __future__ import annotations

import importlib.util
import json
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from volviz.doctor.check import Check
from volviz.doctor.child import ChildResult, run_python
from volviz.doctor.system_libraries import install_command, missing_libraries, missing_packages, package_for
from volviz.environment import display_answers, has_display, is_linux

if TYPE_CHECKING:
    from collections.abc import Iterator

NEEDED_VERSION = 330
"""Our shaders are GLSL 3.30 core."""
COMFORTABLE_3D_TEXTURE = 512
SOFTWARE = ("llvmpipe", "softpipe", "swrast", "Microsoft Basic Render", "GDI Generic")

# Words in messages of Mesa, VTK and Qt -> the Debian package behind them.
KNOWN_MESSAGES = (
    ("MESA-LOADER: failed to open", "libgl1-mesa-dri"),
    ("Could not initialize GLX", "libglx-mesa0"),
    ("GLX extension", "libglx-mesa0"),
    ("failed to create any EGL", "libegl1"),
)


def check_libraries() -> Iterator[Check]:
    """Shared libraries that the wheels expect the system to have."""
    if not is_linux():
        return
    missing = missing_libraries("window")
    if not missing:
        yield Check("libraries", "ok", "all shared libraries of the system that VTK and Qt load are there")
        return
    names = ", ".join(library.soname for library in missing)
    yield Check("libraries", "fail", f"missing: {names}", install_command(missing_packages("window")))


def check_display() -> Iterator[Check]:
    """Whether there is a screen for the window."""
    if not is_linux():
        return
    if display_answers():
        yield Check("display", "ok", "the display answers")
        return
    what = "the display does not answer" if has_display() else "neither DISPLAY nor WAYLAND_DISPLAY is set"
    detail = f"{what}: the window cannot open, pictures can be drawn (volviz render)"
    if shutil.which("xvfb-run"):
        remedy = "log in with a desktop, or use a virtual screen: xvfb-run volviz"
    else:
        remedy = f"log in with a desktop, or use a virtual screen: {install_command(['xvfb', 'xauth'])}"
    yield Check("display", "warn", detail, remedy)


def check_window_system() -> Iterator[Check]:
    """Whether Qt's plugin for X loads.

    Whichever library it lacks, Qt itself names xcb-cursor and aborts; the dynamic loader names the real one.
    """
    if not is_linux():
        return
    plugin = qt_plugin()
    if plugin is None:
        yield Check(
            "Qt", "fail", "PySide6 is not installed", f"{sys.executable} -m pip install PySide6-Essentials"
        )
        return
    loaded = run_python("import ctypes, sys; ctypes.CDLL(sys.argv[1])", str(plugin))
    if loaded.status == 0:
        yield Check("Qt", "ok", f"{plugin.name} loads")
    else:
        yield Check("Qt", "fail", f"{plugin.name} does not load: {loaded.last_error()}", remedy_for(loaded))


def qt_plugin() -> Path | None:
    """Path of Qt's plugin for X, found without importing Qt; None without PySide6."""
    spec = importlib.util.find_spec("PySide6")
    if spec is None or spec.origin is None:
        return None
    plugin = Path(spec.origin).parent / "Qt" / "plugins" / "platforms" / "libqxcb.so"
    return plugin if plugin.exists() else None


def check_drawing() -> Iterator[Check]:
    """OpenGL for images that are drawn off-screen."""
    yield from _check_gl("OpenGL", "offscreen")


def check_window_drawing() -> Iterator[Check]:
    """OpenGL on the display, where there is one."""
    if display_answers():
        yield from _check_gl("OpenGL (window)", "window")


def _check_gl(name: str, kind: str) -> Iterator[Check]:
    result = run_python("import sys; from volviz.doctor.gl_probe import main; main(sys.argv[1])", kind)
    answer = parse_answer(result)
    if answer is None:
        yield Check(name, "fail", f"no OpenGL context: {result.last_error()}", remedy_for(result))
        return
    detail = (
        f"{answer['version']}, {answer['renderer']} ({answer['vendor']}); textures up to "
        f"{answer['texture_3d']}^3 and {answer['texture_2d']}^2, {answer['texture_units']} units, "
        f"{answer['samples']} samples; context in {answer['seconds']:.1f} s through {answer['way']}"
    )
    yield judge(name, detail, answer)


def judge(name: str, detail: str, answer: dict[str, Any]) -> Check:
    """Turn what a context says of itself into a finding."""
    if answer["code"] < NEEDED_VERSION:
        return Check(name, "fail", detail, "VolViz needs OpenGL 3.3: update the driver of the graphics card")
    if answer["texture_3d"] < COMFORTABLE_3D_TEXTURE:
        return Check(name, "warn", detail, "larger volumes are shown at a lower level of detail")
    if any(word in answer["renderer"] for word in SOFTWARE):
        remedy = "drawn by the processor; with a graphics card, install its driver"
        return Check(name, "warn", detail, remedy)
    return Check(name, "ok", detail)


def parse_answer(result: ChildResult) -> dict[str, Any] | None:
    """The probe's line of JSON; None when it did not get that far."""
    if result.status != 0:
        return None
    for line in reversed(result.output.splitlines()):
        try:
            answer = json.loads(line)
        except ValueError:
            continue
        if isinstance(answer, dict):
            return answer
    return None


def remedy_for(result: ChildResult) -> str:
    """What to do about a process that failed, from its messages."""
    package = package_for(result.errors)
    if package is None:
        package = next((package for words, package in KNOWN_MESSAGES if words in result.errors), None)
    if package is not None:
        return install_command([package])
    if is_linux():
        return (
            f"install the driver of the graphics card, or {install_command(['libegl1', 'libgl1-mesa-dri'])}"
        )
    return "install the driver of the graphics card"
