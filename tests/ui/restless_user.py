"""A user who does one thing after another in the window with mouse and keys, and an eye that checks what is seen.

After every step, at rest, each view is compared with the same scene drawn off-screen, the screen with the views, and
the cameras with one another. ``python -m tests.ui.restless_user STEPS [SEED]`` goes on for as long as it is told.
"""

from __future__ import annotations

import random
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMessageBox, QWidget

from tests.ui.conftest import drag, drawn_image, save_ball, turn_wheel
from volviz.compare.image_metrics import difference_image
from volviz.custom_gl.scene_techniques import change_setting, current_technique
from volviz.model.light import Light
from volviz.model.parameters import Cost
from volviz_ui.app.main_window import MainWindow
from volviz_ui.views.difference_image import array_of
from volviz_ui.views.sides import choose_side
from volviz_ui.views.view_widget import ViewWidget
from volviz_ui.views.viewport import same_view

LEVELS = 2
"""In the window the background is rounded to bytes before the volume is laid over it, off-screen only the result."""
EDGES = 2e-4
"""Part of the values that may differ by more: at a cut edge a pixel falls to one side or the other by rounding."""
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton


class Mistake(AssertionError):
    """Something seen in the window is not what the scene says."""


class RestlessUser:
    """Does what users do, in an order that a seed decides.

    Parameters
    ----------
    window : MainWindow
        With a volume open.
    folder : Path
        Where volumes and sessions are written.
    """

    def __init__(self, window: MainWindow, folder: Path, seed: int) -> None:
        self.window = window
        self.random = random.Random(seed)
        self.folder = folder
        self.files = [str(save_ball(folder / f"ball{n}.npy", 80 + 50 * n, size=20 + 6 * n)) for n in range(3)]
        self.log: list[str] = []
        self.errors: list[object] = []
        window.views.failed.connect(self.errors.append)
        window.documents.failed.connect(lambda name, error: self.errors.append((name, error)))
        for name in ("marker", "box", "axes", "bar"):
            if window.commands[f"view.{name}"].isChecked():
                window.commands[f"view.{name}"].trigger()
        if window.commands["view.handles"].isChecked():
            window.commands["view.handles"].trigger()
        self.deeds: list[Callable[[], None]] = [
            getattr(self, name) for name in sorted(dir(self)) if name.startswith("do_")
        ]

    def step(self) -> None:
        """One deed, then a look at everything."""
        deed = self.random.choice(self.deeds)
        self.log.append(deed.__name__.removeprefix("do_"))
        deed()
        if self.random.random() < 0.25:
            return  # the next one comes before anything has settled
        self.rest()
        self.look()

    # ------------------------------------------------------------------ deeds

    def _viewport(self) -> Any:
        seen = [p.viewport for p in self.window.views.shown_view_widgets]
        return self.random.choice(seen)

    def _way(self, reach: int = 70) -> QPoint:
        return QPoint(self.random.randint(-reach, reach), self.random.randint(-reach, reach))

    def _key(self, key: Any, modifiers: Any = Qt.KeyboardModifier.NoModifier) -> None:
        # from wherever the focus is, as for a user
        QTest.keyClick(self.window, key, modifiers)

    def do_turn(self) -> None:
        viewport = self._viewport()
        middle = viewport.rect().center()
        keys = self.random.choice([Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.ShiftModifier])
        drag(viewport, middle, middle + self._way(), modifiers=keys, steps=3)

    def do_light_or_zoom(self) -> None:
        viewport = self._viewport()
        middle = viewport.rect().center()
        button = self.random.choice([Qt.MouseButton.RightButton, Qt.MouseButton.MiddleButton])
        drag(viewport, middle, middle + self._way(30), button=button, steps=3)

    def do_wheel(self) -> None:
        turn_wheel(self._viewport(), self.random.choice([-1, 1]))

    def do_interrupted_drag(self) -> None:
        """A key, a resize or a closed view while the button is down."""
        viewport = self._viewport()
        middle = viewport.rect().center()
        QTest.mousePress(viewport, LEFT, Qt.KeyboardModifier.NoModifier, middle)
        self._move(viewport, middle + QPoint(20, 10))
        self.random.choice(
            [self.do_technique_by_key, self.do_count, self.do_mode, self.do_resize, self.do_close]
        )()
        if viewport in [view_widget.viewport for view_widget in self.window.views.view_widgets]:
            self._move(viewport, middle + QPoint(40, 10))
            QTest.mouseRelease(viewport, LEFT, Qt.KeyboardModifier.NoModifier, middle + QPoint(40, 10))
        else:
            # the button is let go over what is there now
            QTest.mouseRelease(self.window, LEFT)

    def _move(self, widget: QWidget, to: QPoint) -> None:
        event = QMouseEvent(
            QEvent.Type.MouseMove, QPointF(to), QPointF(widget.mapToGlobal(to)), NONE, LEFT,
            Qt.KeyboardModifier.NoModifier,
        )  # fmt: skip
        QApplication.sendEvent(widget, event)
        QTest.qWait(5)

    def do_divider(self) -> None:
        divider = self.window.views.arrangement.divider
        if divider.isVisible():
            QTest.mousePress(divider, LEFT)
            start = divider.mapToGlobal(divider.rect().center())
            at = start + QPoint(self.random.randint(-80, 80), 0)
            event = QMouseEvent(
                QEvent.Type.MouseMove, QPointF(divider.mapFromGlobal(at)), QPointF(at), NONE, LEFT,
                Qt.KeyboardModifier.NoModifier,
            )  # fmt: skip
            QApplication.sendEvent(divider, event)
            QTest.mouseRelease(divider, LEFT)

    def do_count(self) -> None:
        self._key(self.random.choice(["1", "2", "2", "4"]), Qt.KeyboardModifier.ControlModifier)

    def do_mode(self) -> None:
        keys = [Qt.Key.Key_F6, Qt.Key.Key_F7, Qt.Key.Key_F8, Qt.Key.Key_F9]
        self._key(self.random.choice(keys))

    def do_next_view(self) -> None:
        self._key("N")

    def do_close(self) -> None:
        if self.random.random() < 0.5:
            self._key("W", Qt.KeyboardModifier.ControlModifier)
        elif len(self.window.views.view_widgets) > 1:
            view_widget = self.random.choice(self.window.views.shown_view_widgets)
            QTest.mouseClick(view_widget.header.close_button, LEFT)

    def do_technique_by_key(self) -> None:
        self._key(str(self.random.randint(1, 9)))

    def do_technique_by_header(self) -> None:
        box = self.random.choice(self.window.views.view_widgets).header.box
        slow = ("reference",)
        index = self.random.choice([i for i in range(box.count()) if box.itemData(i) not in slow])
        box.setCurrentIndex(index)
        box.activated.emit(index)

    def do_choose_sides(self) -> None:
        choose_side(self.window.store, self.random.randint(0, 1), self.random.randint(0, 3))

    def do_exchange(self) -> None:
        self.window.commands["compare.swap"].trigger()

    def do_with_vtk(self) -> None:
        self._key("K", Qt.KeyboardModifier.ControlModifier)

    def do_setting(self) -> None:
        scene = self.window.store.scene
        found = [p for p in current_technique(scene).parameters if p.cost <= Cost.PROGRAM]
        parameter = self.random.choice(found)
        low, high = parameter.minimum, parameter.maximum
        if parameter.kind == "bool":
            change_setting(self.window.store, parameter, self.random.random() < 0.5)
        elif parameter.kind == "choice" and parameter.choices:
            change_setting(self.window.store, parameter, self.random.choice(parameter.choices)[0])
        elif parameter.name == "step" or (low is not None and high is not None and parameter.kind == "float"):
            low, high = (0.3, 2.0) if parameter.name == "step" else (low, high)
            change_setting(
                self.window.store, parameter, round(self.random.uniform(low or 0.0, high or 1.0), 3)
            )

    def do_function(self) -> None:
        layer = self.window.store.scene.layer
        if layer is not None:
            function = layer.transfer_function.shifted(self.random.uniform(-8, 8))
            self.window.store.update(
                lambda scene: scene.with_layer(transfer_function=function), label="Colours"
            )

    def do_light(self) -> None:
        light = self.random.choice([Light(), Light(headlight=False)])
        self.window.store.update(lambda scene: replace(scene, light=light), label="Light")

    def do_crop(self) -> None:
        field = self.random.choice(self.window.data_panel.crop.fields)[self.random.randint(0, 1)]
        field.setValue(self.random.randint(field.minimum(), field.maximum()))

    def do_background(self) -> None:
        self.window.view_commands.set_background(self.random.choice([None, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)]))

    def do_parallel(self) -> None:
        self._key("O")

    def do_axis_view(self) -> None:
        self._key(self.random.choice("APLRSI"))

    def do_home(self) -> None:
        self._key(Qt.Key.Key_Home)

    def do_undo(self) -> None:
        for _ in range(self.random.randint(1, 3)):
            self._key("Z", Qt.KeyboardModifier.ControlModifier)

    def do_redo(self) -> None:
        for _ in range(self.random.randint(1, 2)):
            self._key("Y", Qt.KeyboardModifier.ControlModifier)

    def do_open(self) -> None:
        self.window.open(self.random.choice(self.files))

    def do_forget_volumes(self) -> None:
        self.window.documents.cache.clear()

    def do_save_and_open_session(self) -> None:
        path = self.folder / "kept.volviz.json"
        if not path.exists() or self.random.random() < 0.5:
            self.window.session_commands.save_path(path)
        else:
            self.window.session_commands.open_path(path)

    def do_resize(self) -> None:
        self.window.resize(self.random.randint(860, 1040), self.random.randint(600, 720))

    def do_float_a_panel(self) -> None:
        dock = self.random.choice(self.window.docks.all)
        dock.setFloating(not dock.isFloating())

    def do_show_or_hide_a_panel(self) -> None:
        # the ray inspector marks a pixel in the images
        docks = [dock for dock in self.window.docks.all if dock is not self.window.docks["ray"]]
        self.random.choice(docks).toggleViewAction().trigger()

    def do_reset_layout(self) -> None:
        self.window.docks.reset()

    def do_theme(self) -> None:
        self.window.edit_commands.set_theme(self.random.choice(["light", "dark"]))

    def do_annotations_for_a_moment(self) -> None:
        action = self.window.commands[
            f"view.{self.random.choice(['box', 'axes', 'marker', 'bar', 'handles'])}"
        ]
        action.trigger()
        QTest.qWait(30)
        action.trigger()

    # ------------------------------------------------------------------ rest

    def rest(self, seconds: float = 20.0) -> None:
        """Wait until nothing moves and everything is drawn."""
        end = time.monotonic() + seconds
        for box in self.window.findChildren(QMessageBox):
            raise Mistake(f"a message: {box.text()}")
        quiet = 0
        while quiet < 3:
            QTest.qWait(12)
            quiet = quiet + 1 if self._is_quiet() else 0
            if time.monotonic() > end:
                raise Mistake(
                    f"never at rest: {[p.controller.status for p in self.window.views.shown_view_widgets]}"
                )

    def _is_quiet(self) -> bool:
        views = self.window.views
        difference = views.arrangement.difference
        settled = not difference.isVisible() or difference.is_exact
        ready = self.window.documents.is_current and not self.window.documents.is_loading
        return views.is_complete and ready and not self.window.store.is_interacting and settled

    # ------------------------------------------------------------------ looking

    def look(self) -> None:
        """Compare what is seen with what the scene says."""
        if self.errors:
            raise Mistake(f"errors: {self.errors}")
        self.check_cameras()
        drawn = [self.check_view(view_widget) for view_widget in self.window.views.shown_view_widgets]
        self.check_screen()
        difference = self.window.views.arrangement.difference
        if difference.isVisible() and difference.comparison.map != "ssim":
            comparison = self.window.store.scene.comparison
            wanted = difference_image(
                *drawn, kind=comparison.map, channel=comparison.channel, limit=difference.limit
            ).image
            self._same("difference", array_of(difference.image), wanted, mean=1.0)

    def check_cameras(self) -> None:
        """One camera, everywhere the same to the last bit."""
        scene, view_widgets = self.window.store.scene, self.window.views.view_widgets
        if len(scene.views) != len(view_widgets):
            raise Mistake(f"{len(view_widgets)} panes for {len(scene.views)} views")
        cameras = {view.camera for view in scene.views}
        if len(cameras) != 1 or len({view_widget.viewport.view_camera for view_widget in view_widgets}) != 1:
            raise Mistake(f"cameras have drifted: {cameras}")
        seen, kept = view_widgets[0].viewport.view_camera, scene.view.camera
        if kept is None or not same_view(seen, kept):
            raise Mistake(f"the scene does not know the camera: {seen} seen, {kept} known")
        sizes = {view_widget.viewport.pixel_size for view_widget in self.window.views.shown_view_widgets}
        if len(sizes) != 1:
            raise Mistake(f"views of different sizes: {sizes}")

    def check_view(self, view_widget: ViewWidget) -> np.ndarray:
        """A view against the same drawn off-screen; gives the latter, shape (H, W, 3), uint8."""
        scene, volume = self.window.store.scene, self.window.documents.volume
        assert volume is not None
        wanted = drawn_image(
            replace(scene, active=view_widget.view),
            volume,
            view_widget.viewport.pixel_size,
            transparent=False,
        )[..., :3]
        self._same(f"view {view_widget.view}", array_of(view_widget.viewport.grabFramebuffer()), wanted)
        return wanted

    def check_screen(self) -> None:
        """What Qt put on the screen against the framebuffers."""
        views = self.window.views
        mode = self.window.store.scene.comparison.mode if len(views.view_widgets) > 1 else "side_by_side"
        if mode == "blink":
            return  # it changes while one looks
        screen = array_of(self.window.grab().toImage())
        ratio = round(self.window.devicePixelRatioF())
        origin = views.mapTo(self.window, QPoint(0, 0))

        def on_screen(rect: QRect) -> np.ndarray:
            at = rect.translated(origin)
            return screen[
                ratio * at.top() : ratio * (at.bottom() + 1), ratio * at.left() : ratio * (at.right() + 1)
            ]

        if mode == "difference":
            place = views.arrangement.difference.geometry()
            shown = array_of(views.arrangement.difference.image)
            seen = on_screen(place)
            width = ratio * (place.width() - 160)  # the bar
            self._same("difference on the screen", seen[:, :width], shown[:, :width])
            return
        line = views.arrangement.divider.geometry()
        for number, view_widget in enumerate(views.shown_view_widgets):
            place = QRect(view_widget.viewport.mapTo(views, QPoint(0, 0)), view_widget.viewport.size())
            seen, shown = on_screen(place), array_of(view_widget.viewport.grabFramebuffer())
            if mode == "wipe":
                left = slice(0, ratio * line.left())
                cut = left if number == 0 else slice(ratio * (line.right() + 1), ratio * place.width())
                seen, shown = seen[:, cut], shown[:, cut]
            self._same(f"view {view_widget.view} on the screen", seen, shown)

    def _same(self, what: str, seen: np.ndarray, wanted: np.ndarray, *, mean: float | None = None) -> None:
        if seen.shape != wanted.shape:
            raise Mistake(f"{what}: {seen.shape} instead of {wanted.shape}")
        apart = np.abs(seen.astype(int) - wanted)
        if (mean is None and (apart > LEVELS).mean() > EDGES) or (mean is not None and apart.mean() > mean):
            self.kept = (seen, wanted)
            techniques = [view.technique for view in self.window.store.scene.views]
            raise Mistake(
                f"{what}: {apart.max()} levels apart at most, {(apart > LEVELS).mean():.2%} of the values; "
                f"{techniques}, {self.window.store.scene.comparison.mode}"
            )


