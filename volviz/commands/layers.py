"""Options of ``volviz render`` that draw several layers: ``--channel N:LOOK`` and ``--layer FILE:LOOK``."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from typing import TYPE_CHECKING

from volviz.commands.inputs import hints_of, number_or_name, source_of
from volviz.errors import InputError

if TYPE_CHECKING:
    from volviz.model.layers import ImageLayer, LabelLayer
    from volviz.model.transfer.function import TransferFunction
    from volviz.volume_data.source import VolumeSource
    from volviz.volume_data.volume import Volume


#: Look of a file whose values are labels; files that say so need none.
LABELS = "labels"


def add_layer_option(parser: argparse.ArgumentParser) -> None:
    """``--layer``; ``--channel`` is one of the hints for reading (`volviz.commands.inputs.add_input`)."""
    parser.add_argument(
        "--layer", action="append", default=[], metavar="FILE[:LOOK]", dest="layers",
        help="draw this file as well, in the same ray integral; a look is a colour, colour map or preset, or "
        "\"labels\" for surfaces of labels. Can be repeated",
    )  # fmt: skip


def asks_for_layers(options: argparse.Namespace) -> bool:
    """Whether more than one layer is to be drawn, or a channel in a colour."""
    return bool(options.layers) or len(options.channel) > 1 or any(":" in text for text in options.channel)


def single_channel(options: argparse.Namespace) -> None:
    """Let ``--channel N`` alone mean the channel that is read, as in the other commands."""
    options.channel = _channel(options.channel[0])[0] if options.channel else None


def layers_of_options(
    options: argparse.Namespace, function: Callable[[argparse.Namespace, Volume], TransferFunction | None]
) -> tuple[ImageLayer | LabelLayer, ...]:
    """What FILE, ``--channel`` and ``--layer`` name.

    Parameters
    ----------
    options : argparse.Namespace
    function : callable
        Gives the function that other options name for FILE, or None; looks of channels take its place.

    Raises
    ------
    VolvizError
        A file that cannot be read, a channel or a look that does not exist.
    """
    import volviz.io
    from volviz.model.layers import ImageLayer

    if options.level is not None or options.box is not None:
        raise InputError("--level and --box read a part of one volume, and go with a single layer.")
    chosen = [_channel(text) for text in options.channel]
    first = argparse.Namespace(**{**vars(options), "channel": None, "time": None})
    source = volviz.io.open(source_of(options), **hints_of(first))
    time = options.time or 0
    if chosen:
        found = [_channel_layer(source, number, look, time) for number, look in chosen]
    else:
        found = [ImageLayer(source, function(options, source.read_fitting(time)), time=time)]
    return (*found, *(_file_layer(text, time) for text in options.layers))


def _channel(text: str) -> tuple[int | str, str]:
    """Number or name, and look, which may be empty, from "1:green"; a name may have colons of its own."""
    channel, colon, look = text.rpartition(":")
    channel, look = (channel, look.strip()) if colon else (text, "")
    if not channel.strip():
        raise InputError(
            f"--channel takes a number from 0 or a name, or one with a look such as 1:green, got {text!r}."
        )
    return number_or_name(channel.strip()), look


def _channel_layer(source: VolumeSource, channel: int | str, look: str, time: int) -> ImageLayer:
    from volviz.model.layer_looks import channel_color, channel_function, named_look
    from volviz.model.layers import ImageLayer

    number = source.channel_number(channel)
    volume = source.read_fitting(time, number)
    known = source.channels[number]
    if look:
        function = named_look(look, volume)
    else:
        function = channel_function(volume, known.color or channel_color(number), known.window)
    return ImageLayer(source, function, known.name, channel=number, time=time)


def _file_layer(text: str, time: int) -> ImageLayer | LabelLayer:
    """A layer of "pet.nii.gz:hot" or "seg.nii.gz:labels"; the name of a file may have colons of its own.

    One that stands still is shown at every time point.
    """
    import volviz.io
    from volviz.model.layer_looks import named_look
    from volviz.model.layers import ImageLayer, LabelLayer

    path, look = _split(text)
    source = volviz.io.open(path)
    time = time if source.sizes.get("t", 1) > 1 else 0
    if look == LABELS or (not look and source.is_labels):
        return LabelLayer(source, time=time)
    return ImageLayer(source, named_look(look, source.read_fitting(time)) if look else None, time=time)


def file_of(text: str) -> str:
    """The file of a text such as "pet.nii.gz:hot"."""
    return _split(text)[0]


def _split(text: str) -> tuple[str, str]:
    """File and look: what follows the last colon is a look unless it has a slash or stands after a scheme."""
    path, colon, look = text.rpartition(":")
    if not colon or re.search(r"[\\/]", look) or re.fullmatch(r"[A-Za-z]|sample", path):
        return text, ""
    return path, look
