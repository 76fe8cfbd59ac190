"""NIfTI-1, NIfTI-2 and Analyze 7.5 files.

Read here and not by a library: SimpleITK fills a file that is cut off with zeros without a warning, and refuses
slightly sheared axes; nibabel refuses such a file, but, like SimpleITK, can neither report its progress nor be
cancelled.

Sources: the NIfTI-1 header ``nifti1.h`` (R. W. Cox, 2004) and ``nifti2.h`` (2011) for fields, data types,
scaling and the three methods of orientation.
"""

from __future__ import annotations

import gzip
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from volviz.io.endings import NIFTI
from volviz.io.file_source import file_source
from volviz.io.geometry import RAS_TO_LPS, is_usable
from volviz.io.long_doubles import doubles_of
from volviz.io.raw_payload import RawPayload, check_sizes, read_part
from volviz.io.reader import stem
from volviz.io.scaling import is_scaling, rescaled
from volviz.volume_data.description import Channel

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest


Order = Literal["<", ">"]

# Only the fields that are used, by their offsets.
_NIFTI1: dict[str, tuple[int, Any]] = {
    "dim": (40, ("i2", 8)),
    "datatype": (70, "i2"),
    "intent_code": (68, "i2"),
    "pixdim": (76, ("f4", 8)),
    "vox_offset": (108, "f4"),
    "scl_slope": (112, "f4"),
    "scl_inter": (116, "f4"),
    "xyzt_units": (123, "u1"),
    "cal_max": (124, "f4"),
    "cal_min": (128, "f4"),
    "toffset": (136, "f4"),
    "glmax": (140, "i4"),
    "glmin": (144, "i4"),
    # Analyze alone
    "spm_origin": (253, ("i2", 3)),
    "qform_code": (252, "i2"),
    "sform_code": (254, "i2"),
    "quatern": (256, ("f4", 3)),
    "qoffset": (268, ("f4", 3)),
    "srow": (280, ("f4", (3, 4))),
}
_NIFTI2: dict[str, tuple[int, Any]] = {
    "datatype": (12, "i2"),
    "dim": (16, ("i8", 8)),
    "pixdim": (104, ("f8", 8)),
    "vox_offset": (168, "i8"),
    "scl_slope": (176, "f8"),
    "scl_inter": (184, "f8"),
    "cal_max": (192, "f8"),
    "cal_min": (200, "f8"),
    "toffset": (216, "f8"),
    "qform_code": (344, "i4"),
    "sform_code": (348, "i4"),
    "quatern": (352, ("f8", 3)),
    "qoffset": (376, ("f8", 3)),
    "srow": (400, ("f8", (3, 4))),
    "xyzt_units": (500, "i4"),
    "intent_code": (504, "i4"),
}
_SIZES = {348: _NIFTI1, 540: _NIFTI2}

_TYPES = {
    2: "u1", 4: "i2", 8: "i4", 16: "f4", 64: "f8", 256: "i1", 512: "u2", 768: "u4", 1024: "i8", 1280: "u8",
    32: "c8", 1792: "c16", 128: "u1", 2304: "u1",
    # long doubles, as bytes
    1536: "V16",
}  # fmt: skip
_LONG_DOUBLE = 1536
_COLOURS = {128: 3, 2304: 4}

#: Millimetres per unit of length, by the lowest three bits of `xyzt_units`; 0 = not said, taken for mm.
_MILLIMETRES = {0: 1.0, 1: 1000.0, 2: 1.0, 3: 0.001}
#: Seconds per unit of time, by the next three bits.
_SECONDS = {8: 1.0, 16: 1e-3, 24: 1e-6}
_LABELS = 1002


def sniff(head: bytes, path: Path) -> bool:
    """Whether these bytes begin a NIfTI or Analyze header, or the file is the image beside such a header."""
    if path.name.lower().endswith((".img", ".img.gz")):
        return _partner(path, ".hdr") is not None
    return _layout(head) is not None


