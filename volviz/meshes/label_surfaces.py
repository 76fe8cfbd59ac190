"""Surfaces of labels as meshes: a closed one for each, neighbours with the same triangles where they touch."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from volviz import environment
from volviz.errors import Cancelled, InputError, VolvizError
from volviz.meshes.files import check_mesh_target, save_mesh
from volviz.meshes.polydata import polydata
from volviz.volume_data.label_indices import label_indices_of
from volviz.volume_data.volume import Volume

environment.prepare()

from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkImageData  # noqa: E402
from vtkmodules.vtkFiltersCore import vtkSurfaceNets3D  # noqa: E402

Array = npt.NDArray[Any]
#: Turns of smoothing: each shrinks a little. After four, a ball with a radius of 10 voxels is 0.08 voxels too small and
#: its vertices lie 0.12 apart from a sphere; after sixteen, 0.3 and 0.06.
SMOOTHING = 4


class LabelSurface(NamedTuple):
    """The surface of a label.

    Attributes
    ----------
    vertices : ndarray of shape (V, 3), float64
        World positions (x, y, z).
    faces : ndarray of shape (F, 3), int64
        Numbers of vertices, counter-clockwise seen from outside.
    """

    vertices: npt.NDArray[np.float64]
    faces: npt.NDArray[np.int64]


def label_surfaces(
    labels: Volume,
    chosen: Iterable[int] | None = None,
    *,
    smoothing: int = SMOOTHING,
    progress: Callable[[float], object] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> dict[int, LabelSurface]:
    """The surface of each label by surface nets (Gibson 1998; Frisken 2022).

    All surfaces are extracted and smoothed together: where two labels touch, both have the same triangles, so that no
    gap opens between them. Each is closed, at the border of the volume as well.

    Parameters
    ----------
    labels : Volume
        Whole numbers; 0 is nothing.
    chosen : iterable of int, optional
        Labels whose surfaces are wanted; default: all. The others still shape the borders.
    smoothing : int
        Turns of smoothing; 0 leaves the steps of the voxels.
    progress : callable, optional
        Told of the finished fraction, 0..1.
    cancel : callable, optional
        Asked now and then; True ends the work.

    Returns
    -------
    dict of int to LabelSurface
        By label, ascending.

    Raises
    ------
    InputError
        There is no such label, or values are no whole numbers.
    Cancelled
    """
    known = label_indices_of(labels)
    rows = {int(label): row for row, label in enumerate(known.labels) if row}
    wanted = list(rows) if chosen is None else sorted(set(chosen))
    if missing := [label for label in wanted if label not in rows]:
        raise InputError(f"{labels.name}: it holds no label {missing[0]}.")
    if not wanted:
        raise InputError(f"{labels.name}: it holds no label, 0 stands for nothing.")
    vertices, faces, sides = _nets(known.indices, len(rows), smoothing, progress, cancel)
    matrix = labels.index_to_world
    places = vertices @ matrix[:3, :3].T + matrix[:3, 3]
    mirrored = np.linalg.det(matrix[:3, :3]) < 0
    found = {}
    for label in wanted:
        if cancel is not None and cancel():
            raise Cancelled("The extraction of surfaces was cancelled.")
        own = sides == rows[label]
        of_label = faces[own.any(axis=1)]
        # triangles face away from the first of their two labels
        turned = own[own.any(axis=1), 1] != mirrored
        of_label[turned] = of_label[turned, ::-1]
        used, renumbered = np.unique(of_label, return_inverse=True)
        found[label] = LabelSurface(places[used], renumbered.reshape(-1, 3).astype(np.int64))
    return found


def save_label_surfaces(
    surfaces: Mapping[int, LabelSurface],
    folder: str | os.PathLike[str],
    names: Mapping[int, str] | None = None,
    *,
    suffix: str = ".stl",
    overwrite: bool = False,
) -> list[Path]:
    """Write each surface to a file of its own, called by number and name of the label; nothing is written in part.

    Parameters
    ----------
    surfaces : mapping from label to LabelSurface
    folder : str or path
        Made if it is not there.
    names : mapping from label to str, optional
    suffix : str
        Format, as for `volviz.meshes.files.save_mesh`.
    overwrite : bool
        Whether files that are there are replaced.

    Raises
    ------
    InputError
        Another format, or a file that is not to be replaced.
    VolvizError
        The folder or a file cannot be written.
    """
    place = Path(folder)
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise VolvizError(f"{place}: the folder cannot be made ({error.strerror or error}).") from None
    targets = {}
    for label in surfaces:
        # a name may hold what no name of a file may
        name = " ".join(re.sub(r'[\\/:*?"<>|\x00-\x1f]', " ", (names or {}).get(label, "")).split())
        path = place / f"{label} {name}".strip()
        targets[label] = check_mesh_target(path.with_name(path.name + suffix), overwrite=overwrite)
    for label, surface in surfaces.items():
        save_mesh(polydata(surface.vertices, surface.faces), targets[label], overwrite=overwrite)
    return list(targets.values())


def _nets(
    indices: Array,
    count: int,
    smoothing: int,
    progress: Callable[[float], object] | None,
    cancel: Callable[[], bool] | None,
) -> tuple[Array, Array, Array]:
    """Vertices in voxel indices, triangles, and the rows of the two labels at either side of each."""
    # nothing around it, so that surfaces close at the border
    padded = np.pad(indices, 1)
    image = vtkImageData()
    image.SetDimensions(*padded.shape[::-1])
    image.SetOrigin(-1.0, -1.0, -1.0)
    image.GetPointData().SetScalars(numpy_to_vtk(padded.ravel()))
    nets = vtkSurfaceNets3D()
    nets.SetInputData(image)
    nets.GenerateLabels(count, 1, count)
    nets.SetBackgroundLabel(0)
    nets.SetOutputMeshTypeToTriangles()
    nets.SetSmoothing(smoothing > 0)
    nets.SetNumberOfIterations(smoothing)
    # a vertex stays within its cell of eight voxels
    nets.AutomaticSmoothingConstraintsOff()
    nets.GetSmoother().SetConstraintStrategyToConstraintBox()
    nets.GetSmoother().SetConstraintBox(1.0, 1.0, 1.0)

    def tell(*_event: object) -> None:
        if progress is not None:
            progress(float(nets.GetProgress()))
        if cancel is not None and cancel():
            nets.SetAbortExecute(True)

    observer = nets.AddObserver("ProgressEvent", tell)
    nets.Update()
    nets.RemoveObserver(observer)
    if cancel is not None and cancel():
        raise Cancelled("The extraction of surfaces was cancelled.")
    mesh = nets.GetOutput()
    vertices = vtk_to_numpy(mesh.GetPoints().GetData()).astype(np.float64)
    faces = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3).astype(np.int64)
    return vertices, faces, vtk_to_numpy(mesh.GetCellData().GetArray("BoundaryLabels")).astype(np.int64)
