"""The View menu: cameras, what stands around the volume, panels, full screen."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from PySide6.QtCore import QByteArray, QObject, Qt, Signal
from PySide6.QtGui import QColor, QKeySequence
from PySide6.QtWidgets import QToolBar

from volviz.custom_gl.scene_techniques import with_slices, without_slices
from volviz.model.camera import Camera
from volviz.model.scene import Color, Layout, Scene
from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Command, Menu, has_volume
from volviz_ui.commands.looks import LookCommands
from volviz_ui.commands.time import TimeCommands
from volviz_ui.editors.simple import chosen_color
from volviz_ui.views.camera_moves import axis_camera
from volviz_ui.widgets.docks import Docks

USUAL_BACKGROUNDS: tuple[Color | None, ...] = (None, (0.0, 0.0, 0.0), (0.5, 0.5, 0.5), (1.0, 1.0, 1.0))
SHOWN_AT_FIRST = {
    "box": False,
    "axes": False,
    "marker": True,
    "bar": False,
    "scale": False,
    "letters": True,
    "cross_hair": True,
    "measurements": True,
    "legend": False,
    "handles": True,
}


class ViewCommands(QObject):
    """Looks at the scene in other ways for the window."""

    quality_changed = Signal(str)

    def __init__(self, context: AppContext, looks: LookCommands, time: TimeCommands) -> None:
        super().__init__(context.window)
        self._context = context
        self._before_presentation: tuple[QByteArray, bool] | None = None
        self._looks = looks
        self._time = time

    def menu(self) -> Menu:
        """The table of its commands."""
        tr, docks = self.tr, self._context.docks
        return Menu(
            tr("&View"),
            [
                self._looks.menu(),
                Command(
                    "view.reset_camera", tr("Re&set camera"), tr("See the whole volume again"), self.reset_camera,
                    keys=("Home", "F"), icon="frame-corners", enabled=has_volume,
                ),
                Menu(tr("&Look from"), self._axis_views()),
                Menu(tr("Sl&ices"), self._slice_layouts()),
                self._time.menu(),
                Command(
                    "view.parallel", tr("Para&llel projection"), tr("Without perspective"), self.set_parallel,
                    keys=("O",), enabled=has_volume, checked=lambda state: is_parallel(state.scene),
                ),
                None,
                self._switch("box", tr("&Box"), tr("Outline of the volume"), "B", "bounding-box"),
                self._switch(
                    "axes", tr("A&xes with units"), tr("Axes around the volume, in world units"), "X", "ruler"
                ),
                self._switch(
                    "marker", tr("&Orientation marker"), tr("Directions of the world, in the corner"), "M", "compass"
                ),
                self._switch("bar", tr("&Colour bar"), tr("Colours of the values, with numbers"), "C"),
                self._switch("scale", tr("Scal&e bar"), tr("A line of known length, in the corner"), "U"),
                self._switch(
                    "measurements", tr("&Measurements"), tr("What was measured and marked, with its numbers"), "Shift+M"
                ),
                self._switch(
                    "legend", tr("Le&gend"), tr("Names and colours of labels, and of several layers"), "G"
                ),
                self._switch(
                    "handles", tr("&Handles"),
                    tr("Knobs in the picture that move the light and the cut plane, where the technique has them"), "H",
                ),
                Menu(tr("Back&ground"), self._backgrounds()),
                None,
                Menu(
                    tr("&Panels"),
                    [
                        *(panel_command(docks, name) for name in docks.names),
                        None,
                        Command(
                            "view.reset_layout", tr("Reset la&yout"), tr("All panels back to their places"), docks.reset
                        ),
                    ],
                ),
                Command(
                    "view.presentation", tr("Presentati&on"),
                    tr("The picture alone on the whole screen, with larger letters; Escape ends it"),
                    self.set_presentation, keys=("F5",), checked=lambda state: "presentation" in state.shown,
                ),
                Command(
                    "view.full_screen", tr("&Full screen"), tr("Use the whole screen"), self.set_full_screen,
                    keys=(QKeySequence.StandardKey.FullScreen, "F11"), icon="corners-out",
                    checked=lambda state: "full_screen" in state.shown,
                ),
            ],
        )  # fmt: skip

    def _axis_views(self) -> list[Command]:
        tip = self.tr("Look along an axis of the world")
        return [
            Command(
                f"view.from.{letter}", words, tip, partial(self.show_axis_view, letter), keys=(letter,),
                enabled=has_volume,
            )
            for letter, words in (
                ("A", self.tr("From &anterior (front)")),
                ("P", self.tr("From &posterior (back)")),
                ("L", self.tr("From &left")),
                ("R", self.tr("From &right")),
                ("S", self.tr("From &superior (above)")),
                ("I", self.tr("From &inferior (below)")),
            )
        ]  # fmt: skip

    def _slice_layouts(self) -> list[Command | None]:
        def layout(name: Layout, words: str, tip: str, key: str) -> Command:
            return Command(
                f"view.slices.{name}", words, tip, partial(self.show_slices, name), keys=(key,), icon="grid-four",
                enabled=has_volume,
                checked=lambda state: state.scene.layout == name and any(v.own_camera for v in state.scene.views),
            )  # fmt: skip

        tr = self.tr
        return [
            layout("grid", tr("Three slices and the volume, &equal"),
                   tr("Axial, coronal and sagittal slices beside the volume; click again for the volume alone"),
                   "Ctrl+D"),
            layout("large", tr("Three slices beside a &large volume"),
                   tr("The volume large, three slices small at its right"), "Ctrl+Shift+D"),
            None,
            self._switch("cross_hair", tr("&Cross-hair"), tr("Where the slices meet")),
            self._switch("letters", tr("L&etters at the edges"), tr("Right and left, front and back, head and feet")),
            Command(
                "view.slices.centre", tr("Cross-hair to the &middle"), tr("Back to the middle of the volume"),
                self.center_cursor, enabled=lambda state: state.scene.cursor is not None,
            ),
            Command(
                "view.slices.straighten", tr("&Straighten"), tr("Slices across the axes of the world again"),
                self.straighten, enabled=lambda state: state.scene.tilt is not None,
            ),
        ]  # fmt: skip

    def show_slices(self, layout: Layout, on: bool) -> None:
        """Slices of three directions beside the volume, or the volume alone again."""
        self._context.store.update(
            (lambda scene: with_slices(scene, layout)) if on else without_slices, label=self.tr("Slices")
        )

    def center_cursor(self) -> None:
        """Let the cross-hair stand in the middle of the volume."""
        self._context.store.update(
            lambda scene: replace(scene, cursor=None), label=self.tr("Cross-hair to the middle")
        )

    def straighten(self) -> None:
        """Let slices lie across the axes of the world again."""
        self._context.store.update(lambda scene: replace(scene, tilt=None), label=self.tr("Straighten"))

    def _switch(self, name: str, words: str, tip: str, key: str = "", icon: str = "") -> Command:
        return Command(
            f"view.{name}", words, tip, partial(self.show_annotations, name), keys=(key,) if key else (), icon=icon,
            checked=lambda state: name in state.shown,
        )  # fmt: skip

    def _backgrounds(self) -> list[Command]:
        tip = self.tr("One colour behind the volume, or the usual gradient")

        def choice(name: str, words: str, color: Color | None) -> Command:
            return Command(
                f"view.background.{name}", words, tip, partial(self.set_background, color), group="background",
                checked=lambda state: state.scene.background == color,
            )  # fmt: skip

        return [
            choice("gradient", self.tr("Gradient"), None),
            choice("black", self.tr("Black"), (0.0, 0.0, 0.0)),
            choice("grey", self.tr("Grey"), (0.5, 0.5, 0.5)),
            choice("white", self.tr("White"), (1.0, 1.0, 1.0)),
            Command(
                "view.background.own", self.tr("Own &colour…"), self.tr("Choose the colour behind the volume"),
                self.choose_background, group="background",
                checked=lambda state: state.scene.background not in USUAL_BACKGROUNDS,
            ),
        ]  # fmt: skip

    # ------------------------------------------------------------------ cameras

    def reset_camera(self) -> None:
        """See all that is visible, a little from the side, as at first; a slice whole."""
        controller = self._context.views.active.controller
        camera = controller.first_camera(self._context.documents.shown)
        if camera is None:
            return
        if not camera.parallel:
            camera = projected(camera, parallel=is_parallel(self._context.store.scene))
        controller.show_camera(camera)

    def show_axis_view(self, letter: str) -> None:
        """Look from anterior, posterior, left, right, superior or inferior."""
        volume = self._context.documents.volume
        if volume is not None:
            self._show_camera(axis_camera(volume, letter, self._context.views.first.viewport.aspect))

    def _show_camera(self, camera: Camera) -> None:
        """Look through another camera in the present projection."""
        self._context.views.first.controller.show_camera(
            projected(camera, parallel=is_parallel(self._context.store.scene))
        )

    def set_parallel(self, on: bool) -> None:
        """Parallel projection or perspective; what lies at the focal point keeps its size."""
        if self._context.documents.volume is not None:
            first = self._context.views.first
            first.controller.show_camera(projected(first.viewport.view_camera, parallel=on))

    # ------------------------------------------------------------------ what stands around

    def show_annotations(self, name: str, on: bool) -> None:
        """Switch box, axes, orientation marker, colour bar or handles, and remember that."""
        self._context.preferences.set_shows(name, on)
        self._show(name, on)

    def _show(self, name: str, on: bool) -> None:
        if name == "handles":
            self._context.views.shows_manipulators = on
        else:
            self._context.views.show_annotations(name, on)

    def restore(self) -> None:
        """Show what was shown when the program was closed."""
        preferences = self._context.preferences
        for name, default in SHOWN_AT_FIRST.items():
            self._show(name, preferences.shows(name, default))
        self.set_quality(preferences.quality)

    def choose_background(self) -> None:
        """Ask for the colour behind the volume."""
        color = QColor.fromRgbF(*(self._context.store.scene.background or (0.5, 0.5, 0.5)))
        chosen = chosen_color(self._context.window, color, self.tr("Background"))
        if chosen is not None:
            self.set_background((chosen.redF(), chosen.greenF(), chosen.blueF()))

    def set_background(self, color: Color | None) -> None:
        """One colour behind the volume, or the usual gradient."""
        self._context.store.update(
            lambda scene: replace(scene, background=color), label=self.tr("Background")
        )

    def set_quality(self, quality: str) -> None:
        """Give up more or less while something moves."""
        self._context.preferences.quality = quality
        self._context.views.quality = quality
        self.quality_changed.emit(quality)

    def set_presentation(self, on: bool) -> None:
        """The picture alone on the whole screen, or the window with its panels again."""
        window, docks = self._context.window, self._context.docks
        if on == self._context.views.is_presented:
            return
        around = [window.menuBar(), window.statusBar(), *window.findChildren(QToolBar)]
        if on:
            self._before_presentation = (docks.state(), window.isFullScreen())
            for part in (*docks.all, *around):
                part.hide()
        self._context.views.is_presented = on
        if not on and self._before_presentation is not None:
            state, was_full = self._before_presentation
            for part in around:
                part.show()
            docks.restore(state)
            self.set_full_screen(was_full)
            self._before_presentation = None
        elif on:
            self.set_full_screen(True)

    def set_full_screen(self, on: bool) -> None:
        """Use the whole screen, or the window again."""
        window, full = self._context.window, Qt.WindowState.WindowFullScreen
        window.setWindowState(window.windowState() | full if on else window.windowState() & ~full)


def panel_command(docks: Docks, name: str) -> Command:
    """The command that opens and closes a panel."""
    dock = docks[name]
    text = docks.tr("%1 panel").replace("%1", dock.windowTitle())
    return Command(
        f"panel.{name}", text, dock.tip, partial(docks.switch, name), keys=dock.keys,
        checked=lambda state: f"panel.{name}" in state.shown,
    )  # fmt: skip


def is_parallel(scene: Scene) -> bool:
    """Whether the scene is seen in parallel projection."""
    return scene.view.camera is not None and scene.view.camera.parallel


def projected(camera: Camera, *, parallel: bool) -> Camera:
    """The camera in parallel projection or perspective; what lies at the focal point keeps its size."""
    return replace(camera, parallel=parallel, parallel_scale=camera.scale if parallel else None)
