"""A number at every place of a triangle surface, and the colours that stand for it."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError

Array = npt.NDArray[Any]
Floats = npt.NDArray[np.float32]

#: Share of the diagonal by which vertices of one surface may differ that were computed in two ways.
SAME_PLACE = 1e-5


@dataclass(frozen=True, eq=False)
class SurfaceValues:
    """A number at the vertices of a surface and at the middles of its triangles; linear in between.

    With vertices alone, a distance to a surface that goes through the same vertices would be zero everywhere.

    Attributes
    ----------
    vertices : ndarray of shape (V, 3), float
        World positions (x, y, z).
    faces : ndarray of shape (F, 3), integers
        Vertex numbers.
    at_vertices : ndarray of shape (V,), float32
    at_middles : ndarray of shape (F,), float32

    Raises
    ------
    InputError
        Shapes that do not belong together, or no triangle.
    """

    vertices: Array
    faces: Array
    at_vertices: Floats
    at_middles: Floats
    _trees: dict[str, Any] = field(default_factory=dict, repr=False)
    _lock: threading.Lock = field(default_factory=threading.Lock, repr=False)

    def __post_init__(self) -> None:
        shapes = (self.at_vertices.shape, self.at_middles.shape)
        if shapes != ((len(self.vertices),), (len(self.faces),)) or not len(self.faces):
            raise InputError(
                f"values of shapes {shapes[0]} and {shapes[1]} do not fit {len(self.vertices)} vertices and "
                f"{len(self.faces)} triangles; give one number for each, and at least one triangle."
            )

    def with_numbers(self, at_vertices: Floats, at_middles: Floats) -> SurfaceValues:
        """Other numbers on the same surface; what was prepared for finding places is kept."""
        return replace(self, at_vertices=at_vertices, at_middles=at_middles)

    def at(self, vertices: Array, faces: Array) -> tuple[Floats, Floats]:
        """Values for a mesh of the same surface: its own, or those of the nearest vertex and the nearest triangle.

        Parameters
        ----------
        vertices : ndarray of shape (N, 3), float
            World positions (x, y, z).
        faces : ndarray of shape (M, 3), integers
            Vertex numbers.

        Returns
        -------
        at_vertices : ndarray of shape (N,), float32
        at_middles : ndarray of shape (M,), float32
        """
        if self._is_mesh_of(vertices, faces):
            return self.at_vertices, self.at_middles
        _, vertex = self._tree("vertices").query(vertices, workers=-1)
        _, triangle = self._tree("middles").query(_middles(vertices, faces), workers=-1)
        return self.at_vertices[vertex], self.at_middles[triangle]

    def around(self, points: Array) -> Floats:
        """Means of the triangles that are nearest to points, for a coarser mesh that stands for the surface.

        Parameters
        ----------
        points : ndarray of shape (N, 3), float
            World positions (x, y, z).

        Returns
        -------
        ndarray of shape (N,), float32
            Means over the area: a triangle is cut into three at its middle, with linear values on each.
        """
        _, nearest = self._tree("middles").query(points, workers=-1)
        corners = self.at_vertices[self.faces[nearest]].sum(axis=1)
        return np.asarray(corners * np.float32(2 / 9) + self.at_middles[nearest] / np.float32(3), np.float32)

    def prepare(self) -> None:
        """Build the search tree that `around` needs; call it on a worker, because that takes long for large meshes."""
        self._tree("middles")

    def _is_mesh_of(self, vertices: Array, faces: Array) -> bool:
        if self.vertices.shape != vertices.shape or self.faces.shape != faces.shape:
            return False
        diagonal = float(np.linalg.norm(np.ptp(self.vertices, axis=0)))
        same_place = np.abs(self.vertices - vertices).max() <= SAME_PLACE * diagonal
        return bool(same_place) and np.array_equal(self.faces, faces)

    def _tree(self, name: str) -> Any:
        from scipy.spatial import cKDTree

        with self._lock:
            if name not in self._trees:
                points = self.vertices if name == "vertices" else _middles(self.vertices, self.faces)
                # without searching for medians it is built in half the time, and surfaces are evenly sampled
                self._trees[name] = cKDTree(points, balanced_tree=False, compact_nodes=False)
            return self._trees[name]


@dataclass(frozen=True, eq=False)
class SurfaceColors:
    """Values of a surface, and what colours they are shown in.

    Attributes
    ----------
    values : SurfaceValues
    low, high : float
        Values that get the first and the last colour; what lies beyond gets the same.
    table : ndarray of shape (N, 3), uint8
        Colours from low to high, evenly spaced, at least two.

    Raises
    ------
    InputError
        `low` is not below `high`, or the table is none.
    """

    values: SurfaceValues
    low: float
    high: float
    table: npt.NDArray[np.uint8]

    def __post_init__(self) -> None:
        if not self.low < self.high:
            raise InputError(f"colours go from a lower to a higher value, got {self.low:g} to {self.high:g}.")
        if self.table.ndim != 2 or self.table.shape[1] != 3 or len(self.table) < 2:
            raise InputError(f"a table of colours has shape (N, 3), N at least 2, got {self.table.shape}.")


@dataclass(frozen=True)
class DistanceColoring:
    """A request to colour a surface by its distance to the one that another technique draws of the same volume.

    Attributes
    ----------
    technique : str
        Id of the technique that draws the other surface.
    settings : object or None
        Its settings; None means its defaults.
    signed : bool
        Whether places inside the other surface have distances below 0.
    limit : float or None
        Distance that gets the strongest colour, in world units; None: the largest there is.
    """

    technique: str
    settings: Any = None
    signed: bool = True
    limit: float | None = None


def _middles(vertices: Array, faces: Array) -> Array:
    """Middles of triangles, shape (F, 3), in the precision of the vertices."""
    return np.asarray((vertices[faces[:, 0]] + vertices[faces[:, 1]] + vertices[faces[:, 2]]) / 3)
