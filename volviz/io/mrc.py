"""MRC and CCP4 maps of electron microscopy and crystallography; the header by mrcfile, lengths in ångström.

Source: "MRC2014 file format" (A. Cheng et al., J. Struct. Biol. 192, 2015): which axis of the cell columns, rows and
sections run along (MAPC, MAPR, MAPS), cells with any angles, where the first voxel lies (ORIGIN, else NSTART).
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.endings import MRC
from volviz.io.file_source import file_source
from volviz.io.raw_payload import RawPayload, check_sizes, read_part
from volviz.io.reader import stem
from volviz.volume_data.description import Statistics

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest


HEADER = 1024
_TYPES = {0: "i1", 1: "i2", 2: "f4", 4: "c8", 6: "u2", 12: "f2"}
#: Space groups of a stack of images, and of a stack of volumes (401 and above).
_IMAGES, _VOLUMES = 0, 401
#: "IMOD", whose files hold bytes without a sign where the lowest bit of its flags is not set.
_IMOD = 1146047817


def sniff(head: bytes, _path: Path) -> bool:
    """Whether a header of 1024 bytes names itself a map."""
    return len(head) >= HEADER and head[208:211] == b"MAP"


def open_source(request: LoadRequest) -> FileSource:
    """What the header says; a stack of volumes is one of time points."""
    header = _header(request)
    columns, rows, sections = int(header.nx), int(header.ny), int(header.nz)
    mode = int(header.mode)
    if not 0 <= mode < 1000:
        raise request.error("this is no MRC file, though it is called so; check how it was made.")
    if mode not in _TYPES:
        raise request.error(
            f"values of the MRC mode {mode} cannot be shown; save it as integers or real numbers."
        )
    if min(columns, rows, sections) < 1:
        raise request.error(
            f"its header gives the size {columns} x {rows} x {sections}; the file is damaged."
        )
    # which axis of the cell the columns, rows and sections follow, from 0
    along = [int(header.mapc) - 1, int(header.mapr) - 1, int(header.maps) - 1]
    if sorted(along) != [0, 1, 2]:
        if any(axis != -1 for axis in along):
            request.note(
                "Its header does not say which axes its columns, rows and sections are; x, y, z is taken."
            )
        along = [0, 1, 2]
    kind = _TYPES[mode]
    if mode == 0 and _is_unsigned(header):
        kind = "u1"
    axes = "".join("XYZ"[axis] for axis in reversed(along))
    shape: tuple[int, ...] = (sections, rows, columns)
    volumes = int(header.mz) if int(header.ispg) >= _VOLUMES else 0
    if volumes > 0 and sections % volumes == 0 and sections > volumes:
        axes, shape = "T" + axes, (sections // volumes, volumes, rows, columns)
    if int(header.ispg) == _IMAGES and sections > 1 and request.path.name.lower().endswith(".mrcs"):
        request.note("It is a stack of images; they are shown as slices of a volume.")
    dtype = np.dtype(header.mode.dtype.byteorder + kind)
    payload = RawPayload(
        (request.path,), shape, dtype, offset=HEADER + max(int(header.nsymbt), 0), whole=False
    )
    check_sizes(payload, request)

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        array = read_part(payload, axes, request)
        if array.dtype.kind == "c":
            request.note("Complex values are shown as their magnitude.")
            array = np.abs(array)
        return array

    low, high = float(header.dmin), float(header.dmax)
    return file_source(
        request,
        values,
        axes,
        shape,
        request.geometry(_affine(request, header, along)),
        format="MRC",
        name=stem(request.path, MRC),
        dtype=dtype,
        # a highest value below the lowest one means that nobody has counted
        statistics=Statistics(low, high) if low < high and mode != 4 else None,
        length_unit="Å",
    )


def _header(request: LoadRequest) -> Any:
    import mrcfile

    with warnings.catch_warnings():
        # of what is odd in a header, only what matters is told, in a sentence
        warnings.simplefilter("ignore")
        try:
            with mrcfile.open(request.path, permissive=True, header_only=True) as file:
                header = file.header
        except (ValueError, TypeError):
            header = None
    if header is None:
        raise request.error("this is no MRC file, though it is called so; check how it was made.")
    return header


def _is_unsigned(header: Any) -> bool:
    """Whether IMOD has written bytes without a sign."""
    extra = (
        np.frombuffer(header.extra2.tobytes(), header.mode.dtype) if "extra2" in header.dtype.names else ()
    )
    at = next((n for n, word in enumerate(extra) if int(word) == _IMOD), None)
    return at is not None and at + 1 < len(extra) and not int(extra[at + 1]) & 1


def _affine(request: LoadRequest, header: Any, along: list[int]) -> npt.NDArray[np.float64]:
    """Index along the axes of the cell to world: a along x, b in the plane of x and y."""
    cell = np.array([header.cella.x, header.cella.y, header.cella.z], np.float64)
    samples = np.array([header.mx, header.my, header.mz], np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        steps = cell / samples
    if not np.all(np.isfinite(steps)) or steps.min() <= 0:
        request.note("The file gives no distance between voxels; 1 is taken.")
        steps = np.ones(3)
    angles = np.array([header.cellb.alpha, header.cellb.beta, header.cellb.gamma], np.float64)
    axes = np.eye(3)
    # nobody has filled in angles of 0
    if np.all(np.isfinite(angles)) and np.all(angles > 0) and np.all(angles < 180):
        axes = _axes_of_cell(angles, axes)
    matrix = axes * steps
    origin = np.array([header.origin.x, header.origin.y, header.origin.z], np.float64)
    starts = np.zeros(3)
    starts[along] = int(header.nxstart), int(header.nystart), int(header.nzstart)
    if not np.any(origin) or not np.all(np.isfinite(origin)):
        origin = matrix @ starts
    affine: npt.NDArray[np.float64] = np.c_[matrix, origin]
    return affine


def _axes_of_cell(angles: npt.NDArray[np.float64], usual: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Unit vectors along a, b and c as columns, from the angles between b and c, a and c, a and b in degrees."""
    if np.allclose(angles, 90.0, atol=1e-4):
        return usual
    cos_a, cos_b, cos_g = np.cos(np.radians(angles))
    sin_g = np.sin(np.radians(angles[2]))
    y = (cos_a - cos_b * cos_g) / sin_g
    rest = 1.0 - cos_b**2 - y**2
    # three angles that no cell has
    if rest <= 1e-6:
        return usual
    found: npt.NDArray[np.float64] = np.array(
        [[1.0, cos_g, cos_b], [0.0, sin_g, y], [0.0, 0.0, np.sqrt(rest)]]
    )
    return found
