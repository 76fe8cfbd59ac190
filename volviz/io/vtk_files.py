"""VTK images: XML (.vti) and legacy (.vtk) structured points, point or cell values.

VTK says nothing about patients; its coordinates are taken for the world frame as they are.
"""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.axes import choose, to_zyx
from volviz.io.reader import stem
from volviz.vtk_messages import vtk_complaints

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt

    from volviz.io.reader import Job
    from volviz.model.volume import Volume

SUFFIXES = (".vti", ".vtk")

#: Deflate packs by 1032 at most; with lzma, the third of VTK's compressors, files can be smaller still.
PACKING = 10_000


def sniff(head: bytes, _path: Path) -> bool:
    """Whether these are the first bytes of a VTK file, XML or legacy."""
    return (
        head.startswith(b"# vtk DataFile") or re.match(rb"\s*(<\?xml[^>]*>\s*)?<VTKFile\b", head) is not None
    )


def read(job: Job) -> Volume:
    """Read one volume."""
    with job.path.open("rb") as stream:
        head = stream.read(4096)
    if not sniff(head, job.path):
        raise job.error("this is no VTK file, though it is called so; check how it was made.")
    legacy = head.startswith(b"#")
    _check(job, head, legacy=legacy)
    job.report(0.0)
    image = _image(job, legacy=legacy)
    job.report(0.9)
    dimensions = image.GetDimensions()
    data, is_cell = image.GetPointData(), False
    values = _values(job, data)
    origin_index = np.array(image.GetExtent()[::2], float)
    if values is None:
        data, is_cell = image.GetCellData(), True
        values = _values(job, data)
        dimensions = tuple(max(n - 1, 1) for n in dimensions)
        # the value of a cell lies in its middle
        origin_index += 0.5
    if values is None:
        raise job.error(
            "the VTK file holds no numbers at its points or cells; save it with an array of scalars."
        )
    array, name, components = values
    if array.shape[0] != int(np.prod(dimensions, dtype=np.int64)):
        raise job.error("its values do not fit its dimensions; the file is damaged or cut off.")
    if is_cell:
        job.note("The values belong to cells; they are shown at the middles of the cells.")
    shaped = array.reshape(*dimensions[::-1], *((components,) if components > 1 else ()))
    scalars = to_zyx(shaped, "ZYXS" if components > 1 else "ZYX", job)
    direction = np.array([[image.GetDirectionMatrix().GetElement(i, j) for j in range(3)] for i in range(3)])
    # numbers that are not finite are refused below
    with np.errstate(over="ignore", invalid="ignore"):
        matrix = direction * np.asarray(image.GetSpacing())
        start = np.asarray(image.GetOrigin()) + matrix @ origin_index
    geometry = job.geometry(np.c_[matrix, start])
    # the array may still belong to VTK, which frees it with the image
    return job.volume(np.array(scalars), geometry, format="VTK", name=stem(job.path, SUFFIXES), field=name)


def _check(job: Job, head: bytes, *, legacy: bool) -> None:
    """Refuse other kinds of VTK data, and sizes that the file cannot hold, before VTK asks for memory."""
    if legacy:
        kind = re.search(rb"^\s*DATASET\s+(\w+)", head, re.MULTILINE | re.IGNORECASE)
        if kind is None:
            raise job.error("its header names no DATASET; the file is damaged or cut off.")
        if kind[1].upper() != b"STRUCTURED_POINTS":
            raise job.error(
                f"it holds {kind[1].decode('ascii', 'replace')}, no image; save STRUCTURED_POINTS."
            )
        sizes = re.search(
            rb"^\s*DIMENSIONS\s+(-?\d+)\s+(-?\d+)\s+(-?\d+)", head, re.MULTILINE | re.IGNORECASE
        )
        counts = [int(n) for n in sizes.groups()] if sizes else []
    else:
        kind = re.search(rb"<VTKFile\b[^>]*\btype\s*=\s*[\"'](\w+)", head)
        if kind is None or kind[1] != b"ImageData":
            what = kind[1].decode("ascii", "replace") if kind else "nothing that it names"
            raise job.error(f"it holds {what}, no image; save it as ImageData (.vti).")
        extent = re.search(rb"WholeExtent\s*=\s*[\"']([-\d\s]+)[\"']", head)
        ends = [int(n) for n in extent[1].split()] if extent else []
        counts = [high - low + 1 for low, high in zip(ends[::2], ends[1::2], strict=False)]
    if len(counts) != 3 or min(counts) < 1:
        raise job.error("its header gives no size that a volume can have; the file is damaged.")
    voxels = counts[0] * counts[1] * counts[2]
    if voxels > job.path.stat().st_size * (1 if legacy else PACKING):
        raise job.error(f"the file is cut off: its header promises {voxels:,} voxels, more than it can hold.")


def _image(job: Job, *, legacy: bool) -> Any:
    """The vtkImageData; VTK's errors become one sentence, and its progress ours."""
    if legacy:
        from vtkmodules.vtkIOLegacy import vtkStructuredPointsReader as Reader
    else:
        from vtkmodules.vtkIOXML import vtkXMLImageDataReader as Reader
    reader = Reader()
    stopped: list[BaseException] = []

    def progressed(caller: Any, _event: str) -> None:
        try:
            job.report(0.9 * caller.GetProgress())
        except BaseException as error:  # noqa: BLE001 - VTK swallows what an observer raises; it is raised below
            stopped.append(error)
            caller.AbortExecuteOn()

    observer = reader.AddObserver("ProgressEvent", progressed)
    try:
        with vtk_complaints() as complaints:
            # as bytes: a name on Linux need not be text
            reader.SetFileName(os.fsencode(job.path))
            reader.Update()
    finally:
        reader.RemoveObserver(observer)
    if stopped:
        raise stopped[0]
    image = reader.GetOutput()
    if complaints.GetOutput() or image is None or image.GetNumberOfPoints() == 0:
        raise job.error("VTK cannot read it; the file is damaged, cut off or of an unusual kind.")
    return image


def _values(job: Job, data: Any) -> tuple[npt.NDArray[Any], str, int] | None:
    """The active scalars, else the first array of numbers: values, name, number of components."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    names = [data.GetArrayName(n) or "" for n in range(data.GetNumberOfArrays())]
    arrays = [data.GetArray(n) for n in range(data.GetNumberOfArrays())]
    usable = [
        (name, a) for name, a in zip(names, arrays, strict=True) if a is not None and a.GetNumberOfTuples()
    ]
    if not usable:
        return None
    active = data.GetScalars()
    index = next((n for n, (_, a) in enumerate(usable) if a is active), 0)
    if len(usable) > 1:
        if active is None or job.hints.channel is not None:
            index = choose(job, "C", len(usable))
        shown = ", ".join(f"{n}: {name}" for n, (name, _) in enumerate(usable[:8]))
        job.note(f"The file holds {len(usable)} arrays ({shown}); {usable[index][0]} is shown.")
    name, array = usable[index]
    return vtk_to_numpy(array), name, int(array.GetNumberOfComponents())
