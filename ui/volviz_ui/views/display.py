"""Between the store and the picture: every change of the scene becomes one update of what is drawn."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable
from dataclasses import replace
from typing import Any

from PySide6.QtCore import QObject, Qt, Signal

from volviz.custom_gl.scene_techniques import current_settings, current_technique
from volviz.custom_gl.technique import drawn_function
from volviz.framing import default_camera
from volviz.model.camera import Camera
from volviz.model.light import default_position
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.model.volume import Volume
from volviz_ui.documents import Documents
from volviz_ui.views.camera_moves import light_moved, light_turned
from volviz_ui.views.pacer import Pacer
from volviz_ui.views.viewport import Viewport, same_view

AddVolume = Callable[..., Any]


class Display(QObject):
    """Keeps one viewport showing one view of the scene.

    It is told of every change by `show_change` and `show_volume`, so that several displays hear of it in order.

    Parameters
    ----------
    store : Store
        The scene.
    documents : Documents
        Where the volume of the scene is.
    viewport : Viewport
        Where it is shown.
    add_volume : callable
        `volviz.add_volume`.
    view : int
        Number of the view; the first one frames the scene for all.
    """

    failed = Signal(object)
    recovered = Signal()
    status_changed = Signal(object)
    _status_arrived = Signal(object)

    def __init__(
        self,
        store: Store,
        documents: Documents,
        viewport: Viewport,
        add_volume: AddVolume,
        parent: QObject | None = None,
        *,
        view: int = 0,
    ) -> None:
        super().__init__(parent)
        self._store = store
        self._documents = documents
        self._viewport = viewport
        self._add_volume = add_volume
        self._view = view
        self._share = 1.0
        self._quality = "balanced"
        self._shows_handles = True
        self._last_error: BaseException | None = None
        self.handle: Any = None
        self.pacer = Pacer(store, self)
        self.pacer.completed.connect(viewport.render)
        self.pacer.frame_wanted.connect(viewport.render)
        self.pacer.failed.connect(self._on_failed)
        # the host tells its status while it draws; what listens must not run inside the drawing
        self._status_arrived.connect(self.status_changed, Qt.ConnectionType.QueuedConnection)
        viewport.camera_committed.connect(self._on_camera_committed)
        viewport.light_dragged.connect(self._on_light_dragged)
        viewport.light_wheeled.connect(self._on_light_wheeled)
        viewport.handle_dragged.connect(self._on_handle_dragged)
        viewport.frame_drawn.connect(self._on_frame_drawn)

    # ------------------------------------------------------------------ gestures

    def show_interaction(self, running: bool) -> None:
        """Something is being dragged: draw fast, complete nothing. Or it is over."""
        if self.handle is not None:
            if running:
                self.handle.begin_interaction()
            else:
                self.handle.end_interaction()
        if not running:
            self.pacer.go_on()
            self._viewport.render()

    @property
    def is_interacting(self) -> bool:
        """Whether something is being dragged."""
        return self._store.is_interacting

    def show_picture(self) -> None:
        """Bring the picture at hand to the screen."""
        self._viewport.render()

    def frame_seconds(self) -> float:
        """Wall time in seconds of a frame of VTK that shows the finished image again, without drawing the volume."""
        window = self._viewport.render_window
        begin = time.perf_counter()
        window.Render()
        window.WaitForCompletion()
        return time.perf_counter() - begin

    @property
    def share(self) -> float:
        """Part of the time of an interactive frame that this picture may take, 0..1."""
        return self._share

    @share.setter
    def share(self, share: float) -> None:
        self._share = share
        if self.handle is not None:
            self.handle.share = share

    # ------------------------------------------------------------------ quality, status

    @property
    def quality(self) -> str:
        """How much is given up while something moves: "balanced", "fast" or "full"."""
        return self._quality

    @quality.setter
    def quality(self, quality: str) -> None:
        self._quality = quality
        if self.handle is not None:
            self.handle.update(quality=quality)
            self._viewport.render()

    @property
    def shows_handles(self) -> bool:
        """Whether light and cut plane can be dragged in the picture, where the technique has them."""
        return self._shows_handles

    @shows_handles.setter
    def shows_handles(self, on: bool) -> None:
        self._shows_handles = on
        self._show_handles()
        self._viewport.render()

    def _show_handles(self) -> None:
        if self.handle is not None:
            self.handle.show_handles(self._shows_handles, listens=False)
            self._viewport.set_handles(self.handle.handles)

    @property
    def status(self) -> Any:
        """What the host says about the last picture, None without one."""
        return None if self.handle is None else self.handle.status

    @property
    def is_complete(self) -> bool:
        """Whether the viewport shows the complete picture of the present scene."""
        if self.handle is None:
            return False
        # what follows the full picture at rest only makes it smoother
        busy = self.pacer.is_busy and not self.handle.is_accumulating
        waits = self._viewport.awaits_frame or busy or self.is_interacting
        return bool(self.handle.status.complete) and not waits

    def opaque_depth(self, column: int, row: int) -> float | None:
        """Window depth of opaque geometry at a device pixel of the viewport, from the upper left; None = nothing."""
        return None if self.handle is None else self.handle.opaque_depth(column, row)

    # ------------------------------------------------------------------ from the scene to the picture

    def show_volume(self, volume: Volume | None) -> None:
        """Show another volume as the scene says, or none."""
        scene = self._store.scene
        if volume is None or scene.layer is None:
            self._remove()
            self._viewport.render()
            return
        self._apply(lambda: self._show_volume(volume, scene))

    def _show_volume(self, volume: Volume, scene: Scene) -> None:
        values = {
            "technique": current_technique(scene, self._view).id,
            "transfer_function": scene.layer.transfer_function if scene.layer else None,
            "settings": current_settings(scene, self._view),
            "light": scene.light,
            "clipping": scene.clipping,
        }
        if self.handle is None:
            self.handle = self._add_volume(self._viewport, volume, pacer=self.pacer, **values)
            self.handle.update(quality=self._quality)
            self.handle.share = self._share
            if self.is_interacting:
                self.handle.begin_interaction()
            self.handle.on_status.append(self._status_arrived.emit)
            self._show_handles()
        else:
            self.handle.update(volume=volume, **values)
        self._frame_scene(volume, scene)

    def _frame_scene(self, volume: Volume, scene: Scene) -> None:
        camera = scene.view_at(self._view).camera
        if camera is None and scene.layer is not None and self._view == 0:
            function = drawn_function(
                current_technique(scene), current_settings(scene), scene.layer.transfer_function
            )
            camera = default_camera(volume, self._viewport.pixel_size, transfer_function=function)
            self._commit(camera)
        if camera is not None:
            self._viewport.show_camera(camera)
        self._viewport.light_is_movable = "light" in current_technique(scene, self._view).handles

    def show_change(self, old: Scene, new: Scene) -> None:
        """Show what has changed in the scene."""
        if self.handle is None or not self._documents.is_ready_for(new):
            return
        if not self._documents.is_ready_for(old):
            return  # the volume changes: `show_volume` shows all of it at once
        changes: dict[str, Any] = {}
        before, after = old.view_at(self._view), new.view_at(self._view)
        if before.technique != after.technique:
            changes["technique"] = current_technique(new, self._view).id
            changes["settings"] = current_settings(new, self._view)
            self._viewport.light_is_movable = "light" in current_technique(new, self._view).handles
        elif current_settings(old, self._view) != current_settings(new, self._view):
            changes["technique"] = current_technique(new, self._view).id
            changes["settings"] = current_settings(new, self._view)
        if old.layer is not None and new.layer is not None:
            function = new.layer.transfer_function
            if old.layer.transfer_function is not function:
                changes["transfer_function"] = function
        if old.light != new.light:
            changes["light"] = new.light
        if old.clipping != new.clipping:
            changes["clipping"] = new.clipping
        camera = after.camera
        moving = any(viewport.is_moving for viewport in self._viewport.linked)
        if camera is not None and camera != before.camera and not moving:
            self._viewport.show_camera(camera)
        elif camera is None and self._documents.volume is not None:
            self._frame_scene(self._documents.volume, new)
        if changes:
            self._apply(lambda: self.handle.update(**changes))

    def _apply(self, change: Callable[[], Any]) -> None:
        try:
            change()
        except Exception as error:  # noqa: BLE001 - the window shows what went wrong and goes on
            self._on_failed(error)
        self._viewport.render()

    # ------------------------------------------------------------------ from the picture to the scene

    def show_camera(self, camera: Camera) -> None:
        """Look from another place and remember it."""
        self._viewport.show_camera(camera)
        self._commit(camera)

    def _commit(self, camera: Camera) -> None:
        self._store.update(lambda scene: scene.with_camera(camera), label="Camera", record=False)

    def _on_camera_committed(self, camera: Camera) -> None:
        known = self._store.scene.view_at(self._view).camera
        # what VTK says of a camera that has not moved may differ in the last digit
        if self._documents.volume is not None and not (known is not None and same_view(known, camera)):
            self._commit(camera)

    def _on_light_dragged(self, dx: float, dy: float) -> None:
        volume = self._documents.volume
        if volume is None:
            return
        camera, size = self._viewport.view_camera, (self._viewport.width(), self._viewport.height())
        self._move_light(
            lambda position: light_turned(position, volume.center, camera, dx, dy, size),
            self._viewport.drag_key,
        )

    def _on_light_wheeled(self, factor: float) -> None:
        volume = self._documents.volume
        if volume is None:
            return
        radius = 0.5 * sum(length**2 for length in volume.extent) ** 0.5
        self._move_light(
            lambda position: light_moved(position, volume.center, factor, radius), self._viewport.wheel_key
        )

    def _on_handle_dragged(self, values: dict[str, Any]) -> None:
        scene = self._store.scene
        if "light" in values:
            light = values["light"]
            self._store.update(
                lambda scene: replace(scene, light=light),
                label=self.tr("Move the light"),
                gesture=self._viewport.drag_key,
            )
            return
        info = current_technique(scene, self._view)
        if isinstance(values.get("settings"), info.settings):
            view = scene.views[self._view].with_settings(info.id, values["settings"])
            self._store.update(
                lambda scene: scene.with_view(self._view, settings=view.settings),
                label=self.tr("Move the cut plane"),
                gesture=self._viewport.drag_key,
            )

    def _move_light(self, move: Callable[[Any], Any], gesture: Hashable) -> None:
        volume = self._documents.volume
        light = self._store.scene.light
        if volume is None:
            return
        position = light.position if light.position is not None else default_position(volume.bounds)
        moved = replace(light, headlight=False, position=move(position))
        self._store.update(
            lambda scene: replace(scene, light=moved), label=self.tr("Move the light"), gesture=gesture
        )

    # ------------------------------------------------------------------ errors, end

    def _on_frame_drawn(self) -> None:
        error = None if self.handle is None else self.handle.error
        if error is not self._last_error:
            self._last_error = error
            if error is None:
                self.recovered.emit()
            else:
                self.failed.emit(error)

    def _on_failed(self, error: object) -> None:
        self.failed.emit(error)

    def _remove(self) -> None:
        self.pacer.stop()
        if self.handle is not None:
            self._viewport.set_handles(None)
            self.handle.remove()
            self.handle = None

    def close(self) -> None:
        """Release everything on the GPU while the context still lives."""
        window = self._viewport.render_window
        if window is not None and self.handle is not None:
            window.MakeCurrent()
        self._remove()
