"""VTK images: XML (.vti) and legacy (.vtk) structured points, point or cell values.

VTK says nothing about patients; its coordinates are taken for the world frame as they are.
"""

from __future__ import annotations

import math
import os
import re
from dataclasses import dataclass, replace
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from volviz.errors import InputError
from volviz.io.axes import choose, to_zyx
from volviz.io.file_source import file_source
from volviz.io.memory import check_memory
from volviz.io.reader import stem
from volviz.io.vtk_blocks import are_believable
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

#: The header of a file lies within its first bytes.
HEADER_BYTES = 1 << 20

#: Bytes of the types that legacy files name.
_LEGACY_TYPES = {
    b"bit": 1 / 8, b"unsigned_char": 1, b"char": 1, b"signed_char": 1, b"unsigned_short": 2, b"short": 2,
    b"unsigned_int": 4, b"int": 4, b"unsigned_long": 8, b"long": 8, b"vtktypeint64": 8, b"vtktypeuint64": 8,
    b"vtkidtype": 4, b"float": 4, b"double": 8,
}  # fmt: skip

#: Lines of a legacy file behind which values lie: kind and name, or name, components and tuples of a field.
_LEGACY_ARRAY = re.compile(
    rb"(?:(?P<kind>SCALARS|VECTORS|NORMALS|TENSORS6?)[ \t]+\S+[ \t]+(?P<type>\w+)(?:[ \t]+(?P<width>\d+))?"
    rb"|\S+[ \t]+(?P<components>\d+)[ \t]+(?P<tuples>\d+)[ \t]+(?P<field>\w+))[ \t\r]*",
    re.IGNORECASE,
)
#: In the name of every type; a line is not longer than this.
_TYPE_WORDS = (b"bit", b"char", b"short", b"int", b"long", b"float", b"double", b"idtype")
_LINE_BYTES = 512
_BLOCK = 1 << 18
_COMPONENTS = {b"SCALARS": 1, b"VECTORS": 3, b"NORMALS": 3, b"TENSORS": 9, b"TENSORS6": 6}


def sniff(head: bytes, _path: Path) -> bool:
    """Whether these are the first bytes of a VTK file, XML or legacy."""
    return (
        head.startswith(b"# vtk DataFile") or re.match(rb"\s*(<\?xml[^>]*>\s*)?<VTKFile\b", head) is not None
    )


@dataclass(frozen=True)
class _Arrays:
    """The arrays at the points of an image, or at its cells."""

    #: Name and number of components of each.
    listed: tuple[tuple[str, int], ...]
    active: int | None
    dtype: npt.DTypeLike | None

    @property
    def channels(self) -> list[tuple[int, int, str]]:
        """Array, component and name of what can be chosen: every component of every array."""
        return [
            (number, component, name if count == 1 else f"{name} [{component}]")
            for number, (name, count) in enumerate(self.listed)
            for component in range(count)
        ]


@dataclass(frozen=True)
class _Header:
    """What there is in an image: its lattice, and the arrays at its points and at its cells."""

    extent: tuple[int, ...]
    spacing: tuple[float, ...]
    origin: tuple[float, ...]
    direction: npt.NDArray[np.float64]
    points: _Arrays
    cells: _Arrays


def open_source(request: LoadRequest) -> FileSource:
    """What the header says. The arrays of a legacy file lie one after another without a list: it is read as a whole."""
    with request.path.open("rb") as stream:
        head = stream.read(HEADER_BYTES)
    if not sniff(head, request.path):
        raise request.error("this is no VTK file, though it is called so; check how it was made.")
    legacy = head.startswith(b"#")
    _check(request, head, legacy=legacy)
    request.report(0.0)
    image = _image(request, legacy=True) if legacy else None
    header = _header_of_image(image) if legacy else _header_of_xml(request)
    if not header.points.listed and not header.cells.listed:
        raise request.error(
            "the VTK file holds no numbers at its points or cells; save it with an array of scalars."
        )
    dimensions = [high - low + 1 for low, high in zip(header.extent[::2], header.extent[1::2], strict=True)]
    start_index = np.array(header.extent[::2], float)
    is_cell = _is_cell(request, header)
    arrays = header.cells if is_cell else header.points
    if is_cell:
        request.note("The values belong to cells; they are shown at the middles of the cells.")
        dimensions = [max(n - 1, 1) for n in dimensions]
        # the value of a cell lies in its middle
        start_index += 0.5
    # numbers that are not finite are refused below
    with np.errstate(over="ignore", invalid="ignore"):
        matrix = header.direction * np.asarray(header.spacing)
        start = np.asarray(header.origin) + matrix @ start_index
    shape = tuple(dimensions[::-1])
    is_single = len(arrays.listed) == 1

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        read = image if image is not None else _image(request, legacy=False)
        request.report(0.9)
        data = read.GetCellData() if is_cell else read.GetPointData()
        return _values(request, data, arrays, shape)

    return file_source(
        request,
        values,
        "ZYXS" if is_single else "ZYXC",
        (*shape, len(arrays.channels)),
        request.geometry(np.c_[matrix, start]),
        format="VTK",
        name=stem(request.path, SUFFIXES),
        dtype=arrays.dtype,
        channels=() if is_single else [Channel(name) for _, _, name in arrays.channels],
        field=arrays.listed[arrays.active or 0][0],
    )


