"""Multi-page TIFF, with the spacing that ImageJ and OME write."""

from __future__ import annotations

import logging
import math
import struct
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import InputError, VolvizError
from volviz.io.axes import choose, to_zyx
from volviz.io.geometry import Geometry
from volviz.io.memory import check_memory
from volviz.io.reader import stem

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt
    import tifffile

    from volviz.io.geometry import Vector
    from volviz.io.reader import Job
    from volviz.model.volume import Volume

SUFFIXES = (".tif", ".tiff", ".ome.tif", ".ome.tiff", ".lsm", ".tf8", ".btf")

_MAGIC = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")

#: Codes of tag 296 (ResolutionUnit): inch, centimetre, millimetre, micrometre; in micrometres.
_RESOLUTION_UNITS = {2: 25400.0, 3: 10000.0, 4: 1000.0, 5: 1.0}
_SAME_UNIT = dict.fromkeys(("micron", "microns", "um", "\\u00b5m", "\u03bcm", "micrometer"), "µm")


def sniff(head: bytes, _path: Path) -> bool:
    """Whether these are the first bytes of a TIFF or BigTIFF file."""
    return head[:4] in _MAGIC


def read(job: Job) -> Volume:
    """Read one volume: one time point and channel of the largest series of the file."""
    import tifffile

    log = logging.getLogger("tifffile")
    level = log.level
    # damage is answered with one sentence; the library's log would repeat it on the terminal
    log.setLevel(logging.CRITICAL + 1)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with tifffile.TiffFile(job.path) as file:
                return _read(job, file)
    except (VolvizError, OSError, MemoryError):
        raise
    except Exception:  # noqa: BLE001 - what a damaged file raises inside the library and its codecs has no end
        raise job.error("this TIFF file is damaged, cut off or of an unusual kind; save it again.") from None
    finally:
        log.setLevel(level)


def _read(job: Job, file: tifffile.TiffFile) -> Volume:
    series = _series(job, file)
    if _is_cut_off(file, series):
        raise job.error("the file is cut off: its last pages are missing; get it again.")
    array, axes = _array(job, series)
    colour = "S" in axes and series.keyframe.photometric in (2, 6) and series.keyframe.photometric is not None
    spacing, length_unit = _spacing(job, file, series)
    scalars = to_zyx(array, axes, job, colour=colour)
    if scalars.dtype.kind == "c":
        job.note("Complex values are shown as their magnitude.")
        scalars = np.abs(scalars)
    return job.volume(
        scalars, Geometry(spacing), format="TIFF", name=stem(job.path, SUFFIXES), length_unit=length_unit
    )


def _series(job: Job, file: tifffile.TiffFile) -> tifffile.TiffPageSeries:
    every = list(file.series)
    if not every:
        raise job.error("the TIFF file holds no image; get it again.")
    wanted = job.hints.series
    if wanted is None:
        if len(every) > 1:
            job.note(f"The largest of {len(every)} images is shown; choose with series=0..{len(every) - 1}.")
        return max(every, key=lambda s: s.size)
    if not isinstance(wanted, int) or not 0 <= wanted < len(every):
        raise InputError(f"{job.path.name}: series must lie in 0..{len(every) - 1}, got {wanted!r}.")
    return every[wanted]


def _array(job: Job, series: tifffile.TiffPageSeries) -> tuple[npt.NDArray[Any], str]:
    """The chosen time point and channel, page by page where pages are images of their own."""
    axes = _meaning(job, series.axes.upper())
    shape = tuple(int(n) for n in series.shape)
    if series.dtype is None or series.dtype.kind not in "buifc":
        raise job.error(f"values of type {series.dtype} cannot be shown; save them as numbers.")
    page = series.keyframe
    in_page = page.ndim
    leading = shape[: len(shape) - in_page]
    _check_size(job, series)
    if int(np.prod(leading, dtype=np.int64)) != len(series.pages) or page.shape != shape[len(leading) :]:
        job.report(0.1, "reading pages")
        for number in range(len(series.pages)):
            _page(job, series, number)
        check_memory(job, series.nbytes)
        return series.asarray(), axes
    # one page per index of the leading axes: read those of the wanted time point and channel alone
    index: list[Any] = [slice(None)] * len(leading)
    for letter in "TC":
        if letter in axes[: len(leading)]:
            at = axes.index(letter)
            index[at] = choose(job, letter, leading[at])
    numbers = np.asarray(np.arange(len(series.pages)).reshape(leading)[tuple(index)])
    kept = "".join(letter for letter, i in zip(axes, index, strict=False) if isinstance(i, slice))
    kept += axes[len(leading) :]
    check_memory(job, numbers.size * page.nbytes)
    array = np.empty((numbers.size, *page.shape), series.dtype)
    for number, page_number in enumerate(numbers.flat):
        job.report(number / numbers.size, "reading pages")
        array[number] = _page(job, series, int(page_number)).asarray()
    return array.reshape((*numbers.shape, *page.shape)), kept


