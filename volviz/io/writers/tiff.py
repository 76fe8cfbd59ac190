"""TIFF by tifffile: hyperstacks of ImageJ, and OME-TIFF.

Source: "OME-TIFF specification" (docs.openmicroscopy.org/ome-model) for what the description of an OME-TIFF says.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.volume_data.description import Color

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.writers.content import Content
    from volviz.io.writers.request import SaveRequest

#: ImageJ reads no BigTIFF, and classic TIFF ends here; some room is left for its tags.
CLASSIC_LIMIT = 2**32 - (1 << 25)


def write_imagej(content: Content, request: SaveRequest) -> None:
    """A hyperstack: time, slices, channels, in this order of pages."""
    import tifffile

    if content.nbytes > CLASSIC_LIMIT:
        raise request.error(
            "ImageJ reads no TIFF above 4 GB; write .ome.tif, or a part of it (time, channel, crop)."
        )
    z, y, x = content.shape
    sx, sy, sz = content.lattice.spacing
    info: dict[str, Any] = {"spacing": sz, "unit": content.length_unit.replace("µ", "u") or "pixel"}
    if content.even_times:
        info["finterval"] = content.even_times[1]
    count = 1 if content.is_colour else content.channel_count or 1
    windows = [channel.window for channel in content.channels]
    if not content.is_colour and all(window is not None for window in windows):
        info["Ranges"] = [value for window in windows if window is not None for value in window]
    if count > 1:
        info["mode"] = "composite"
        if all(channel.color is not None for channel in content.channels):
            info["LUTs"] = [_ramp(channel.color) for channel in content.channels if channel.color is not None]
    shape: tuple[int, ...] = (content.time_count or 1, z, count, y, x)
    if content.is_colour:
        shape = (*shape, content.channel_count or 3)

    def pages() -> Iterator[npt.NDArray[Any]]:
        for time in content.frames:
            # pages of one slice lie side by side, so all channels are needed at once
            stack = content.all_channels(time, request)
            first, last = content.span(time, len(content.frames))
            for number, page in enumerate(stack):
                request.report(first + (last - first) * number / z)
                if content.is_colour:
                    yield page
                else:
                    yield from np.moveaxis(page, -1, 0)

    tifffile.imwrite(
        request.path, pages(), shape=shape, dtype=content.dtype, imagej=True, resolution=(1 / sx, 1 / sy),
        photometric="rgb" if content.is_colour else "minisblack", metadata={"axes": "TZCYXS"[: len(shape)], **info},
    )  # fmt: skip


def write_ome(content: Content, request: SaveRequest) -> None:
    """OME-TIFF, BigTIFF where it must be: one time point and channel after another."""
    import tifffile

    z, y, x = content.shape
    count = 1 if content.is_colour else content.channel_count or 1
    shape: tuple[int, ...] = (content.time_count or 1, count, z, y, x)
    if content.is_colour:
        shape = (*shape, content.channel_count or 3)
    number = 0

    def pages() -> Iterator[npt.NDArray[Any]]:
        nonlocal number
        for time in content.frames:
            for channel in range(count):
                stack = (
                    content.all_channels(time, request)
                    if content.is_colour
                    else content.array(time, channel, request)
                )
                first, last = content.span(number, len(content.frames) * count)
                number += 1
                for at, page in enumerate(stack):
                    request.report(first + (last - first) * at / z)
                    yield page

    tifffile.imwrite(
        request.path, pages(), shape=shape, dtype=content.dtype, ome=True, bigtiff=content.nbytes > CLASSIC_LIMIT,
        photometric="rgb" if content.is_colour else "minisblack",
        compression="zlib" if request.compress else None, predictor=request.compress and content.dtype.kind in "ui",
        metadata={"axes": "TCZYXS"[: len(shape)], **_ome_metadata(content)},
    )  # fmt: skip


def _ome_metadata(content: Content) -> dict[str, Any]:
    found: dict[str, Any] = {"Name": content.name}
    for axis, size in zip("XYZ", content.lattice.spacing, strict=True):
        found[f"PhysicalSize{axis}"] = size
        # without a unit it would be micrometres
        found[f"PhysicalSize{axis}Unit"] = content.length_unit or "pixel"
    if content.times is not None:
        even = content.even_times
        if even is not None and even[0] == 0:
            found["TimeIncrement"], found["TimeIncrementUnit"] = even[1], "s"
        else:
            planes = (1 if content.is_colour else content.channel_count or 1) * content.shape[0]
            seconds = [time for time in content.times for _ in range(planes)]
            found["Plane"] = {"DeltaT": seconds, "DeltaTUnit": ["s"] * len(seconds)}
    if not content.is_colour and any(content.channels):
        channels: dict[str, Any] = {"Name": content.channel_names()}
        if all(channel.color is not None for channel in content.channels):
            channels["Color"] = [_packed(channel.color) for channel in content.channels if channel.color]
        if all(channel.wavelength is not None for channel in content.channels):
            channels["EmissionWavelength"] = [channel.wavelength for channel in content.channels]
            channels["EmissionWavelengthUnit"] = ["nm"] * len(content.channels)
        found["Channel"] = channels
    return found


def _packed(color: Color) -> int:
    """Red, green, blue and full alpha as OME's signed number of 32 bits."""
    red, green, blue = (round(255 * part) for part in color)
    value = red << 24 | green << 16 | blue << 8 | 255
    return value - 2**32 if value >= 2**31 else value


def _ramp(color: Color) -> npt.NDArray[np.uint8]:
    """ImageJ's table of 3 x 256 bytes from black to a colour."""
    table: npt.NDArray[np.uint8] = np.rint(np.outer(color, np.arange(256))).astype(np.uint8)
    return table
