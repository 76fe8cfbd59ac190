"""Our isosurface against VTK's: vertices, triangles, topology, distance, time; every difference explained."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.compare.mesh_differences import (
    REASONS,
    CaseDifference,
    Mesh,
    VertexMatch,
    explain_differences,
    match_vertices,
)
from volviz.compare.surface_distance import SurfaceDistance, surface_distance
from volviz.compare.vtk_contours import VTK_METHODS, run_vtk_contour, vtk_image, vtk_mesh_arrays
from volviz.errors import Cancelled, InputError
from volviz.kernels.marching import marching_cubes
from volviz.kernels.marching.surface import clean_mesh
from volviz.kernels.mesh_metrics import MeshMetrics, mesh_metrics

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

_OURS = "ours"
#: Name of the run of Flying Edges on all processors.
THREADED = "vtkFlyingEdges3D, threaded"
#: Places of each surface from which the distance to the other one is measured, at most.
MOST_SAMPLES = 200_000


@dataclass(frozen=True)
class FilterComparison:
    """Our mesh against that of one filter of VTK.

    Attributes
    ----------
    filter_name : str
        "vtkMarchingCubes" or "vtkFlyingEdges3D".
    vertices : VertexMatch
        Which positions both have.
    raw : MeshMetrics
        VTK's mesh as it comes.
    cleaned : MeshMetrics
        The same with coincident vertices merged and triangles without area dropped.
    common_triangles : int
        Triangles that both cleaned meshes have.
    differences : tuple of CaseDifference
        The others, by the case of their cell.
    distance : SurfaceDistance or None
        None when a mesh is empty.
    """

    filter_name: str
    vertices: VertexMatch
    raw: MeshMetrics
    cleaned: MeshMetrics
    common_triangles: int
    differences: tuple[CaseDifference, ...]
    distance: SurfaceDistance | None


@dataclass(frozen=True)
class CrosscheckReport:
    """What a cross-check found; `format` gives it as text.

    Attributes
    ----------
    volume_name : str
    dimensions : tuple of 3 ints
        Voxels along (x, y, z).
    dtype : str
        Type of the scalars.
    isovalue : float
        In data units.
    method : str
        Our method.
    raw, cleaned : MeshMetrics
        Our mesh as it comes, and with coincident vertices merged.
    comparisons : tuple of FilterComparison
        One for each filter of VTK.
    threaded : MeshMetrics
        Cleaned mesh of vtkFlyingEdges3D on all processors.
    seconds : dict of str to float
        Median times, normals included: "ours", each filter, and "vtkFlyingEdges3D, threaded".
    """

    volume_name: str
    dimensions: tuple[int, int, int]
    dtype: str
    isovalue: float
    method: str
    raw: MeshMetrics
    cleaned: MeshMetrics
    comparisons: tuple[FilterComparison, ...]
    threaded: MeshMetrics
    seconds: dict[str, float]

    @property
    def vertices_agree(self) -> bool:
        """Tell whether both filters have exactly our vertices."""
        return all(comparison.vertices.are_identical for comparison in self.comparisons)

    @property
    def is_explained(self) -> bool:
        """Tell whether all differences are of kinds that leave the vertices alone."""
        return self.vertices_agree and all(
            difference.reason != "vertices" for c in self.comparisons for difference in c.differences
        )

    def format(self) -> str:
        """The report as text for a terminal, without a line break at the end."""
        size = " x ".join(map(str, self.dimensions))
        what = f"{self.volume_name}, {size}, {self.dtype}"
        lines = [f"{what}, isovalue {self.isovalue:g}, method {self.method}", ""]
        lines += self._table()
        for comparison in self.comparisons:
            lines += ["", *_comparison_lines(comparison, self.cleaned)]
        lines += ["", *self._time_lines()]
        lines += ["", self.verdict]
        return "\n".join(lines)

    def columns(self) -> list[tuple[str, MeshMetrics]]:
        """Names and figures of all cleaned meshes, ours first."""
        others = [(comparison.filter_name, comparison.cleaned) for comparison in self.comparisons]
        return [(_OURS, self.cleaned), *others, (THREADED, self.threaded)]

    def explanations(self) -> list[tuple[str, list[str]]]:
        """What there is to say about each filter of VTK, sentence by sentence."""
        return [
            (
                comparison.filter_name,
                [line.strip() for line in _comparison_lines(comparison, self.cleaned)[1:]],
            )
            for comparison in self.comparisons
        ]

    @property
    def verdict(self) -> str:
        """The result in one sentence."""
        vertices = "identical with VTK's" if self.vertices_agree else "NOT identical with VTK's"
        return f"Vertices are {vertices}; our mesh is {_topology_in_words(self.raw)}."

    def to_dict(self) -> dict[str, Any]:
        """All of it as plain values, for JSON."""
        return asdict(self) | {
            "vertices_agree": self.vertices_agree,
            "is_explained": self.is_explained,
            "verdict": self.verdict,
        }

    def _table(self) -> list[str]:
        columns = [("ours", self.raw), ("ours, cleaned", self.cleaned)]
        for comparison in self.comparisons:
            columns += [(comparison.filter_name, comparison.raw), ("cleaned", comparison.cleaned)]
        rows = [
            ("vertices", "vertices", "d"),
            ("triangles", "faces", "d"),
            ("area", "area", ".6g"),
            ("volume", "volume", ".6g"),
            ("Euler characteristic", "euler_characteristic", "d"),
            ("boundary edges", "boundary_edges", "d"),
            ("non-manifold edges", "non_manifold_edges", "d"),
            ("parts", "components", "d"),
        ]
        lines = [" " * 22 + "".join(f"{title:>18}" for title, _ in columns)]
        for label, name, style in rows:
            cells = "".join(f"{getattr(metrics, name):>18{style}}" for _, metrics in columns)
            lines.append(f"{label:<22}{cells}")
        return lines

    def _time_lines(self) -> list[str]:
        own = self.seconds[_OURS]
        lines = ["Time (median, with normals)"]
        for name, seconds in self.seconds.items():
            ratio = "" if name == _OURS else f"   {seconds / own:6.2f} x ours"
            lines.append(f"  {name:<28}{1000 * seconds:10.2f} ms{ratio}")
        return lines


def crosscheck(
    volume: Volume,
    isovalue: float,
    method: str = "lorensen",
    *,
    repeats: int = 3,
    progress: Callable[[float], object] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> CrosscheckReport:
    """Compare our isosurface with those of vtkMarchingCubes and vtkFlyingEdges3D.

    Parameters
    ----------
    volume : Volume
        Scalars and where they lie.
    isovalue : float
        In data units.
    method : {"lorensen", "topological", "tetrahedra"}, default: "lorensen"
        Ours; VTK has the first only, so vertices of the others agree only in part.
    repeats : int, default: 3
        Runs of each side for the times, taken in turn after one run for warming up.
    progress : callable, optional
        Called with the finished fraction, 0..1.
    cancel : callable, optional
        Asked between the steps; when it returns True the work ends with `Cancelled`.

    Raises
    ------
    InputError
        An argument is not one of the above.
    Cancelled
        `cancel` returned True.
    """
    if repeats < 1:
        raise InputError(f"repeats must be at least 1, got {repeats}.")

    def report(fraction: float) -> None:
        if progress is not None:
            progress(fraction)
        if cancel is not None and cancel():
            raise Cancelled("The cross-check was cancelled.")

    report(0.0)
    image = vtk_image(volume)
    vertices, faces, _ = _extract(volume, isovalue, method)
    raw = (vertices, faces)
    cleaned = clean_mesh(vertices, faces, None)[:2]
    report(0.05)
    comparisons = []
    for step, name in enumerate(VTK_METHODS):
        begin = 0.05 + 0.35 * step
        theirs = vtk_mesh_arrays(run_vtk_contour(image, isovalue, name))
        report(begin + 0.05)
        comparisons.append(_compare(name, cleaned, theirs, volume, isovalue, report, begin))
    threaded = clean_mesh(*vtk_mesh_arrays(run_vtk_contour(image, isovalue, threaded=True)), None)[:2]
    report(0.76)
    seconds = _times(volume, isovalue, method, repeats, report)
    report(1.0)
    return CrosscheckReport(
        volume_name=volume.name,
        dimensions=volume.dimensions,
        dtype=str(volume.array.dtype),
        isovalue=float(isovalue),
        method=method,
        raw=mesh_metrics(*raw),
        cleaned=mesh_metrics(*cleaned),
        comparisons=tuple(comparisons),
        threaded=mesh_metrics(*threaded),
        seconds=seconds,
    )


def _extract(volume: Volume, isovalue: float, method: str) -> tuple[np.ndarray, ...]:
    vertices, faces, normals = marching_cubes(
        volume.array,
        isovalue,
        method=method,
        spacing=volume.spacing,
        origin=volume.origin,
        direction=volume.direction,
    )
    return vertices, faces, normals if normals is not None else np.empty((0, 3))


def _compare(
    name: str,
    ours: Mesh,
    theirs: Mesh,
    volume: Volume,
    isovalue: float,
    report: Callable[[float], None],
    begin: float,
) -> FilterComparison:
    cleaned = clean_mesh(*theirs, None)[:2]
    match, partner = match_vertices(ours[0], cleaned[0], volume.spacing)
    report(begin + 0.12)
    common, differences = explain_differences(ours, cleaned, partner, volume, isovalue)
    report(begin + 0.2)
    both = len(ours[1]) and len(cleaned[1])
    distance = surface_distance(ours, cleaned, max_samples=MOST_SAMPLES) if both else None
    report(begin + 0.3)
    return FilterComparison(
        filter_name=name,
        vertices=match,
        raw=mesh_metrics(*theirs),
        cleaned=mesh_metrics(*cleaned),
        common_triangles=common,
        differences=differences,
        distance=distance,
    )


def _times(
    volume: Volume, isovalue: float, method: str, repeats: int, report: Callable[[float], None]
) -> dict[str, float]:
    """Median times of both sides, run in turn, so that a busy machine hits all alike."""
    image = vtk_image(volume)
    runs: dict[str, Callable[[], object]] = {_OURS: lambda: _extract(volume, isovalue, method)}
    for name in VTK_METHODS:
        runs[name] = lambda name=name: run_vtk_contour(image, isovalue, name)  # type: ignore[misc]
    runs[THREADED] = lambda: run_vtk_contour(image, isovalue, threaded=True)
    seconds: dict[str, list[float]] = {name: [] for name in runs}
    for turn in range(repeats + 1):
        for name, run in runs.items():
            start = time.perf_counter()
            run()
            if turn:
                seconds[name].append(time.perf_counter() - start)
        report(0.76 + 0.23 * (turn + 1) / (repeats + 1))
    return {name: float(np.median(times)) for name, times in seconds.items()}


def _comparison_lines(comparison: FilterComparison, ours: MeshMetrics) -> list[str]:
    match = comparison.vertices
    lines = [f"Against {comparison.filter_name}"]
    if match.are_identical:
        lines.append(f"  all {match.ours} vertices agree, to {match.largest_distance:.2g} (world units)")
    else:
        lines.append(
            f"  {match.only_ours} of our {match.ours} vertices are not in VTK's mesh, "
            f"{match.only_theirs} of its {match.theirs} are not in ours"
        )
    lines.append(f"  {comparison.common_triangles} of {ours.faces} triangles are the same")
    if comparison.cleaned.area:
        change = ours.area / comparison.cleaned.area - 1
        lines.append(f"  area differs by {100 * change:+.4f} %")
    if comparison.cleaned.volume and ours.boundary_edges == 0:
        change = ours.volume / comparison.cleaned.volume - 1
        lines.append(f"  volume differs by {100 * change:+.4f} %")
    if comparison.distance is not None:
        distance = comparison.distance
        lines.append(f"  Hausdorff distance {distance.hausdorff:.3g}, mean {distance.mean:.3g} (world units)")
    for difference in comparison.differences:
        polygons = " + ".join(map(str, difference.polygons))
        lines.append(
            f"  {difference.cells} cells with {difference.inside_corners} corners inside, polygons of {polygons} "
            f"sides: {REASONS[difference.reason]} ({difference.our_triangles} triangles instead of "
            f"{difference.their_triangles}, area {difference.area_difference:+.4g})"
        )
    return lines


def _topology_in_words(metrics: MeshMetrics) -> str:
    if not metrics.faces:
        return "empty"
    if metrics.is_closed:
        return "a closed manifold"
    if metrics.non_manifold_edges == 0:
        return "a manifold, open at the border of the volume"
    return f"not a manifold ({metrics.non_manifold_edges} edges)"