def _is_cell(request: LoadRequest, header: _Header) -> bool:
    """Whether the values of cells are shown: where there are no others, or they are chosen by ``series=1``."""
    groups = [arrays for arrays in (header.points, header.cells) if arrays.listed]
    wanted = request.hints.series
    if wanted is None and len(groups) > 1:
        names = ", ".join(name for name, _ in header.cells.listed[:8])
        request.note(
            f"The values at the points are shown; choose those at the cells ({names}) with series=1."
        )
    if wanted is None:
        return not header.points.listed
    if not isinstance(wanted, int) or not 0 <= wanted < len(groups):
        raise InputError(f"{request.path.name}: series must lie in 0..{len(groups) - 1}, got {wanted!r}.")
    return groups[wanted] is header.cells


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
    if legacy:
        _check_legacy(request, head, counts)
    elif voxels > request.path.stat().st_size * PACKING:
        raise request.error(
            f"the file is cut off: its header promises {voxels:,} voxels, more than it can hold."
        )


def _check_legacy(request: LoadRequest, head: bytes, counts: list[int]) -> None:
    """Refuse a legacy file, which is never packed, whose lines promise more values than it can hold.

    VTK asks for the memory of an array as soon as it has read such a line, and ends the process without it.
    """
    size = request.path.stat().st_size
    points, cells = math.prod(counts), math.prod(max(n - 1, 1) for n in counts)
    is_text = re.search(rb"^[ \t]*ASCII\b", head, re.MULTILINE | re.IGNORECASE) is not None
    wanted, least, memory, at = 0.0, 0.0, 0.0, 0
    with request.path.open("rb") as stream:
        while (array := _next_array(request, stream, at)) is not None:
            found, at = array
            each = _LEGACY_TYPES[(found["type"] or found["field"]).lower()]
            if found["kind"]:
                width = int(found["width"] or _COMPONENTS[found["kind"].upper()])
                fewest, most = min(points, cells) * width, points * width
            else:
                fewest = most = int(found["components"]) * int(found["tuples"])
            # a value in text has a digit and a blank
            least += fewest * (2 if is_text else each)
            wanted += fewest
            memory += most * each
            # nothing is looked for among values
            at += 0 if is_text else int(fewest * each)
    # without any such line there is at least a bit for each point, or for each cell
    if least > size + 1 or min(points, cells) > 8 * size:
        what = f"{wanted:,.0f} values" if least > size + 1 else f"{points:,} voxels"
        raise request.error(f"the file is cut off: its header promises {what}, more than it can hold.")
    check_memory(request, int(memory))


def _next_array(request: LoadRequest, stream: IO[bytes], at: int) -> tuple[re.Match[bytes], int] | None:
    """The next line from byte `at` on behind which values lie, and where it ends; found by the names of types."""
    size = request.path.stat().st_size
    while at < size:
        request.report(0.1 * at / size)
        stream.seek(at)
        data = stream.read(_BLOCK)
        hits = []
        for word in (*_TYPE_WORDS, *map(bytes.upper, _TYPE_WORDS)):
            hit = data.find(word)
            while hit >= 0:
                first = data.rfind(b"\n", max(hit - _LINE_BYTES, 0), hit) + 1
                last = data.find(b"\n", hit, hit + _LINE_BYTES)
                found = _LEGACY_ARRAY.fullmatch(data, first, last) if last > 0 else None
                if found is not None and (found["type"] or found["field"]).lower() in _LEGACY_TYPES:
                    hits.append((last, found))
                    break
                hit = data.find(word, hit + 1)
        if hits:
            last, found = min(hits, key=lambda one: one[0])
            return found, at + last
        # a line may have been cut in two
        at += max(len(data) - _LINE_BYTES, 1) if at + len(data) < size else len(data)
    return None


