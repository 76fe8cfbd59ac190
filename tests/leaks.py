"""What a test may not leave behind: threads, VTK windows, GL objects, Qt widgets and timers.

Everything here looks only at modules that are already imported, so that a test of plain values pays for none
of it.

`Watch` hides all that existed before the test from the garbage collector (`gc.freeze`): the search after the
test then sees only the objects that the test made, and costs milliseconds instead of a walk over the whole
heap. `thaw` gives everything back; it is called after each file, since a full collection takes 0.3 s.
"""

from __future__ import annotations

import gc
import sys
import threading
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

ALLOWED_THREAD_PREFIXES = ("volviz-shared", "pytest_timeout")
"""Threads that live as long as the process name themselves so."""

GRACE_SECONDS = 2.0
"""How long a thread may take to end after its test."""

TASK_THREAD_PREFIX = "volviz-task"
TASK_GRACE_SECONDS = 120.0
"""The same for work in the background that has been cancelled: a kernel that is being compiled goes on to its end."""

VTK_CLASSES = (
    ("vtkmodules.vtkRenderingCore", "vtkRenderWindow"),
    ("vtkmodules.vtkRenderingCore", "vtkRenderer"),
    ("vtkmodules.vtkRenderingCore", "vtkRenderWindowInteractor"),
    ("vtkmodules.vtkRenderingCore", "vtkAbstractVolumeMapper"),
    ("vtkmodules.vtkRenderingCore", "vtkPolyDataMapper"),
)
GL_CLASSES = (
    "Texture",
    "TextureArray",
    "Texture3D",
    "TextureCube",
    "Buffer",
    "Program",
    "VertexArray",
    "Renderbuffer",
)


def running_threads() -> set[threading.Thread]:
    """Python threads alive now, without those that may live on."""
    return {
        thread
        for thread in threading.enumerate()
        if not thread.name.startswith(ALLOWED_THREAD_PREFIXES)
        # Python's stand-in for a thread of Qt stays listed when that has ended; Qt itself is asked below.
        and not isinstance(thread, threading._DummyThread)
    }


def wait_for_threads(before: set[threading.Thread], grace: float = GRACE_SECONDS) -> list[str]:
    """Names of the threads that were started since `before` and outlive `grace` seconds.

    Tasks in the background, which nobody waits for when their owner is closed, get `TASK_GRACE_SECONDS`.
    """
    begin = time.monotonic()
    while left := running_threads() - before:
        tasks = all(thread.name.startswith(TASK_THREAD_PREFIX) for thread in left)
        if time.monotonic() > begin + (max(grace, TASK_GRACE_SECONDS) if tasks else grace):
            break
        time.sleep(0.01)
    return [f"thread {thread.name!r} is still running" for thread in left]


def settle_qt() -> None:
    """Deliver deferred deletions: outside of `exec()` Qt keeps every widget that asked for `deleteLater`."""
    core = sys.modules.get("PySide6.QtCore")
    if core is None or core.QCoreApplication.instance() is None:
        return
    for _ in range(3):
        core.QCoreApplication.sendPostedEvents(None, core.QEvent.Type.DeferredDelete)
        core.QCoreApplication.processEvents()


def _is_valid(qt_object: Any) -> bool:
    shiboken = sys.modules.get("shiboken6")
    return shiboken is None or bool(shiboken.isValid(qt_object))


def qt_windows() -> set[Any]:
    """Top-level widgets that exist now."""
    widgets = sys.modules.get("PySide6.QtWidgets")
    if widgets is None or not isinstance(widgets.QApplication.instance(), widgets.QApplication):
        return set()
    return set(widgets.QApplication.topLevelWidgets())


def _qt_objects(objects: Iterable[Any]) -> Iterator[str]:
    core = sys.modules.get("PySide6.QtCore")
    if core is None:
        return
    for item in objects:
        # the types themselves are asked: a dead weak proxy among the objects must not be touched
        if issubclass(type(item), core.QTimer) and _is_valid(item) and item.isActive():
            yield f"QTimer {item.objectName()!r} of {item.parent()!r} is still running"
        elif issubclass(type(item), core.QThread) and _is_valid(item) and item.isRunning():
            yield f"QThread {item.objectName()!r} is still running"


def _qt_pool() -> Iterator[str]:
    core = sys.modules.get("PySide6.QtCore")
    if core is None or core.QCoreApplication.instance() is None:
        return
    pool = core.QThreadPool.globalInstance()
    if not pool.waitForDone(int(1000 * GRACE_SECONDS)):
        yield f"QThreadPool.globalInstance() still runs {pool.activeThreadCount()} task(s)"


def _vtk_objects(objects: Iterable[Any]) -> Iterator[str]:
    classes = tuple(
        getattr(sys.modules[module], name) for module, name in VTK_CLASSES if module in sys.modules
    )
    if classes:
        for item in objects:
            if issubclass(type(item), classes):
                yield f"{item.GetClassName()} is still alive, held by {_holders(item, objects)}"


def _gl_objects(objects: Iterable[Any]) -> Iterator[str]:
    moderngl = sys.modules.get("moderngl")
    if moderngl is None:
        return
    classes = tuple(getattr(moderngl, name) for name in GL_CLASSES)
    for item in objects:
        # After release() the wrapped object is replaced by an InvalidObject.
        if issubclass(type(item), classes) and type(item.mglo).__name__ != "InvalidObject":
            label = getattr(item, "label", None) or ""
            yield f"moderngl.{type(item).__name__} {label} is not released, held by {_holders(item, objects)}"


def _holders(item: Any, ignored: Any) -> str:
    """Short description of who refers to `item`, for the message of a failure."""
    names = []
    for holder in gc.get_referrers(item):
        if holder is ignored or type(holder).__name__ in {"frame", "list_iterator", "generator"}:
            continue
        if isinstance(holder, dict):
            names.append(f"dict with keys {sorted(map(str, holder))[:6]}")
        else:
            names.append(f"{type(holder).__module__}.{type(holder).__qualname__}")
    return ", ".join(sorted(set(names))[:4]) or "nobody Python knows of"


class Watch:
    """The state before a test, and the comparison after it.

    Parameters
    ----------
    objects : bool
        Look for VTK, GL and Qt objects too. False for tests of plain values, which cannot make any.
    """

    def __init__(self, *, objects: bool) -> None:
        self.objects = objects
        self.threads = running_threads()
        self.windows: set[Any] = set()
        if objects:
            self.windows = qt_windows()
            gc.collect()
            gc.freeze()

    def leaks(self) -> list[str]:
        """One sentence for each thing that the test left behind."""
        if not self.objects:
            return wait_for_threads(self.threads)
        settle_qt()
        gc.collect()
        settle_qt()
        found = wait_for_threads(self.threads)
        found += [
            f"top-level widget {widget!r} still exists"
            for widget in qt_windows() - self.windows
            if _is_valid(widget)
        ]
        found += _qt_pool()
        made = gc.get_objects()
        found += [*_qt_objects(made), *_vtk_objects(made), *_gl_objects(made)]
        return found


def thaw() -> None:
    """Hand everything back to the garbage collector, and collect what became garbage while it was hidden."""
    gc.unfreeze()
    gc.collect()
