"""What can be dragged in the image: the light, and the cut plane with its normal.

A technique declares its manipulators (`TechniqueInfo.manipulators`); here they are one actor in VTK's overlay, found
under the pointer, and moved. In a plain plotter they listen to VTK's interactor; a window with a mouse of its own
calls `hover`, `grab`, `drag` and `release`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.vtk.pixel_shapes import PixelShapes
from volviz.custom_gl.vtk.renderer_view import RendererView
from volviz.kernels.slices import slice_polygons
from volviz.model.cut_plane import default_cut_plane
from volviz.model.light import Light
from volviz.model.manipulators import (
    Arcball,
    PlanePush,
    Projection,
    as_vector,
    distance_to_segment,
    radius_in_view,
)
from volviz.volume_data.volume import Volume

Array = npt.NDArray[np.float64]
Pixel = tuple[float, float]

#: Radius of a manipulator, how far beside it a grip still holds, and the distance that manipulators keep to the rim;
#: in pixels.
RADIUS, CLEARANCE, RIM = 7.0, 4.0, 18.0
#: Length of the arrow along a plane's normal, as a share of the box's diagonal.
ARROW = 0.22

_DARK = (0.05, 0.06, 0.07, 0.75)
_PLANE = (1.0, 0.76, 0.28, 1.0)
_HELD = (1.0, 1.0, 1.0, 1.0)


class HandleOwner(Protocol):
    """What of a `VolumeHandle` its handles look at, and what they move."""

    plotter: Any
    renderer: Any
    window: Any
    view: RendererView

    @property
    def volume(self) -> Volume:
        """The data shown."""

    @property
    def technique(self) -> TechniqueInfo:
        """Says which handles there are."""

    @property
    def settings(self) -> Any:
        """With the cut plane."""

    @property
    def light(self) -> Light:
        """The light."""

    @property
    def light_position(self) -> tuple[float, float, float]:
        """Where it is, in the world."""

    @property
    def box_corners(self) -> Array:
        """World corners of the cropped box, shape (8, 3)."""

    def update(self, **changes: Any) -> object:
        """Show something else."""

    def begin_interaction(self) -> None:
        """A drag begins."""

    def end_interaction(self) -> None:
        """It is over."""


class Manipulators:
    """The handles of one volume; made by `VolumeHandle.show_manipulators`.

    Parameters
    ----------
    owner : VolumeHandle
        Whose light and settings are moved.
    listens : bool
        Whether VTK's interactor drags them.

    Attributes
    ----------
    scale : float
        Pixels of the framebuffer per pixel of the window system.
    """

    def __init__(self, owner: HandleOwner, *, listens: bool) -> None:
        self._owner = owner
        self._shapes = PixelShapes()
        self._held: str | None = None
        self._under: str | None = None
        self._move: Callable[[Pixel], dict[str, Any]] | None = None
        self.scale = 1.0
        owner.renderer.AddViewProp(self._shapes.actor)
        self._observers = [(owner.renderer, owner.renderer.AddObserver("StartEvent", self._draw))]
        if listens:
            self._listen()

    # ------------------------------------------------------------------ what there is

    def _projection(self) -> Projection:
        camera = self._owner.view.camera()
        width, height, _, _ = self._owner.view.rectangle()
        return Projection(camera.view_projection, (width, height))

    @property
    def shown(self) -> tuple[str, ...]:
        """Which handles there are now: those that the technique has and whose settings count."""
        names = []
        info = self._owner.technique
        light = self._owner.light
        if "light" in info.manipulators and not light.headlight and not light.beside_eye:
            names.append("light")
        if "plane" in info.manipulators and self._plane_counts():
            names.append("plane")
        return tuple(names)

    def _plane_counts(self) -> bool:
        parameter = next(p for p in self._owner.technique.parameters if p.name == "plane_origin")
        if parameter.enabled_by is None:
            return True
        name, values = parameter.enabled_by
        return getattr(self._owner.settings, name) in values

    def _plane(self) -> tuple[Array, Array]:
        """Origin and unit normal of the cut plane, chosen or not."""
        settings = self._owner.settings
        origin, normal = default_cut_plane(self._owner.box_corners)
        chosen = np.asarray(settings.plane_normal if settings.plane_normal is not None else normal, float)
        place = np.asarray(settings.plane_origin if settings.plane_origin is not None else origin, float)
        return place, chosen / np.linalg.norm(chosen)

    def _outline(self) -> Array:
        """World corners of the plane within the box, shape (n, 3)."""
        origin, normal = self._plane()
        vertices, counts = slice_polygons(self._owner.box_corners, normal, [float(origin @ normal)])
        return np.asarray(vertices[0, : counts[0]])

    def _arrow_length(self) -> float:
        corners = self._owner.box_corners
        return ARROW * float(np.linalg.norm(corners[7] - corners[0]))

    def _light_manipulator(self, projection: Projection) -> Array:
        """World place of the light's manipulator: the light, or nearer to the volume's middle so that it is in view."""
        center = np.asarray(self._owner.volume.center)
        way = np.asarray(self._owner.light_position) - center
        distance = float(np.linalg.norm(way))
        clearance = radius_in_view(projection, center, RIM * self.scale)
        return np.asarray(center + way * min(1.0, clearance / distance) if distance > 0 else center)

    # ------------------------------------------------------------------ under the pointer

    def part_at(self, x: float, y: float) -> str | None:
        """What can be held at a pixel (from the upper left of the renderer's viewport), None for nothing."""
        projection = self._projection()
        clearance = (RADIUS + CLEARANCE) * self.scale
        pixel = (x, y)
        found = [(_distance(pixel, at), name) for name, at in self._manipulators(projection).items()]
        if "plane" in self.shown:
            outline = self._outline()
            corners = projection.pixels(outline) if len(outline) else np.zeros((0, 2))
            edges = [distance_to_segment(pixel, a, b) for a, b in _closed(corners)]
            if edges:
                # thin: an edge must be met more exactly than a manipulator
                found.append((min(edges) + (RADIUS - 1) * self.scale, "plane"))
        near = [(d, name) for d, name in found if d <= clearance]
        return min(near, key=lambda each: each[0])[1] if near else None

    def place(self, part: str) -> Pixel | None:
        """Where the middle of a manipulator is, in pixels from the upper left; None while it is not shown."""
        at = self._manipulators(self._projection()).get(part)
        return None if at is None or not np.all(np.isfinite(at)) else (float(at[0]), float(at[1]))

    def _manipulators(self, projection: Projection) -> dict[str, Array]:
        """Pixels of the manipulators that there are, by name."""
        manipulators = {}
        shown = self.shown
        if "light" in shown:
            manipulators["light"] = projection.pixels(self._light_manipulator(projection))[0]
        if "plane" in shown:
            origin, normal = self._plane()
            tip = origin + self._arrow_length() * normal
            manipulators["normal"], manipulators["plane"] = projection.pixels([tip, origin])
        return manipulators

    def hover(self, x: float, y: float) -> bool:
        """Note where the pointer is; True when what lies under it has changed and is to be drawn anew."""
        under = self.part_at(x, y)
        changed, self._under = under != self._under, under
        return changed

    @property
    def under(self) -> str | None:
        """What lies under the pointer: "light", "plane", "normal" or nothing."""
        return self._held or self._under

    def leave(self) -> bool:
        """The pointer is elsewhere; True when something is to be drawn anew."""
        changed, self._under = self._under is not None, None
        return changed

    # ------------------------------------------------------------------ dragging

    def grab(self, x: float, y: float) -> bool:
        """Take hold of what lies at a pixel; False when there is nothing."""
        self._held = self.part_at(x, y)
        if self._held is None:
            return False
        projection = self._projection()
        if self._held == "light":
            self._move = self._light_drag(projection)
        elif self._held == "normal":
            origin, normal = self._plane()
            sphere = Arcball(projection, origin, origin + self._arrow_length() * normal)
            self._move = lambda pixel: self._plane_values(plane_normal=as_vector(sphere.to(pixel)))
        else:
            origin, normal = self._plane()
            push = PlanePush(projection, origin, normal, self._owner.box_corners, (x, y))
            self._move = lambda pixel: self._plane_values(plane_origin=push.to(pixel))
        return True

    def _light_drag(self, projection: Projection) -> Callable[[Pixel], dict[str, Any]]:
        center = np.asarray(self._owner.volume.center)
        distance = float(np.linalg.norm(np.asarray(self._owner.light_position) - center))
        sphere = Arcball(projection, center, self._light_manipulator(projection))

        def move(pixel: Pixel) -> dict[str, Any]:
            position = as_vector(center + distance * sphere.to(pixel))
            return {"light": replace(self._owner.light, headlight=False, position=position)}

        return move

    def _plane_values(self, **values: Any) -> dict[str, Any]:
        # both are fixed with the first move: one alone would let the other go on following the box
        origin, normal = self._plane()
        settings = self._owner.settings
        if settings.plane_origin is None:
            values.setdefault("plane_origin", as_vector(origin))
        if settings.plane_normal is None:
            values.setdefault("plane_normal", as_vector(normal))
        return {"settings": replace(settings, **values)}

    def drag(self, x: float, y: float) -> dict[str, Any]:
        """What changes when the pointer is there: ``light`` or ``settings``, as `VolumeHandle.update` takes them."""
        return self._move((x, y)) if self._move is not None else {}

    def release(self) -> None:
        """Let go."""
        self._held = self._move = None

    # ------------------------------------------------------------------ VTK's interactor

    def _listen(self) -> None:
        interactor = getattr(self._owner.plotter, "iren", None)
        interactor = getattr(interactor, "interactor", None)
        if interactor is None:
            return
        # above the styles, which must not turn the camera at the same time
        for event, callback in (
            ("LeftButtonPressEvent", self._on_press),
            ("MouseMoveEvent", self._on_move),
            ("LeftButtonReleaseEvent", self._on_release),
        ):
            self._observe(interactor, event, callback)

    def _observe(self, interactor: Any, event: str, callback: Callable[[Any], bool]) -> None:
        def on_event(*_: Any) -> None:
            if callback(interactor):
                interactor.GetCommand(tag).SetAbortFlag(1)

        tag = interactor.AddObserver(event, on_event, 10.0)
        self._observers.append((interactor, tag))

    def _pointer(self, interactor: Any) -> Pixel:
        x, y = interactor.GetEventPosition()
        _, height, left, bottom = self._owner.view.rectangle()
        return float(x - left), float(height - (y - bottom))

    def _on_press(self, interactor: Any) -> bool:
        if not self.grab(*self._pointer(interactor)):
            return False
        self._owner.begin_interaction()
        return True

    def _on_move(self, interactor: Any) -> bool:
        pointer = self._pointer(interactor)
        if self._held is None:
            if self.hover(*pointer):
                self._owner.plotter.render()
            return False
        self._owner.update(**self.drag(*pointer))
        self._owner.plotter.render()
        return True

    def _on_release(self, interactor: Any) -> bool:
        if self._held is None:
            return False
        self.release()
        self._owner.end_interaction()
        self._owner.plotter.render()
        return True

    # ------------------------------------------------------------------ drawing

    def _draw(self, *_: Any) -> None:
        """Place the shapes for the frame that begins."""
        self._shapes.clear()
        shown = self.shown
        # pieces of a larger image: their pixels are not those of the window
        whole = tuple(self._owner.window.GetTileScale()) == (1, 1)
        if shown and whole:
            projection = self._projection()
            if "plane" in shown:
                self._draw_plane(projection)
            if "light" in shown:
                self._draw_light(projection)
        self._shapes.show(visible=whole)

    def _draw_light(self, projection: Projection) -> None:
        center = np.asarray(self._owner.volume.center)
        center_of_light = self._light_manipulator(projection)
        (at,) = _flipped(projection, projection.pixels(center_of_light))
        (toward,) = _flipped(projection, projection.pixels(center))
        if not (np.all(np.isfinite(at)) and np.all(np.isfinite(toward))):
            return
        scale, shapes = self.scale, self._shapes
        color = _HELD if self.under == "light" else (*self._owner.light.color, 1.0)
        way = toward - at
        length = float(np.linalg.norm(way))
        if length > 3 * RADIUS * scale:
            # a tail that says where the light shines
            end = at + way / length * min(26.0 * scale, length)
            shapes.line(at, end, 4.5 * scale, _DARK)
            shapes.line(at, end, 2.0 * scale, color)
        shapes.disc(at, (RADIUS + 2) * scale, _DARK)
        shapes.disc(at, RADIUS * scale, color)
        if projection.depths(center_of_light)[0] > projection.depths(center)[0]:
            # behind the volume: a ring
            shapes.disc(at, (RADIUS - 2.5) * scale, (*_DARK[:3], 1.0))

    def _draw_plane(self, projection: Projection) -> None:
        origin, normal = self._plane()
        scale, shapes = self.scale, self._shapes
        edge = _HELD if self.under == "plane" else _PLANE
        arrow = _HELD if self.under == "normal" else _PLANE
        outline = self._outline()
        if len(outline):
            rim = _closed(_flipped(projection, projection.pixels(outline)))
            for a, b in rim:
                shapes.line(a, b, 3.5 * scale, (*_DARK[:3], 0.5))
            for a, b in rim:
                shapes.line(a, b, 1.5 * scale, edge)
        ends = np.stack([origin, origin + self._arrow_length() * normal])
        root, tip = _flipped(projection, projection.pixels(ends))
        if not (np.all(np.isfinite(root)) and np.all(np.isfinite(tip))):
            return
        depths = projection.depths(ends)
        # what is nearer lies on top
        nearer_tip = bool(depths[1] <= depths[0])
        if not nearer_tip:
            self._head(root, tip, arrow)
        else:
            self._manipulator(root, edge)
        shapes.line(root, tip, 5.0 * scale, _DARK)
        shapes.line(root, tip, 2.5 * scale, arrow)
        if nearer_tip:
            self._head(root, tip, arrow)
        else:
            self._manipulator(root, edge)

    def _manipulator(self, at: Array, color: tuple[float, float, float, float]) -> None:
        self._shapes.disc(at, (RADIUS + 1.5) * self.scale, _DARK)
        self._shapes.disc(at, (RADIUS - 0.5) * self.scale, color)

    def _head(self, root: Array, tip: Array, color: tuple[float, float, float, float]) -> None:
        """A cone seen from the side, or its round base when it points at the eye or away from it."""
        way = tip - root
        length = float(np.linalg.norm(way))
        if length < 2 * RADIUS * self.scale:
            self._manipulator(tip, color)
            self._shapes.disc(tip, 2.0 * self.scale, (*_DARK[:3], 1.0))
            return
        along = way / length
        across = np.array([-along[1], along[0]])
        for size, tint in ((RADIUS + 4.0, _DARK), (RADIUS + 1.5, color)):
            wide = size * self.scale
            corners = np.array([tip + 1.3 * wide * along, tip - 0.7 * wide * along + 0.8 * wide * across,
                                tip - 0.7 * wide * along - 0.8 * wide * across])  # fmt: skip
            self._shapes.polygon(corners, tint)

    def remove(self) -> None:
        """Take the handles away."""
        for subject, tag in self._observers:
            subject.RemoveObserver(tag)
        self._observers.clear()
        self._owner.renderer.RemoveViewProp(self._shapes.actor)


def _distance(pixel: Pixel, place: Array) -> float:
    distance = float(np.hypot(place[0] - pixel[0], place[1] - pixel[1]))
    return distance if np.isfinite(distance) else float("inf")


def _flipped(projection: Projection, pixels: Array) -> Array:
    """Pixels from the lower left instead of the upper left."""
    return np.asarray(np.c_[pixels[:, 0], projection.size[1] - pixels[:, 1]])


def _closed(points: Array) -> list[tuple[Array, Array]]:
    """The edges of a polygon."""
    return [(points[i], points[(i + 1) % len(points)]) for i in range(len(points))]
