"""How the window feels: time to the first image, frames a second of a drag, longest gaps of the event loop.

    python benchmarks/bench_window.py start FILE [--pairs 5]      first complete image beside an empty window
    python benchmarks/bench_window.py drag FILE [TECHNIQUE ...]   frames a second of a drag, and the gaps around it
    python benchmarks/bench_window.py open FILE FILE ...          gaps while files are opened one after another
    python benchmarks/bench_window.py idle FILE                   frames that an idle window draws in ten seconds

FILE may be ``sample:<id>``. A display is needed (Xvfb will do). A gap is the time between two turns of the event
loop: as long as it lasts, the window answers nobody. With ``--where``, the place in our code is printed that holds
up the loop for more than 90 ms. Name the machine when quoting figures.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

SIZE = (800, 600)
"""Size of the viewport in pixels."""
TICK_MS = 4
LONG_SECONDS = 0.09

EMPTY_WINDOW = """
import os, time
os.environ["QT_API"] = "pyside6"
from PySide6.QtCore import QCoreApplication, Qt
from PySide6.QtWidgets import QApplication, QMainWindow
QCoreApplication.setAttribute(Qt.ApplicationAttribute.AA_ShareOpenGLContexts)
from pyvistaqt import QtInteractor
application = QApplication([])
window = QMainWindow()
viewport = QtInteractor(window, auto_update=False, multi_samples=0)
window.setCentralWidget(viewport)
window.resize(1400, 900)
window.show()
for _ in range(20):
    application.processEvents()
viewport.render()
for _ in range(5):
    application.processEvents()
print(time.time(), time.process_time(), flush=True)
os._exit(0)
"""

OUR_WINDOW = """
import os, sys, time
import volviz_ui.app.start
from PySide6.QtCore import QTimer
from volviz_ui.app import main_window
begin = main_window.MainWindow.__init__
def init(self, *arguments, **keywords):
    begin(self, *arguments, **keywords)
    def look():
        if self.controller.is_complete and self.controller.status.seconds > 0:
            print(time.time(), time.process_time(), flush=True)
            os._exit(0)
    timer = QTimer(self)
    timer.timeout.connect(look)
    timer.start(5)
