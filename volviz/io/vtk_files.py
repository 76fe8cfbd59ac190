"""VTK images and even rectilinear grids: XML (.vti, .vtr, and .pvti, .pvtr in pieces) and legacy (.vtk).

Values lie at points or at cells. VTK says nothing about patients; its coordinates are taken for the
world frame as they are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import InputError
from volviz.io.axes import choose, to_zyx
from volviz.io.endings import VTK
from volviz.io.file_source import file_source
from volviz.io.memory import check_memory
from volviz.io.reader import stem
from volviz.io.vtk_blocks import are_believable
from volviz.io.vtk_kinds import (
    HEADER_BYTES,
    PACKING,
    Kind,
    check_sizes,
    kind_in,
    new_reader,
    pieces_of,
    sniff,
)
from volviz.io.vtk_messages import vtk_complaints
from volviz.volume_data.description import Channel

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest


#: Coordinates are even when they stray by this fraction of their distance at most: digits of a text, or floats.
EVEN = 1e-3


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
    kind = kind_in(request, head)
    check_sizes(request, head, kind)
    request.report(0.0)
    image = _image(request, kind) if kind.is_legacy else None
    header = _header_of_image(request, image) if image is not None else _header_of_xml(request, kind)
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
        read = image if image is not None else _image(request, kind)
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
        name=stem(request.path, VTK),
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


def _check_xml(request: LoadRequest, header: _Header, sizes: list[int], kind: Kind) -> None:
    """Refuse an XML file whose arrays cannot have been packed into it, or do not fit into memory."""
    counts = [high - low + 1 for low, high in zip(header.extent[::2], header.extent[1::2], strict=True)]
    points, cells = math.prod(counts), math.prod(max(n - 1, 1) for n in counts)
    each = [
        count * components
        for count, arrays in ((points, header.points), (cells, header.cells))
        for _, components in arrays.listed
    ]
    wanted = sum(count * size for count, size in zip(each, sizes, strict=True))
    files = pieces_of(request) if kind.is_parallel else [request.path]
    if wanted > sum(file.stat().st_size for file in files) * PACKING:
        raise request.error(
            f"the file is cut off: its header promises {wanted:,} bytes of values, more than it can hold."
        )
    # arrays beside those of numbers are small
    if not all(are_believable(file, max(wanted, 8 * points, 1 << 20)) for file in files):
        raise request.error("its packed values are not listed as they should be; the file is damaged.")
    check_memory(request, wanted)


def _header_of_image(request: LoadRequest, image: Any) -> _Header:
    """The header of a data set that was read."""

    def found(data: Any) -> _Arrays:
        arrays, active = _arrays(data), data.GetScalars()
        return _Arrays(
            tuple((a.GetName() or "", int(a.GetNumberOfComponents())) for a in arrays),
            next((n for n, a in enumerate(arrays) if a is active), None),
            _dtype(arrays[0].GetDataType()) if arrays else None,
        )

    arrays = found(image.GetPointData()), found(image.GetCellData())
    if hasattr(image, "GetXCoordinates"):
        spacing, origin = _even(request, image)
        return _Header(image.GetExtent(), tuple(spacing), tuple(origin), np.eye(3), *arrays)
    matrix = image.GetDirectionMatrix()
    return _Header(
        image.GetExtent(),
        image.GetSpacing(),
        image.GetOrigin(),
        np.array([[matrix.GetElement(i, j) for j in range(3)] for i in range(3)]),
        *arrays,
    )


def _even(request: LoadRequest, grid: Any) -> tuple[list[float], list[float]]:
    """Distance of the points of a rectilinear grid along x, y, z, and the place of index 0.

    Raises
    ------
    LoadError
        They are not even.
    """
    spacing, origin = [], []
    extent = grid.GetExtent()
    for axis, letter in enumerate("XYZ"):
        values = np.asarray(_numbers(getattr(grid, f"Get{letter}Coordinates")()), np.float64)
        if len(values) != extent[2 * axis + 1] - extent[2 * axis] + 1 or not np.all(np.isfinite(values)):
            raise request.error("its coordinates do not fit its dimensions; the file is damaged or cut off.")
        gaps = np.diff(values)
        step = float((values[-1] - values[0]) / len(gaps)) if len(gaps) else 1.0
        if step == 0 or np.abs(values - values[0] - step * np.arange(len(values))).max() > EVEN * abs(step):
            raise request.error(
                f"its {letter.lower()} coordinates lie {np.abs(gaps).min():.4g} to {np.abs(gaps).max():.4g} apart, "
                "and a volume needs even ones; resample it (ParaView: Resample To Image)."
            )
        spacing.append(step)
        origin.append(float(values[0]) - step * extent[2 * axis])
    return spacing, origin


def _header_of_xml(request: LoadRequest, kind: Kind) -> _Header:
    """The header of an XML file, without its values."""
    from vtkmodules.vtkCommonDataModel import vtkDataObject as Data
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

    reader = new_reader(kind, request.path)
    with vtk_complaints() as complaints:
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
    _check_xml(request, header, sizes, kind)
    if not kind.is_rectilinear:
        return header
    # the coordinates alone
    reader.GetPointDataArraySelection().DisableAllArrays()
    reader.GetCellDataArraySelection().DisableAllArrays()
    with vtk_complaints() as complaints:
        reader.Update()
    if complaints.GetOutput():
        raise request.error("VTK cannot read it; the file is damaged, cut off or of an unusual kind.")
    spacing, origin = _even(request, reader.GetOutput())
    return replace(header, spacing=tuple(spacing), origin=tuple(origin))


def _dtype(kind: int) -> npt.DTypeLike | None:
    """Type of VTK's arrays of numbers, bits as bytes; None for texts."""
    from vtkmodules.util.numpy_support import get_vtk_to_numpy_typemap

    found: npt.DTypeLike | None = get_vtk_to_numpy_typemap().get(kind)
    return found


def _image(request: LoadRequest, kind: Kind) -> Any:
    """The data set with its values; VTK's errors become one sentence, and its progress ours."""
    reader = new_reader(kind, request.path)
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
