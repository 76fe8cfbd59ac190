"""How light and cut plane are moved by the pointer: arithmetic on world points and pixels, no window."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Vector = tuple[float, float, float]
Pixel = tuple[float, float]

#: Below this sine of the angle between a normal and the view, pushing a plane follows the pointer up and down.
FACING = 0.3


@dataclass(frozen=True, eq=False)
class Projection:
    """From the world to the pixels of a viewport, and back along rays.

    Attributes
    ----------
    matrix : ndarray of shape (4, 4)
        World to clip space (OpenGL conventions, column vectors).
    size : tuple of 2 ints
        Width and height in pixels; pixels count from the upper left corner.
    """

    matrix: Array
    size: tuple[int, int]

    def pixels(self, points: npt.ArrayLike) -> Array:
        """Places of world points, shape (N, 2); NaN for points behind the eye."""
        world = np.atleast_2d(np.asarray(points, np.float64))
        clip = np.c_[world, np.ones(len(world))] @ self.matrix.T
        w = np.where(clip[:, 3] > 1e-12, clip[:, 3], np.nan)
        ndc = clip[:, :2] / w[:, None]
        return np.asarray(np.c_[(ndc[:, 0] + 1) / 2 * self.size[0], (1 - ndc[:, 1]) / 2 * self.size[1]])

    def depths(self, points: npt.ArrayLike) -> Array:
        """Normalised depths of world points, shape (N,): larger is farther away."""
        world = np.atleast_2d(np.asarray(points, np.float64))
        clip = np.c_[world, np.ones(len(world))] @ self.matrix.T
        return np.asarray(clip[:, 2] / clip[:, 3])

    def ray(self, pixel: Pixel) -> tuple[Array, Array]:
        """Origin on the near plane and unit direction of the ray through a pixel."""
        x, y = 2 * pixel[0] / self.size[0] - 1, 1 - 2 * pixel[1] / self.size[1]
        inverse = np.linalg.inv(self.matrix)
        near, far = (inverse @ (x, y, z, 1.0) for z in (-1.0, 1.0))
        start = near[:3] / near[3]
        along = far[:3] / far[3] - start
        return start, along / np.linalg.norm(along)

    def world_per_pixel(self, point: npt.ArrayLike) -> float:
        """World length of a pixel at the depth of a point."""
        start, along = self.ray((self.size[0] / 2, self.size[1] / 2))
        other = self.ray((self.size[0] / 2, self.size[1] / 2 + 1))
        depth = float((np.asarray(point, np.float64) - start) @ along)
        a = start + depth * along
        b = other[0] + depth / float(other[1] @ along) * other[1]
        return float(np.linalg.norm(b - a))


class Arcball:
    """A point that is dragged over a sphere: on the side it began on, and around its edge to the other.

    Parameters
    ----------
    projection : Projection
        The view, which does not change meanwhile.
    center, point : array_like of shape (3,)
        Middle of the sphere, and the point on it that is dragged.
    """

    def __init__(self, projection: Projection, center: npt.ArrayLike, point: npt.ArrayLike) -> None:
        self._projection = projection
        self._center = np.asarray(center, np.float64)
        offset = np.asarray(point, np.float64) - self._center
        self._radius = float(np.linalg.norm(offset))
        self._last = offset / self._radius
        pixel = projection.pixels(point)[0]
        _, along = projection.ray((float(pixel[0]), float(pixel[1])))
        self._near = float(offset @ along) <= 0
        self._beside = False

    def to(self, pixel: Pixel) -> Array:
        """Unit vector from the middle to the point of the sphere under a pixel, or nearest to it."""
        found = self._hit(pixel)
        if found is None:
            self._beside = True
            found = self._edge(pixel)
        elif self._beside:
            # it went around the edge
            self._near, self._beside = not self._near, False
            found = self._hit(pixel)
        if found is not None:
            self._last = found
        return self._last

    def _hit(self, pixel: Pixel) -> Array | None:
        start, along = self._projection.ray(pixel)
        to_center = self._center - start
        middle = float(to_center @ along)
        beside = middle * along - to_center
        square = self._radius**2 - float(beside @ beside)
        if square < 0:
            return None
        half = np.sqrt(square)
        way = -half if self._near and middle > half else half
        # the eye may be within the sphere, or have all of it behind
        if middle + way <= 0:
            return None
        offset = beside + way * along
        return np.asarray(offset / np.linalg.norm(offset))

    def _edge(self, pixel: Pixel) -> Array:
        """The point of the outline towards a pixel beside the sphere."""
        outer = np.asarray(pixel, np.float64)
        middle = self._projection.pixels(self._center)[0]
        inner = middle if np.all(np.isfinite(middle)) else np.array(self._projection.size) / 2
        found = None
        for _ in range(24):
            between = (inner + outer) / 2
            hit = self._hit((float(between[0]), float(between[1])))
            if hit is None:
                outer = between
            else:
                inner, found = between, hit
        # the middle is behind the eye, and nothing of the sphere towards the pixel is seen: stay where we are
        return self._last if found is None else found


class PlanePush:
    """A plane that is pushed along its normal, within a box.

    Parameters
    ----------
    projection : Projection
        The view, which does not change meanwhile.
    origin, normal : array_like of shape (3,)
        Of the plane; the normal has length 1.
    corners : ndarray of shape (8, 3)
        World corners of the box that the plane must not leave.
    pixel : tuple of 2 floats
        Where it was grabbed.
    """

    def __init__(
        self,
        projection: Projection,
        origin: npt.ArrayLike,
        normal: npt.ArrayLike,
        corners: Array,
        pixel: Pixel,
    ) -> None:
        self._origin, self._normal = np.asarray(origin, np.float64), np.asarray(normal, np.float64)
        self._pixel = np.asarray(pixel, np.float64)
        along = (corners - self._origin) @ self._normal
        # the outermost hair's breadth cuts nothing any more
        hair = 1e-3 * float(np.ptp(along))
        self._low, self._high = min(float(along.min()) + hair, 0.0), max(float(along.max()) - hair, 0.0)
        unit = projection.world_per_pixel(self._origin)
        ends = projection.pixels(np.stack([self._origin, self._origin + unit * self._normal]))
        step = ends[1] - ends[0]
        # pixels on the screen for one world unit along the normal
        self._per_world = step / unit
        if not float(np.linalg.norm(step)) >= FACING:
            _, view = projection.ray((float(ends[0, 0]), float(ends[0, 1])))
            # seen face-on: up is away from the eye
            sign = 1.0 if float(self._normal @ view) > 0 else -1.0
            self._per_world = np.array([0.0, -sign / unit])

    def to(self, pixel: Pixel) -> Vector:
        """The plane's origin when the pointer is there."""
        way = np.asarray(pixel, np.float64) - self._pixel
        square = float(self._per_world @ self._per_world)
        distance = float(way @ self._per_world) / square
        return as_vector(self._origin + min(max(distance, self._low), self._high) * self._normal)


