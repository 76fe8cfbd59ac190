"""Scalars as they lie in files: read in blocks, checked against the size of the file beforehand.

NIfTI, NRRD, MetaImage, NumPy and raw files are all a header and one run of values, plain or compressed. Their
readers parse the header; this module brings the values in, reports the progress, can be cancelled, and
notices a file that is cut off.
"""

from __future__ import annotations

import math
import os
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Literal

import numpy as np

from volviz.io.axes import choose, to_zyx
from volviz.io.memory import check_memory
from volviz.io.unpacking import unpacked_at_once

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.reader import LoadRequest

Encoding = Literal["raw", "gzip", "bzip2", "text", "hex"]

BLOCK = 4 << 20
"""Bytes read at once: small enough to cancel within some 20 ms, large enough to cost nothing."""

DEFLATE_RATIO = 1032
"""Deflate cannot shrink data by more than this factor (RFC 1951: 258 bytes in 2 bits)."""


@dataclass(frozen=True)
class RawPayload:
    """Where the values of a volume lie and how.

    Attributes
    ----------
    files : tuple of Path
        Usually one; several files are joined, each holds an equal part.
    shape : tuple of int
        Sizes, the slowest axis first, as in a C-ordered array.
    dtype : numpy dtype
        With byte order.
    offset : int
        Bytes before the values, of the *unpacked* stream for compressed data; -1 = the values end with the
        file or that stream.
    packed_offset : int
        Bytes of the file before compressed data begins.
    encoding : {"raw", "gzip", "bzip2", "text", "hex"}
        "gzip" covers zlib streams too; "text" is one number after another, "hex" two digits a byte.
    whole : bool
        The values go on to the end of the stream; False for a `frame`.
    """

    files: tuple[Path, ...]
    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    offset: int = 0
    packed_offset: int = 0
    encoding: Encoding = "raw"
    whole: bool = True

    @property
    def nbytes(self) -> int:
        """Bytes of all values."""
        return math.prod(self.shape) * self.dtype.itemsize

    @property
    def is_divisible(self) -> bool:
        """Whether a part can be found without what lies before: the values are one run of bytes."""
        is_counted_from_its_end = self.offset < 0 and self.encoding != "raw"
        return len(self.files) == 1 and self.encoding != "text" and not is_counted_from_its_end

    def frame(self, index: int) -> RawPayload:
        """One entry along the slowest axis alone: the only part that is read of a 4D file."""
        one = self.entries(index, index + 1)
        return replace(one, shape=one.shape[1:])

    def entries(self, first: int, last: int) -> RawPayload:
        """Those from `first` to before `last` along the slowest axis."""
        if not self.is_divisible:
            raise ValueError("only a single run of bytes has entries")
        size = math.prod(self.shape[1:]) * self.dtype.itemsize
        offset = self.offset
        if offset < 0:
            offset = self.files[0].stat().st_size - self.nbytes
        return replace(self, shape=(last - first, *self.shape[1:]), offset=offset + first * size, whole=False)


def check_sizes(payload: RawPayload, request: LoadRequest, *, is_opening: bool = True) -> None:
    """Compare what the header promises with what the files can hold, before any memory is asked for.

    Whether the end of a packed file is there is found out at its opening: reading it shows that anyway.

    Raises
    ------
    LoadError
        Sizes below 1, a missing data file, fewer bytes than promised.
    """
    if min(payload.shape, default=0) < 1:
        sizes = " x ".join(str(n) for n in payload.shape[::-1])
        raise request.error(f"its header gives the size {sizes}, which no volume has; the file is damaged.")
    part = payload.nbytes // len(payload.files)
    for file in payload.files:
        if not file.is_file():
            raise request.error(
                f"the values should lie in {file.name}, which is not there; keep both files in one folder."
            )
        size = file.stat().st_size - payload.packed_offset
        skip = max(payload.offset, 0)
        if payload.encoding == "raw":
            there, wanted = size - skip, part
        elif payload.encoding == "gzip":
            there, wanted = size * DEFLATE_RATIO, part + skip
            if is_opening and there >= wanted and not _ends_as_promised(payload, file, wanted):
                there = _unpacked_bytes(payload, request, file)
        elif payload.encoding == "hex":
            there, wanted = size // 2, part + skip
        elif payload.encoding == "text":
            # at least one digit and one blank a value; the last one may end the file
            there, wanted = size + 1, 2 * math.prod(payload.shape)
        else:
            # 45 bytes of bzip2 can hold 45,899,235 equal ones: the best ratio the format has
            there, wanted = size * 1_100_000, part + skip
        if there < wanted:
            raise request.error(
                f"the file is cut off: the header promises {_amount(part)} bytes of values and the file "
                f"can hold {max(there, 0):,} at most; get it again.",
                file,
            )


