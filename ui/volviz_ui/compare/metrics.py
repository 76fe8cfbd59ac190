"""What is counted of a pair of views: images, samples, meshes. Runs on a worker; no Qt, no OpenGL."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from volviz.compare.image_metrics import ImageMetrics, compare_images, similarity_image, ssim_map
from volviz.compare.meshes import Mesh, cleaned, drawn_mesh
from volviz.compare.samples import RaySamples, ray_samples
from volviz.compare.surface_distance import SurfaceDistance, surface_distance
from volviz.custom_gl.resolve import resolve
from volviz.custom_gl.technique import surface_settings
from volviz.kernels.mesh_metrics import MeshMetrics, mesh_metrics
from volviz.model.parameters import setting_values
from volviz.model.render_spec import RenderSpec, View
from volviz.volume_data.volume import Volume
from volviz_ui.views.difference_image import Bytes

MESHES_KEPT = 4


@dataclass(frozen=True)
class MeasuredView:
    """A view as it was drawn: what it shows, and the image (H, W, 3) as it would be exported."""

    spec: RenderSpec
    image: Bytes


@dataclass(frozen=True)
class PairMetrics:
    """Everything that is told about two views.

    Attributes
    ----------
    images : ImageMetrics
    similarity : ndarray of shape (H, W, 3), uint8
        Map of structural similarity, white where the images are alike.
    samples : tuple of two RaySamples or None
        None for techniques that do not go along rays.
    meshes : tuple of two MeshMetrics or None
        None for techniques that draw no mesh.
    distance : SurfaceDistance or None
        Between the meshes, where both sides draw one.
    length_unit : str
        Of the volume; empty where nobody knows.
    """

    images: ImageMetrics
    similarity: Bytes
    samples: tuple[RaySamples | None, RaySamples | None]
    meshes: tuple[MeshMetrics | None, MeshMetrics | None]
    distance: SurfaceDistance | None
    length_unit: str = ""


class MeshCache:
    """The meshes of the last few sides: they take seconds to extract and do not change with the camera."""

    def __init__(self) -> None:
        self._drawn: dict[Any, Mesh | None] = {}
        self._measured: dict[Any, tuple[Mesh, MeshMetrics] | None] = {}
        self._distances: dict[Any, SurfaceDistance] = {}
        # metrics and colours of one pair need the same meshes at the same time
        self._lock = threading.Lock()

    def clear(self) -> None:
        """Forget all: another volume is shown. What is being made meanwhile is kept apart by its volume."""
        for kept in (self._drawn, self._measured, self._distances):
            kept.clear()

    def drawn(
        self, volume: Volume, technique: str, settings: Any, cancel: Callable[[], bool] | None = None
    ) -> Mesh | None:
        """The mesh as a technique draws it, None when it draws none.

        Raises
        ------
        Cancelled
            `cancel` said so.
        """
        key = mesh_key(volume, technique, settings)
        with self._lock:
            if key in self._drawn:
                return self._drawn[key]
            mesh = drawn_mesh(volume, technique, setting_values(settings), cancel=cancel)
            return _keep(self._drawn, key, mesh, MESHES_KEPT)

    def mesh(self, volume: Volume, side: MeasuredView) -> tuple[Mesh, MeshMetrics] | None:
        """The mesh of a side without vertices at one place, and its metrics; None when it draws none."""
        key = mesh_key(volume, side.spec.technique, side.spec.settings)
        if key in self._measured:
            return self._measured[key]
        drawn = self.drawn(volume, side.spec.technique, side.spec.settings)
        made = None if drawn is None else cleaned(drawn)
        return _keep(self._measured, key, None if made is None else (made, mesh_metrics(*made)), MESHES_KEPT)

    def distance(
        self, volume: Volume, sides: tuple[MeasuredView, MeasuredView], meshes: tuple[Mesh, Mesh]
    ) -> SurfaceDistance | None:
        """How far two meshes lie apart, None when one is empty."""
        if not len(meshes[0][1]) or not len(meshes[1][1]):
            return None
        key = tuple(mesh_key(volume, side.spec.technique, side.spec.settings) for side in sides)
        found = self._distances.get(key)
        return found if found is not None else _keep(self._distances, key, surface_distance(*meshes), 1)


def mesh_key(volume: Volume, technique: str, settings: Any) -> tuple[Any, ...]:
    """What decides a mesh: equal keys have equal meshes."""
    return volume, technique, *surface_settings(settings).items()


def _keep(kept: dict[Any, Any], key: Any, value: Any, most: int) -> Any:
    """Remember a value and forget the oldest ones."""
    kept[key] = value
    for old in list(kept)[:-most]:
        kept.pop(old, None)
    return value


def pair_metrics(
    sides: tuple[MeasuredView, MeasuredView],
    view: View,
    store: MeshCache,
    check: Callable[[], None],
) -> PairMetrics:
    """All metrics of a pair.

    Parameters
    ----------
    sides : tuple of 2 MeasuredView
        Whose layers hold the volume itself.
    view : View
        Of the images.
    check : callable
        Called between the parts; raises when nobody waits for the metrics any more.
    """
    first, second = sides
    images = compare_images(first.image, second.image)
    check()
    similarity = similarity_image(ssim_map(first.image, second.image))
    check()
    samples = [ray_samples(side.spec, view) for side in sides]
    volume = resolve(first.spec).volume
    meshes = []
    for side in sides:
        check()
        meshes.append(store.mesh(volume, side))
    check()
    one, other = meshes
    distance = None if one is None or other is None else store.distance(volume, sides, (one[0], other[0]))
    return PairMetrics(
        images,
        similarity,
        (samples[0], samples[1]),
        (None if one is None else one[1], None if other is None else other[1]),
        distance,
        str(volume.metadata.get("length_unit", "mm")),
    )
