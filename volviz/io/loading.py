"""`load`: from a path to a `Volume`, with one clear sentence for everything that can go wrong."""

from __future__ import annotations

import os
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from volviz.io.reader import HEAD_BYTES, SAMPLE_PREFIX, Hints, Job
from volviz.io.table import READERS

if TYPE_CHECKING:
    from volviz.io.reader import Cancel, Progress, Reader
    from volviz.model.volume import Volume


def load(
    path: str | os.PathLike[str],
    *,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
    **hints: Any,
) -> Volume:
    """Load a volume from a file, a DICOM folder or the bundled samples.

    The world frame of every volume is LPS (x to the patient's left, y to posterior, z up), as in ITK and
    DICOM; files in RAS (NIfTI, some NRRD) are turned.

    Parameters
    ----------
    path : str or path
        A file, a folder with DICOM slices, or ``"sample:<id>"`` (see `volviz.io.samples`).
    progress : callable(fraction, text), optional
        Called with a fraction 0..1 while the file is read.
    cancel : callable() -> bool, optional
        Asked between blocks and slices; True stops the loading.
    **hints
        See `volviz.io.Hints`: ``dims``, ``dtype``, ``endian``, ``header`` describe raw files; ``spacing``,
        ``origin``, ``unit``, ``name`` replace what a file says; ``time``, ``channel``, ``series`` choose.

    Returns
    -------
    Volume
        ``metadata`` holds ``"source"`` (path as given, absolute), ``"format"``, ``"length_unit"`` ("mm",
        "µm" or "" when unknown) and ``"notes"`` (a tuple of sentences for the user: what was chosen or
        changed).

    Raises
    ------
    LoadError
        The file is missing, unreadable, damaged, of an unknown format, or holds no volume.
    InputError
        A hint is unknown or unusable.
    Cancelled
    """
    text = os.fspath(path)
    given = Hints.from_keywords(hints)
    if text.startswith(SAMPLE_PREFIX):
        from volviz.io.samples import sample

        return sample(text.removeprefix(SAMPLE_PREFIX), progress=progress, cancel=cancel, **hints)
    job = Job(Path(text).expanduser(), given, progress, cancel)
    volume = read_file(job)
    job.report(1.0, "ready")
    return volume


def read_file(job: Job) -> Volume:
    """Find the reader for a job and let it read; what the system complains about becomes one sentence."""
    try:
        return _reader_for(job).read(job)
    except PermissionError:
        raise job.error("you may not read it; change its permissions or copy it.") from None
    except MemoryError:
        raise job.error("it does not fit into memory; crop it or save it with fewer voxels.") from None
    except OSError as error:
        reason = (error.strerror or "unknown reason").lower()
        raise job.error(f"the system cannot read it ({reason}); check disk and path.") from None


def info(path: str | os.PathLike[str], **hints: Any) -> dict[str, Any]:
    """What a file holds, as plain values that print and go into JSON.

    The file is read completely, since range and damage show only then.

    Returns
    -------
    dict
        "name", "format", "source", "dims" (x, y, z), "dtype", "bytes", "spacing", "origin", "direction"
        (9 values, row by row), "length_unit", "unit", "range", "nonfinite", "notes".
    """
    volume = load(path, **hints)
    low, high = volume.range
    return {
        "name": volume.name,
        "format": volume.metadata.get("format", ""),
        "source": volume.metadata.get("source", ""),
        "dims": list(volume.dimensions),
        "dtype": str(volume.array.dtype),
        "bytes": int(volume.array.nbytes),
        "spacing": list(volume.spacing),
        "origin": list(volume.origin),
        "direction": [float(v) for v in volume.direction.flat],
        "length_unit": volume.metadata.get("length_unit", ""),
        "unit": volume.unit,
        "range": [low, high],
        "nonfinite": volume.nonfinite_count,
        "notes": list(volume.metadata.get("notes", ())),
    }


def suffixes() -> tuple[str, ...]:
    """All file name endings that some reader takes, lower case, with the dot."""
    return tuple(dict.fromkeys(suffix for reader in READERS for suffix in reader.suffixes))


def file_dialog_filters() -> list[str]:
    """Entries for a file dialog in Qt's syntax: all formats together, each format, all files."""
    everything = f"Volumes ({' '.join('*' + suffix for suffix in suffixes())})"
    return [everything, *(reader.dialog_filter for reader in READERS if reader.suffixes), "All files (*)"]


def _reader_for(job: Job) -> Reader:
    path = job.path
    if not path.exists():
        raise job.error("there is no such file or folder; check the path.")
    head = _head(path)
    if not head and path.is_file():
        raise job.error("the file is empty; get it again.")
    by_content = next((reader for reader in READERS if reader.sniff(head, path)), None)
    by_name = _by_suffix(path)
    if path.is_file() and by_name is not None and by_name.name == "Raw" and job.hints.dims is not None:
        return by_name
    if by_content is not None:
        return by_content
    if job.hints.dims is not None and path.is_file():
        return next(reader for reader in READERS if reader.name == "Raw")
    if by_name is not None and path.is_file():
        return by_name
    if path.is_dir():
        raise job.error("the folder holds no DICOM slices; choose a folder of DICOM files, or one file.")
    known = ", ".join(reader.name for reader in READERS)
    raise job.error(f"no reader knows this file (known: {known}); for a raw file give dims= and dtype=.")


def _by_suffix(path: Path) -> Reader | None:
    name = path.name.lower()
    fitting = [(len(s), reader) for reader in READERS for s in reader.suffixes if name.endswith(s)]
    return max(fitting, key=lambda pair: pair[0])[1] if fitting else None


def _head(path: Path) -> bytes:
    """First bytes of a file, unpacked if it is gzipped; empty for folders."""
    if not path.is_file():
        return b""
    with path.open("rb") as stream:
        head = stream.read(HEAD_BYTES)
    if head[:2] == b"\x1f\x8b":
        try:
            return zlib.decompressobj(wbits=31).decompress(head, HEAD_BYTES)
        except zlib.error:
            return head
    return head
