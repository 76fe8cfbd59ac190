"""Pixels of DICOM frames: decoded, colours as their brightness, rescaled to the values they stand for."""

from __future__ import annotations

import warnings
from collections import defaultdict
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.axes import brightness, choose
from volviz.io.dicom.codecs import register
from volviz.io.dicom.finding import opened
from volviz.io.scaling import rescaled

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    import numpy.typing as npt

    from volviz.io.dicom.headers import Frame, ImageFile, PlainPixels
    from volviz.io.reader import LoadRequest


def slices_of(request: LoadRequest, frames: Sequence[Frame]) -> Iterator[tuple[int, npt.NDArray[Any]]]:
    """Place in `frames` and stored pixels (rows, columns) of every frame; a file is opened once.

    Raises
    ------
    LoadError
        Pixels that cannot be decoded or do not fit their header.
    """
    by_file: dict[ImageFile, dict[int, list[int]]] = defaultdict(lambda: defaultdict(list))
    for place, frame in enumerate(frames):
        by_file[frame.file][frame.number].append(place)
    done = 0
    for file, numbers in by_file.items():
        for number, pixels in zip(sorted(numbers), _decoded(request, file, sorted(numbers)), strict=True):
            request.report(0.3 + 0.7 * done / len(frames), "reading slices")
            image = _gray(request, pixels, file)
            if image.shape != (file.rows, file.columns):
                raise request.error("its pixels do not fit its header; the file is damaged.", file.path)
            for place in numbers[number]:
                done += 1
                tiles = file.tiles
                yield place, image if tiles is None else tiles.cut(image, frames[place].tile)


def is_scaled_alike(frames: Sequence[Frame]) -> bool:
    """Whether all frames have one rescaling, which then is applied once, at the end."""
    return len({(f.slope, f.intercept) for f in frames}) == 1


def values_of(frame: Frame, pixels: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Stored pixels as the values they stand for."""
    return rescaled(pixels, frame.slope, frame.intercept, may_narrow=False)


def _gray(request: LoadRequest, pixels: npt.NDArray[Any], file: ImageFile) -> npt.NDArray[Any]:
    if pixels.ndim != 3:
        return pixels
    if file.interpretation == "PALETTE COLOR":
        request.note("Its pixels are indices of a palette; the brightness of the colours is shown.")
        return brightness(pixels)
    if request.channel is None:
        request.note("Colours are shown as their brightness; their components are channels 0, 1 and 2.")
        return brightness(pixels)
    return np.asarray(pixels[..., choose(request, "S", pixels.shape[-1])])


def _decoded(request: LoadRequest, file: ImageFile, numbers: list[int]) -> Iterator[npt.NDArray[Any]]:
    """Frames of one file, (rows, columns[, samples]), in the order of their numbers."""
    if file.plain is not None and file.plain.are_in(file.path):
        yield from _plain(request, file, file.plain, numbers)
        return
    import pydicom
    from pydicom.config import disable_value_validation
    from pydicom.pixels.processing import apply_color_lut
    from pydicom.pixels.utils import iter_pixels, pixel_array

    register()
    with warnings.catch_warnings(), disable_value_validation():
        warnings.simplefilter("ignore")
        try:
            with opened(file.path) as stream:
                data = pydicom.dcmread(stream, force=True)
            if "TransferSyntaxUID" not in data.file_meta:
                # a file without meta information: the form was seen while it was read
                data.file_meta.TransferSyntaxUID = _syntax(data)
            if file.count == 1:
                found: Iterator[Any] = iter([pixel_array(data)])
            else:
                found = iter_pixels(data, indices=numbers)
            for pixels in found:
                palette = file.interpretation == "PALETTE COLOR"
                yield np.asarray(apply_color_lut(pixels, data) if palette else pixels)
        except OSError:
            raise
        except Exception:  # noqa: BLE001 - what damaged pixels raise inside the library and its codecs has no end
            raise request.error("its pixels cannot be decoded; the file is damaged.", file.path) from None


def _plain(
    request: LoadRequest, file: ImageFile, plain: PlainPixels, numbers: list[int]
) -> Iterator[npt.NDArray[Any]]:
    """Frames that lie uncompressed in the file."""
    kind = np.dtype(plain.dtype)
    unused = 8 * kind.itemsize - plain.used_bits
    count = file.rows * file.columns
    with file.path.open("rb", buffering=0) as stream:
        for number in numbers:
            pixels = np.empty((file.rows, file.columns), kind)
            stream.seek(plain.offset + number * pixels.nbytes)
            if stream.readinto(pixels.reshape(-1).view(np.uint8).data) != count * kind.itemsize:
                raise request.error(
                    "the file is cut off: its pixel data is incomplete; get it again.", file.path
                )
            if not kind.isnative:
                pixels = pixels.astype(kind.newbyteorder("="))
            if unused:
                # they may hold anything, an overlay say; of numbers with a sign they repeat it
                pixels <<= unused
                pixels >>= unused
            yield pixels


def _syntax(data: Any) -> Any:
    from pydicom.uid import ExplicitVRBigEndian, ExplicitVRLittleEndian, ImplicitVRLittleEndian

    implicit, little = data.original_encoding
    if implicit:
        return ImplicitVRLittleEndian
    return ExplicitVRLittleEndian if little else ExplicitVRBigEndian
