"""The viewport: PyVista's interactor with our own mouse, drawn when something changed and never otherwise."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QEvent, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QImage, QKeyEvent, QMouseEvent, QNativeGestureEvent, QWheelEvent
from PySide6.QtWidgets import QApplication, QWidget
from pyvistaqt import QtInteractor

from volviz.model.camera import Camera
from volviz.model.store import Store
from volviz_ui.views.camera_moves import TURN, WHEEL_STEP, panned, rotated, zoomed, zoomed_at

if TYPE_CHECKING:
    from volviz.custom_gl.vtk.manipulators import Manipulators

ARROWS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}
"""Where the volume goes with an arrow, right and down."""
POINT_KEYS = (Qt.Key.Key_Escape, Qt.Key.Key_Backspace, Qt.Key.Key_Return, Qt.Key.Key_Enter)
"""Keys for points that are being placed."""
ARROW_TURN = 5.0
"""Degrees that one press of an arrow turns the view."""

WHEEL_REST_MS = 250
"""A turn of the wheel is over when this long nothing more has come."""


class Drag(Enum):
    """What a drag does."""

    ROTATE = "rotate"
    PAN = "pan"
    ZOOM = "zoom"
    LIGHT = "light"
    HANDLE = "handle"
    FUNCTION = "function"
    CURSOR = "cursor"
    WINDOW = "window"
    PLACE = "place"
    POINT = "point"
    TILT = "tilt"


#: What begins with a press that is a click when nothing moves.
CLICKS = frozenset({Drag.ROTATE, Drag.CURSOR, Drag.PLACE, Drag.POINT, Drag.TILT})


class Viewport(QtInteractor):
    """Shows the scene; turns mouse events into moves of the camera and of the light.

    VTK's interactor gets no event at all: neither its styles nor PyVista's keys can interfere. The camera
    belongs to VTK; `camera_committed` is emitted once when a move is over.

    Parameters
    ----------
    store : Store
        Is told of drags and turns of the wheel, by the keys `drag_key` and `wheel_key`.
    view : int
        Number of the view, part of these keys.
    """

    camera_committed = Signal(object)
    camera_moved = Signal()
    """The mouse has moved the camera; nothing is committed yet."""
    pressed = Signal()
    """A button has gone down in the image."""
    light_dragged = Signal(float, float)
    """Pixels right and down since the last time."""
    manipulator_dragged = Signal(object)
    """What has become of light or settings, by name."""
    light_wheeled = Signal(float)
    """Factor by which the light comes nearer."""
    function_drag_started = Signal()
    function_dragged = Signal(float, float)
    """How far right and up the drag has gone, in fractions of the viewport's size."""
    function_drag_ended = Signal(bool)
    """Whether Escape has cancelled it."""
    cursor_dragged = Signal(QPointF)
    """Where on a slice the cross-hair is to stand."""
    window_dragged = Signal(float, float)
    """How far right and up the grey window of slices was dragged since the last time, in fractions of the viewport."""
    stepped = Signal(float)
    """Through how many slices the wheel has turned, away from the viewer."""
    pointer_moved = Signal(QPointF)
    clicked = Signal(QPointF)
    """The left button was pressed and let go without a move between."""
    pointer_left = Signal()
    double_clicked = Signal(QPointF)
    render_asked = Signal()
    """An image was asked for: camera or scene may be others."""
    point_dragged = Signal(QPointF)
    """Where a point of a measurement is to lie."""
    tilt_dragged = Signal(QPointF)
    """Where a knob of the cross-hair is to lie."""
    point_key_pressed = Signal(int)
    """A key for the points that are being placed: Escape, Backspace or Enter."""
    frame_drawn = Signal()
    unseen_drawn = Signal(QImage)
    """The image of a viewport that is covered, each time that it was drawn."""

    # PyVista asks for images while it is being made
    _covered = False

    def __init__(self, store: Store, view: int, parent: QWidget | None = None) -> None:
        super().__init__(parent, auto_update=False, multi_samples=0)
        self.setAcceptDrops(False)  # the window takes dropped files, wherever they fall
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName(self.tr("Picture of the volume"))
        self.iren.interactor.SetInteractorStyle(None)
        self.light_is_movable = False
        self.shows_slice = False
        """Whether a plane is faced here: drags move cross-hair and window, the wheel goes through the slices."""
        self.grab_point: Callable[[QPointF], bool] = lambda _position: False
        """Takes up a point of a measurement; whether there is one."""
        self.grab_knob: Callable[[QPointF], bool] = lambda _position: False
        """Takes up a knob of the cross-hair; whether there is one."""
        self._places_points = False
        self.linked: list[Viewport] = [self]
        self._own_camera = self.renderer.camera
        self.manipulators: Manipulators | None = None
        self.frames = 0
        self.awaits_frame = False
        self._drag: Drag | None = None
        self._last = QPointF()
        self._start = QPointF()
        self._placed: QPointF | None = None
        """Where the drag began that has placed a point already."""
        self._store = store
        self.drag_key, self.wheel_key = ("drag", view), ("wheel", view)
        self._wheel_rest = QTimer(self)
        self._wheel_rest.setSingleShot(True)
        self._wheel_rest.setInterval(WHEEL_REST_MS)
        self._wheel_rest.timeout.connect(self._end_wheel)
        self._unseen = QTimer(self)
        self._unseen.setSingleShot(True)
        self._unseen.setInterval(0)
        self._unseen.timeout.connect(self._draw_unseen)

    # ------------------------------------------------------------------ drawing

    def render(self, *_args: Any, **_keywords: Any) -> None:
        """Ask for an image; several requests before the next turn of the event loop are one."""
        if not getattr(self, "_closed", False):
            self.awaits_frame = True
            self.render_asked.emit()
            if self._covered:
                self._unseen.start()
            else:
                self.update()

    def paintGL(self) -> None:
        """Draw, and tell those who count or report."""
        self.awaits_frame = False
        super().paintGL()
        self.frames += 1
        self.frame_drawn.emit()

    @property
    def is_covered(self) -> bool:
        """Whether something else lies over the whole image, which is drawn all the same."""
        return self._covered

    @is_covered.setter
    def is_covered(self, covered: bool) -> None:
        if covered != self._covered:
            self._covered = covered
            self.render()

    def _draw_unseen(self) -> None:
        """Qt paints nothing that lies below something else: draw into our own framebuffer."""
        if self._covered and self.isVisible() and not getattr(self, "_closed", False):
            self.unseen_drawn.emit(self.grabFramebuffer())

    @property
    def pixel_size(self) -> tuple[int, int]:
        """Width and height in device pixels."""
        ratio = self.devicePixelRatioF()
        return max(1, round(self.width() * ratio)), max(1, round(self.height() * ratio))

    @property
    def aspect(self) -> float:
        """Width divided by height."""
        return max(self.width(), 1) / max(self.height(), 1)

    # ------------------------------------------------------------------ points

    @property
    def places_points(self) -> bool:
        """Whether clicks place points instead of anything else."""
        return self._places_points

    @places_points.setter
    def places_points(self, on: bool) -> None:
        self._places_points = on
        self._show_grip()

    # ------------------------------------------------------------------ camera

    @property
    def view_camera(self) -> Camera:
        """The camera as it is in the image now."""
        camera = self.renderer.GetActiveCamera()
        return Camera(
            camera.GetPosition(),
            camera.GetFocalPoint(),
            camera.GetViewUp(),
            camera.GetViewAngle(),
            bool(camera.GetParallelProjection()),
            camera.GetParallelScale() if camera.GetParallelProjection() else None,
        )

    def show_camera(self, camera: Camera) -> None:
        """Look from another place; nothing is committed."""
        # VTK normalises the view up anew each time: the same view given back must not drift by a rounding
        if not same_view(self.view_camera, camera):
            vtk_camera = self.renderer.GetActiveCamera()
            vtk_camera.SetPosition(*camera.position)
            vtk_camera.SetFocalPoint(*camera.focal_point)
            vtk_camera.SetViewUp(*camera.view_up)
            vtk_camera.SetViewAngle(camera.view_angle)
            vtk_camera.SetParallelProjection(camera.parallel)
            vtk_camera.SetParallelScale(camera.scale)
        # PyVista frames the scene by itself as long as it believes that nobody has set a camera
        self.renderer.camera_set = True
        self._reset_clipping_range()
        self.render()

    def link_camera(self, leader: Viewport) -> None:
        """Look through the camera of another viewport from now on: one camera cannot drift apart."""
        self.renderer.camera = leader.renderer.camera
        leader.linked.append(self)
        self.linked = leader.linked

    def unlink_camera(self) -> None:
        """Have a camera of one's own again."""
        if self.renderer.camera is not self._own_camera:
            self.linked.remove(self)
            self.linked = [self]
            self.renderer.camera = self._own_camera

    def _reset_clipping_range(self) -> None:
        """Near and far plane around what any of the viewports with this camera shows."""
        if len(self.linked) == 1:
            self.renderer.ResetCameraClippingRange()
            return
        boxes = np.array([view.renderer.ComputeVisiblePropBounds() for view in self.linked])
        boxes = boxes[boxes[:, 0] <= boxes[:, 1]]
        if len(boxes):
            low, high = boxes[:, ::2].min(axis=0), boxes[:, 1::2].max(axis=0)
            self.renderer.ResetCameraClippingRange(np.stack([low, high], axis=1).ravel().tolist())

    def _move_camera(self, camera: Camera) -> None:
        self.show_camera(camera)
        self.camera_moved.emit()

    @property
    def is_moving(self) -> bool:
        """Whether a drag or a turn of the wheel is under way."""
        return self._store.has_gesture(self.drag_key) or self._store.has_gesture(self.wheel_key)

    # ------------------------------------------------------------------ mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin what the button stands for; nothing changes before the pointer moves."""
        self.setFocus(Qt.FocusReason.MouseFocusReason)
        self.pressed.emit()
        if self._drag is None:
            self._drag = self._meaning(event)
            self._last = self._start = event.position()
            self._placed = None
            if self._drag is Drag.HANDLE:
                self._show_grip()
        event.accept()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """The second click of a double-click is a click, and asks to look at what was clicked on."""
        self.mousePressEvent(event)
        if self._places_points and event.button() == Qt.MouseButton.LeftButton:
            # the first click has placed the last point
            self._drag = None
            self.double_clicked.emit(event.position())
        elif self._drag is Drag.ROTATE:
            self.double_clicked.emit(event.position())

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Move camera or light, or tell where the pointer is."""
        if self._drag is None or event.buttons() == Qt.MouseButton.NoButton:
            if self._drag is not None:
                # the button was let go where nobody could tell us
                self._end_drag(cancelled=False)
            self._hover(event.position())
            self.pointer_moved.emit(event.position())
            return
        step = event.position() - self._last
        if not self._is_dragging and step.manhattanLength() < QApplication.startDragDistance() / 3:
            return
        self._last = event.position()
        if self._drag is Drag.PLACE:
            self._place(event.position())
            return
        self._begin_drag()
        dx, dy, size = step.x(), step.y(), (self.width(), self.height())
        if self._drag is Drag.ROTATE:
            self._move_camera(rotated(self.view_camera, dx, dy, size))
        elif self._drag is Drag.PAN:
            self._move_camera(panned(self.view_camera, dx, dy, size))
        elif self._drag is Drag.ZOOM:
            self._move_camera(zoomed(self.view_camera, WHEEL_STEP ** (-dy / 20)))
        elif self._drag is Drag.HANDLE:
            if self.manipulators is not None:
                self.manipulator_dragged.emit(self.manipulators.drag(*self._pixel(event.position())))
        elif self._drag is Drag.CURSOR:
            self.cursor_dragged.emit(event.position())
        elif self._drag is Drag.TILT:
            self.tilt_dragged.emit(event.position())
        elif self._drag is Drag.POINT:
            self.point_dragged.emit(event.position())
        elif self._drag is Drag.WINDOW:
            self.window_dragged.emit(dx / max(self.width(), 1), -dy / max(self.height(), 1))
        elif self._drag is Drag.FUNCTION:
            way = event.position() - self._start
            self.function_dragged.emit(way.x() / max(self.width(), 1), -way.y() / max(self.height(), 1))
        else:
            self.light_dragged.emit(dx, dy)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """The drag is over when the last button is up."""
        if event.buttons() == Qt.MouseButton.NoButton:
            is_click = self._drag in CLICKS and not self.is_moving
            self._end_drag(cancelled=False)
            if is_click:
                self.clicked.emit(event.position())
        event.accept()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom to the pointer; with Ctrl the light comes nearer or goes away. Through slices, which zoom with Ctrl."""
        notches = event.angleDelta().y() / 120
        if notches:
            self._begin_wheel()
            if self.shows_slice and not event.modifiers() & Qt.KeyboardModifier.ControlModifier:
                self.stepped.emit(notches)
            elif event.modifiers() & Qt.KeyboardModifier.ControlModifier and self.light_is_movable:
                self.light_wheeled.emit(WHEEL_STEP**notches)
            else:
                at = (event.position().x(), event.position().y())
                size = (self.width(), self.height())
                self._move_camera(zoomed_at(self.view_camera, WHEEL_STEP**notches, at, size))
        event.accept()

    def event(self, event: QEvent) -> bool:
        """Two fingers on a touchpad zoom."""
        if (
            isinstance(event, QNativeGestureEvent)
            and event.gestureType() == Qt.NativeGestureType.ZoomNativeGesture
        ):
            self._begin_wheel()
            self._move_camera(zoomed(self.view_camera, 1 + event.value()))
            return True
        return super().event(event)

    def enterEvent(self, event: QEvent) -> None:
        """VTK need not know."""

    def leaveEvent(self, event: QEvent) -> None:
        """Nothing is under the pointer any more."""
        if self.manipulators is not None and self._drag is None and self.manipulators.leave():
            self._show_grip()
        self.pointer_left.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Arrows turn the view, with Shift they move it; Escape cancels a drag; all other keys belong to the window."""
        if self._places_points and event.key() in POINT_KEYS:
            self.point_key_pressed.emit(event.key())
            return
        step = None if self.shows_slice else ARROWS.get(event.key())
        # the arrows of a number pad come with a modifier of their own
        modifiers = event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier
        if event.key() == Qt.Key.Key_Escape and self._drag in {Drag.FUNCTION, Drag.HANDLE}:
            self._end_drag(cancelled=True)
        elif step is not None and modifiers in (
            Qt.KeyboardModifier.NoModifier,
            Qt.KeyboardModifier.ShiftModifier,
        ):
            size = (self.width(), self.height())
            dx, dy = (part * ARROW_TURN / TURN * min(size) for part in step)
            move = rotated if modifiers == Qt.KeyboardModifier.NoModifier else panned
            self._begin_wheel()
            self._move_camera(move(self.view_camera, dx, dy, size))
        else:
            event.ignore()

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        """Keys belong to the window."""
        event.ignore()

    # ------------------------------------------------------------------ handles

    def _pixel(self, position: QPointF) -> tuple[float, float]:
        """A place in device pixels, from the upper left."""
        ratio = self.devicePixelRatioF()
        return position.x() * ratio, position.y() * ratio

    def _hover(self, position: QPointF) -> None:
        if self.manipulators is not None:
            self.manipulators.scale = self.devicePixelRatioF()
            if self.manipulators.hover(*self._pixel(position)):
                self._show_grip()

    def _show_grip(self) -> None:
        """Let pointer and image say what can be dragged here."""
        under = None if self.manipulators is None else self.manipulators.under
        words = {
            "light": self.tr("Drag to move the light"),
            "plane": self.tr("Drag to push the plane along its normal"),
            "normal": self.tr("Drag to tilt the plane"),
        }
        self.setToolTip(words.get(under or "", ""))
        if under is None and self._places_points:
            self.setCursor(Qt.CursorShape.CrossCursor)
        elif under is None:
            self.unsetCursor()
        else:
            held = self._drag is not None
            self.setCursor(Qt.CursorShape.ClosedHandCursor if held else Qt.CursorShape.OpenHandCursor)
        self.render()

    def set_manipulators(self, handles: Manipulators | None) -> None:
        """The handles that are dragged here from now on, None for none."""
        if self._drag is Drag.HANDLE:
            self._end_drag(cancelled=False)
        self.manipulators = handles
        if handles is not None:
            handles.scale = self.devicePixelRatioF()
        self._show_grip()

    # ------------------------------------------------------------------ meaning of a drag

    def _meaning(self, event: QMouseEvent) -> Drag:
        if self.shows_slice:
            return self._meaning_on_slice(event)
        if event.button() == Qt.MouseButton.RightButton:
            return Drag.LIGHT if self.light_is_movable else Drag.ZOOM
        if event.button() == Qt.MouseButton.MiddleButton:
            return Drag.ZOOM
        if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            return Drag.FUNCTION
        plain = event.modifiers() == Qt.KeyboardModifier.NoModifier
        if plain and self.manipulators is not None and self.manipulators.grab(*self._pixel(event.position())):
            return Drag.HANDLE
        return Drag.PAN if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else Drag.ROTATE

    def _meaning_on_slice(self, event: QMouseEvent) -> Drag:
        if event.button() == Qt.MouseButton.RightButton:
            return Drag.WINDOW
        if event.button() == Qt.MouseButton.MiddleButton:
            return Drag.PAN
        if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            return Drag.ZOOM
        if event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
            return Drag.PAN
        if self._places_points:
            return Drag.PLACE
        if self.grab_point(event.position()):
            return Drag.POINT
        return Drag.TILT if self.grab_knob(event.position()) else Drag.CURSOR

    def _place(self, position: QPointF) -> None:
        """A line that is drawn by one drag: its first point lies where the button went down."""
        if self._placed is None:
            self._placed = self._start
            self.clicked.emit(self._start)
        self.pointer_moved.emit(position)

    @property
    def _is_dragging(self) -> bool:
        return self._store.has_gesture(self.drag_key)

    def _begin_drag(self) -> None:
        if not self._is_dragging:
            self._store.begin_gesture(self.drag_key)
            if self._drag is Drag.FUNCTION:
                self.function_drag_started.emit()

    def _end_drag(self, *, cancelled: bool) -> None:
        drag, self._drag = self._drag, None
        moved = self._is_dragging
        if drag is Drag.FUNCTION and moved:
            self.function_drag_ended.emit(cancelled)
        if cancelled:
            self._store.cancel_gesture(self.drag_key)
        self._store.end_gesture(self.drag_key)
        if drag is Drag.HANDLE:
            if self.manipulators is not None:
                self.manipulators.release()
            self._show_grip()
        if moved:
            self.camera_committed.emit(self.view_camera)

    def _begin_wheel(self) -> None:
        self._store.begin_gesture(self.wheel_key)
        self._wheel_rest.start()

    def _end_wheel(self) -> None:
        self._store.end_gesture(self.wheel_key)
        self.camera_committed.emit(self.view_camera)

    def end_moves(self) -> None:
        """What is being dragged here ends, and no camera is committed: the viewport is about to close."""
        self._wheel_rest.stop()
        self._store.end_gesture(self.drag_key)
        self._store.end_gesture(self.wheel_key)


def same_view(a: Camera, b: Camera) -> bool:
    """Whether two cameras differ by no more than rounding."""
    if (a.view_angle, a.parallel, a.parallel_scale) != (b.view_angle, b.parallel, b.parallel_scale):
        return False
    reach = 1e-12 * max(a.distance, *map(abs, a.position), *map(abs, a.focal_point))
    ups = max(abs(x - y) for x, y in zip(a.view_up, b.view_up, strict=True))
    places = zip((*a.position, *a.focal_point), (*b.position, *b.focal_point), strict=True)
    return ups <= 1e-12 and max(abs(x - y) for x, y in places) <= reach
