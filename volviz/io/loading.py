"""`open` and `load`: from a path to what it holds, with one clear sentence for everything that can go wrong."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io import raw
from volviz.io.file_source import told_in_a_sentence
from volviz.io.reader import (
    GZIP,
    HEAD_BYTES,
    PACKED_SUFFIXES,
    PART,
    ZIP,
    LoadOptions,
    LoadRequest,
    is_packed,
)  # fmt: skip
from volviz.io.table import READERS
from volviz.volume_data.references import SAMPLE_PREFIX, is_address
from volviz.volume_data.source import checked_box, checked_number

if TYPE_CHECKING:
    from volviz.io.file_source import FileSource
    from volviz.io.table import Reader
    from volviz.volume_data.source import Cancel, Progress, VolumeSource
    from volviz.volume_data.volume import Volume


#: Formats of makers of microscopes, which nothing here reads.
_VENDORS = {
    ".czi": "Zeiss (.czi)", ".lif": "Leica (.lif)", ".nd2": "Nikon (.nd2)", ".oib": "Olympus (.oib)",
    ".oif": "Olympus (.oif)", ".vsi": "Olympus (.vsi)", ".dm3": "Gatan (.dm3)", ".dm4": "Gatan (.dm4)",
}  # fmt: skip


def open(  # noqa: A001 - what it does, as `volviz.open`
    path: str | os.PathLike[str],
    *,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    **hints: Any,
) -> VolumeSource:
    """Open a file, a DICOM folder or a bundled sample: say what it holds, and read parts of it when asked.

    Only headers are read, except of formats that have none at their beginning (legacy VTK files) and of
    volumes that are computed. The world frame is LPS (x to the patient's left, y to posterior, z up), as in
    ITK and DICOM; files in RAS (NIfTI, some NRRD) are turned.

    Parameters
    ----------
    path : str or path
        A file, a folder (of DICOM slices, a Zarr store), ``"sample:<id>"`` (see `volviz.io.samples`), or a URL
        (``https://``, ``s3://``, ``gs://``): stores are read where they are, other files are downloaded first.
    progress : callable(fraction, text), optional
        Called with a fraction 0..1 while headers are read.
    cancel : callable() -> bool, optional
        Asked between headers; True stops the work.
    **hints
        See `volviz.io.LoadOptions`: ``dims``, ``dtype``, ``endian``, ``header`` describe raw files; ``spacing``,
        ``origin``, ``unit``, ``name`` replace what a file says; ``series`` chooses.

    Returns
    -------
    VolumeSource
        Axes, channels, times and geometry; its ``read(level, time, channel, box)`` gives a `Volume`.

    Raises
    ------
    LoadError
        The file is missing, unreadable, damaged, of an unknown format, or holds no volume.
    InputError
        A hint is unknown or unusable.
    Cancelled
    """
    text = os.fspath(path)
    given = LoadOptions.from_keywords(hints)
    if text.startswith(SAMPLE_PREFIX):
        from volviz.io.samples import sample_source

        return sample_source(LoadRequest(Path(text), given, progress=progress, cancel=cancel))
    if is_address(text):
        from volviz.io.addresses import name_in, open_address

        request = LoadRequest(Path(name_in(text)), given, progress=progress, cancel=cancel, address=text)
        return open_address(request, open_file, suffixes())
    return open_file(LoadRequest(Path(text).expanduser(), given, progress=progress, cancel=cancel))


def load(
    path: str | os.PathLike[str],
    *,
    level: int | None = None,
    time: int | None = None,
    channel: int | str | None = None,
    box: Sequence[int] | None = None,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    **hints: Any,
) -> Volume:
    """Load a volume from a file, a DICOM folder or the bundled samples: `open`, then read.

    Parameters
    ----------
    path, **hints
        As for `open`.
    level, time, channel : int, optional
        Which part of a larger file, counted from 0 (a channel by its name, too); default: the finest level that
        fits into memory, the first time point, and the first channel or the brightness of colours. A box alone
        is one of level 0.
    box : sequence of 6 ints, optional
        Voxels (i0, i1, j0, j1, k0, k1) to read, those of i1, j1 and k1 no more.
    progress : callable(fraction, text), optional
        Called with a fraction 0..1 while the file is read.
    cancel : callable() -> bool, optional
        Asked between blocks and slices; True stops the loading.

    Returns
    -------
    Volume
        ``array`` has shape (Z, Y, X) in the file's own data type; ``spacing``, ``origin`` and ``direction`` are
        (x, y, z) in the LPS frame and in ``"length_unit"``. ``metadata`` holds ``"source"`` (path as given,
        absolute), ``"format"``, ``"length_unit"`` ("mm", "µm" or "" when unknown) and ``"notes"`` (a tuple of
        sentences for the user: what was chosen or changed).

    Raises
    ------
    LoadError
        The file is missing, unreadable, damaged, of an unknown format, or holds no volume.
    InputError
        A hint is unknown or unusable, or the file has no such part.
    Cancelled
    """
    source = open(path, progress=progress, cancel=cancel, **hints)
    if level is None and box is None:
        volume = source.read_fitting(time, channel, cancel, progress)
    else:
        volume = source.read(level or 0, time, channel, box, cancel, progress)
    LoadRequest(Path(path), progress=progress, cancel=cancel).report(1.0, "ready")
    return volume


def open_file(request: LoadRequest) -> FileSource:
    """Find the reader for a job and let it open the file."""
    with told_in_a_sentence(request):
        magic = _first_bytes(request.path)
        # some formats are zip files themselves
        if magic.startswith(ZIP) and not any(reader.sniff(magic, request.path) for reader in READERS):
            from volviz.io.packed_files import open_zip

            return open_zip(request, open_file)
        reader = _reader_for(request)
        if not is_packed(magic) or (reader.reads_gzip and magic.startswith(GZIP)):
            return reader.open(request)
        from volviz.io.packed_files import open_unpacked

        return open_unpacked(request, reader.open)


def info(path: str | os.PathLike[str], *, statistics: bool = False, **hints: Any) -> dict[str, Any]:
    """What a file holds, as plain values that print and go into JSON.

    Parameters
    ----------
    path, **hints
        As for `load`.
    statistics : bool, default: False
        Read the values as well: range, what is not finite, the type that `load` gives and damage among the values
        show only then. Otherwise headers alone are read.

    Returns
    -------
    dict
        "name", "format", "source", "dims" (x, y, z), "dtype", "bytes", "spacing", "origin", "direction"
        (9 values, row by row), "length_unit", "unit", "range", "nonfinite", "notes"; of the whole file "sizes"
        (axis: size), "channels" (names), "times" (seconds or None), "levels" (each with "dims", "spacing" and
        "origin"), "labels" (numbers and names) and "series" (what else the file holds, in words).
        From headers alone "dtype" and "bytes" are those of the values as they are stored, None where unknown, "range"
        is None unless the header tells it, and "nonfinite" is None.
    """
    chosen = {name: hints.pop(name) for name in PART if hints.get(name) is not None}
    source = open(path, **{name: value for name, value in hints.items() if name not in PART})
    if "level" not in chosen and "box" not in chosen:
        chosen["level"] = source.default_level
    level = source.levels[checked_number("level", chosen.get("level", 0), len(source.levels), source.name)]
    if "box" in chosen:
        level = level.part(checked_box(chosen["box"], level.dimensions, source.name))
    said = source.description
    found = {
        "name": source.name,
        "format": said.metadata.get("format", ""),
        "source": said.metadata.get("source", ""),
        "dims": list(level.dimensions),
        "dtype": said.dtype or None,
        "bytes": math.prod(level.dimensions) * np.dtype(said.dtype).itemsize if said.dtype else None,
        "spacing": list(level.spacing),
        "origin": list(level.origin),
        "direction": [float(v) for row in level.direction for v in row],
        "length_unit": said.length_unit,
        "unit": source.unit,
        "range": [said.statistics.minimum, said.statistics.maximum] if said.statistics else None,
        "nonfinite": None,
        "notes": list(said.metadata.get("notes", ())),
        "sizes": source.sizes,
        "channels": [channel.name for channel in source.channels] if "c" in source.axes else [],
        "times": None if source.times is None else list(source.times),
        "levels": [
            {"dims": list(each.dimensions), "spacing": list(each.spacing), "origin": list(each.origin)}
            for each in source.levels
        ],
        "labels": [[one.number, one.name] for one in source.labels],
        "series": [each.words for each in source.entries],
    }
    if statistics:
        volume = source.read(**chosen)
        found |= {
            "dtype": str(volume.array.dtype),
            "bytes": int(volume.array.nbytes),
            "range": list(volume.range),
            "nonfinite": volume.nonfinite_count,
            "notes": list(volume.metadata.get("notes", ())),
        }
    return found


def suffixes() -> tuple[str, ...]:
    """All file name endings that some reader takes, lower case, with the dot."""
    return tuple(dict.fromkeys(suffix for reader in READERS for suffix in reader.suffixes))


def file_dialog_filters() -> list[str]:
    """Entries for a file dialog in Qt's syntax: all formats together, each format, all files."""
    packed = [suffix for suffix in (*PACKED_SUFFIXES, ".zip") if suffix not in suffixes()]
    everything = f"Volumes ({' '.join('*' + suffix for suffix in (*suffixes(), *packed))})"
    return [everything, *(reader.dialog_filter for reader in READERS if reader.suffixes), "All files (*)"]


def _reader_for(request: LoadRequest) -> Reader:
    path = request.path
    if not path.exists():
        raise request.error("there is no such file or folder; check the path.")
    if not path.is_file() and not path.is_dir():
        raise request.error(
            "this is no file but a pipe or a device; save what comes out of it as a file first."
        )
    head = _head(path)
    if not head and path.is_file():
        raise request.error("the file is empty; get it again.")
    by_content = next((reader for reader in READERS if reader.sniff(head, path)), None)
    by_name = _by_suffix(path)
    is_raw = path.is_file() and by_name is not None and by_name.name == "Raw"
    # numbers can begin like any file; a size that fits to the byte is no chance
    if is_raw and by_name is not None and (request.hints.dims is not None or raw.fits(request)):
        return by_name
    if by_content is not None:
        return by_content
    if request.hints.dims is not None and path.is_file():
        return next(reader for reader in READERS if reader.name == "Raw")
    if by_name is not None and path.is_file():
        return by_name
    if path.is_dir():
        raise request.error(_found_in_folder(path))
    if (maker := _VENDORS.get(path.suffix.lower())) is not None:
        raise request.error(
            f"files of {maker} are not read; save it as OME-TIFF, with the program of the microscope or with Fiji."
        )
    known = ", ".join(reader.name for reader in READERS)
    raise request.error(f"no reader knows this file (known: {known}); for a raw file give dims= and dtype=.")


def _found_in_folder(folder: Path) -> str:
    """What to say of a folder without DICOM slices and numbered pictures."""
    from volviz.io.dicom.finding import FILES_AT_MOST, has_more_files

    volumes = sorted(p.name for p in folder.iterdir() if p.is_file() and _by_suffix(p) is not None)
    if volumes:
        names = ", ".join(volumes[:3]) + (" ..." if len(volumes) > 3 else "")
        one = "open it" if len(volumes) == 1 else "open one of them"
        return f"a folder is opened for the DICOM slices or numbered pictures in it; this one holds {names}: {one}."
    if has_more_files(folder):
        return (
            f"no DICOM slices were found among the first {FILES_AT_MOST:,} files of the folder; choose the folder "
            "in which the slices lie."
        )
    return "no DICOM slices and no numbered pictures were found in the folder; choose another one, or a file."


def _by_suffix(path: Path) -> Reader | None:
    name = path.name.lower()
    for suffix in PACKED_SUFFIXES:
        if name.endswith(suffix) and is_packed(_first_bytes(path)):
            name = name.removesuffix(suffix)
    fitting = [(len(s), reader) for reader in READERS for s in reader.suffixes if name.endswith(s)]
    return max(fitting, key=lambda pair: pair[0])[1] if fitting else None


def _first_bytes(path: Path) -> bytes:
    """First bytes of a file; empty for folders."""
    if not path.is_file():
        return b""
    with path.open("rb") as stream:
        return stream.read(HEAD_BYTES)


def _head(path: Path) -> bytes:
    """First bytes of a file, unpacked if it is packed; empty for folders."""
    head = _first_bytes(path)
    if not is_packed(head):
        return head
    from volviz.io.unpacking import unpacked_head

    return unpacked_head(path, HEAD_BYTES) or head
