"""The mesh in the image: its metrics, worked out on a worker, and what is being done to it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal

from volviz.custom_gl.mesh_drawing import MeshSettings, ReadyMesh, world_triangles
from volviz.custom_gl.scene_techniques import current_settings, current_technique
from volviz.custom_gl.technique import surface_settings
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz_ui.session.workers import Task, Workers

if TYPE_CHECKING:
    from volviz.kernels.mesh_metrics import MeshMetrics


@dataclass(frozen=True, eq=False)
class MeshSummary:
    """A mesh and its metrics.

    Attributes
    ----------
    mesh : ReadyMesh
        As it is drawn.
    polydata : pyvista.PolyData
        The same in world units: what is exported.
    metrics : MeshMetrics
        Its size and topology.
    length_unit : str
        Unit of the world.
    """

    mesh: ReadyMesh
    polydata: Any
    metrics: MeshMetrics
    length_unit: str


def shows_mesh(scene: Scene) -> bool:
    """Whether the technique of the active view draws triangles of an isosurface."""
    return issubclass(current_technique(scene).settings, MeshSettings)


class ShownMesh(QObject):
    """Watches the mesh of the active view.

    Parameters
    ----------
    store : Store
        The scene.
    workers : Workers
        Where the metrics are worked out.
    """

    summary_changed = Signal(object)
    """`MeshSummary`, or None while there are none for what is shown."""
    work_changed = Signal(object)
    """How far the mesh in work is, 0..1; None when none is in work."""

    def __init__(self, store: Store, workers: Workers, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._store = store
        self._workers = workers
        self._mesh: ReadyMesh | None = None
        self._settings: tuple[str, Any] | None = None
        self.summary: MeshSummary | None = None
        self.is_working = False

    def show_status(self, status: Any, handle: Any) -> None:
        """Take notice of what the host says about the image of the active view."""
        if not shows_mesh(self._store.scene):
            self._set_working(None)
            return
        waiting = getattr(status, "waiting", None)
        self._set_working(waiting)
        if waiting is not None or not status.complete or handle is None:
            return
        mesh = handle.mesh
        if mesh is not None and mesh is not self._mesh:
            self._take(mesh, (handle.technique.id, handle.settings))
        elif mesh is not None:
            self._settings = (handle.technique.id, handle.settings)

    def cancel(self) -> None:
        """Give up the mesh in work: the settings that the last one was made with come back."""
        if self._settings is None:
            return
        technique, settings = self._settings

        def back(scene: Scene) -> Scene:
            if scene.view.technique != technique:
                return scene
            restored = replace(current_settings(scene), **surface_settings(settings))
            return scene.with_view(settings=scene.view.with_settings(technique, restored).settings)

        self._store.update(back, label=self.tr("Cancel the mesh"))

    def _set_working(self, fraction: float | None) -> None:
        if fraction is not None or self.is_working:
            self.is_working = fraction is not None
            self.work_changed.emit(fraction)

    def _take(self, mesh: ReadyMesh, settings: tuple[str, Any]) -> None:
        self._mesh, self._settings = mesh, settings
        self._set_summary(None)
        task = self._workers.start(
            lambda task: summary_of(mesh, task), label=self.tr("Figures of the mesh"), key="mesh facts"
        )
        task.succeeded.connect(self._set_summary)

    def _set_summary(self, summary: MeshSummary | None) -> None:
        self.summary = summary
        self.summary_changed.emit(summary)


def summary_of(mesh: ReadyMesh, task: Task | None = None) -> MeshSummary:
    """The metrics of a mesh; on a worker, since large ones take a second."""
    from volviz.kernels.mesh_metrics import mesh_metrics
    from volviz.meshes.polydata import polydata

    vertices, faces, normals = world_triangles(mesh)
    if task is not None:
        task.report(0.3)
    volume = mesh.request.volume
    whole = polydata(vertices, faces, normals)
    whole.field_data["isovalue"] = [mesh.request.isovalue]
    return MeshSummary(
        mesh, whole, mesh_metrics(vertices, faces), str(volume.metadata.get("length_unit", "mm"))
    )