def open_source(request: LoadRequest) -> FileSource:
    """What the header says; the fourth axis is time, the fifth holds the components of a vector."""
    header_file, data_file = _files(request)
    head = _head(header_file, request)
    found = _layout(head)
    if found is None:
        raise request.error(
            "this is no NIfTI file, though it is called so; check how it was made.", header_file
        )
    header, order = found
    is_pair = header["magic"] in (b"ni1", b"ni2") or header["magic"] == b""
    if is_pair and data_file is None:
        raise request.error(
            f"the image that belongs to this header, {stem(header_file, NIFTI)}.img, is not there; "
            "keep both files in one folder."
        )
    code = int(header["datatype"])
    if code not in _TYPES:
        raise request.error(
            f"values of NIfTI data type {code} cannot be shown; save them as integers or reals."
        )
    rank = int(header["dim"][0])
    if not 1 <= rank <= 7:
        raise request.error(f"its header gives {rank} dimensions; the file is damaged.")
    # sizes beyond the third that nobody has filled in are 0
    sizes = [int(n) or int(at > 2) for at, n in enumerate(header["dim"][1 : rank + 1])] + [1] * (3 - rank)
    file = data_file if is_pair and data_file is not None else header_file
    smallest = 0 if is_pair else (544 if header["size"] == 540 else 352)
    offset = float(header["vox_offset"])
    if not smallest <= offset < 2**40:
        offset = smallest
    shape = (*sizes[::-1], _COLOURS[code]) if code in _COLOURS else tuple(sizes[::-1])
    payload = RawPayload(
        (file,),
        shape,
        np.dtype(_TYPES[code]).newbyteorder(order),
        offset=int(offset),
        encoding="gzip" if _is_gzip(file) else "raw",
    )
    check_sizes(payload, request)
    # anything beyond the fifth axis is taken at its first entry
    for _ in range(rank - 5):
        payload = payload.frame(0)
    axes = "CTZYX"[-max(3, min(rank, 5)) :] + ("S" if code in _COLOURS else "")

    slope, intercept = float(header["scl_slope"]), float(header["scl_inter"])
    if np.isfinite(slope) and slope != 0 and not np.isfinite(intercept):
        request.note("The file gives a slope for its values and no usable intercept; 0 is taken.")
        intercept = 0.0

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        array = read_part(payload, axes, request, colour=True)
        if code == _LONG_DOUBLE:
            request.note("Its 128-bit numbers are shown as 64-bit ones; digits beyond the 16th are lost.")
            array = doubles_of(array, order)
        if array.dtype.kind == "c":
            request.note("Complex values are shown as their magnitude.")
            array = np.abs(array)
        elif code not in _COLOURS:
            array = rescaled(array, slope, intercept)
        return array

    low, high = float(header["cal_min"]), float(header["cal_max"])
    return file_source(
        request,
        values,
        axes,
        payload.shape,
        request.geometry(_affine(header, request)),
        format="NIfTI",
        name=stem(request.path, NIFTI),
        is_rescaled=code not in _COLOURS and is_scaling(slope, intercept),
        dtype=np.float64 if code == _LONG_DOUBLE else payload.dtype,
        colour=True,
        channels=[Channel(window=(low, high))] if low < high < np.inf else (),
        times=_times(header, sizes[3]) if rank > 3 else None,
        is_labels=int(header["intent_code"]) == _LABELS,
        length_unit="mm",
    )


def _times(header: dict[str, Any], count: int) -> list[float] | None:
    """Seconds of the time points, None when the header gives no distance in a unit of time."""
    unit = _SECONDS.get(int(header["xyzt_units"]) & 0x38)
    step, start = float(header["pixdim"][4]), float(header["toffset"])
    if unit is None or not 0.0 < step < np.inf or not np.isfinite(start):
        return None
    return [unit * (start + step * index) for index in range(count)]


