"""Formats of neuroimaging by nibabel: MGH and MGZ of FreeSurfer, MINC 1 and 2, AFNI, Philips PAR/REC.

nibabel reads headers, scaling and orientation (RAS, turned to LPS here). Where the values are one run of bytes (MGH,
AFNI), they are read as those of other formats are, with progress; else nibabel reads them slice by slice.
"""

from __future__ import annotations

import gzip
import io
import re
import struct
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import VolvizError
from volviz.io.axes import choose, to_zyx
from volviz.io.endings import AFNI, MGH, MINC, PARREC
from volviz.io.file_source import file_source
from volviz.io.geometry import RAS_TO_LPS
from volviz.io.memory import check_memory
from volviz.io.raw_payload import RawPayload, check_sizes, read_part
from volviz.io.reader import stem
from volviz.io.scaling import rescaled

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest


#: Bytes of the header of an MGH file, and the types of values that it can name.
_MGH_HEADER = 284
_MGH_TYPES = {0: "u1", 1: "i4", 3: "f4", 4: "i2"}


def sniff_mgh(head: bytes, _path: Path) -> bool:
    """Whether these bytes begin with version 1, four sizes and a type of values, as those of FreeSurfer do."""
    if len(head) < _MGH_HEADER:
        return False
    version, *sizes, kind = struct.unpack(">6i", head[:24])
    return version == 1 and all(0 < n < 1 << 20 for n in sizes) and kind in _MGH_TYPES


def sniff_minc(head: bytes, path: Path) -> bool:
    """Whether this is netCDF or HDF5 of the MINC kind, by the names in its beginning or its own."""
    is_container = head.startswith((b"CDF\x01", b"CDF\x02", b"\x89HDF\r\n\x1a\n"))
    names = (b"minc-2.0", b"MINC standard variable", b"xspace")
    return is_container and (path.name.lower().endswith(MINC) or any(name in head for name in names))


def sniff_afni(head: bytes, path: Path) -> bool:
    """Whether this is a header of AFNI, or the values beside one."""
    if path.name.lower().endswith((".brik", ".brik.gz")):
        return _partner(path, (".HEAD", ".head")) is not None
    return re.match(rb"\s*type\s*=\s*(string|integer|float)-attribute\b", head) is not None


def sniff_parrec(head: bytes, path: Path) -> bool:
    """Whether this is a header of Philips, or the values beside one."""
    if path.name.lower().endswith(".rec"):
        beside = _partner(path, (".PAR", ".par"))
        return beside is not None and sniff_parrec(_first(beside), beside)
    return head.startswith(b"# === DATA DESCRIPTION FILE")


def open_mgh(request: LoadRequest) -> FileSource:
    """What the header says; frames are time points."""
    is_packed = _first(request.path).startswith(b"\x1f\x8b")
    header = _mgh_header(request, is_packed=is_packed)
    shape = tuple(int(n) for n in header.get_data_shape())
    payload = RawPayload(
        (request.path,),
        shape[::-1],
        np.dtype(">" + _MGH_TYPES[int(header["type"])]),
        offset=_MGH_HEADER,
        encoding="gzip" if is_packed else "raw",
        # tags follow the values
        whole=False,
    )
    milliseconds = float(header["tr"])
    step = milliseconds / 1000.0 if 0.0 < milliseconds < np.inf else None
    return _source(request, payload, header.get_affine(), "MGH", MGH, step=step)


def _mgh_header(request: LoadRequest, *, is_packed: bool) -> Any:
    """The header by nibabel; of several frames with the time between them, which stands behind the values."""
    from nibabel.freesurfer.mghformat import MGHHeader

    with request.path.open("rb") as file:
        stream: Any = gzip.GzipFile(fileobj=file) if is_packed else file
        with _told_as_damage(request, "MGH"):
            try:
                head = stream.read(_MGH_HEADER)
            except EOFError:
                head = b""
            if not sniff_mgh(head, request.path):
                raise request.error("this is no MGH file, though it is called so; check how it was made.")
            header = MGHHeader.from_fileobj(io.BytesIO(head))
            if len(header.get_data_shape()) > 3:
                stream.seek(0)
                header = MGHHeader.from_fileobj(stream)
    return header


def open_afni(request: LoadRequest) -> FileSource:
    """What the header says; sub-bricks are time points, each with a factor of its own."""
    import nibabel

    header_file = request.path
    if header_file.name.lower().endswith((".brik", ".brik.gz")):
        header_file = _partner(header_file, (".HEAD", ".head")) or header_file
    image = _opened(request, nibabel.brikhead.AFNIImage, header_file, "AFNI")
    file = next(
        (beside for ending in (".BRIK", ".BRIK.gz", ".brik", ".brik.gz")
         if (beside := header_file.with_name(header_file.name[:-5] + ending)).is_file()), None,
    )  # fmt: skip
    if file is None:
        raise request.error(
            f"the values that belong to this header, {header_file.name[:-5]}.BRIK, are not there; keep both files in "
            "one folder."
        )
    payload = RawPayload(
        (file,),
        tuple(int(n) for n in image.shape[::-1]),
        image.dataobj.dtype,
        encoding="gzip" if _first(file).startswith(b"\x1f\x8b") else "raw",
    )
    scaling = image.dataobj.scaling
    factors = None if scaling is None else [float(f) for f in np.asarray(scaling).ravel()]
    return _source(request, payload, image.affine, "AFNI", AFNI, factors=factors)


