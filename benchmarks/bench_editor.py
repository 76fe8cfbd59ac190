"""How quickly the image follows the transfer-function editor.

    python benchmarks/bench_editor.py tables [FILE]              one change: table, upload, empty space, ...
    python benchmarks/bench_editor.py drag FILE [TECHNIQUE ...]  frames a second while a point is dragged

FILE may be ``sample:<id>``. ``tables`` draws off-screen; ``drag`` opens a window (Xvfb will do), drags the middle point
of the curve with mouse events, and waits for the image after every one. Name the machine when quoting figures.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

REPETITIONS = 40
MOVES = 60
VIEWPORT = (800, 600)


def median_ms(work: Callable[[int], Any]) -> float:
    """Median time of `work(i)` in milliseconds, after three calls that do not count."""
    times = []
    for i in range(REPETITIONS + 3):
        begin = time.perf_counter()
        work(i)
        times.append(1e3 * (time.perf_counter() - begin))
    return statistics.median(times[3:])


def bench_tables(source: str) -> None:
    """Print what one changed point costs, part by part."""
    import pyvista

    import volviz
    from volviz.custom_gl.gpu.resources import PREINTEGRATED_SIZE, PREINTEGRATED_SIZE_INTERACTIVE
    from volviz.custom_gl.vtk.frame_scheduling import FULL

    volume = volviz.load(source)
    start = volviz.TransferFunction.auto(volume)
    plotter = pyvista.Plotter(off_screen=True, window_size=[64, 64])
    handle = volviz.add_volume(plotter, volume, transfer_function=start)
    plotter.show(auto_close=False, interactive=False)
    resources, middle = handle._textures.of(handle._shown), len(start.points) // 2  # noqa: SLF001 - its parts are measured

    def changed(i: int) -> volviz.TransferFunction:
        # never twice the same: equal values are not uploaded again
        return start.with_changed_point(middle, opacity=0.2 + 0.001 * i)

    def finished(texture: Any) -> None:
        handle.gpu.gl.finish()

    handle.window.MakeCurrent()
    frame = handle._frame(FULL, (64, 64))  # noqa: SLF001

    def framed(i: int) -> Any:
        frame.transfer_function = changed(i)
        return frame

    rows = (
        ("table, baked", lambda i: start.bake(volume.range, 4096)),
        ("table, baked and uploaded", lambda i: finished(resources.table(changed(i)))),
        (
            "table per step, baked and uploaded",
            lambda i: finished(resources.table_per_length(changed(i), 0.5)),
        ),
        ("empty space of the new function", lambda i: finished(resources.visible_distance(framed(i)))),
        *(
            (
                f"pre-integrated {size} x {size}",
                lambda i, size=size: finished(resources.preintegrated(changed(i), size, 0.0)),
            )
            for size in (PREINTEGRATED_SIZE_INTERACTIVE, PREINTEGRATED_SIZE)
        ),
    )
    print(f"{volume.name}, {' x '.join(map(str, volume.dimensions))}")
    for name, work in rows:
        print(f"  {name:38} {median_ms(work):7.2f} ms")
    handle.remove()
    plotter.close()


def bench_drag(source: str, techniques: list[str]) -> None:
    """Print frames a second while a point is dragged, for every technique."""
    from volviz.environment import prepare

    prepare()
    from volviz_ui.app.application import make_application

    application = make_application()
    from PySide6.QtCore import QEvent, QPointF, QSettings, Qt
    from PySide6.QtGui import QMouseEvent

    from volviz.custom_gl.scene_techniques import choose_technique
    from volviz_ui.app.main_window import MainWindow
    from volviz_ui.session.preferences import Preferences
    from volviz_ui.style.theme import Theme

    def wait(condition: Callable[[], object], seconds: float = 20.0) -> None:
        end = time.perf_counter() + seconds
        while not condition():
            application.processEvents()
            if time.perf_counter() > end:
                raise SystemExit("the picture did not come")

    with tempfile.TemporaryDirectory() as folder:
        settings = QSettings(str(Path(folder) / "settings.ini"), QSettings.Format.IniFormat)
        window = MainWindow(Theme(application, "dark"), Preferences(settings))
        window.resize(1400, 900)
        window.show()
        application.processEvents()
        viewport = window.viewport
        window.resize(
            window.width() + VIEWPORT[0] - viewport.width(), window.height() + VIEWPORT[1] - viewport.height()
        )
        window.open(source)
        wait(lambda: window.documents.volume is not None and window.controller.is_complete)
        plot = window.transfer_editor.plot
        print(f"{source}, viewport {viewport.width()} x {viewport.height()}")

        def send(kind: QEvent.Type, at: QPointF, button: Qt.MouseButton, buttons: Qt.MouseButton) -> None:
            event = QMouseEvent(
                kind, at, plot.mapToGlobal(at), button, buttons, Qt.KeyboardModifier.NoModifier
            )
            application.sendEvent(plot, event)

        left, none = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
        for technique in techniques:
            choose_technique(window.store, technique)
            wait(lambda: window.controller.is_complete)
            function = window.transfer_editor.model.function
            assert function is not None
            point = function.points[len(function.points) // 2]
            start = plot.places.point(point.value, point.opacity)
            send(QEvent.Type.MouseButtonPress, start, left, left)
            times, shown = [], set()
            processor = time.process_time()
            for i in range(MOVES):
                frames, begin = viewport.frames, time.perf_counter()
                way = i + 1 if i < MOVES // 2 else MOVES - i - 0.5
                # far enough from the press that it counts as a drag
                send(QEvent.Type.MouseMove, start + QPointF(4 + 0.5 * way, -4 - 0.7 * way), none, left)
                wait(lambda frames=frames: viewport.frames > frames)
                times.append(time.perf_counter() - begin)
                shown.add(round(window.controller.status.resolution, 3))
            processor = (time.process_time() - processor) / MOVES
            send(QEvent.Type.MouseButtonRelease, start, left, none)
            wait(lambda: window.controller.is_complete)
            times = sorted(times[5:])
            most = 1e3 * times[int(0.9 * len(times))]
            print(
                f"  {technique:20} {len(times) / sum(times):5.1f} frames a second, median "
                f"{1e3 * statistics.median(times):5.1f} ms, nine of ten within {most:5.1f} ms, "
                f"resolution {min(shown):g} to {max(shown):g}, processor {1e3 * processor:.1f} ms a frame"
            )
        window.close()
        window.deleteLater()
        application.processEvents()


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("what", choices=("tables", "drag"))
    parser.add_argument("source", nargs="?", default="sample:engine")
    parser.add_argument("techniques", nargs="*", default=["raycast", "slicing"])
    options = parser.parse_args()
    if options.what == "tables":
        bench_tables(options.source)
    else:
        bench_drag(options.source, options.techniques)


if __name__ == "__main__":
    main()
