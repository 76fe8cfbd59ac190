"""Compressed DICOM pixels by imagecodecs, for pydicom, which does the rest (fragments, frames, colours).

pydicom itself decodes RLE, and 8-bit JPEG and most of JPEG 2000 by Pillow; this adds what is missing.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

LABEL = "imagecodecs"

_LOSSLESS_JPEG = ("1.2.840.10008.1.2.4.57", "1.2.840.10008.1.2.4.70")
_EXTENDED_JPEG = ("1.2.840.10008.1.2.4.51",)
_JPEG_LS = ("1.2.840.10008.1.2.4.80", "1.2.840.10008.1.2.4.81")
_JPEG_2000 = ("1.2.840.10008.1.2.4.90", "1.2.840.10008.1.2.4.91")
_HTJ2K = ("1.2.840.10008.1.2.4.201", "1.2.840.10008.1.2.4.202", "1.2.840.10008.1.2.4.203")
_DECODERS = {
    **dict.fromkeys(_LOSSLESS_JPEG, "ljpeg_decode"),
    **dict.fromkeys(_EXTENDED_JPEG, "jpeg8_decode"),
    **dict.fromkeys(_JPEG_LS, "jpegls_decode"),
    **dict.fromkeys(_JPEG_2000, "jpeg2k_decode"),
    **dict.fromkeys(_HTJ2K, "htj2k_decode"),
}

#: Asked for by pydicom: transfer syntaxes and the packages they need.
DECODER_DEPENDENCIES = dict.fromkeys(_DECODERS, (LABEL,))


def is_available(uid: str) -> bool:
    """Whether the codec of a transfer syntax is there; asked by pydicom."""
    import imagecodecs

    codec = _DECODERS[uid].removesuffix("_decode").upper()
    return bool(getattr(getattr(imagecodecs, codec, None), "available", False))


def decode_frame(source: bytes, runner: Any) -> bytes:
    """One frame; called by pydicom.

    Parameters
    ----------
    source : bytes
        The compressed frame.
    runner : pydicom.pixels.decoders.base.DecodeRunner
        What the header says about the frame; is told what the decoded bytes are.

    Returns
    -------
    bytes
        Pixels row by row, components beside one another, little endian.
    """
    import imagecodecs

    syntax = str(runner.transfer_syntax)
    pixels = np.asarray(getattr(imagecodecs, _DECODERS[syntax])(source))
    if runner.samples_per_pixel == 1:
        pixels = pixels.reshape(runner.rows, runner.columns)
    else:
        runner.set_option("planar_configuration", 0)
        if syntax in _JPEG_2000 + _HTJ2K:
            # its colour transform is part of the code stream and has been undone
            runner.set_option("photometric_interpretation", "RGB")
    bits = 8 * pixels.dtype.itemsize
    if runner.pixel_representation == 1 and pixels.dtype.kind == "u":
        # two's complement of `bits_stored` bits: the upper bits repeat the sign
        unused = bits - min(int(runner.bits_stored), bits)
        pixels = (pixels << unused).view(f"i{pixels.dtype.itemsize}") >> unused
    runner.set_option("bits_allocated", bits)
    return pixels.astype(pixels.dtype.newbyteorder("<"), copy=False).tobytes()


@cache
def register() -> None:
    """Make pydicom use these decoders where it has none of its own, or where its own refuses."""
    from pydicom.pixels.decoders.base import get_decoder
    from pydicom.uid import UID

    for syntax in _DECODERS:
        decoder = get_decoder(UID(syntax))
        if LABEL not in (*decoder.available_plugins, *decoder.missing_dependencies):
            decoder.add_plugin(LABEL, (__name__, "decode_frame"))
