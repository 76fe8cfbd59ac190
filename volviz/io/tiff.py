"""Multi-page TIFF, with the spacing that ImageJ and OME write."""

from __future__ import annotations

import logging
import math
import struct
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import InputError, VolvizError
from volviz.io.axes import choose, to_zyx
from volviz.io.endings import TIFF
from volviz.io.entries import Entry
from volviz.io.file_source import file_source
from volviz.io.geometry import Geometry
from volviz.io.memory import check_memory
from volviz.io.reader import stem
from volviz.io.scaling import is_scaling, rescaled
from volviz.io.tiff_metadata import calibration_of, channels_of, missing_files, spacing_of, times_of

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt
    import tifffile

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest


_MAGIC = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")

#: Photometric interpretations (tag 262).
MIN_IS_WHITE, PALETTE = 0, 3

_LOCK = threading.RLock()


def sniff(head: bytes, _path: Path) -> bool:
    """Whether these are the first bytes of a TIFF or BigTIFF file."""
    return head[:4] in _MAGIC


def open_source(request: LoadRequest) -> FileSource:
    """The largest series of the file, with its time points and channels."""
    import tifffile

    with quiet(request), tifffile.TiffFile(request.path) as file:
        return _source(request, file)


@contextmanager
def quiet(request: LoadRequest) -> Iterator[None]:
    """Answer damage with one sentence; the library's log and warnings would repeat it on the terminal."""
    log = logging.getLogger("tifffile")
    # both are set for the whole process
    with _LOCK:
        level = log.level
        log.setLevel(logging.CRITICAL + 1)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                yield
        except (VolvizError, OSError, MemoryError):
            raise
        except Exception:  # noqa: BLE001 - what a damaged file raises inside the library and its codecs has no end
            raise request.error(
                "this TIFF file is damaged, cut off or of an unusual kind; save it again."
            ) from None
        finally:
            log.setLevel(level)


def _source(request: LoadRequest, file: tifffile.TiffFile) -> FileSource:
    series = _series(request, file)
    if missing := missing_files(request, file):
        names = ", ".join(missing[:3]) + (", …" if len(missing) > 3 else "")
        raise request.error(
            f"it belongs to a set of files, of which {names} does not lie beside it; put all of them there."
        )
    if _is_cut_off(file, series):
        raise request.error("the file is cut off: its last pages are missing; get it again.")
    axes = _meaning(request, series.axes.upper())
    if series.dtype is None or series.dtype.kind not in "buifc":
        raise request.error(f"values of type {series.dtype} cannot be shown; save them as numbers.")
    if not set("YX") <= set(axes) or len(set(axes)) < len(axes):
        raise request.error(f"its axes {axes!r} are not those of a volume; save it with the axes z, y, x.")
    _check_size(request, series)
    colour = "S" in axes and series.keyframe.photometric in (2, 6) and series.keyframe.photometric is not None
    spacing, length_unit = spacing_of(request, file, series)
    slope, intercept, unit = calibration_of(request, file)
    if series.keyframe.photometric == MIN_IS_WHITE:
        request.note("Its low values are meant to look white; the stored values are shown, high ones bright.")
    if series.keyframe.photometric == PALETTE:
        request.note("Its pixels are indices of a palette of colours; the indices are shown.")
    sizes = dict(zip(axes, series.shape, strict=True))

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        with quiet(request):
            # it was closed when its pages were known
            file.filehandle.open()
            try:
                scalars = _values(request, series, axes, colour=colour)
            finally:
                file.filehandle.close()
        if scalars.dtype.kind == "c":
            request.note("Complex values are shown as their magnitude.")
            scalars = np.abs(scalars)
        return rescaled(scalars, slope, intercept)

    return file_source(
        request,
        values,
        axes,
        series.shape,
        Geometry(spacing),
        format="TIFF",
        name=stem(request.path, TIFF),
        is_rescaled=is_scaling(slope, intercept),
        dtype=series.dtype,
        colour=colour,
        entries=_entries(file),
        channels=channels_of(file, series, sizes.get("C", 1)),
        times=times_of(file, series, sizes.get("T", 1)),
        unit=unit,
        length_unit=length_unit,
    )