def _page(job: Job, series: tifffile.TiffPageSeries, number: int) -> tifffile.TiffPage | tifffile.TiffFrame:
    """One page, which must be of the size that the first one promises."""
    page = series.pages[number]
    if page is None:
        raise job.error(f"page {number} of {len(series.pages)} is missing; the file is damaged.")
    if page.shape != series.keyframe.shape:
        raise job.error(f"page {number} has another size than the first one; the file is damaged.")
    return page


def _is_cut_off(file: tifffile.TiffFile, series: tifffile.TiffPageSeries) -> bool:
    """Whether the chain of pages leads beyond the end of the file while pixels of the series are missing."""
    stream, tiff = file.filehandle, file.tiff
    if series.dataoffset is not None and series.dataoffset + series.nbytes <= stream.size:
        return False
    last = file.pages[-1]
    stream.seek(last.offset)
    (count,) = struct.unpack(tiff.tagnoformat, stream.read(tiff.tagnosize))
    stream.seek(last.offset + tiff.tagnosize + count * tiff.tagsize)
    following = stream.read(tiff.offsetsize)
    return len(following) < tiff.offsetsize or bool(
        struct.unpack(tiff.offsetformat, following)[0] >= stream.size
    )


def _meaning(job: Job, axes: str) -> str:
    """Axes of a file with Z, T and C given to those that have no name (Q, I, R: pages), Z first."""
    free = [letter for letter in "ZTC" if letter not in axes]
    for at, letter in enumerate(axes):
        if letter not in "TCZYXS" and free:
            axes = axes[:at] + free.pop(0) + axes[at + 1 :]
    if "Z" not in axes:
        for letter, word in (("T", "time points"), ("C", "channels")):
            if letter in axes:
                job.note(f"The file names its pages {word}; they are stacked as slices.")
                return axes.replace(letter, "Z")
    return axes


def _check_size(job: Job, series: tifffile.TiffPageSeries) -> None:
    """A header that promises more than any compression could have packed into the file is damaged."""
    page = series.keyframe
    size = job.path.stat().st_size
    plain = page.compression == 1 and page.is_contiguous
    # each piece needs an entry that says where it lies; missing ones would be gone through one by one
    pieces = math.prod(page.chunked) > len(page.dataoffsets)
    if pieces or (series.nbytes > size * (1 if plain else 100_000) and not series.is_multifile):
        raise job.error("the file is cut off: its header promises more pixels than it can hold.")


def _spacing(job: Job, file: tifffile.TiffFile, series: tifffile.TiffPageSeries) -> tuple[Vector, str]:
    """Spacing (x, y, z) and its unit, from OME, ImageJ or the resolution tags, in this order."""
    if file.is_ome:
        found = _ome(file)
        if found is not None:
            return found
    tags = series.keyframe.tags
    x, y = (_per_pixel(tags, name) for name in ("XResolution", "YResolution"))
    if file.is_imagej:
        info = file.imagej_metadata or {}
        unit = str(info.get("unit", "") or "")
        unit = _SAME_UNIT.get(unit.lower(), "" if unit in ("pixel", "pixels") else unit)
        z = abs(float(info.get("spacing", 0) or 0))
        return (x or 1.0, y or 1.0, z or x or 1.0), unit
    code = int(tags["ResolutionUnit"].value) if "ResolutionUnit" in tags else 1
    if not x or not y or code not in _RESOLUTION_UNITS or abs(x - y) < 1e-12:
        # 72 or 300 dots per inch are a printer's, no microscope's; without a z distance they would mislead
        job.note("The file does not say how far its pages lie apart; voxels are taken for cubes of side 1.")
        return (1.0, 1.0, 1.0), ""
    job.note("The file does not say how far its pages lie apart; the distance of its columns is taken.")
    micrometres = _RESOLUTION_UNITS[code]
    return (x * micrometres, y * micrometres, x * micrometres), "µm"


def _per_pixel(tags: Any, name: str) -> float | None:
    if name not in tags:
        return None
    above, below = tags[name].value
    return below / above if above and below else None


def _ome(file: tifffile.TiffFile) -> tuple[Vector, str] | None:
    # expat neither fetches external entities nor expands internal ones without bound
    import xml.etree.ElementTree as ET

    try:
        root = ET.fromstring(file.ome_metadata or "")  # noqa: S314
    except ET.ParseError:
        return None
    pixels = next((e for e in root.iter() if e.tag.endswith("}Pixels")), None)
    if pixels is None or "PhysicalSizeX" not in pixels.attrib:
        return None
    try:
        x, y, z = (float(pixels.get(f"PhysicalSize{c}", pixels.attrib["PhysicalSizeX"])) for c in "XYZ")
    except ValueError:
        return None
    unit = pixels.get("PhysicalSizeXUnit", "µm")
    return ((x, y, z), _SAME_UNIT.get(unit.lower(), unit)) if min(x, y, z) > 0 else None
