"""VTK images: XML (.vti) and legacy (.vtk) structured points, point or cell values.

VTK says nothing about patients; its coordinates are taken for the world frame as they are.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.axes import choose, to_zyx
from volviz.io.file_source import file_source
from volviz.io.reader import stem
from volviz.io.vtk_messages import vtk_complaints
from volviz.volume_data.description import Channel

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest

SUFFIXES = (".vti", ".vtk")

#: Deflate packs by 1032 at most; with lzma, the third of VTK's compressors, files can be smaller still.
PACKING = 10_000


def sniff(head: bytes, _path: Path) -> bool:
    """Whether these are the first bytes of a VTK file, XML or legacy."""
    return (
        head.startswith(b"# vtk DataFile") or re.match(rb"\s*(<\?xml[^>]*>\s*)?<VTKFile\b", head) is not None
    )


@dataclass(frozen=True)
class _Header:
    """What there is in an image: its lattice, and the arrays at its points, or else at its cells."""

    extent: tuple[int, ...]
    spacing: tuple[float, ...]
    origin: tuple[float, ...]
    direction: npt.NDArray[np.float64]
    is_cell: bool
    #: Name and number of components of each array.
    arrays: tuple[tuple[str, int], ...]
    active: int | None
    dtype: npt.DTypeLike | None


def open_source(request: LoadRequest) -> FileSource:
    """What the header says. The arrays of a legacy file lie one after another without a list: it is read as a whole."""
    with request.path.open("rb") as stream:
        head = stream.read(4096)
    if not sniff(head, request.path):
        raise request.error("this is no VTK file, though it is called so; check how it was made.")
    legacy = head.startswith(b"#")
    _check(request, head, legacy=legacy)
    request.report(0.0)
    image = _image(request, legacy=True) if legacy else None
    header = _header_of_image(image) if legacy else _header_of_xml(request)
    if not header.arrays:
        raise request.error(
            "the VTK file holds no numbers at its points or cells; save it with an array of scalars."
        )
    dimensions = [high - low + 1 for low, high in zip(header.extent[::2], header.extent[1::2], strict=True)]
    start_index = np.array(header.extent[::2], float)
    if header.is_cell:
        request.note("The values belong to cells; they are shown at the middles of the cells.")
        dimensions = [max(n - 1, 1) for n in dimensions]
        # the value of a cell lies in its middle
        start_index += 0.5
    # numbers that are not finite are refused below
    with np.errstate(over="ignore", invalid="ignore"):
        matrix = header.direction * np.asarray(header.spacing)
        start = np.asarray(header.origin) + matrix @ start_index
    shape = tuple(dimensions[::-1])
    count, components = len(header.arrays), header.arrays[0][1]
    letter = "C" if count > 1 else "S"

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        read = image if image is not None else _image(request, legacy=False)
        request.report(0.9)
        return _values(request, read, header, shape)

    return file_source(
        request,
        values,
        "ZYX" + letter,
        (*shape, count if count > 1 else components),
        request.geometry(np.c_[matrix, start]),
        format="VTK",
        name=stem(request.path, SUFFIXES),
        dtype=header.dtype,
        channels=[Channel(name) for name, _ in header.arrays] if count > 1 else (),
        field=header.arrays[header.active or 0][0],
    )


def _check(request: LoadRequest, head: bytes, *, legacy: bool) -> None:
    """Refuse other kinds of VTK data, and sizes that the file cannot hold, before VTK asks for memory."""
    if legacy:
        kind = re.search(rb"^\s*DATASET\s+(\w+)", head, re.MULTILINE | re.IGNORECASE)
        if kind is None:
            raise request.error("its header names no DATASET; the file is damaged or cut off.")
        if kind[1].upper() != b"STRUCTURED_POINTS":
            raise request.error(
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
            raise request.error(f"it holds {what}, no image; save it as ImageData (.vti).")
        extent = re.search(rb"WholeExtent\s*=\s*[\"']([-\d\s]+)[\"']", head)
        ends = [int(n) for n in extent[1].split()] if extent else []
        counts = [high - low + 1 for low, high in zip(ends[::2], ends[1::2], strict=False)]
    if len(counts) != 3 or min(counts) < 1:
        raise request.error("its header gives no size that a volume can have; the file is damaged.")
    voxels = counts[0] * counts[1] * counts[2]
    if voxels > request.path.stat().st_size * (1 if legacy else PACKING):
        raise request.error(
            f"the file is cut off: its header promises {voxels:,} voxels, more than it can hold."
        )


def _header_of_image(image: Any) -> _Header:
    """The header of an image that was read."""
    matrix = image.GetDirectionMatrix()
    is_cell = not _arrays(image.GetPointData())
    data = image.GetCellData() if is_cell else image.GetPointData()
    arrays, active = _arrays(data), data.GetScalars()
    return _Header(
        image.GetExtent(),
        image.GetSpacing(),
        image.GetOrigin(),
        np.array([[matrix.GetElement(i, j) for j in range(3)] for i in range(3)]),
        is_cell,
        tuple((a.GetName() or "", int(a.GetNumberOfComponents())) for a in arrays),
        next((n for n, a in enumerate(arrays) if a is active), None),
        _dtype(arrays[0].GetDataType()) if arrays else None,
    )


def _header_of_xml(request: LoadRequest) -> _Header:
    """The header of an XML file, without its values."""
    from vtkmodules.vtkCommonDataModel import vtkDataObject as Data
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader

    reader = vtkXMLImageDataReader()
    with vtk_complaints() as complaints:
        # as bytes: a name on Linux need not be text
        reader.SetFileName(os.fsencode(request.path))
        reader.UpdateInformation()
    information = reader.GetOutputInformation(0)
    extent = information.Get(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT())
    if complaints.GetOutput() or extent is None:
        raise request.error("VTK cannot read it; the file is damaged, cut off or of an unusual kind.")

    def listed(key: Any) -> list[Any]:
        entries = information.Get(key)
        count = 0 if entries is None else entries.GetNumberOfInformationObjects()
        found = [entries.GetInformationObject(n) for n in range(count)]
        return [each for each in found if _dtype(each.Get(Data.FIELD_ARRAY_TYPE())) is not None]

    at_points = listed(Data.POINT_DATA_VECTOR())
    arrays = at_points or listed(Data.CELL_DATA_VECTOR())
    return _Header(
        extent,
        information.Get(Data.SPACING()) or (1.0, 1.0, 1.0),
        information.Get(Data.ORIGIN()) or (0.0, 0.0, 0.0),
        np.reshape(information.Get(Data.DIRECTION()) or np.eye(3), (3, 3)),
        not at_points,
        tuple(
            (each.Get(Data.FIELD_NAME()) or "", int(each.Get(Data.FIELD_NUMBER_OF_COMPONENTS()) or 1))
            for each in arrays
        ),
        # the lowest bit: active scalars (vtkDataSetAttributes::SCALARS)
        next((n for n, a in enumerate(arrays) if int(a.Get(Data.FIELD_ACTIVE_ATTRIBUTE()) or 0) & 1), None),
        _dtype(arrays[0].Get(Data.FIELD_ARRAY_TYPE())) if arrays else None,
    )


def _dtype(kind: int) -> npt.DTypeLike | None:
    """Type of VTK's arrays of numbers, None for texts and bits."""
    from vtkmodules.util.numpy_support import get_vtk_to_numpy_typemap

    found: npt.DTypeLike | None = get_vtk_to_numpy_typemap().get(kind)
    return found


