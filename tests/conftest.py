"""Surroundings of every test: display, marks by folder, leak checks, test volumes."""

from __future__ import annotations

import os
import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import hypothesis
import pytest

from tests.leaks import Watch, thaw
from tests.screens import NO_DISPLAY, window_can_open
from volviz.environment import prepare

if TYPE_CHECKING:
    from collections.abc import Iterator

TESTS = Path(__file__).parent
LAYERS = ("unit", "contract", "render", "ui")
#: Files that take long for what they find: random users, reports that are drawn by programs of their own. ``make test``
#: leaves them out, ``make test-all`` runs them as well.
SLOW = frozenset(f"test_{name}.py" for name in ("random_operations", "restless_user", "compare_reports"))
FAILED = pytest.StashKey[bool]()

# All of this must stand before the first import of Qt (pytest-qt does it while pytest starts) or VTK.
if sys.platform.startswith("linux"):
    os.environ.pop("WAYLAND_DISPLAY", None)
    os.environ["QT_QPA_PLATFORM"] = "xcb"
    # Images are drawn as on a machine without a display, though the tests of the window have one.
    os.environ["VTK_DEFAULT_OPENGL_WINDOW"] = "vtkEGLRenderWindow"
prepare()
if "PYTEST_XDIST_WORKER" in os.environ:
    # OpenMP's threads wait for work by turning in circles, at the cost of the process beside this one
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")

# The same examples each time, so that a change that breaks nothing never fails; no deadline, since machines
# differ. `--hypothesis-profile=search` looks for new ones.
hypothesis.settings.register_profile("volviz", derandomize=True, deadline=None, database=None)
hypothesis.settings.register_profile("search", deadline=None, max_examples=1000)
hypothesis.settings.load_profile("volviz")


def layer_of(path: Path) -> str | None:
    """Layer that a test file belongs to: the first folder below `tests`."""
    try:
        first = path.relative_to(TESTS).parts[0]
    except ValueError:
        return None
    return first if first in LAYERS else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if layer := layer_of(item.path):
            item.add_marker(getattr(pytest.mark, layer))
        if item.path.name in SLOW:
            item.add_marker(pytest.mark.slow)
    # Later plugins and -m may still deselect; running the plain layers first makes simple mistakes show
    # first. Within a layer the files with the most tests come first, so that two processes end together.
    tests = Counter(item.path for item in items)
    items.sort(
        key=lambda item: (LAYERS.index(layer_of(item.path) or "unit"), -tests[item.path], str(item.path))
    )


def pytest_collection_finish(session: pytest.Session) -> None:
    """Say in words what Qt would only say with "Aborted"."""
    # a process among several cannot stop the others: there the fixture below refuses each test
    if session.config.option.collectonly or "PYTEST_XDIST_WORKER" in os.environ:
        return
    if any(layer_of(item.path) == "ui" for item in session.items) and not window_can_open():
        pytest.exit(NO_DISPLAY, returncode=pytest.ExitCode.USAGE_ERROR)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    report = yield
    if report.failed:
        item.stash[FAILED] = True
    return report


@pytest.fixture(autouse=True)
def nothing_is_left_behind(request: pytest.FixtureRequest) -> Iterator[None]:
    """After each test: no thread, window, widget, timer or GL object more than before.

    A failed test is not searched: its traceback keeps its local variables alive.
    """
    if request.node.get_closest_marker("leaks_allowed"):
        yield
        return
    layer = layer_of(request.path)
    watch = Watch(objects=layer not in {None, "unit"})
    yield
    if request.node.stash.get(FAILED, False):
        return
    if leaks := watch.leaks():
        pytest.fail("The test left behind:\n  " + "\n  ".join(leaks), pytrace=False)


@pytest.fixture(autouse=True, scope="module")
def memory_is_given_back(request: pytest.FixtureRequest) -> Iterator[None]:
    """After each file: what its fixtures kept can be collected."""
    yield
    if layer_of(request.path) not in {None, "unit"}:
        thaw()


@pytest.fixture(scope="session")
def qapp_args() -> list[str]:
    """Runs before the application is made: unless contexts share, a floating dock loses its image."""
    from PySide6.QtCore import QCoreApplication, Qt

    QCoreApplication.setAttribute(Qt.ApplicationAttribute.AA_ShareOpenGLContexts)
    return ["volviz-tests"]


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Folder of real volumes that the project may not ship: VOLVIZ_TEST_DATA, or `../shared/data`."""
    override = os.environ.get("VOLVIZ_TEST_DATA")
    folder = Path(override) if override else TESTS.parent.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"no test volumes in {folder}; set VOLVIZ_TEST_DATA to a folder that holds them")
    return folder