def _ends_as_promised(payload: RawPayload, file: Path, wanted: int) -> bool:
    """Whether the end of a gzip file tells of so many bytes, or the stream is of a kind that does not tell."""
    with file.open("rb") as stream:
        stream.seek(payload.packed_offset)
        if stream.read(2) != b"\x1f\x8b":
            return True
        stream.seek(-4, os.SEEK_END)
        told = int.from_bytes(stream.read(4), "little")
    return told == wanted % 2**32


def _unpacked_bytes(payload: RawPayload, request: LoadRequest, file: Path) -> int:
    """How many bytes a compressed stream really holds; it is gone through for that."""
    total = 0
    try:
        for block, _fraction in _unpacked_blocks(file, payload.packed_offset, payload.encoding):
            total += len(block)
            # nothing is read yet: the part that is told must not fall afterwards
            request.report(0.0, "checking")
    except (zlib.error, OSError, EOFError, ValueError):
        raise request.error(_DAMAGED["gzip"], file) from None
    return total


def _amount(count: int) -> str:
    """A number of bytes in words that stay short, however damaged the header is."""
    return f"{count:,}" if count < 10**15 else "more than 10^15"


def read_payload(payload: RawPayload, request: LoadRequest) -> npt.NDArray[Any]:
    """The values as an array of `payload.shape`, native byte order not ensured.

    Raises
    ------
    LoadError
        See `check_sizes`; more values than memory can hold; damaged compressed data.
    Cancelled
    """
    check_sizes(payload, request, is_opening=False)
    check_memory(request, payload.nbytes)
    if payload.encoding == "text":
        return _read_text(payload, request)
    request.report(0.0)
    if payload.offset < 0 and payload.encoding != "raw":
        quick = _unpack_at_once(_from_trailer(payload), request) if payload.encoding == "gzip" else None
        if quick is not None:
            request.report(1.0)
            return quick
        payload = replace(payload, offset=_bytes_before(payload, request))
    if payload.encoding == "gzip" and payload.whole and len(payload.files) == 1:
        quick = _unpack_at_once(payload, request)
        if quick is not None:
            request.report(1.0)
            return quick
    array = np.empty(payload.shape, payload.dtype)
    flat = array.reshape(-1).view(np.uint8)
    part = payload.nbytes // len(payload.files)
    for number, file in enumerate(payload.files):
        target = flat[number * part : (number + 1) * part]
        base = number / len(payload.files)
        if payload.encoding == "raw":
            _fill_plain(target, file, payload.offset, request, base, 1 / len(payload.files))
        else:
            _fill_unpacked(target, file, payload, request)
    request.report(1.0)
    return array


def read_part(
    payload: RawPayload, axes: str, request: LoadRequest, *, colour: bool | None = None
) -> npt.NDArray[Any]:
    """The time point, channel and box that a job asks for, shape (z, y, x).

    Only what is wanted is read of axes that come before the slices, and of the slices themselves, as long as
    the values are one run of bytes; of compressed ones, what lies before is unpacked and forgotten.

    Parameters
    ----------
    payload : RawPayload
    axes : str
        One letter for each axis of `payload`, the slowest first; see `to_zyx`, also for `colour`.
    """
    while axes[0] in "TC" and payload.is_divisible:
        payload = payload.frame(choose(request, axes[0], payload.shape[0]))
        if axes[0] == "C":
            request = replace(request, channel=None)
        axes = axes[1:]
    if axes[0] == "Z" and request.box is not None and payload.is_divisible:
        payload = payload.entries(*request.box[4:])
        request = request.within_slices()
    return to_zyx(read_payload(payload, request), axes, request, colour=colour)