def open_minc(request: LoadRequest) -> FileSource:
    """What the header says. Slices have ranges of their own, so nibabel reads the values."""
    import nibabel

    kind = nibabel.Minc2Image if _first(request.path).startswith(b"\x89HDF") else nibabel.Minc1Image
    image = _opened(request, kind, request.path, "MINC")
    # its arrays have the slowest axis first
    axes, affine = "TZYX"[-len(image.shape) :], image.affine[:, [2, 1, 0, 3]]
    return _by_slices(request, image.dataobj, np.dtype(image.get_data_dtype()), axes, affine, "MINC", MINC)


def open_parrec(request: LoadRequest) -> FileSource:
    """What the header says; dynamics, echoes and the like are time points."""
    from nibabel.parrec import PARRECArrayProxy, PARRECHeader

    path = request.path
    if path.name.lower().endswith(".rec"):
        path = _partner(path, (".PAR", ".par")) or path
    if not sniff_parrec(_first(path), path):
        raise request.error("this is no PAR file of Philips, though it is called so; check how it was made.")
    values = _partner(path, (".REC", ".rec"))
    if values is None:
        raise request.error(
            f"the values that belong to this header, {path.stem}.REC, are not there; keep both files in one folder."
        )
    with _told_as_damage(request, "PAR/REC"):
        with path.open(encoding="latin-1") as stream:
            header = PARRECHeader.from_fileobj(stream)
        image = PARRECArrayProxy(str(values), header)
        affine = header.get_affine()
    stored = np.dtype(header.get_data_dtype())
    check_sizes(RawPayload((values,), tuple(header.get_data_shape()), stored, whole=False), request)
    axes = "XYZT"[: len(image.shape)]
    return _by_slices(request, image, stored, axes, affine, "PAR/REC", PARREC)


@contextmanager
def _told_as_damage(request: LoadRequest, name: str) -> Iterator[None]:
    """What nibabel raises about a damaged header becomes one sentence."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except (VolvizError, OSError, MemoryError):
        raise
    except Exception:  # noqa: BLE001 - what a damaged file raises inside the library has no end
        raise request.error(
            f"this {name} file is damaged, cut off or of an unusual kind; get it again."
        ) from None


def _opened(request: LoadRequest, kind: Any, path: Path, name: str) -> Any:
    """Nibabel's image of a file, of which the header has been read."""
    with _told_as_damage(request, name):
        image = kind.from_filename(path)
    if len(image.shape) not in (3, 4):
        raise request.error(
            f"it has {len(image.shape)} axes; save it with the axes x, y, z and at most time."
        )
    return image


def _source(
    request: LoadRequest,
    payload: RawPayload,
    affine: npt.NDArray[np.float64],
    kind: str,
    suffixes: tuple[str, ...],
    *,
    factors: Sequence[float] | None = None,
    step: float | None = None,
) -> FileSource:
    """Values that are one run of bytes, x fastest."""
    check_sizes(payload, request)
    axes = "TZYX"[-len(payload.shape) :]

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        array = read_part(payload, axes, request)
        if factors is None:
            return array
        return rescaled(array, factors[min(request.time or 0, len(factors) - 1)], 0.0)

    count = payload.shape[0] if axes[0] == "T" else 1
    return file_source(
        request,
        values,
        axes,
        payload.shape,
        request.geometry(RAS_TO_LPS @ affine[:3]),
        format=kind,
        name=stem(request.path, suffixes),
        dtype=payload.dtype,
        times=None if step is None else [step * number for number in range(count)],
        length_unit="mm",
    )


def _by_slices(
    request: LoadRequest,
    proxy: Any,
    stored: np.dtype[Any],
    axes: str,
    affine: npt.NDArray[np.float64],
    kind: str,
    suffixes: tuple[str, ...],
) -> FileSource:
    """Values that nibabel reads and scales, one slice after another."""
    sizes = dict(zip(axes, proxy.shape, strict=True))
    # whole numbers that were scaled: float32 has digits enough for 16 bits
    wanted = np.float32 if stored.kind in "ui" and stored.itemsize <= 2 else None

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        index: list[Any] = [slice(None)] * len(axes)
        if "T" in axes:
            index[axes.index("T")] = choose(request, "T", int(sizes["T"]))
        first, last = (0, int(sizes["Z"])) if request.box is None else request.box[4:]
        check_memory(request, 8 * (last - first) * int(sizes["Y"]) * int(sizes["X"]))
        slices = []
        for number in range(first, last):
            request.report((number - first) / (last - first))
            index[axes.index("Z")] = slice(number, number + 1)
            with _told_as_damage(request, kind):
                part = np.asarray(proxy[tuple(index)])
            slices.append(part if wanted is None or part.dtype.kind != "f" else part.astype(wanted))
        array = np.concatenate(slices, axis=axes.replace("T", "").index("Z"))
        return to_zyx(array, axes.replace("T", ""), request.within_slices())

    return file_source(
        request,
        values,
        axes,
        proxy.shape,
        request.geometry(RAS_TO_LPS @ affine[:3]),
        format=kind,
        name=stem(request.path, suffixes),
        length_unit="mm",
    )


def _partner(path: Path, endings: tuple[str, ...]) -> Path | None:
    """The other file of a pair."""
    base = path.name[: -len(".gz")] if path.name.lower().endswith(".gz") else path.name
    base = base.rpartition(".")[0]
    return next((beside for end in endings if (beside := path.with_name(base + end)).is_file()), None)


def _first(path: Path) -> bytes:
    with path.open("rb") as stream:
        return stream.read(64)
