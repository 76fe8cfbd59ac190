"""Another look: the ways of showing the volume that suit its values, one after the other."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QObject, QTimer
from PySide6.QtGui import QImage

from volviz.custom_gl.scene_techniques import can_take_looks, with_look
from volviz.model.looks.choice import looks
from volviz.model.looks.look import Look
from volviz.model.scene import Scene
from volviz.model.transfer.presets import Preset
from volviz.volume_data.volume import Volume
from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Command, Menu, State
from volviz_ui.library_words import translated
from volviz_ui.session.loaded_scene import LoadedScene, volume_of
from volviz_ui.transfer_editor.preset_popup import ThumbnailProvider
from volviz_ui.views.look_strip import LookStrip
from volviz_ui.views.viewport import same_view
from volviz_ui.widgets.binding import show_value


class LookCommands(QObject):
    """Takes looks, and shows them in a strip over the views.

    Parameters
    ----------
    context : AppContext
    thumbnail : callable
        Draws a small image of a look on the user's volume.

    Attributes
    ----------
    strip : LookStrip
    is_drawing : bool
        Images of looks are still missing.
    """

    def __init__(self, context: AppContext, thumbnail: ThumbnailProvider) -> None:
        super().__init__(context.window)
        self._context = context
        self._thumbnail = thumbnail
        self._steps = 0
        self.strip = LookStrip(context.views)
        self.strip.chosen.connect(self.take)
        # one image a turn of the event loop
        self._idle = QTimer(self)
        self._idle.setSingleShot(True)
        self._idle.setInterval(0)
        self._idle.timeout.connect(self._draw_next)
        self._undrawn: list[int] = []
        self.is_drawing = False
        show_value(context.documents, volume_of, self._forget)
        context.documents.changed.connect(self._on_changed)

    def menu(self) -> Menu:
        """The table of its commands."""
        tr = self.tr
        return Menu(
            tr("Loo&ks"),
            [
                Command(
                    "view.next_look", tr("&Another look"),
                    tr("Show the volume in another way that suits it: skin, bone, tissue, surface, X-ray …"),
                    partial(self.step, 1), keys=("Space",), icon="eye", enabled=_can_take, only_in_views=True,
                ),
                Command(
                    "view.previous_look", tr("&Previous look"), tr("Back to the way of showing it before"),
                    partial(self.step, -1), keys=("Shift+Space",), enabled=_can_take, only_in_views=True,
                ),
            ],
        )  # fmt: skip

    def step(self, steps: int) -> None:
        """Take the next look, or the one before; they are chosen on a worker where that has not been done."""
        volume = self._context.documents.volume
        if volume is None:
            return
        self._steps += steps
        task = self._context.workers.start(lambda _task: tuple(looks(volume).values()), key="looks")
        task.succeeded.connect(lambda found: self._on_found(volume, found))

    def take(self, look: Look) -> None:
        """Show the volume with a look; a step of the history. A view that nobody has turned is framed anew."""
        label = self.tr("Look: %1").replace("%1", translated(look.label))
        documents, store = self._context.documents, self._context.store
        controller = self._context.views.first.controller
        camera, first = store.scene.view_at(0).camera, controller.first_camera(documents.shown)
        store.update(lambda scene: with_look(scene, look), label=label)
        if camera is not None and first is not None and same_view(camera, first):
            controller.show_camera(controller.first_camera(documents.shown) or first)

    def _on_found(self, volume: Volume, found: tuple[Look, ...]) -> None:
        steps, self._steps = self._steps, 0
        scene = self._context.store.scene
        if volume is not self._context.documents.volume or not can_take_looks(scene):
            return
        if found != self.strip.looks:
            self._undrawn, self.is_drawing = list(range(len(found))), True
            self._idle.start()
        self.strip.show_looks(found)
        now = _shown(scene, found)
        before = (-1 if steps > 0 else 0) if now is None else now
        self.take(found[(before + steps) % len(found)])
        self._mark(self._context.store.scene)

    def _forget(self, _volume: Volume | None) -> None:
        self._idle.stop()
        self.is_drawing = False
        self.strip.clear()

    def _on_changed(self, _old: LoadedScene, new: LoadedScene) -> None:
        self._mark(new.scene)

    def _mark(self, scene: Scene) -> None:
        if not self.strip.isHidden():
            self.strip.mark(_shown(scene, self.strip.looks))

    def _draw_next(self) -> None:
        self.is_drawing = bool(self._undrawn)
        if not self._undrawn:
            return
        number = self._undrawn.pop(0)
        look = self.strip.looks[number]
        preset = Preset(
            look.id, look.label, look.description, look.transfer_function, technique=look.technique,
            settings=look.settings,
        )  # fmt: skip
        self._thumbnail(preset, look.transfer_function, self._deliver(look, number))

    def _deliver(self, look: Look, number: int) -> Callable[[QImage], None]:
        def deliver(image: QImage) -> None:
            if look in self.strip.looks:
                self.strip.show_image(number, image)
                self._idle.start()

        return deliver


def _can_take(state: State) -> bool:
    return state.has_volume and can_take_looks(state.scene)


def _shown(scene: Scene, found: tuple[Look, ...]) -> int | None:
    """Number of the look that the scene has."""
    return next((n for n, look in enumerate(found) if with_look(scene, look) == scene), None)