def _image(request: LoadRequest, *, legacy: bool) -> Any:
    """The vtkImageData; VTK's errors become one sentence, and its progress ours."""
    if legacy:
        from vtkmodules.vtkIOLegacy import vtkStructuredPointsReader as Reader
    else:
        from vtkmodules.vtkIOXML import vtkXMLImageDataReader as Reader
    reader = Reader()
    stopped: list[BaseException] = []

    def progressed(caller: Any, _event: str) -> None:
        try:
            request.report(0.9 * caller.GetProgress())
        except BaseException as error:  # noqa: BLE001 - VTK swallows what an observer raises; it is raised below
            stopped.append(error)
            caller.AbortExecuteOn()

    observer = reader.AddObserver("ProgressEvent", progressed)
    try:
        with vtk_complaints() as complaints:
            # as bytes: a name on Linux need not be text
            reader.SetFileName(os.fsencode(request.path))
            reader.Update()
    finally:
        reader.RemoveObserver(observer)
    if stopped:
        raise stopped[0]
    image = reader.GetOutput()
    if complaints.GetOutput() or image is None or image.GetNumberOfPoints() == 0:
        raise request.error("VTK cannot read it; the file is damaged, cut off or of an unusual kind.")
    return image


def _arrays(data: Any) -> list[Any]:
    """Arrays of numbers at points or cells."""
    found = [data.GetArray(n) for n in range(data.GetNumberOfArrays())]
    return [array for array in found if array is not None and array.GetNumberOfTuples()]


def _values(request: LoadRequest, image: Any, header: _Header, shape: tuple[int, ...]) -> npt.NDArray[Any]:
    """The array that is asked for, else the active scalars, else the first one."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    arrays = _arrays(image.GetCellData() if header.is_cell else image.GetPointData())
    if len(arrays) != len(header.arrays):
        raise request.error("some of its arrays cannot be read; the file is damaged or cut off.")
    index = header.active or 0
    if len(arrays) > 1:
        if header.active is None or request.channel is not None:
            index = choose(request, "C", len(arrays))
        shown = ", ".join(f"{n}: {name}" for n, (name, _) in enumerate(header.arrays[:8]))
        request.note(f"The file holds {len(arrays)} arrays ({shown}); {header.arrays[index][0]} is shown.")
        request = replace(request, channel=None)
    components = int(arrays[index].GetNumberOfComponents())
    array = vtk_to_numpy(arrays[index])
    if array.shape[0] != int(np.prod(shape, dtype=np.int64)):
        raise request.error("its values do not fit its dimensions; the file is damaged or cut off.")
    shaped = array.reshape(*shape, *((components,) if components > 1 else ()))
    # the array may still belong to VTK, which frees it with the image
    return np.array(to_zyx(shaped, "ZYXS" if components > 1 else "ZYX", request))