def main() -> None:
    """Work in a window of one's own; mistakes are printed and their images kept, then it goes on."""
    import tempfile

    from PIL import Image
    from PySide6.QtCore import QSettings

    from volviz.environment import prepare

    prepare()
    from volviz.custom_gl.vtk.handle import VolumeHandle
    from volviz_ui.app.application import make_application
    from volviz_ui.session.preferences import Preferences
    from volviz_ui.style.theme import Theme

    steps, seed = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1
    VolumeHandle.accumulates = False
    application = make_application()
    folder = Path(tempfile.mkdtemp())
    kept = QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat)
    preferences = Preferences(kept)
    preferences.asks_about_changes = False
    window = MainWindow(Theme(application, "dark"), preferences)
    window.resize(960, 680)
    window.show()
    QTest.qWaitForWindowExposed(window)
    window.activateWindow()
    user = RestlessUser(window, folder, seed)
    window.open(user.files[1])
    user.rest()
    found = 0
    for number in range(steps):
        try:
            user.step()
        except Mistake as mistake:
            found += 1
            print(f"step {number}: {mistake}\n    after {', '.join(user.log[-8:])}", flush=True)
            settings = [v.settings_for(v.technique, lambda: None) for v in window.store.scene.views]
            print(f"    {settings} {window.store.scene.light} {window.store.scene.clipping}", flush=True)
            for name, image in zip(("seen", "wanted"), getattr(user, "kept", ()), strict=False):
                Image.fromarray(image.astype(np.uint8)).save(folder / f"{number}-{name}.png")
            user.errors.clear()
            for box in window.findChildren(QMessageBox):
                box.close()
    print(f"{steps} steps with seed {seed}, {found} mistakes; pictures of mistakes in {folder}")
    window.close()
    sys.stdout.flush()
    import os

    os._exit(found > 0)


if __name__ == "__main__":
    main()