def affine(header: dict[str, Any]) -> npt.NDArray[np.float64] | None:
    """Index to world matrix (RAS, in the file's unit of length), or None when the header names none.

    The sform is taken when its code is above 0 and it spans space, else the qform, as is custom: the sform
    is the transform that a registration wrote last.

    Parameters
    ----------
    header : dict
        "sform_code", "srow" (3 x 4), "qform_code", "quatern" (b, c, d), "qoffset" (3), "pixdim" (8).
    """
    result = np.eye(4)
    if header["sform_code"] > 0 and is_usable(np.asarray(header["srow"], float)[:, :3]):
        result[:3] = header["srow"]
        return result
    if header["qform_code"] > 0:
        b, c, d = (float(v) for v in header["quatern"])
        # rounding can push the sum of squares above one; then it is a half turn
        rest = 1.0 - (b * b + c * c + d * d)
        if rest < 1e-7:
            length = (b * b + c * c + d * d) ** 0.5
            a, b, c, d = 0.0, b / length, c / length, d / length
        else:
            a = rest**0.5
        rotation = np.array(
            [
                [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
                [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
                [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c],
            ]
        )
        steps = np.abs(np.asarray(header["pixdim"][1:4], float))
        if header["pixdim"][0] < 0:
            steps[2] = -steps[2]
        result[:3, :3] = rotation * steps
        result[:3, 3] = header["qoffset"]
        return result if is_usable(result[:3, :3]) else None
    return None


def _affine(header: dict[str, Any], request: LoadRequest) -> npt.NDArray[np.float64]:
    """Index to world, LPS, millimetres."""
    # what a damaged header says may not even be a number
    with np.errstate(over="ignore", invalid="ignore"):
        return _placed(header, request)


def _placed(header: dict[str, Any], request: LoadRequest) -> npt.NDArray[np.float64]:
    matrix = _analyze_affine(header, request) if not header["magic"] else affine(header)
    if matrix is None:
        request.note("The file does not say how it lies in space; right, anterior, superior is taken.")
        steps = np.abs(np.asarray(header["pixdim"][1:4], float))
        if not np.all(np.isfinite(steps)) or steps.min() <= 0:
            request.note("The file gives no distance between voxels; 1 is taken.")
            steps = np.where(np.isfinite(steps) & (steps > 0), steps, 1.0)
        matrix = np.diag([*steps, 1.0])
    unit = _MILLIMETRES.get(int(header["xyzt_units"]) & 7, 1.0)
    return np.asarray(RAS_TO_LPS @ matrix[:3] * unit)


def _analyze_affine(header: dict[str, Any], request: LoadRequest) -> npt.NDArray[np.float64]:
    """Index to world (RAS) of an Analyze file, as SPM and nibabel take it: the first axis leads to the left.

    A file of MATLAB beside it says more (SPM99, SPM2), else the header may hold the voxel that is the origin.
    """
    beside = _partner(request.path, ".mat")
    found = None if beside is None else _matlab_affine(beside)
    if found is not None:
        return found
    steps = np.abs(np.asarray(header["pixdim"][1:4], float))
    if not np.all(np.isfinite(steps)) or steps.min() <= 0:
        request.note("The file gives no distance between voxels; 1 is taken.")
        steps = np.where(np.isfinite(steps) & (steps > 0), steps, 1.0)
    sizes = np.maximum(np.asarray(header["dim"][1:4], float), 1)
    # counted from 1
    origin = np.asarray(header["spm_origin"], float)
    if not np.any(origin) or np.any(origin < -sizes) or np.any(origin > 2 * sizes):
        request.note(
            "The file does not say how it lies in space; left, anterior, superior from its middle is taken."
        )
        origin = (sizes + 1) / 2
    steps[0] = -steps[0]
    result = np.diag([*steps, 1.0])
    result[:3, 3] = -steps * (origin - 1)
    return result


def _matlab_affine(path: Path) -> npt.NDArray[np.float64] | None:
    """The matrix "mat", or "M" of a mirrored x axis, from voxels that are counted from 1; None without either."""
    from scipy.io import loadmat

    try:
        held = loadmat(path, variable_names=["mat", "M"])
        matrix = np.asarray(held["mat"] if "mat" in held else np.diag([-1, 1, 1, 1]) @ held["M"], np.float64)
        matrix = matrix.reshape(4, 4, -1)[..., 0].copy()
    except Exception:  # noqa: BLE001 - what a damaged file raises inside the library has no end
        return None
    matrix[:3, 3] = matrix[:3] @ np.ones(4)
    return matrix if is_usable(matrix[:3, :3]) and np.all(np.isfinite(matrix)) else None


def _analyze_scaling(header: dict[str, Any]) -> tuple[float, float]:
    """Slope and intercept of an Analyze file: SPM's, else those that its two ranges give, else none (0)."""
    slope, intercept = float(header["scl_slope"]), float(header["scl_inter"])
    if np.isfinite(slope) and slope != 0:
        return slope, intercept if np.isfinite(intercept) else 0.0
    low, high = int(header["glmin"]), int(header["glmax"])
    first, last = float(header["cal_min"]), float(header["cal_max"])
    if low < high and -np.inf < first < last < np.inf:
        slope = (last - first) / (high - low)
        return slope, first - slope * low
    return 0.0, 0.0


def _layout(head: bytes) -> tuple[dict[str, Any], Order] | None:
    """Fields of the header and its byte order ("<" or ">"), or None when these bytes are no header."""
    orders: tuple[Order, ...] = ("<", ">")
    for order in orders:
        size = int.from_bytes(head[:4], "little" if order == "<" else "big")
        if size not in _SIZES or len(head) < size:
            continue
        fields = _SIZES[size]
        kind = np.dtype(
            {
                "names": list(fields),
                "formats": [_with_order(f, order) for _, f in fields.values()],
                "offsets": [offset for offset, _ in fields.values()],
                "itemsize": size,
            }
        )
        record = np.frombuffer(head[:size], kind)[0]
        header: dict[str, Any] = {name: record[name] for name in fields}
        magic = head[4:7] if size == 540 else head[344:347]
        header["magic"] = magic if magic in (b"n+1", b"ni1", b"n+2", b"ni2") else b""
        header["size"] = size
        if not header["magic"]:
            # Analyze 7.5: what NIfTI uses for orientation and scaling holds other things there
            if size == 540 or not 1 <= header["dim"][0] <= 7:
                continue
            slope, intercept = _analyze_scaling(header)
            header.update(qform_code=0, sform_code=0, xyzt_units=0, intent_code=0)
            header.update(scl_slope=slope, scl_inter=intercept, cal_min=0.0, cal_max=0.0, toffset=0.0)
        return header, order
    return None


def _with_order(kind: Any, order: str) -> Any:
    return (order + kind[0], kind[1]) if isinstance(kind, tuple) else order + kind


def _files(request: LoadRequest) -> tuple[Path, Path | None]:
    """Header file and, for pairs, the file of the values (None when it is not there)."""
    path = request.path
    name = path.name.lower()
    if name.endswith((".img", ".img.gz")):
        header = _partner(path, ".hdr")
        if header is None:
            raise request.error(
                f"the header that belongs to this image, {stem(path, NIFTI)}.hdr, is not there; "
                "keep both files in one folder."
            )
        return header, path
    if name.endswith((".hdr", ".hdr.gz")):
        return path, _partner(path, ".img")
    return path, None


def _partner(path: Path, suffix: str) -> Path | None:
    base = stem(path, NIFTI)
    for end in (suffix, suffix + ".gz", suffix.upper()):
        candidate = path.with_name(base + end)
        if candidate.is_file():
            return candidate
    return None


def _is_gzip(path: Path) -> bool:
    with path.open("rb") as stream:
        return stream.read(2) == b"\x1f\x8b"


def _head(path: Path, request: LoadRequest) -> bytes:
    if not _is_gzip(path):
        with path.open("rb") as stream:
            return stream.read(544)
    try:
        with gzip.open(path) as stream:
            return stream.read(544)
    except (OSError, EOFError, zlib.error):
        raise request.error("the compressed data is damaged or cut off; get the file again.", path) from None
