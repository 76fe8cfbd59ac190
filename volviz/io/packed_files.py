"""Files packed as a whole (.nrrd.gz, .npy.bz2, .vti.xz, .nii.zst) and zip files: unpacked, then read as any other.

Readers that unpack while they read (NIfTI, raw) get what gzip has packed as it is.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import weakref
import zipfile
import zlib
from dataclasses import replace
from pathlib import Path
from typing import IO, TYPE_CHECKING

from volviz.errors import LoadError
from volviz.io.reader import PACKED_SUFFIXES
from volviz.io.unpacking import damage, unpacker
from volviz.volume_data.references import content_id

if TYPE_CHECKING:
    from collections.abc import Callable

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest

_BLOCK = 4 << 20

#: Bytes of the disk that stay free whatever a packed file holds.
_LEFT_FREE = 256 << 20


#: Headers whose values lie in another file, which would not be found beside an unpacked copy.
_HEADERS = (".nhdr", ".mhd", ".hdr", ".hv", ".h33", ".par", ".head")


def open_unpacked(request: LoadRequest, opening: Callable[[LoadRequest], FileSource]) -> FileSource:
    """What a reader makes of the unpacked copy, which stays as long as the source does.

    Parameters
    ----------
    opening : callable(LoadRequest) -> FileSource
        Of the reader that knows what is packed.

    Raises
    ------
    LoadError
        Damaged, or larger than the room for temporary files; what the reader refuses.
    Cancelled
    """
    path = request.path
    name = path.name
    for suffix in PACKED_SUFFIXES:
        name = name[: -len(suffix)] if name.lower().endswith(suffix) else name
    if name.lower().endswith(_HEADERS):
        raise request.error("a packed header does not lead to the values beside it; unpack it first.")
    folder = Path(tempfile.mkdtemp(prefix="volviz-"))
    try:
        # under its own name, so that sentences name the file that was asked for
        _unpack(request, folder / path.name)
        source = opening(replace(request, path=folder / path.name))
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    return _kept_with(source, folder, request)


def open_zip(request: LoadRequest, opening: Callable[[LoadRequest], FileSource]) -> FileSource:
    """The one volume in a zip file: a file, a header with the file of its values, or a folder of slices.

    Parameters
    ----------
    opening : callable(LoadRequest) -> FileSource
        Opens any file or folder.

    Raises
    ------
    LoadError
        Damaged, packed with a password, larger than the room for temporary files; no volume in it, or several.
    Cancelled
    """
    folder = Path(tempfile.mkdtemp(prefix="volviz-"))
    try:
        files = _unzip(request, folder)
        headers = [file for file in files if file.name.lower().endswith(_HEADERS)]
        if len(files) == 1 or len(headers) == 1:
            path = (headers or files)[0]
        else:
            path = Path(os.path.commonpath([file.parent for file in files]))
        try:
            source = opening(replace(request, path=path))
        except LoadError as error:
            if len(files) == 1:
                raise request.error(f"what is packed in it cannot be read: {error}") from None
            names = ", ".join(file.name for file in files[:3]) + (", …" if len(files) > 3 else "")
            raise request.error(
                f"it holds {len(files)} files ({names}) and not one volume; unpack it and open one of them."
            ) from None
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    return _kept_with(source, folder, request)


def _unzip(request: LoadRequest, folder: Path) -> list[Path]:
    """The files of a zip file, without what systems add of their own."""
    files: list[Path] = []
    try:
        with zipfile.ZipFile(request.path) as archive:
            members = [
                member
                for member in archive.infolist()
                if not member.is_dir()
                and not member.filename.startswith("__MACOSX")
                and not member.filename.rpartition("/")[2].startswith(".")
            ]
            size = sum(member.file_size for member in members)
            if size + _LEFT_FREE > shutil.disk_usage(folder).free:
                raise request.error(
                    f"unpacked, it takes more room than is free for temporary files in {folder.parent}; "
                    "unpack it yourself where there is room."
                )
            done = 0
            for member in members:
                # the name with its folders; what would lead out of the folder is left out
                parts = [part for part in member.filename.split("/") if part not in ("", ".", "..")]
                target = folder.joinpath(*parts)
                target.parent.mkdir(parents=True, exist_ok=True)
                with archive.open(member) as packed, target.open("wb") as copy:
                    while block := packed.read(_BLOCK):
                        copy.write(block)
                        done += len(block)
                        request.report(0.5 * done / max(size, 1), "unpacking")
                files.append(target)
    except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, NotImplementedError):
        raise request.error(
            "the zip file is damaged or packed with a password; unpack it yourself."
        ) from None
    if not files:
        raise request.error("the zip file is empty; get it again.")
    return files


def _kept_with(source: FileSource, folder: Path, request: LoadRequest) -> FileSource:
    """A source of an unpacked copy, which stays as long as the source does, under the name of the packed file."""
    weakref.finalize(source, shutil.rmtree, folder, ignore_errors=True)
    said = source.description
    source.description = replace(
        said,
        content_id=content_id(str(request.path)),
        metadata={**said.metadata, "source": request.source},
    )
    return source


def _unpack(request: LoadRequest, target: Path) -> None:
    with request.path.open("rb") as stream:
        try:
            with unpacker(stream) as plain:
                _copy(request, stream, plain, target)
        except EOFError:
            raise request.error("the file is cut off; get it again.") from None
        except damage() as error:
            if isinstance(error, OSError) and error.errno is not None:
                raise
            raise request.error("the compressed data is damaged; get the file again.") from None


def _copy(request: LoadRequest, stream: IO[bytes], plain: IO[bytes], target: Path) -> None:
    size = max(request.path.stat().st_size, 1)
    with target.open("wb") as copy:
        while True:
            block = plain.read(_BLOCK)
            if not block:
                return
            if shutil.disk_usage(target.parent).free < len(block) + _LEFT_FREE:
                raise request.error(
                    f"unpacked, it takes more room than is free for temporary files in {target.parent.parent}; "
                    "unpack it yourself where there is room."
                )
            copy.write(block)
            request.report(0.5 * stream.tell() / size, "unpacking")