def _fill_plain(
    target: npt.NDArray[np.uint8], file: Path, offset: int, request: LoadRequest, base: float, share: float
) -> None:
    view = target.data
    with file.open("rb", buffering=0) as stream:
        stream.seek(offset if offset >= 0 else file.stat().st_size - len(view))
        done = 0
        while done < len(view):
            count = stream.readinto(view[done : done + BLOCK])
            if not count:
                raise request.error("the file is cut off: it became shorter while it was read.", file)
            done += count
            request.report(base + share * done / len(view))


def _from_trailer(payload: RawPayload) -> RawPayload:
    """Values at the end of a gzip stream, by the size (modulo 2^32) that its last four bytes claim."""
    with payload.files[0].open("rb") as stream:
        stream.seek(-4, os.SEEK_END)
        claimed = int.from_bytes(stream.read(4), "little")
    return replace(payload, offset=max(claimed - payload.nbytes, 0))


def _bytes_before(payload: RawPayload, request: LoadRequest) -> int:
    """Where values begin that are the last ones of an unpacked stream, which is gone through once for that."""
    total = 0
    try:
        for block, fraction in _unpacked_blocks(payload.files[0], payload.packed_offset, payload.encoding):
            total += len(block)
            request.report(0.5 * fraction, "unpacking")
    except (zlib.error, OSError, EOFError, ValueError):
        raise request.error(_DAMAGED.get(payload.encoding, _DAMAGED["gzip"]), payload.files[0]) from None
    if total < payload.nbytes:
        raise request.error(
            f"the file is cut off: the header promises {payload.nbytes:,} bytes of values, {total:,} are there.",
            payload.files[0],
        )
    return total - payload.nbytes


_DAMAGED = {
    "gzip": "the compressed data is damaged; get the file again.",
    "hex": "the values are not all hexadecimal digits; the file is damaged.",
}


def _unpack_at_once(payload: RawPayload, request: LoadRequest) -> npt.NDArray[Any] | None:
    """All values by libdeflate, or None when the stream is in any way unusual: zlib then decides."""
    unpacked = unpacked_at_once(
        payload.files[0], payload.packed_offset, payload.offset + payload.nbytes, request
    )
    if unpacked is None:
        return None
    values = unpacked[payload.offset :]
    if payload.offset % payload.dtype.itemsize:
        values = values.copy()
    return values.view(payload.dtype).reshape(payload.shape)


def _fill_unpacked(
    target: npt.NDArray[np.uint8], file: Path, payload: RawPayload, request: LoadRequest
) -> None:
    view = target.data
    skip, done = payload.offset, 0
    try:
        blocks = _unpacked_blocks(file, payload.packed_offset, payload.encoding)
        for block, fraction in blocks:
            used = block
            if skip:
                used = block[skip:]
                skip -= len(block) - len(used)
            count = min(len(used), len(view) - done)
            view[done : done + count] = used[:count]
            done += count
            request.report(fraction, "unpacking")
            if done == len(view):
                if payload.whole:
                    # the checksum behind the values is compared when the next block is asked for
                    next(blocks, None)
                return
    except (zlib.error, OSError, EOFError, ValueError):
        raise request.error(_DAMAGED.get(payload.encoding, _DAMAGED["gzip"]), file) from None
    raise request.error(
        f"the file is cut off: the header promises {len(view):,} bytes of values, {done:,} are there.",
        file,
    )