def radius_in_view(projection: Projection, center: npt.ArrayLike, margin: float) -> float:
    """Radius of a sphere about a world point that just leaves a margin of pixels to the rim of the viewport.

    A point near the rim, or beside the image, gets a sphere of a fifth of the viewport.
    """
    x, y = projection.pixels(center)[0]
    width, height = projection.size
    free = min(x, y, width - x, height - y) - margin
    pixels = max(free if np.isfinite(free) else 0.0, 0.2 * min(width, height))
    # in perspective the outline of a sphere is larger than its middle section
    return 0.9 * pixels * projection.world_per_pixel(center)


def distance_to_segment(pixel: Pixel, a: Array, b: Array) -> float:
    """Distance of a pixel from the segment between two others; infinite where one of them is behind the eye."""
    p = np.asarray(pixel, np.float64)
    if not (np.all(np.isfinite(a)) and np.all(np.isfinite(b))):
        return float("inf")
    along = b - a
    square = float(along @ along)
    share = min(max(float((p - a) @ along) / square, 0.0), 1.0) if square > 0 else 0.0
    return float(np.linalg.norm(p - a - share * along))


def as_vector(values: npt.ArrayLike) -> Vector:
    """Three floats."""
    x, y, z = (float(v) for v in np.asarray(values))
    return x, y, z
