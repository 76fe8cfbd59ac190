"""Headers of legacy VTK files, checked before VTK believes them.

Arrays lie one after another, each behind a line that names its type and size. VTK asks for the memory of an array as
soon as it has read such a line, and ends the process without it.
"""

from __future__ import annotations

import math
import re
from typing import IO, TYPE_CHECKING

from volviz.io.memory import check_memory

if TYPE_CHECKING:
    from volviz.io.reader import LoadRequest

#: Bytes of the types that legacy files name.
_TYPES = {
    b"bit": 1 / 8, b"unsigned_char": 1, b"char": 1, b"signed_char": 1, b"unsigned_short": 2, b"short": 2,
    b"unsigned_int": 4, b"int": 4, b"unsigned_long": 8, b"long": 8, b"vtktypeint64": 8, b"vtktypeuint64": 8,
    b"vtkidtype": 4, b"float": 4, b"double": 8,
}  # fmt: skip

#: Lines behind which values lie: kind and name, name, components and tuples of a field, or coordinates along an axis.
_ARRAY = re.compile(
    rb"(?:(?P<kind>SCALARS|VECTORS|NORMALS|TENSORS6?)[ \t]+\S+[ \t]+(?P<type>\w+)(?:[ \t]+(?P<width>\d+))?"
    rb"|[XYZ]_COORDINATES[ \t]+(?P<coordinates>\d+)[ \t]+(?P<real>\w+)"
    rb"|\S+[ \t]+(?P<components>\d+)[ \t]+(?P<tuples>\d+)[ \t]+(?P<field>\w+))[ \t\r]*",
    re.IGNORECASE,
)
#: In the name of every type; a line is not longer than this.
_TYPE_WORDS = (b"bit", b"char", b"short", b"int", b"long", b"float", b"double", b"idtype")
_LINE_BYTES = 512
_BLOCK = 1 << 18
_COMPONENTS = {b"SCALARS": 1, b"VECTORS": 3, b"NORMALS": 3, b"TENSORS": 9, b"TENSORS6": 6}


def kind_of(head: bytes) -> bytes | None:
    """What the line DATASET of a header names, in capitals."""
    found = re.search(rb"^\s*DATASET\s+(\w+)", head, re.MULTILINE | re.IGNORECASE)
    return None if found is None else found[1].upper()


def counts_of(head: bytes) -> list[int]:
    """Points along (x, y, z); empty where the header does not say it."""
    found = re.search(rb"^\s*DIMENSIONS\s+(-?\d+)\s+(-?\d+)\s+(-?\d+)", head, re.MULTILINE | re.IGNORECASE)
    return [int(n) for n in found.groups()] if found else []


def check_promises(request: LoadRequest, head: bytes, counts: list[int]) -> None:
    """Refuse a file, which is never packed, whose lines promise more values than it can hold.

    Raises
    ------
    LoadError
    """
    size = request.path.stat().st_size
    points, cells = math.prod(counts), math.prod(max(n - 1, 1) for n in counts)
    is_text = re.search(rb"^[ \t]*ASCII\b", head, re.MULTILINE | re.IGNORECASE) is not None
    wanted, least, memory, at = 0.0, 0.0, 0.0, 0
    with request.path.open("rb") as stream:
        while (array := _next_array(request, stream, at)) is not None:
            found, at = array
            each = _TYPES[_type_of(found)]
            if found["kind"]:
                width = int(found["width"] or _COMPONENTS[found["kind"].upper()])
                fewest, most = min(points, cells) * width, points * width
            elif found["coordinates"]:
                fewest = most = int(found["coordinates"])
            else:
                fewest = most = int(found["components"]) * int(found["tuples"])
            # a value in text has a digit and a blank
            least += fewest * (2 if is_text else each)
            wanted += fewest
            memory += most * each
            # nothing is looked for among values
            at += 0 if is_text else int(fewest * each)
    # without any such line there is at least a bit for each point, or for each cell
    if least > size + 1 or min(points, cells) > 8 * size:
        what = f"{wanted:,.0f} values" if least > size + 1 else f"{points:,} voxels"
        raise request.error(f"the file is cut off: its header promises {what}, more than it can hold.")
    check_memory(request, int(memory))


def _type_of(found: re.Match[bytes]) -> bytes:
    return (found["type"] or found["real"] or found["field"]).lower()


def _next_array(request: LoadRequest, stream: IO[bytes], at: int) -> tuple[re.Match[bytes], int] | None:
    """The next line from byte `at` on behind which values lie, and where it ends; found by the names of types."""
    size = request.path.stat().st_size
    while at < size:
        request.report(0.1 * at / size)
        stream.seek(at)
        data = stream.read(_BLOCK)
        hits = []
        for word in (*_TYPE_WORDS, *map(bytes.upper, _TYPE_WORDS)):
            hit = data.find(word)
            while hit >= 0:
                first = data.rfind(b"\n", max(hit - _LINE_BYTES, 0), hit) + 1
                last = data.find(b"\n", hit, hit + _LINE_BYTES)
                found = _ARRAY.fullmatch(data, first, last) if last > 0 else None
                if found is not None and _type_of(found) in _TYPES:
                    hits.append((last, found))
                    break
                hit = data.find(word, hit + 1)
        if hits:
            last, found = min(hits, key=lambda one: one[0])
            return found, at + last
        # a line may have been cut in two
        at += max(len(data) - _LINE_BYTES, 1) if at + len(data) < size else len(data)
    return None