def _check_xml(request: LoadRequest, header: _Header, sizes: list[int]) -> None:
    """Refuse an XML file whose arrays cannot have been packed into it, or do not fit into memory."""
    counts = [high - low + 1 for low, high in zip(header.extent[::2], header.extent[1::2], strict=True)]
    points, cells = math.prod(counts), math.prod(max(n - 1, 1) for n in counts)
    each = [
        count * components
        for count, arrays in ((points, header.points), (cells, header.cells))
        for _, components in arrays.listed
    ]
    wanted = sum(count * size for count, size in zip(each, sizes, strict=True))
    if wanted > request.path.stat().st_size * PACKING:
        raise request.error(
            f"the file is cut off: its header promises {wanted:,} bytes of values, more than it can hold."
        )
    # arrays beside those of numbers are small
    if not are_believable(request.path, max(wanted, 8 * points, 1 << 20)):
        raise request.error("its packed values are not listed as they should be; the file is damaged.")
    check_memory(request, wanted)


def _header_of_image(image: Any) -> _Header:
    """The header of an image that was read."""
    matrix = image.GetDirectionMatrix()

    def found(data: Any) -> _Arrays:
        arrays, active = _arrays(data), data.GetScalars()
        return _Arrays(
            tuple((a.GetName() or "", int(a.GetNumberOfComponents())) for a in arrays),
            next((n for n, a in enumerate(arrays) if a is active), None),
            _dtype(arrays[0].GetDataType()) if arrays else None,
        )

    return _Header(
        image.GetExtent(),
        image.GetSpacing(),
        image.GetOrigin(),
        np.array([[matrix.GetElement(i, j) for j in range(3)] for i in range(3)]),
        found(image.GetPointData()),
        found(image.GetCellData()),
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

    sizes: list[int] = []

    def found(key: Any) -> _Arrays:
        entries = information.Get(key)
        count = 0 if entries is None else entries.GetNumberOfInformationObjects()
        every = [entries.GetInformationObject(n) for n in range(count)]
        arrays = [each for each in every if _dtype(each.Get(Data.FIELD_ARRAY_TYPE())) is not None]
        sizes.extend(np.dtype(_dtype(each.Get(Data.FIELD_ARRAY_TYPE()))).itemsize for each in arrays)
        return _Arrays(
            tuple(
                (each.Get(Data.FIELD_NAME()) or "", int(each.Get(Data.FIELD_NUMBER_OF_COMPONENTS()) or 1))
                for each in arrays
            ),
            # the lowest bit: active scalars (vtkDataSetAttributes::SCALARS)
            next(
                (n for n, a in enumerate(arrays) if int(a.Get(Data.FIELD_ACTIVE_ATTRIBUTE()) or 0) & 1), None
            ),
            _dtype(arrays[0].Get(Data.FIELD_ARRAY_TYPE())) if arrays else None,
        )

    header = _Header(
        extent,
        information.Get(Data.SPACING()) or (1.0, 1.0, 1.0),
        information.Get(Data.ORIGIN()) or (0.0, 0.0, 0.0),
        np.reshape(information.Get(Data.DIRECTION()) or np.eye(3), (3, 3)),
        found(Data.POINT_DATA_VECTOR()),
        found(Data.CELL_DATA_VECTOR()),
    )
    _check_xml(request, header, sizes)
    return header


def _dtype(kind: int) -> npt.DTypeLike | None:
    """Type of VTK's arrays of numbers, bits as bytes; None for texts."""
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


def _values(request: LoadRequest, data: Any, arrays: _Arrays, shape: tuple[int, ...]) -> npt.NDArray[Any]:
    """The component that is asked for, else the active scalars, else the first array."""
    found = _arrays(data)
    if len(found) != len(arrays.listed):
        raise request.error("some of its arrays cannot be read; the file is damaged or cut off.")
    index = 0
    if len(found) > 1:
        channels = arrays.channels
        if request.channel is None:
            index = arrays.active or 0
        else:
            index, component, _ = channels[choose(request, "C", len(channels))]
        shown = ", ".join(f"{n}: {name}" for n, (_, _, name) in enumerate(channels[:8]))
        request.note(
            f"The file holds {len(found)} arrays, with the channels {shown}; {arrays.listed[index][0]} is shown."
        )
        if request.channel is not None:
            request = replace(request, channel=component)
    components = arrays.listed[index][1]
    array = _numbers(found[index])
    if array.size != math.prod(shape) * components:
        raise request.error("its values do not fit its dimensions; the file is damaged or cut off.")
    shaped = array.reshape(*shape, *((components,) if components > 1 else ()))
    # the array may still belong to VTK, which frees it with the image
    return np.array(to_zyx(shaped, "ZYXS" if components > 1 else "ZYX", request))


def _numbers(array: Any) -> npt.NDArray[Any]:
    """The values of an array of VTK; bits, which are packed, as 0 and 1."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.util.vtkConstants import VTK_BIT

    if array.GetDataType() != VTK_BIT:
        return np.asarray(vtk_to_numpy(array))
    return np.unpackbits(array, count=array.GetNumberOfValues())
