"""Between the store and the image: every change of the scene becomes one update of what is drawn."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable
from dataclasses import replace
from typing import Any

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal

from volviz.custom_gl.arguments import keeping_surface_colors
from volviz.custom_gl.framing import default_camera, layers_camera
from volviz.custom_gl.resolve import resolve
from volviz.custom_gl.scene_techniques import (
    current_technique,
    faced,
    has_light,
    with_window_moved,
)
from volviz.custom_gl.vtk import add_spec
from volviz.model.camera import Camera
from volviz.model.cursor import cursor_of, stepped, turned, within
from volviz.model.light import default_position, position_beside_eye
from volviz.model.manipulators import as_vector
from volviz.model.store import Store
from volviz.volume_data.volume import Volume
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.views.camera_moves import faced_anew, light_moved, light_turned, point_on_plane
from volviz_ui.views.frame_scheduler import QtFrameScheduler
from volviz_ui.views.viewport import Viewport, same_view


class ViewController(QObject):
    """Keeps one viewport showing one view of the scene.

    It is told of every change by `show_change`.

    Parameters
    ----------
    store : Store
        The scene.
    documents : Documents
        Where the volume of the scene is.
    viewport : Viewport
        Where it is shown.
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
        parent: QObject | None = None,
        *,
        view: int = 0,
    ) -> None:
        super().__init__(parent)
        self._store = store
        self._documents = documents
        self._viewport = viewport
        self._view = view
        self._share = 1.0
        self._quality = "balanced"
        self._shows_manipulators = True
        self._last_error: BaseException | None = None
        self.handle: Any = None
        self.scheduler = QtFrameScheduler(store, self)
        self.scheduler.completed.connect(viewport.render)
        self.scheduler.frame_wanted.connect(viewport.render)
        self.scheduler.failed.connect(self._on_failed)
        # the host tells its status while it draws; what listens must not run inside the drawing
        self._status_arrived.connect(self.status_changed, Qt.ConnectionType.QueuedConnection)
        viewport.camera_committed.connect(self._on_camera_committed)
        viewport.light_dragged.connect(self._on_light_dragged)
        viewport.light_wheeled.connect(self._on_light_wheeled)
        viewport.manipulator_dragged.connect(self._on_manipulator_dragged)
        viewport.cursor_dragged.connect(self._on_cursor_dragged)
        viewport.tilt_dragged.connect(self._on_tilt_dragged)
        viewport.window_dragged.connect(self._on_window_dragged)
        viewport.stepped.connect(self._on_stepped)
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
            self.scheduler.go_on()
            self._viewport.render()

    @property
    def is_interacting(self) -> bool:
        """Whether something is being dragged."""
        return self._store.is_interacting

    def show_image(self) -> None:
        """Bring the image at hand to the screen."""
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
        """Part of the time of an interactive frame that this image may take, 0..1."""
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
    def shows_manipulators(self) -> bool:
        """Whether light and cut plane can be dragged in the image, where the technique has them."""
        return self._shows_manipulators

    @shows_manipulators.setter
    def shows_manipulators(self, on: bool) -> None:
        self._shows_manipulators = on
        self._show_manipulators()
        self._viewport.render()

    def _show_manipulators(self) -> None:
        if self.handle is not None:
            self.handle.show_manipulators(self._shows_manipulators, listens=False)
            self._viewport.set_manipulators(self.handle.manipulators)

    @property
    def status(self) -> Any:
        """What the host says about the last image, None without one."""
        return None if self.handle is None else self.handle.status

    @property
    def is_complete(self) -> bool:
        """Whether the viewport shows the complete image of the present scene."""
        if self.handle is None:
            return False
        # what follows the full image at rest only makes it smoother
        busy = self.scheduler.is_busy and not self.handle.is_accumulating
        waits = self._viewport.awaits_frame or busy or self.is_interacting
        return bool(self.handle.status.complete) and not waits

    @property
    def shows_present(self) -> bool:
        """Whether the viewport shows an image of the present scene, in whatever quality."""
        return self.handle is None or (self.handle.shows_present and not self._viewport.awaits_frame)

    def opaque_depth(self, column: int, row: int) -> float | None:
        """Window depth of opaque geometry at a device pixel of the viewport, from the upper left; None = nothing."""
        return None if self.handle is None else self.handle.opaque_depth(column, row)

    # ------------------------------------------------------------------ from the scene to the image

    def show_change(self, old: LoadedScene, new: LoadedScene) -> None:
        """Show what has changed."""
        if new.volume is None:
            if self.handle is not None:
                self._remove()
                self._viewport.render()
            return
        if new.volume is not old.volume:
            self._apply(lambda: self._show_volume(new))
        elif self.handle is not None:
            self._show_changes(old, new)
        self._viewport.light_is_movable = has_light(new.scene, self._view)
        self._viewport.shows_slice = faced(new.scene, self._view) is not None

    def _show_volume(self, new: LoadedScene) -> None:
        if self.handle is None:
            self.handle = add_spec(self._viewport, new.spec(self._view), new.volumes, pacer=self.scheduler)
            self.handle.quality = self._quality
            self.handle.share = self._share
            if self.is_interacting:
                self.handle.begin_interaction()
            self.handle.on_status.append(self._status_arrived.emit)
            self._show_manipulators()
        else:
            self.handle.show(new.spec(self._view), new.volumes)
        camera = new.scene.view_at(self._view).camera
        if camera is None:
            self._frame(new)
        else:
            self._viewport.show_camera(camera)

    def _show_changes(self, old: LoadedScene, new: LoadedScene) -> None:
        camera = new.scene.view_at(self._view).camera
        moving = any(viewport.is_moving for viewport in self._viewport.linked)
        turned = faced(new.scene, self._view) != faced(old.scene, self._view)
        if turned and camera is not None and new.scene.tilt != old.scene.tilt and new.volume is not None:
            facing = faced(new.scene, self._view)
            assert facing is not None
            about = cursor_of(new.scene, new.volume)
            self.show_camera(faced_anew(self._viewport.view_camera, *facing, about))
        elif camera is None or (turned and self._viewport.shows_slice):
            self._frame(new)
        elif not moving and (
            camera != old.scene.view_at(self._view).camera
            or not same_view(camera, self._viewport.view_camera)
        ):
            self._viewport.show_camera(camera)
        spec = new.spec(self._view)
        if spec != old.spec(self._view):
            spec = keeping_surface_colors(spec, self.handle.spec)
            self._apply(lambda: self.handle.show(spec, new.volumes))

    def _frame(self, shown: LoadedScene) -> None:
        """Look at what there is to be seen; the first view does it for all that share its camera."""
        if self._view == 0 or shown.scene.view_at(self._view).own_camera:
            camera = self.first_camera(shown)
            if camera is not None:
                self.show_camera(camera)

    def first_camera(self, shown: LoadedScene) -> Camera | None:
        """The camera that sees all that is visible, straight where a plane is faced; None without a volume."""
        if shown.volume is None:
            return None
        facing = faced(shown.scene, self._view)
        if facing is not None:
            return default_camera(shown.volume, self._viewport.pixel_size, facing=facing)
        seen = resolve(shown.spec(self._view), shown.volumes).seen
        return layers_camera(seen, self._viewport.pixel_size, stacks_from_faces=True)

    def _apply(self, change: Callable[[], Any]) -> None:
        try:
            change()
        except Exception as error:  # noqa: BLE001 - the window shows what went wrong and goes on
            self._on_failed(error)
        self._viewport.render()

    # ------------------------------------------------------------------ from the image to the scene

    def show_camera(self, camera: Camera) -> None:
        """Look from another place and remember it."""
        self._viewport.show_camera(camera)
        self._commit(camera)

    def _commit(self, camera: Camera) -> None:
        if self._documents.is_current:
            self._store.update(
                lambda scene: scene.with_camera(camera, self._view), label="Camera", record=False
            )

    @property
    def _movable(self) -> Volume | None:
        """The volume that is shown; None while another one is awaited, whose scene nobody sees yet."""
        return self._documents.volume if self._documents.is_current else None

    def _on_camera_committed(self, camera: Camera) -> None:
        known = self._store.scene.view_at(self._view).camera
        # what VTK says of a camera that has not moved may differ in the last digit
        if self._documents.volume is not None and not (known is not None and same_view(known, camera)):
            self._commit(camera)

    def _on_light_dragged(self, dx: float, dy: float) -> None:
        volume = self._movable
        if volume is None:
            return
        camera, size = self._viewport.view_camera, (self._viewport.width(), self._viewport.height())
        self._move_light(
            lambda position: light_turned(position, volume.center, camera, dx, dy, size),
            self._viewport.drag_key,
        )

    def _on_light_wheeled(self, factor: float) -> None:
        volume = self._movable
        if volume is None:
            return
        radius = 0.5 * sum(length**2 for length in volume.extent) ** 0.5
        self._move_light(
            lambda position: light_moved(position, volume.center, factor, radius), self._viewport.wheel_key
        )

    def _on_manipulator_dragged(self, values: dict[str, Any]) -> None:
        scene = self._store.scene
        if self._movable is None:
            return
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
        volume = self._movable
        light = self._store.scene.light
        if volume is None:
            return
        if light.beside_eye:
            position = position_beside_eye(
                volume.bounds, self._viewport.view_camera.matrices(1.0, (1.0, 2.0))[0]
            )
        else:
            position = light.position or default_position(volume.bounds)
        moved = replace(light, headlight=False, beside_eye=False, position=move(position))
        self._store.update(
            lambda scene: replace(scene, light=moved), label=self.tr("Move the light"), gesture=gesture
        )

    # ------------------------------------------------------------------ slices

    def set_cursor_at(self, position: QPointF, gesture: Hashable | None = None) -> None:
        """Let the cross-hair stand at a place, in pixels of the widget from the upper left.

        On a slice that is the place itself; in a picture of the volume beside slices what is seen there.
        """
        volume = self._movable
        if volume is None:
            return
        if not self._viewport.shows_slice:
            self._set_cursor_on_hit(position)
            return
        before = cursor_of(self._store.scene, volume)
        size = (self._viewport.width(), self._viewport.height())
        place = (position.x(), position.y())
        point = within(volume, point_on_plane(self._viewport.view_camera, place, size, before))
        self._move_cursor(point, gesture)

    def _set_cursor_on_hit(self, position: QPointF) -> None:
        """Let the cross-hair stand on what is seen of the volume, where slices are shown beside it."""
        volume, scene = self._movable, self._store.scene
        if volume is None or self.handle is None or all(view.own_camera is False for view in scene.views):
            return
        ratio = self._viewport.devicePixelRatioF()
        picked = self.handle.pick(position.x() * ratio, position.y() * ratio)
        if picked is not None:
            self._move_cursor(within(volume, picked.position), None)

    def _on_cursor_dragged(self, position: QPointF) -> None:
        self.set_cursor_at(position, self._viewport.drag_key)

    def _on_tilt_dragged(self, position: QPointF) -> None:
        """Turn all slices about the normal of this one, until a line of the cross-hair goes through the pointer."""
        volume, facing = self._movable, faced(self._store.scene, self._view)
        if volume is None or facing is None:
            return
        middle = np.asarray(cursor_of(self._store.scene, volume))
        size = (self._viewport.width(), self._viewport.height())
        place = (position.x(), position.y())
        way = np.subtract(point_on_plane(self._viewport.view_camera, place, size, as_vector(middle)), middle)
        scene, least = self._store.scene, None
        for number in range(len(scene.views)):
            other = faced(scene, number)
            if other is None or number == self._view:
                continue
            line = np.cross(other[0], facing[0])
            angle = float(np.degrees(np.arctan2(np.cross(line, way) @ facing[0], line @ way)))
            # a line has two ends: half a turn is none; the line that is nearest is the one that is held
            angle = (angle + 90.0) % 180.0 - 90.0
            if np.linalg.norm(line) > 1e-6 and (least is None or abs(angle) < abs(least)):
                least = angle
        if least is not None:
            tilt = turned(scene.tilt, facing[0], least)
            self._store.update(
                lambda scene: replace(scene, tilt=tilt), label=self.tr("Tilt the slices"),
                gesture=self._viewport.drag_key,
            )  # fmt: skip

    def _on_stepped(self, notches: float) -> None:
        volume = self._movable
        if volume is not None:
            before = cursor_of(self._store.scene, volume)
            direction = self._viewport.view_camera.direction
            self._move_cursor(stepped(volume, before, direction, notches), self._viewport.wheel_key)

    def _move_cursor(self, point: tuple[float, float, float], gesture: Hashable | None) -> None:
        self._store.update(
            lambda scene: replace(scene, cursor=point), label=self.tr("Move the cross-hair"), gesture=gesture
        )

    def _on_window_dragged(self, right: float, up: float) -> None:
        """Wider to the right; upwards darker, as level goes up."""
        volume = self._movable
        if volume is not None:
            self._store.update(
                lambda scene: with_window_moved(scene, volume, self._view, right, up),
                label=self.tr("Change the grey window"),
                gesture=self._viewport.drag_key,
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
        self.scheduler.stop()
        if self.handle is not None:
            self._viewport.set_manipulators(None)
            self.handle.remove()
            self.handle = None

    def close(self) -> None:
        """Release everything on the GPU while the context still lives."""
        window = self._viewport.render_window
        if window is not None and self.handle is not None:
            window.MakeCurrent()
        self._remove()
