"""Kinds of VTK files: what is a volume, what reads it, whether the file can hold what its header promises."""

from __future__ import annotations

import importlib
import os
import re
from dataclasses import dataclass
from html import unescape
from typing import TYPE_CHECKING, Any

from volviz.io.vtk_legacy import check_promises, counts_of, kind_of

if TYPE_CHECKING:
    from pathlib import Path

    from volviz.io.reader import LoadRequest

#: Deflate packs by 1032 at most; with lzma, the third of VTK's compressors, files can be smaller still.
PACKING = 10_000

#: The header of a file lies within its first bytes.
HEADER_BYTES = 1 << 20


@dataclass(frozen=True)
class Kind:
    """A kind of data set that can be a volume, and what reads it: module and class of VTK."""

    module: str
    reader: str
    is_legacy: bool = False
    #: Its points lie on three lists of coordinates, not on an even lattice by definition.
    is_rectilinear: bool = False
    #: It only names the files of its pieces.
    is_parallel: bool = False


_XML = "vtkmodules.vtkIOXML"
_LEGACY = "vtkmodules.vtkIOLegacy"
_KINDS = {
    b"ImageData": Kind(_XML, "vtkXMLImageDataReader"),
    b"PImageData": Kind(_XML, "vtkXMLPImageDataReader", is_parallel=True),
    b"RectilinearGrid": Kind(_XML, "vtkXMLRectilinearGridReader", is_rectilinear=True),
    b"PRectilinearGrid": Kind(_XML, "vtkXMLPRectilinearGridReader", is_rectilinear=True, is_parallel=True),
    b"STRUCTURED_POINTS": Kind(_LEGACY, "vtkStructuredPointsReader", is_legacy=True),
    b"RECTILINEAR_GRID": Kind(_LEGACY, "vtkRectilinearGridReader", is_legacy=True, is_rectilinear=True),
}


def sniff(head: bytes, _path: Path) -> bool:
    """Whether these are the first bytes of a VTK file, XML or legacy."""
    return (
        head.startswith(b"# vtk DataFile") or re.match(rb"\s*(<\?xml[^>]*>\s*)?<VTKFile\b", head) is not None
    )


def kind_in(request: LoadRequest, head: bytes) -> Kind:
    """What kind of data set a file holds; others than volumes are refused."""
    if head.startswith(b"#"):
        name = kind_of(head)
        if name is None:
            raise request.error("its header names no DATASET; the file is damaged or cut off.")
        advice = "save STRUCTURED_POINTS"
    else:
        found = re.search(rb"<VTKFile\b[^>]*\btype\s*=\s*[\"'](\w+)", head)
        name = found[1] if found else b"nothing that it names"
        advice = "save it as ImageData (.vti)"
    if name not in _KINDS:
        raise request.error(f"it holds {name.decode('ascii', 'replace')}, no image; {advice}.")
    return _KINDS[name]


def check_sizes(request: LoadRequest, head: bytes, kind: Kind) -> None:
    """Refuse sizes that the file, or those of its pieces, cannot hold, before VTK asks for memory."""
    if kind.is_legacy:
        counts = counts_of(head)
    else:
        extent = re.search(rb"WholeExtent\s*=\s*[\"']([-\d\s]+)[\"']", head)
        numbers = extent[1].split() if extent else []
        ends = [int(n) for n in numbers] if all(re.fullmatch(rb"-?\d+", n) for n in numbers) else []
        counts = [high - low + 1 for low, high in zip(ends[::2], ends[1::2], strict=False)]
    if len(counts) != 3 or min(counts) < 1:
        raise request.error("its header gives no size that a volume can have; the file is damaged.")
    if kind.is_legacy:
        check_promises(request, head, counts)
        return
    voxels = counts[0] * counts[1] * counts[2]
    files = pieces_of(request) if kind.is_parallel else [request.path]
    if voxels > sum(file.stat().st_size for file in files) * PACKING:
        raise request.error(
            f"the file is cut off: its header promises {voxels:,} voxels, more than it can hold."
        )


def pieces_of(request: LoadRequest) -> list[Path]:
    """The files of a volume in pieces.

    Raises
    ------
    LoadError
        One is not there, or is no file of VTK.
    """
    names = re.findall(rb"<Piece\b[^>]*\bSource\s*=\s*[\"']([^\"']+)[\"']", request.path.read_bytes())
    files = [
        request.path.parent / os.fsdecode(unescape(name.decode("utf-8", "surrogateescape"))) for name in names
    ]
    for file in files:
        if not file.is_file():
            raise request.error(f"its piece {file.name} is not there; keep all files of it together.")
        with file.open("rb") as stream:
            if not sniff(stream.read(4096), file):
                raise request.error(f"its piece {file.name} is no VTK file; get it again.")
    if not files:
        raise request.error("it names no pieces; the file is damaged or cut off.")
    return files


def new_reader(kind: Kind, path: Path) -> Any:
    """VTK's reader of a file, which has read nothing yet."""
    reader = getattr(importlib.import_module(kind.module), kind.reader)()
    # as bytes: a name on Linux need not be text
    reader.SetFileName(os.fsencode(path))
    return reader