main_window.MainWindow.__init__ = init
volviz_ui.app.start.main([sys.argv[1]])
"""


def child(program: str, *arguments: str) -> tuple[float, float]:
    """Wall and processor seconds from the start of an interpreter to the line it prints."""
    begin = time.time()
    done = subprocess.run(
        [sys.executable, "-c", program, *arguments], check=True, capture_output=True, text=True
    )
    end, processor = done.stdout.split()[-2:]
    return float(end) - begin, float(processor)


def bench_start(source: str, pairs: int) -> None:
    """Print the time to the first complete image above that of an empty window, pair by pair in turn."""
    for program, arguments in ((EMPTY_WINDOW, ()), (OUR_WINDOW, (source,))):
        child(program, *arguments)  # fills the caches of the disk
    empty, ours = [], []
    for _ in range(pairs):
        empty.append(child(EMPTY_WINDOW))
        ours.append(child(OUR_WINDOW, source))
    for k, kind in enumerate(("wall", "processor")):
        a, b = [pair[k] for pair in empty], [pair[k] for pair in ours]
        above = [y - x for x, y in zip(a, b, strict=True)]
        print(
            f"{kind:9} seconds: empty window {statistics.median(a):.2f}, first picture {statistics.median(b):.2f}, "
            f"above it {statistics.median(above):.2f} ({min(above):.2f} to {max(above):.2f})"
        )


class GapWatch:
    """Notes how long the event loop does not turn, and on request where it hangs meanwhile."""

    def __init__(self, *, where: bool) -> None:
        from PySide6.QtCore import Qt, QTimer

        self.longest = 0.0
        self._last = time.perf_counter()
        self._places: Counter[str] = Counter()
        self._where = where
        self._timer = QTimer()
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self.tick)
        self._timer.start(TICK_MS)
        self._gui = threading.get_ident()
        if where:
            threading.Thread(target=self._look, daemon=True).start()

    def tick(self) -> None:
        """The event loop has turned."""
        now = time.perf_counter()
        late, self._last = now - self._last, now
        self.longest = max(self.longest, late)
        if self._where:
            if late > LONG_SECONDS:
                for place, samples in self._places.most_common(6):
                    print(f"    gap of {1e3 * late:.0f} ms: {samples} x {place}")
            self._places.clear()

    def restart(self) -> None:
        """Begin a new measurement."""
        self.longest, self._last = 0.0, time.perf_counter()
        self._places.clear()

    def milliseconds(self) -> float:
        """The longest gap since the last restart; begins anew."""
        longest = max(self.longest, time.perf_counter() - self._last)
        self.restart()
        return 1e3 * longest

    def _look(self) -> None:
        while True:
            time.sleep(0.005)
            frame = sys._current_frames().get(self._gui)  # noqa: SLF001
            rows: list[str] = []
            while frame is not None and len(rows) < 4:
                path = Path(frame.f_code.co_filename)
                if not rows or ("volviz" in str(path) and path.name != Path(__file__).name):
                    rows.append(f"{path.name}:{frame.f_lineno}")
                frame = frame.f_back
            self._places[" < ".join(rows)] += 1


class Session:
    """The program's window with what drives it."""

    def __init__(self, *, where: bool) -> None:
        from volviz.environment import prepare

        prepare()
        from volviz_ui.app.application import make_application

        self.application = make_application()
        from PySide6.QtCore import QSettings

        from volviz_ui.app.main_window import MainWindow
        from volviz_ui.session.memory import spare_lasting_objects
        from volviz_ui.session.preferences import Preferences
        from volviz_ui.style.theme import Theme

        folder = tempfile.mkdtemp()
        kept = QSettings(str(Path(folder) / "settings.ini"), QSettings.Format.IniFormat)
        self.gaps = GapWatch(where=where)
        self.window = MainWindow(Theme(self.application, "dark"), Preferences(kept))
        self.window.show()
        spare_lasting_objects()
        self.viewport = self.window.viewport
        for _ in range(3):  # the layout settles
            extra = [a - b for a, b in zip(self.size, SIZE, strict=True)]
            self.window.resize(self.window.width() - extra[0], self.window.height() - extra[1])
            self.spin(0.1)

    @property
    def size(self) -> tuple[int, int]:
        """Of the viewport."""
        return self.viewport.width(), self.viewport.height()

    def spin(self, seconds: float) -> None:
        """Let the event loop run."""
        begin = time.perf_counter()
        self.wait(lambda: time.perf_counter() - begin > seconds, seconds + 60)

    def wait(self, condition: Callable[[], bool], limit: float = 120.0) -> None:
        """Let the event loop run until something is so."""
        from PySide6.QtCore import QEventLoop

        begin = time.perf_counter()
        while not condition():
            if time.perf_counter() - begin > limit:
                raise TimeoutError("the window did not get there")
            self.application.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents)
            self.gaps.tick()

    def settle(self) -> float:
        """Wait for the complete image; seconds it took to come."""
        begin = time.perf_counter()
        self.wait(lambda: self.window.controller.is_complete and not self.window.documents.is_loading)
        return time.perf_counter() - begin

    def open(self, source: str) -> None:
        """Open a file and print how long it takes and how long the loop stands still."""
        self.gaps.restart()
        begin = time.perf_counter()
        self.window.open(source)
        self.settle()
        seconds = time.perf_counter() - begin
        self.spin(1.0)
        print(
            f"open {Path(source).name}: complete after {seconds:.2f} s, longest gap {self.gaps.milliseconds():.0f} ms"
        )

    def choose(self, technique: str) -> None:
        """Switch the technique and print the same."""
        from volviz.custom_gl.scene_techniques import choose_technique

        self.gaps.restart()
        begin = time.perf_counter()
        choose_technique(self.window.store, technique)
        self.spin(0.02)
        self.settle()
        seconds = time.perf_counter() - begin
        drawn = self.window.controller.status.seconds
        print(
            f"switch to {technique}: complete after {seconds:.2f} s, drawn in {drawn:.2f} s, "
            f"longest gap {self.gaps.milliseconds():.0f} ms"
        )

    def mouse(self, kind: Any, x: float, y: float, button: Any, buttons: Any) -> None:
        """A mouse event, as the window system would send it."""
        from PySide6.QtCore import QPointF, Qt
        from PySide6.QtGui import QMouseEvent

        here = QPointF(x, y)
        event = QMouseEvent(
            kind, here, self.viewport.mapToGlobal(here), button, buttons, Qt.KeyboardModifier.NoModifier
        )
        self.application.sendEvent(self.viewport, event)

    def drag(self, name: str, moves: int = 60, warm_up: int = 8) -> None:
        """Turn the volume, one frame for each move of the mouse, and print the figures."""
        from PySide6.QtCore import QEvent, Qt

        left, none = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
        status = self.window.controller
        x, y = self.size[0] * 0.4, self.size[1] * 0.5
        self.gaps.restart()
        self.mouse(QEvent.Type.MouseButtonPress, x, y, left, left)
        seconds, worked, levels = [], [], []
        for i in range(moves):
            frames, begin, processor = self.viewport.frames, time.perf_counter(), time.process_time()
            self.mouse(QEvent.Type.MouseMove, x + 4 * (i + 1), y + i, none, left)
            self.wait(lambda frames=frames: self.viewport.frames > frames)
            if i >= warm_up:
                seconds.append(time.perf_counter() - begin)
                worked.append(time.process_time() - processor)
                levels.append(status.status.resolution)
        dragging = self.gaps.milliseconds()
        self.mouse(QEvent.Type.MouseButtonRelease, x + 4 * moves, y + moves, left, none)
        settled = self.settle()
        print(
            f"drag {name} at {self.size[0]} x {self.size[1]}: {1 / statistics.mean(seconds):.1f} frames a second "
            f"(median {1e3 * statistics.median(seconds):.0f} ms, slowest {1e3 * max(seconds):.0f} ms, "
            f"{1e3 * statistics.median(worked):.0f} ms of processor time a frame), "
            f"resolution {statistics.median(levels):.2f}, longest gap {dragging:.0f} ms; "
            f"after release complete in {settled:.2f} s, longest gap {self.gaps.milliseconds():.0f} ms"
        )

    def close(self) -> None:
        """Close the window and print how long that takes."""
        begin = time.perf_counter()
        self.window.close()
        print(f"close: {1e3 * (time.perf_counter() - begin):.0f} ms")


def main() -> None:
    """Run one of the four."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=("start", "drag", "open", "idle"))
    parser.add_argument("source")
    parser.add_argument("more", nargs="*", help="techniques to drag, or further files to open")
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--where", action="store_true")
    arguments = parser.parse_args()
    if arguments.what == "start":
        bench_start(arguments.source, arguments.pairs)
        return
    session = Session(where=arguments.where)
    session.open(arguments.source)
    if arguments.what == "open":
        for source in arguments.more:
            session.open(source)
    elif arguments.what == "idle":
        session.spin(2.0)
        frames = session.viewport.frames
        session.spin(10.0)
        print(f"idle: {session.viewport.frames - frames} frames in ten seconds")
    else:
        for technique in arguments.more or ("raycast", "slicing"):
            session.choose(technique)
            session.drag(technique)
    session.close()
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