def _series(request: LoadRequest, file: tifffile.TiffFile) -> tifffile.TiffPageSeries:
    every = list(file.series)
    if not every:
        raise request.error("the TIFF file holds no image; get it again.")
    wanted = request.hints.series
    if wanted is None:
        if len(every) > 1:
            request.note(
                f"The largest of {len(every)} images is shown; choose with series=0..{len(every) - 1}."
            )
        # an overview of one page may be larger than the stack behind it
        return max(every, key=lambda s: (math.prod(s.shape[:-2]) > 1, s.size))
    if not str(wanted).isdecimal() or int(wanted) >= len(every):
        raise InputError(f"{request.path.name}: series must lie in 0..{len(every) - 1}, got {wanted!r}.")
    return every[int(wanted)]


def _entries(file: tifffile.TiffFile) -> list[Entry]:
    """The images of a file that have several pages."""
    return [
        Entry(str(n), tuple(map(int, series.shape)), np.dtype(series.dtype).name, str(series.name or ""))
        for n, series in enumerate(file.series)
        if math.prod(series.shape[:-2]) > 1 and series.dtype is not None
    ]


def _values(
    request: LoadRequest, series: tifffile.TiffPageSeries, axes: str, *, colour: bool
) -> npt.NDArray[Any]:
    """The time point, channel and slices of a job, page by page where pages are images of their own."""
    shape = tuple(int(n) for n in series.shape)
    page = series.keyframe
    leading = shape[: len(shape) - page.ndim]
    if int(np.prod(leading, dtype=np.int64)) != len(series.pages) or page.shape != shape[len(leading) :]:
        request.report(0.1, "reading pages")
        for number in range(len(series.pages)):
            _page(request, series, number)
        check_memory(request, series.nbytes)
        return to_zyx(series.asarray(), axes, request, colour=colour)
    # one page per index of the leading axes: read those that are wanted alone
    index: list[Any] = [slice(None)] * len(leading)
    for at, letter in enumerate(axes[: len(leading)]):
        if letter in "TC":
            index[at] = choose(request, letter, leading[at])
        elif letter == "Z" and request.box is not None:
            index[at] = slice(*request.box[4:])
            request = request.within_slices()
    numbers = np.asarray(np.arange(len(series.pages)).reshape(leading)[tuple(index)])
    kept = "".join(letter for letter, i in zip(axes, index, strict=False) if isinstance(i, slice))
    kept += axes[len(leading) :]
    if "C" in axes and "C" not in kept:
        request = replace(request, channel=None)
    check_memory(request, numbers.size * page.nbytes)
    array = np.empty((numbers.size, *page.shape), series.dtype)
    for number, page_number in enumerate(numbers.flat):
        request.report(number / numbers.size, "reading pages")
        array[number] = _page(request, series, int(page_number)).asarray()
    return to_zyx(array.reshape((*numbers.shape, *page.shape)), kept, request, colour=colour)


def _page(
    request: LoadRequest, series: tifffile.TiffPageSeries, number: int
) -> tifffile.TiffPage | tifffile.TiffFrame:
    """One page, which must be of the size that the first one promises."""
    page = series.pages[number]
    if page is None:
        raise request.error(f"page {number} of {len(series.pages)} is missing; the file is damaged.")
    if page.shape != series.keyframe.shape:
        raise request.error(f"page {number} has another size than the first one; the file is damaged.")
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


def _meaning(request: LoadRequest, axes: str) -> str:
    """Axes of a file, with Z, T and C given to those without a name (Q, I, R: pages), the last one first."""
    free = [letter for letter in "ZTC" if letter not in axes]
    for at in reversed(range(len(axes))):
        if axes[at] not in "TCZYXS" and free:
            axes = axes[:at] + free.pop(0) + axes[at + 1 :]
    if "Z" not in axes:
        for letter, word in (("T", "time points"), ("C", "channels")):
            if letter in axes:
                request.note(f"The file names its pages {word}; they are stacked as slices.")
                return axes.replace(letter, "Z")
    return axes


def _check_size(request: LoadRequest, series: tifffile.TiffPageSeries) -> None:
    """A header that promises more than any compression could have packed into the file is damaged."""
    page = series.keyframe
    size = request.path.stat().st_size
    plain = page.compression == 1 and page.is_contiguous
    # each piece needs an entry that says where it lies; missing ones would be gone through one by one
    pieces = math.prod(page.chunked) > len(page.dataoffsets)
    if pieces or (series.nbytes > size * (1 if plain else 100_000) and not series.is_multifile):
        raise request.error("the file is cut off: its header promises more pixels than it can hold.")
