"""Ready-made moves: turns, cuts, passages through time, values that change, key frames."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from volviz.errors import InputError
from volviz.model.camera import Camera
from volviz.model.clipping import MAX_PLANES, Plane
from volviz.model.movie import Move, Surroundings
from volviz.model.movies.interpolation import between
from volviz.model.parameters import parameters_of, unknown_setting
from volviz.model.scene import Scene
from volviz.volume_data.vectors import Vector, finite_vector

#: Directions by the words of a viewer and of anatomy (world axes of a patient: left, posterior, superior).
VIEWED = ("left", "right", "top", "bottom", "front", "back")
ANATOMICAL: dict[str, Vector] = {
    "patient left": (1.0, 0.0, 0.0),
    "patient right": (-1.0, 0.0, 0.0),
    "posterior": (0.0, 1.0, 0.0),
    "anterior": (0.0, -1.0, 0.0),
    "superior": (0.0, 0.0, 1.0),
    "inferior": (0.0, 0.0, -1.0),
}
WORLD: dict[str, Vector] = {
    "x": (1.0, 0.0, 0.0),
    "-x": (-1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
    "-z": (0.0, 0.0, -1.0),
}
#: "up" is the upright direction of the view.
DIRECTIONS = ("up", *WORLD, *VIEWED, *ANATOMICAL)


def direction_of(word: str | Vector, camera: Camera | None) -> Vector:
    """A unit vector of the world from a word or a vector.

    Parameters
    ----------
    word : str or tuple of 3 floats
        One of `DIRECTIONS`: an axis, a side of the picture, a side of a patient.
    camera : Camera or None
        Who looks, for sides of the picture.

    Raises
    ------
    InputError
        No such direction.
    """
    if not isinstance(word, str):
        vector = np.asarray(finite_vector(word, "a direction"))
        length = float(np.linalg.norm(vector))
        if length == 0.0:
            raise InputError("a direction must not be (0, 0, 0).")
        return _tuple(vector / length)
    known = {**WORLD, **ANATOMICAL}
    if word in known:
        return known[word]
    if word not in DIRECTIONS:
        raise InputError(f"a direction is one of {', '.join(DIRECTIONS)}, got {word!r}.")
    camera = _seen(camera)
    back = -np.asarray(camera.direction)
    right = np.cross(camera.view_up, back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    sides = {"right": right, "left": -right, "top": up, "up": up, "bottom": -up, "front": back, "back": -back}
    return _tuple(sides[word])


@dataclass(frozen=True)
class Turn:
    """The camera goes around what it looks at.

    Attributes
    ----------
    degrees : float
        How far; against the clock for who looks against the axis, so that what is in front goes to the right.
    axis : str or tuple of 3 floats
        About which direction (see `DIRECTIONS`).
    """

    kind = "turn"
    is_place = False
    degrees: float = 360.0
    axis: str | Vector = "up"

    @property
    def closes(self) -> bool:
        """Whole turns do."""
        return math.remainder(self.degrees, 360.0) == 0.0

    def at(self, start: Scene, fraction: float, about: Surroundings) -> Scene:
        """The scene part of the way round."""
        camera = _seen(start.view.camera)
        degrees = self.degrees * fraction
        if math.remainder(degrees, 360.0) == 0.0:
            return start
        return start.with_camera(camera.rotated(direction_of(self.axis, camera), degrees), start.active_index)


@dataclass(frozen=True)
class Swing:
    """The camera goes to one side, to the other, and back.

    Attributes
    ----------
    degrees : float
        From one end to the other.
    axis : str or tuple of 3 floats
    """

    kind = "swing"
    is_place = False
    degrees: float = 60.0
    axis: str | Vector = "up"
    closes = True

    def at(self, start: Scene, fraction: float, about: Surroundings) -> Scene:
        """The scene part of the way there and back."""
        degrees = 0.5 * self.degrees * math.sin(2 * math.pi * fraction)
        camera = _seen(start.view.camera)
        if fraction in (0.0, 1.0) or degrees == 0.0:
            return start
        return start.with_camera(camera.rotated(direction_of(self.axis, camera), degrees), start.active_index)


@dataclass(frozen=True)
class Zoom:
    """The camera comes nearer, or goes away.

    Attributes
    ----------
    factor : float
        How much larger things appear at the end; below 1 smaller.
    """

    kind = "zoom"
    is_place = False
    factor: float = 2.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.factor) and self.factor > 0):
            raise InputError(f"zoom takes a factor greater than 0, got {self.factor:g}.")

    @property
    def closes(self) -> bool:
        """A factor of 1 does."""
        return self.factor == 1.0

    def at(self, start: Scene, fraction: float, about: Surroundings) -> Scene:
        """The scene from so near."""
        camera, factor = _seen(start.view.camera), self.factor**fraction
        offset = np.subtract(camera.position, camera.focal_point) / factor
        scale = camera.parallel_scale
        nearer = replace(
            camera,
            position=_tuple(np.add(camera.focal_point, offset)),
            parallel_scale=None if scale is None else scale / factor,
        )
        return start.with_camera(nearer, start.active_index)


@dataclass(frozen=True)
class Cut:
    """A plane goes through the volume and takes away what it has passed.

    Attributes
    ----------
    toward : str or tuple of 3 floats
        Where it goes (see `DIRECTIONS`).
    begin, end : float
        Where it is at the beginning and at the end, 0 before the volume and 1 behind it; falling numbers give back what
        was taken away.
    """

    kind = "cut"
    is_place = False
    toward: str | Vector = "right"
    begin: float = 0.0
    end: float = 1.0

    @property
    def closes(self) -> bool:
        """A plane that stays does."""
        return self.begin == self.end

    def at(self, start: Scene, fraction: float, about: Surroundings) -> Scene:
        """The scene with the plane at its place; before the volume there is none."""
        share = self.begin + (self.end - self.begin) * fraction
        if share <= 0.0:
            return start
        clipping = start.clipping
        if len(clipping.planes) >= MAX_PLANES:
            raise InputError(f"a cut needs a clip plane, and all {MAX_PLANES} are in use; remove one.")
        normal = np.asarray(direction_of(self.toward, start.view.camera))
        along = _corners(about) @ normal
        low, high = float(along.min()), float(along.max())
        middle = _corners(about).mean(axis=0)
        place = middle + (low + share * (high - low) - middle @ normal) * normal
        plane: Plane = (_tuple(place), _tuple(normal))
        return replace(start, clipping=replace(clipping, planes=(*clipping.planes, plane)))


@dataclass(frozen=True)
class Play:
    """Time passes in all layers that have more than one time point.

    Attributes
    ----------
    first, last : int or None
        Time points from 0; None for the present one and the last one.
    """

    kind = "play"
    is_place = False
    first: int | None = None
    last: int | None = None
    closes = False

    def at(self, start: Scene, fraction: float, about: Surroundings) -> Scene:
        """The scene at the time point of that moment."""
        if about.times < 2:
            raise InputError("there is one time point only: nothing can pass through time.")
        layer = start.layer
        first = self.first if self.first is not None else (0 if layer is None else layer.time)
        last = about.times - 1 if self.last is None else self.last
        for number in (first, last):
            if not 0 <= number < about.times:
                raise InputError(f"time points go from 0 to {about.times - 1}, got {number}.")
        count = abs(last - first) + 1
        passed = min(int(fraction * count), count - 1)
        time = first + (passed if last >= first else -passed)
        return replace(start, layers=tuple(replace(each, time=time) for each in start.layers))


@dataclass(frozen=True)
class Vary:
    """A number of the technique, such as the isovalue, goes from one value to another.

    Attributes
    ----------
    name : str
        Of the setting.
    end : float
        Its value at the end.
    begin : float or None
        At the beginning; None is what it has then.
    """

    kind = "vary"
    is_place = False
    name: str
    end: float
    begin: float | None = None
    closes = False

    def at(self, start: Scene, fraction: float, about: Surroundings) -> Scene:
        """The scene with the value of that moment."""
        view = start.view
        kind = about.settings_of(view.technique)
        settings: Any = view.settings_for(view.technique, kind)
        # surfaces have one isovalue or several
        known = {p.name: p for p in parameters_of(kind)}
        parameter = known.get(self.name) or known.get(f"{self.name}s")
        if parameter is None:
            raise InputError(unknown_setting(view.technique, self.name, list(known)))
        if parameter.kind not in ("float", "int", "floats"):
            raise InputError(f"{self.name} is no number; only numbers pass from one value to another.")
        present = getattr(settings, parameter.name)
        if isinstance(present, tuple):
            present = present[0] if present else None
        begin = present if self.begin is None else self.begin
        if begin is None:
            raise InputError(f"{self.name} is automatic at the beginning; say from which value it goes.")
        value: Any = between(float(begin), float(self.end), fraction)
        value = round(value) if parameter.kind == "int" else (value,) if parameter.kind == "floats" else value
        changed = replace(settings, **{parameter.name: parameter.checked(value)})
        return start.with_view(settings=view.with_settings(view.technique, changed).settings)


@dataclass(frozen=True)
class Fade:
    """A layer appears or vanishes.

    Attributes
    ----------
    layer : int
        Its number, from 0.
    appears : bool
        It appears; otherwise it vanishes.
    """

    kind = "fade"
    is_place = False
    layer: int
    appears: bool = True
    closes = False

    def at(self, start: Scene, fraction: float, about: Surroundings) -> Scene:
        """The scene with so much of the layer."""
        if not 0 <= self.layer < len(start.layers):
            raise InputError(f"there is no layer {self.layer}; numbers go from 0 to {len(start.layers) - 1}.")
        layer = start.layers[self.layer]
        if self.appears:
            changed = replace(layer, visible=fraction > 0.0, opacity=(layer.opacity or 1.0) * fraction)
        else:
            changed = replace(
                layer, opacity=layer.opacity * (1.0 - fraction), visible=layer.visible and fraction < 1.0
            )
        layers = (*start.layers[: self.layer], changed, *start.layers[self.layer + 1 :])
        return replace(start, layers=layers)


@dataclass(frozen=True)
class Scroll:
    """Slices go through the volume.

    Attributes
    ----------
    toward : str or tuple of 3 floats
        Where they go (see `DIRECTIONS`).
    """

    kind = "scroll"
    is_place = False
    toward: str | Vector = "z"
    closes = False

    def at(self, start: Scene, fraction: float, about: Surroundings) -> Scene:
        """The scene whose cursor is so far on its way."""
        along = np.asarray(direction_of(self.toward, start.view.camera))
        corners = _corners(about)
        middle = corners.mean(axis=0) if start.cursor is None else np.asarray(start.cursor)
        ends = corners @ along
        place = float(ends.min() + fraction * (ends.max() - ends.min()))
        return replace(start, cursor=_tuple(middle + (place - middle @ along) * along))


@dataclass(frozen=True)
class KeyFrame:
    """Everything goes to what it is in another scene.

    Attributes
    ----------
    scene : Scene
        Where it ends; its own movie does not count.
    name : str
        What people call it.
    """

    kind = "key frame"
    is_place = True
    scene: Scene
    name: str = ""
    closes = False

    def at(self, start: Scene, fraction: float, about: Surroundings) -> Scene:
        """The scene so far on its way."""
        return replace(between(start, self.scene, fraction), movie=start.movie)


#: Moves that are plain values in files, by kind; key frames hold scenes, which sessions write.
PLAIN_MOVES: Mapping[str, Callable[..., Move[Scene]]] = {
    made.kind: made for made in (Turn, Swing, Zoom, Cut, Play, Vary, Fade, Scroll)
}


def move_values(move: Any) -> dict[str, Any]:
    """The values of a plain move by name."""
    return {field.name: getattr(move, field.name) for field in dataclasses.fields(move)}


def _seen(camera: Camera | None) -> Camera:
    if camera is None:
        raise InputError("a movie needs a camera; frame the picture first.")
    return camera


def _corners(about: Surroundings) -> Any:
    x0, x1, y0, y1, z0, z1 = about.bounds
    return np.array([(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)])


def _tuple(vector: Any) -> Vector:
    x, y, z = (float(v) for v in vector)
    return x, y, z
