"""Folders of images, one slice each: PNG, JPEG, BMP or TIFF files with numbered names."""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import VolvizError
from volviz.io.axes import to_zyx
from volviz.io.endings import PICTURES
from volviz.io.file_source import file_source
from volviz.io.geometry import Geometry
from volviz.io.memory import check_memory
from volviz.io.tiff import quiet

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest

_TIFF = (".tif", ".tiff")
_MAGIC = (b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff", b"BM")


def sniff(head: bytes, path: Path) -> bool:
    """Whether this is an image with others beside it, or a folder that holds some."""
    if path.is_dir():
        return len(_stack(path)) > 1
    return head.startswith(_MAGIC) and path.suffix.lower() in PICTURES


def open_source(request: LoadRequest) -> FileSource:
    """The largest set of images of a folder whose names differ in their numbers alone, or that of an image."""
    if request.path.is_dir():
        paths = _stack(request.path)
        left = sum(len(group) for group in _groups(request.path).values()) - len(paths)
        if left:
            request.note(f"{left} pictures with names of another kind were left out.")
    else:
        paths = _groups(request.path.parent)[_pattern(request.path)]
        if len(paths) < 2:
            raise request.error(
                "it is a single picture, no volume; open a folder of numbered ones, or a stack."
            )
        request.note(f"The picture is one of {len(paths)} in its folder; all of them are shown.")
    _tell_gaps(request, paths)
    first = _pixels(request, paths[0])
    colours = first.ndim == 3
    request.note("Pictures do not say how far they lie apart; voxels are taken for cubes of side 1.")

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        wanted = paths if request.box is None else paths[request.box[4] : request.box[5]]
        check_memory(request, len(wanted) * first.nbytes)
        array = np.empty((len(wanted), *first.shape), first.dtype)
        for number, path in enumerate(wanted):
            request.report(number / len(wanted), "reading pictures")
            pixels = _pixels(request, path)
            if pixels.shape != first.shape:
                raise request.error(
                    f"it is {_size(pixels)} pixels large where {paths[0].name} is {_size(first)}; "
                    "slices of a volume are equally large.",
                    path,
                )
            array[number] = pixels
        return to_zyx(array, "ZYXS" if colours else "ZYX", request.within_slices(), colour=colours)

    folder = request.path if request.path.is_dir() else request.path.parent
    return file_source(
        request,
        values,
        "ZYXS" if colours else "ZYX",
        (len(paths), *first.shape),
        Geometry(),
        format="Pictures",
        name=folder.name,
        dtype=first.dtype,
        colour=colours,
    )


def _stack(folder: Path) -> list[Path]:
    """The largest set of images of a folder, in the order of their numbers."""
    return max(_groups(folder).values(), key=len, default=[])


def _groups(folder: Path) -> dict[tuple[str, ...], list[Path]]:
    groups: dict[tuple[str, ...], list[Path]] = defaultdict(list)
    for path in folder.iterdir():
        if path.suffix.lower() in PICTURES + _TIFF and not path.name.startswith(".") and path.is_file():
            groups[_pattern(path)].append(path)
    for paths in groups.values():
        paths.sort(key=lambda path: (_numbers(path), path.name))
    return groups


def _pattern(path: Path) -> tuple[str, ...]:
    """What is left of a name without its numbers."""
    return tuple(re.split(r"\d+", path.name.lower()))


def _numbers(path: Path) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d+", path.name))


def _tell_gaps(request: LoadRequest, paths: list[Path]) -> None:
    """Note missing numbers; of several numbers in a name the one that changes counts."""
    rows = np.array([_numbers(path) for path in paths], dtype=object)
    changing = [column for column in rows.T if len(set(column)) > 1] if rows.ndim == 2 else []
    if len(changing) != 1:
        return
    numbers = [int(n) for n in changing[0]]
    steps = np.diff(numbers)
    usual = int(np.median(steps))
    missing = sum(int(step) // usual - 1 for step in steps) if usual > 0 else 0
    if missing:
        request.note(
            f"{missing} numbers between {numbers[0]} and {numbers[-1]} have no picture; the others are put together."
        )


def _pixels(request: LoadRequest, path: Path) -> npt.NDArray[Any]:
    """An image as (rows, columns) or (rows, columns, components)."""
    try:
        if path.suffix.lower() in _TIFF:
            import tifffile

            with quiet(replace(request, path=path)):
                array = np.asarray(tifffile.imread(path))
        else:
            from PIL import Image

            with Image.open(path) as image:
                array = np.asarray(image.convert("RGB") if image.mode in ("P", "CMYK", "YCbCr") else image)
    except (MemoryError, VolvizError):
        raise
    except Exception as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise
        raise request.error("this picture is damaged or of an unusual kind; save it again.", path) from None
    if array.ndim == 3 and array.shape[-1] == 2:
        array = array[..., 0]
    if array.ndim not in (2, 3) or (array.ndim == 3 and array.shape[-1] not in (3, 4)):
        raise request.error("it holds several pictures; open it by itself.", path)
    return array


def _size(pixels: npt.NDArray[Any]) -> str:
    return f"{pixels.shape[1]} x {pixels.shape[0]}"
