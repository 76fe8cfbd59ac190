"""Frames put together: MP4 and WebM by PyAV, GIF and animated PNG by Pillow."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.embedded_session import PNG_KEYWORD
from volviz.errors import Cancelled, InputError, VolvizError

if TYPE_CHECKING:
    from PIL.Image import Image

#: What does the asking whether to stop, and the telling how far it is.
Cancel = Callable[[], bool]
Progress = Callable[[float], object]


@dataclass(frozen=True)
class Format:
    """A kind of file for movies.

    Attributes
    ----------
    suffix : str
    codec : str
        Name for PyAV, empty where Pillow writes.
    pixels, transparent_pixels : str
        Pixel formats of the codec; empty where it knows no transparency.
    options : tuple of (str, str)
        For the codec: near to lossless, since what people look at are the fine structures.
    even : bool
        Width and height must be even, as colours are stored at half the resolution.
    """

    suffix: str
    label: str
    codec: str = ""
    pixels: str = ""
    transparent_pixels: str = ""
    options: tuple[tuple[str, str], ...] = ()
    even: bool = False

    @property
    def is_transparent(self) -> bool:
        """Whether it can hold a transparent background."""
        return self.suffix == ".apng" or bool(self.transparent_pixels)


FORMATS: dict[str, Format] = {
    each.suffix: each
    for each in (
        Format(".mp4", "MP4 (H.264)", "libx264", "yuv420p", options=(("crf", "16"), ("preset", "medium")), even=True),
        Format(
            ".webm", "WebM (VP9)", "libvpx-vp9", "yuv420p", "yuva420p",
            (("crf", "20"), ("b", "0"), ("row-mt", "1"), ("deadline", "good"), ("cpu-used", "4")), even=True,
        ),
        Format(".gif", "GIF"),
        Format(".apng", "Animated PNG"),
    )
}  # fmt: skip


def format_of(output: Path) -> Format | None:
    """How a movie of that name is encoded; None for a sequence of numbered PNG files.

    Raises
    ------
    InputError
        The name is none of a movie.
    """
    if "%" in output.name:
        try:
            names = {output.name % number for number in (1, 2)}
        except (TypeError, ValueError):
            names = set()
        if len(names) != 2 or output.suffix.lower() != ".png":
            raise InputError(f"{output}: numbered frames are called like frames/%04d.png.")
        return None
    found = FORMATS.get(output.suffix.lower())
    if found is None:
        raise InputError(
            f"{output}: movies end in {', '.join(FORMATS)}, numbered frames are called like frames/%04d.png."
        )
    return found


def check_encoder(kind: Format, size: tuple[int, int], *, transparent: bool) -> None:
    """Refuse what cannot be encoded before minutes are spent on drawing.

    Raises
    ------
    InputError
        The size or transparency does not go with the format.
    VolvizError
        PyAV is not installed.
    """
    width, height = size
    if kind.even and (width % 2 or height % 2):
        raise InputError(
            f"{kind.label} takes an even width and height; choose {width - width % 2}x{height - height % 2}."
        )
    if transparent and not kind.is_transparent:
        raise InputError(f"{kind.label} holds no transparent background; choose WebM or numbered PNG files.")
    if kind.codec:
        _av()


def encode(
    frames: Sequence[Path],
    output: Path,
    kind: Format,
    *,
    fps: int,
    size: tuple[int, int],
    transparent: bool = False,
    metadata: dict[str, str] | None = None,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> None:
    """Put frames together.

    Parameters
    ----------
    frames : sequence of Path
        PNG files of one size, in order.
    output : Path
        An empty file, or one to be replaced.
    kind : Format
    fps : int
        Frames a second.
    size : tuple of 2 ints
        Width and height of the frames in pixels.
    transparent : bool
        The background is.
    metadata : dict of str, optional
        "title", and "comment": the session.
    progress, cancel : callable, optional

    Raises
    ------
    VolvizError
        The movie cannot be written, or `Cancelled`.
    """
    write = _by_pyav if kind.codec else _by_pillow
    write(_Pictures(frames, progress, cancel), output, kind, fps, size, transparent, metadata or {})


class _Pictures:
    """The frames, opened one after another each time that they are gone through."""

    def __init__(self, frames: Sequence[Path], progress: Progress | None, cancel: Cancel | None) -> None:
        self._frames, self._progress, self._cancel = frames, progress, cancel

    def after(self, count: int) -> _Pictures:
        """The frames without the first ones."""
        return _Pictures(self._frames[count:], self._progress, self._cancel)

    def __iter__(self) -> Iterator[Image]:
        from PIL import Image

        for number, path in enumerate(self._frames):
            if self._cancel is not None and self._cancel():
                raise Cancelled("the movie was cancelled; its frames are kept.")
            with Image.open(path) as picture:
                picture.load()
            if self._progress is not None:
                self._progress((number + 1) / len(self._frames))
            yield picture


def _by_pyav(
    pictures: _Pictures,
    output: Path,
    kind: Format,
    fps: int,
    size: tuple[int, int],
    transparent: bool,
    metadata: dict[str, str],
) -> None:
    av = _av()
    mode, pixels = ("RGBA", "rgba") if transparent else ("RGB", "rgb24")
    try:
        with av.open(str(output), "w", format=kind.suffix[1:], options=_container_options(kind)) as container:
            container.metadata.update(metadata)
            stream = container.add_stream(kind.codec, rate=Fraction(fps), options=dict(kind.options))
            stream.width, stream.height = size
            stream.pix_fmt = kind.transparent_pixels if transparent else kind.pixels
            # players take the colours for what they are: those of HDTV, in studio range
            context = stream.codec_context
            context.color_primaries = context.color_trc = context.colorspace = 1
            context.color_range = 1
            for picture in pictures:
                frame = av.VideoFrame.from_ndarray(np.asarray(picture.convert(mode)), format=pixels)
                frame = frame.reformat(format=stream.pix_fmt, dst_colorspace="ITU709", dst_color_range="MPEG")
                for packet in stream.encode(frame):
                    container.mux(packet)
            for packet in stream.encode():
                container.mux(packet)
    except (av.FFmpegError, OSError) as error:
        raise VolvizError(f"{output}: the movie cannot be written ({error}).") from None


def _container_options(kind: Format) -> dict[str, str]:
    # the index first, so that a browser plays while it loads; and every name of metadata
    return {"movflags": "+faststart+use_metadata_tags"} if kind.suffix == ".mp4" else {}


def _by_pillow(
    pictures: _Pictures,
    output: Path,
    kind: Format,
    fps: int,
    size: tuple[int, int],
    transparent: bool,
    metadata: dict[str, str],
) -> None:
    from PIL.PngImagePlugin import PngInfo

    first = next(iter(pictures))
    options: dict[str, Any] = {
        "save_all": True,
        "loop": 0,
        "duration": 1000 / fps,
        "disposal": 2 if transparent else 1,
    }
    if kind.suffix == ".gif":
        options |= {"format": "GIF", "comment": metadata.get("comment", "").encode()}
    else:
        told = PngInfo()
        for name, text in metadata.items():
            told.add_itxt(PNG_KEYWORD if name == "comment" else name.capitalize(), text, zip=True)
        options |= {"format": "PNG", "pnginfo": told, "disposal": 0}
    try:
        # the first frame is not wanted twice; Pillow goes through the rest more than once
        first.save(output, append_images=pictures.after(1), **options)
    except OSError as error:
        raise VolvizError(f"{output}: the movie cannot be written ({error.strerror or error}).") from None


def _av() -> Any:
    try:
        import av
    except ImportError:
        raise VolvizError(
            "MP4 and WebM need PyAV, which is not installed: pip install av. GIF, animated PNG (.apng) and numbered "
            "PNG files are written without it."
        ) from None
    return av
