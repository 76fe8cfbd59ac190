"""What is counted of a pair of views: pictures, samples, meshes. Runs on a worker; no Qt, no OpenGL."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from volviz.compare.mesh_metrics import MeshMetrics, mesh_metrics
from volviz.compare.meshes import Mesh, side_mesh
from volviz.compare.pictures import PictureMetrics, compare_pictures, similarity_picture, ssim_map
from volviz.compare.samples import RaySamples, ray_samples
from volviz.compare.surface_distance import SurfaceDistance, surface_distance
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.parameters import parameters_of
from volviz.model.volume import Volume
from volviz_ui.compare.difference_picture import Bytes

MESHES_KEPT = 4


@dataclass(frozen=True)
class Side:
    """A view as it was drawn: technique id, its settings, the picture (H, W, 3) as it would be exported."""

    technique: str
    settings: Any
    picture: Bytes


@dataclass(frozen=True)
class PairFigures:
    """Everything that is told about two views.

    Attributes
    ----------
    pictures : PictureMetrics
    similarity : ndarray of shape (H, W, 3), uint8
        Map of structural similarity, white where the pictures are alike.
    samples : tuple of two RaySamples or None
        None for techniques that do not go along rays.
    meshes : tuple of two MeshMetrics or None
        None for techniques that draw no mesh.
    distance : SurfaceDistance or None
        Between the meshes, where both sides draw one.
    """

    pictures: PictureMetrics
    similarity: Bytes
    samples: tuple[RaySamples | None, RaySamples | None]
    meshes: tuple[MeshMetrics | None, MeshMetrics | None]
    distance: SurfaceDistance | None


class MeshStore:
    """The meshes of the last few sides: they take seconds to extract and do not change with the camera."""

    def __init__(self) -> None:
        self._meshes: dict[Any, tuple[Mesh, MeshMetrics] | None] = {}
        self._distances: dict[Any, SurfaceDistance] = {}

    def clear(self) -> None:
        """Forget all: another volume is shown."""
        self._meshes.clear()
        self._distances.clear()

    def mesh(self, volume: Volume, side: Side) -> tuple[Mesh, MeshMetrics] | None:
        """The mesh of a side and its figures, None when it draws none."""
        key = _mesh_key(side)
        if key not in self._meshes:
            values = {p.name: getattr(side.settings, p.name) for p in parameters_of(type(side.settings))}
            made = side_mesh(volume, side.technique, values)
            self._meshes[key] = None if made is None else (made, mesh_metrics(*made))
            while len(self._meshes) > MESHES_KEPT:
                self._meshes.pop(next(iter(self._meshes)))
        return self._meshes[key]

    def distance(self, sides: tuple[Side, Side], meshes: tuple[Mesh, Mesh]) -> SurfaceDistance | None:
        """How far two meshes lie apart, None when one is empty."""
        if not len(meshes[0][1]) or not len(meshes[1][1]):
            return None
        key = (_mesh_key(sides[0]), _mesh_key(sides[1]))
        if key not in self._distances:
            self._distances.clear()
            self._distances[key] = surface_distance(*meshes)
        return self._distances[key]


def _mesh_key(side: Side) -> tuple[str, Any]:
    return side.technique, side.settings


def pair_figures(
    sides: tuple[Side, Side],
    volume: Volume,
    camera: Camera,
    clipping: Clipping,
    store: MeshStore,
    check: Callable[[], None],
) -> PairFigures:
    """All figures of a pair.

    Parameters
    ----------
    check : callable
        Called between the parts; raises when nobody waits for the figures any more.
    """
    first, second = sides
    pictures = compare_pictures(first.picture, second.picture)
    check()
    similarity = similarity_picture(ssim_map(first.picture, second.picture))
    check()
    height, width = first.picture.shape[:2]
    samples = [
        ray_samples(volume, camera, (width, height), side.technique, side.settings, clipping)
        for side in sides
    ]
    meshes = []
    for side in sides:
        check()
        meshes.append(store.mesh(volume, side))
    check()
    one, other = meshes
    distance = None if one is None or other is None else store.distance(sides, (one[0], other[0]))
    return PairFigures(
        pictures,
        similarity,
        (samples[0], samples[1]),
        (None if one is None else one[1], None if other is None else other[1]),
        distance,
    )
