"""DICOM files among others: by their first bytes, or by the list that a DICOMDIR holds."""

from __future__ import annotations

import gzip
import io
import os
import warnings
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO

#: A folder is given up after so many files: a home folder must not take minutes.
FILES_AT_MOST = 200_000
FOLDERS_DEEP = 16
DIRECTORY_NAME = "DICOMDIR"

_GZIP = b"\x1f\x8b"
_HEAD = 512


def sniff(head: bytes, path: Path) -> bool:
    """Whether this is a DICOM file, or a folder in which DICOM files lie."""
    if path.is_dir():
        return next(files_below(path), None) is not None
    return looks_like_dicom(head)


def looks_like_dicom(head: bytes) -> bool:
    """Whether these first bytes belong to a DICOM file, with or without its preamble.

    Without a preamble the file begins with its first element: a tag of group 0002 or 0008 and, in the explicit form,
    two letters that name a value representation, or a length that is not absurd for such an element.
    """
    if head[128:132] == b"DICM":
        return True
    if len(head) < 12 or head[:2] not in (b"\x02\x00", b"\x08\x00"):
        return False
    if head[2:4] not in (b"\x00\x00", b"\x01\x00", b"\x05\x00", b"\x08\x00", b"\x16\x00", b"\x18\x00"):
        return False
    if head[4:6] in (b"UL", b"CS", b"UI", b"OB"):
        return True
    length = int.from_bytes(head[4:8], "little")
    following = 8 + length
    # a second element of a header must follow, so that the numbers of a raw file do not pass
    if not 0 < length <= 256 or following + 4 > len(head):
        return False
    first, second = (_tag(head[at : at + 4]) for at in (0, following))
    return first < second <= (0x0028, 0xFFFF) and second[0] % 2 == 0


def _tag(four: bytes) -> tuple[int, int]:
    return int.from_bytes(four[:2], "little"), int.from_bytes(four[2:], "little")


def files_below(folder: Path, at_most: int = FILES_AT_MOST) -> Iterator[Path]:
    """DICOM files of a folder: those that its DICOMDIR lists, else all below it that look like DICOM.

    Folders come in order, links are not followed in circles. Gives up after `at_most` files.
    """
    directory = next((p for p in folder.iterdir() if p.name.upper() == DIRECTORY_NAME and p.is_file()), None)
    listed = files_of_directory(directory) if directory is not None else []
    if listed:
        yield from listed[:at_most]
        return
    tried = 0
    base = len(folder.parts)
    for place, folders, names in os.walk(folder):
        here = Path(place)
        folders[:] = sorted(folders) if len(here.parts) - base < FOLDERS_DEEP else []
        for name in sorted(names):
            if tried >= at_most:
                return
            path = here / name
            if name.startswith(".") or name.upper() == DIRECTORY_NAME or not path.is_file():
                continue
            tried += 1
            try:
                head = _head(path)
            except (OSError, EOFError, zlib.error):
                continue
            if looks_like_dicom(head):
                yield path


def _head(path: Path) -> bytes:
    """First bytes of a file, unpacked where gzip has packed it."""
    with path.open("rb") as stream:
        head = stream.read(_HEAD)
        if not head.startswith(_GZIP):
            return head
        stream.seek(0)
        return gzip.GzipFile(fileobj=stream).read(_HEAD)


def opened(path: Path) -> IO[bytes]:
    """A file for reading, one that gzip has packed unpacked in memory: slices are small.

    Raises
    ------
    OSError
        Damaged or cut off, too.
    """
    stream = path.open("rb")
    if stream.read(2) != _GZIP:
        stream.seek(0)
        return stream
    with stream:
        stream.seek(0)
        try:
            return io.BytesIO(gzip.GzipFile(fileobj=stream).read())
        except (EOFError, zlib.error) as error:
            raise gzip.BadGzipFile(str(error)) from None


def has_more_files(folder: Path, than: int = FILES_AT_MOST) -> bool:
    """Whether so many files lie below a folder that not all of them are looked at."""
    count = 0
    for _, _, names in os.walk(folder):
        count += len(names)
        if count > than:
            return True
    return False


def files_of_directory(directory: Path) -> list[Path]:
    """Image files that a DICOMDIR lists and that are there (DICOM PS3.3, F.3); empty when it lists none.

    Names are compared without regard to case, since discs are written in capitals and often copied in small letters.
    """
    import pydicom

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            records = pydicom.dcmread(directory).get("DirectoryRecordSequence", ())
            names = [record.get("ReferencedFileID") for record in records]
        except Exception:  # noqa: BLE001 - what a damaged directory raises inside the library has no end
            return []
    found = []
    for name in names:
        if not name:
            continue
        path: Path | None = directory.parent
        for part in [name] if isinstance(name, str) else name:
            path = _member(path, str(part)) if path is not None else None
        if path is not None and path.is_file():
            found.append(path)
    return found


def _member(folder: Path, name: str) -> Path | None:
    exact = folder / name
    if exact.exists():
        return exact
    if not folder.is_dir():
        return None
    return next((p for p in folder.iterdir() if p.name.upper() == name.upper()), None)