def _unpacked_blocks(file: Path, start: int, encoding: Encoding) -> Iterator[tuple[memoryview, float]]:
    """Unpacked blocks of at most `BLOCK` bytes, and how much of the file is read; members are joined."""
    size = max(file.stat().st_size, 1)
    with file.open("rb") as stream:
        stream.seek(start)
        if encoding == "hex":
            for digits, fraction in _without_breaks(stream, size, _BLANKS, b""):
                yield memoryview(bytes.fromhex(digits.decode("ascii"))), fraction
            return
        pending = b""
        while True:
            unpacker: Any = _decompressor(encoding)
            while not unpacker.eof:
                if not pending:
                    pending = stream.read(BLOCK // 16)
                    if not pending:
                        return
                block = unpacker.decompress(pending, BLOCK)
                pending = b"" if encoding == "bzip2" else unpacker.unconsumed_tail
                yield memoryview(block), stream.tell() / size
                while encoding == "bzip2" and not unpacker.needs_input and not unpacker.eof:
                    yield memoryview(unpacker.decompress(b"", BLOCK)), stream.tell() / size
            pending = unpacker.unused_data or stream.read(BLOCK // 16)
            # padding after the last member is allowed and common (tapes, block devices)
            if not pending.strip(b"\0"):
                return


def _decompressor(encoding: Encoding) -> Any:
    if encoding != "bzip2":
        return zlib.decompressobj(wbits=47)
    import bz2

    return bz2.BZ2Decompressor()


_BLANKS = b" \t\r\n\v\f"


def _without_breaks(
    stream: IO[bytes], size: int, removed: bytes, separators: bytes
) -> Iterator[tuple[bytes, float]]:
    """The rest of a text in blocks that end between two values, and how much of the file is read.

    Parameters
    ----------
    removed : bytes
        Characters that are left out.
    separators : bytes
        What stands between values; without any, a value has two characters.
    """
    kept = b""
    while True:
        block = stream.read(BLOCK // 4)
        text = kept + block.translate(None, removed)
        if not block:
            if text:
                yield text, 1.0
            return
        end = max(text.rfind(c) for c in separators) + 1 if separators else len(text) // 2 * 2
        kept = text[end:]
        if end:
            yield text[:end], stream.tell() / size


def _read_text(payload: RawPayload, request: LoadRequest) -> npt.NDArray[Any]:
    """Numbers in decimal digits, block by block: as words they take many times the memory of their values."""
    request.report(0.0)
    kind = payload.dtype.newbyteorder("=")
    values = np.empty(math.prod(payload.shape), kind)
    done = 0
    for file in payload.files:
        with file.open("rb") as stream:
            stream.seek(max(payload.offset, 0))
            for text, fraction in _without_breaks(stream, max(file.stat().st_size, 1), b"", _BLANKS + b","):
                words = text.replace(b",", b" ").split()[: len(values) - done]
                values[done : done + len(words)] = _numbers(words, kind, request)
                done += len(words)
                request.report(fraction)
                if done == len(values):
                    return values.reshape(payload.shape)
    raise request.error(
        f"the file is cut off: the header promises {len(values):,} values, {done:,} are there."
    )


def _numbers(words: list[bytes], kind: np.dtype[Any], request: LoadRequest) -> npt.NDArray[Any]:
    """Words as numbers, whole ones to the last digit."""
    if not words:
        return np.empty(0, kind)
    try:
        if kind.kind == "f":
            return np.array(words).astype(np.float64)
        try:
            whole = np.array([int(word) for word in words], object)
        except ValueError:
            real = np.array(words).astype(np.float64)
            if not np.all(real == np.trunc(real)):
                raise request.error(
                    f"not all of its values are numbers of the type {kind} that it names."
                ) from None
            whole = np.array([int(value) for value in real], object)
    except (ValueError, OverflowError):
        raise request.error("the values are not all numbers; the file is damaged.") from None
    limits = np.iinfo(kind)
    if whole.min() < limits.min or whole.max() > limits.max:
        raise request.error(
            f"it holds values that the type {kind}, which it names, cannot hold; save it again."
        )
    return whole.astype(kind)
