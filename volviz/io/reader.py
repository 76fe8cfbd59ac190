"""What a reader is, and what it is told: path, hints, part, progress, cancelling."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from volviz.errors import Cancelled, InputError, LoadError
from volviz.volume_data.orientation import checked_orientation
from volviz.volume_data.references import SAMPLE_PREFIX

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.geometry import Geometry
    from volviz.volume_data.description import Box
    from volviz.volume_data.source import Cancel, Progress


Result_co = TypeVar("Result_co", covariant=True)

#: Seconds between two questions whether the user has cancelled.
_PATIENCE = 0.05


class Future(Protocol[Result_co]):
    """Work on another thread: one of `concurrent.futures`, or of tensorstore."""

    def result(self, timeout: float | None = None) -> Result_co:
        """What came of it; a `TimeoutError` while it goes on."""

    def done(self) -> bool:
        """Whether it has ended."""

    def cancel(self) -> bool:
        """Give it up."""


#: What is chosen when values are read, not when a file is opened.
PART = ("level", "time", "channel", "box")

GZIP = b"\x1f\x8b"
ZIP = b"PK\x03\x04"

#: Endings of files that are packed as a whole, behind that of their format, and their first bytes.
PACKINGS = {".gz": GZIP, ".bz2": b"BZh", ".xz": b"\xfd7zXZ\0", ".zst": b"\x28\xb5\x2f\xfd"}
PACKED_SUFFIXES = tuple(PACKINGS)

#: Bytes of a file that `Reader.sniff` is given.
HEAD_BYTES = 4096


@dataclass(frozen=True)
class LoadOptions:
    """What the user says about a file that the file itself leaves open; None = not said.

    Attributes
    ----------
    dims : tuple of 3 ints
        Number of voxels along (x, y, z) of a raw file.
    dtype : str or numpy dtype
        Type of the values of a raw file, "uint8" or "float32" say.
    endian : {"little", "big"}
        Byte order of a raw file; "little" when not said.
    header : int
        Bytes before the values of a raw file; -1 = the values are the last bytes of the file. Default 0.
    spacing, origin : tuple of 3 floats
        Replace what the file says about spacing and origin, (x, y, z) in world units.
    orientation : str
        Where the axes i, j, k of the voxels lead, a letter each, in the place of the directions in the file:
        "L" or "R", "A" or "P", "S" or "I" of a patient, each axis once; "LPS" is the world's +x, +y, +z.
    length_unit : str
        Replaces the unit of lengths; their numbers stay.
    unit, name : str
        Replace unit of the values and name of the volume.
    series : str or int
        DICOM: series instance UID or number of the series in the folder, counted from 0.
        TIFF: number of the series in the file.
        VTK: 0 for the arrays at points, 1 for those at cells, in a file that has both.
        Zarr, HDF5, .npz, .mat: name of the image or array, or its number among them, counted from 0; ``dataset``
        is another word for it.
    """

    dims: tuple[int, int, int] | None = None
    dtype: Any = None
    endian: str | None = None
    header: int | None = None
    spacing: tuple[float, float, float] | None = None
    origin: tuple[float, float, float] | None = None
    orientation: str | None = None
    length_unit: str | None = None
    unit: str | None = None
    name: str | None = None
    series: str | int | None = None

    @classmethod
    def from_keywords(cls, keywords: dict[str, Any]) -> LoadOptions:
        """Checked hints; an unknown keyword or a value of the wrong kind raises `InputError`."""
        known = [f.name for f in fields(cls)]
        if "dataset" in keywords and keywords.get("series") is None:
            keywords = {**keywords, "series": keywords["dataset"]}
            del keywords["dataset"]
        for name in keywords:
            if name not in known:
                if name in PART:
                    raise InputError(
                        f"{name} is chosen when values are read: volviz.open(...).read({name}=...)."
                    )
                raise InputError(f"reading knows no hint {name!r}; it takes {', '.join((*known, *PART))}.")
        values = {name: value for name, value in keywords.items() if value is not None}
        for name in ("dims", "spacing", "origin"):
            if name in values:
                values[name] = _three(name, values[name], int if name == "dims" else float)
        if "header" in values and not _is_integer(values["header"]):
            raise InputError(f"header must be an integer, got {values['header']!r}.")
        if "endian" in values and values["endian"] not in ("little", "big"):
            raise InputError(f"endian must be 'little' or 'big', got {values['endian']!r}.")
        if "orientation" in values:
            values["orientation"] = checked_orientation(values["orientation"])
        return cls(**values)


@dataclass(frozen=True)
class LoadRequest:
    """One call of `open` or of a source's `read`: what is wanted and whom to tell.

    Attributes
    ----------
    path : Path
        File or folder; the name alone where there is an address.
    hints : LoadOptions
    level : int
        Resolution that is read, 0 is the finest.
    time, channel : int or None
        What is read, counted from 0; None where nobody has chosen.
    box : tuple of 6 ints or None
        Voxels (i0, i1, j0, j1, k0, k1) that are read, those of i1, j1 and k1 no more; None reads all.
    progress : callable(fraction, text) or None
        Told about the progress, fraction 0..1.
    cancel : callable() -> bool or None
        Asked between blocks; True stops the work.
    notes : list of str
        Sentences for the user: what was chosen or changed. They end up in ``Volume.metadata["notes"]``.
    address : str
        URL from which the data comes; empty for what lies on this machine.
    """

    path: Path
    hints: LoadOptions = field(default_factory=LoadOptions)
    level: int = 0
    time: int | None = None
    channel: int | None = None
    box: Box | None = None
    progress: Progress | None = None
    cancel: Cancel | None = None
    notes: list[str] = field(default_factory=list)
    address: str = ""

    def report(self, fraction: float, text: str = "reading") -> None:
        """Tell the progress and stop when the user wants to.

        Raises
        ------
        Cancelled
        """
        self.check_cancelled()
        if self.progress is not None:
            self.progress(min(max(fraction, 0.0), 1.0), text)

    def check_cancelled(self) -> None:
        """Stop when the user wants to.

        Raises
        ------
        Cancelled
        """
        if self.cancel is not None and self.cancel():
            raise Cancelled(f"{self.path.name}: loading was cancelled.")

    def wait(self, future: Future[Result_co]) -> Result_co:
        """What came of work on another thread; a cancelled job does not wait for it.

        Raises
        ------
        Cancelled
        """
        while True:
            try:
                self.check_cancelled()
                return future.result(timeout=_PATIENCE)
            except TimeoutError:
                # the work itself may have raised one
                if future.done():
                    return future.result()
            except Cancelled:
                future.cancel()
                raise

    def within_slices(self) -> LoadRequest:
        """The job for an array that holds the slices of the box alone."""
        if self.box is None:
            return self
        i0, i1, j0, j1, first, last = self.box
        return replace(self, box=(i0, i1, j0, j1, 0, last - first))

    def note(self, sentence: str) -> None:
        """Add a sentence for the user, once."""
        if sentence not in self.notes:
            self.notes.append(sentence)

    @property
    def is_remote(self) -> bool:
        """Whether the data lies at the address, and no copy of it on this machine."""
        return bool(self.address) and not self.path.is_absolute()

    @property
    def source(self) -> str:
        """What `load` was asked for, so that it can be asked again: an absolute path, a URL or ``sample:<id>``."""
        text = self.address or str(self.path)
        return text if self.address or text.startswith(SAMPLE_PREFIX) else str(self.path.absolute())

    def geometry(self, affine: npt.ArrayLike) -> Geometry:
        """Where the lattice lies, from an affine matrix (index to world, LPS) of shape (3, 4) or (4, 4).

        Raises
        ------
        LoadError
            A number that is not finite, or an axis without length.
        """
        from volviz.io.geometry import Geometry

        try:
            return Geometry.from_affine(affine)
        except ValueError:
            raise self.error("its spacing, origin or orientation is unusable; the file is damaged.") from None

    def error(self, what: str, path: Path | None = None) -> LoadError:
        """A `LoadError` that names the file."""
        return LoadError(f"{(path or self.path).name}: {what}")


def is_packed(head: bytes) -> bool:
    """Whether these first bytes are those of a packed file."""
    return head.startswith(tuple(PACKINGS.values()))


def stem(path: Path, suffixes: tuple[str, ...] = ()) -> str:
    """Name of a file without the suffix of its format and without ``.gz`` and the like."""
    name = path.name
    for suffix in (*PACKED_SUFFIXES, *sorted(suffixes, key=len, reverse=True)):
        if name.lower().endswith(suffix) and len(name) > len(suffix):
            name = name[: -len(suffix)]
    return name if suffixes else (Path(name).stem or name)


def shortened(text: str, at_most: int = 40) -> str:
    """Text of a header in quotation marks as it may stand in a sentence: without control characters, not long."""
    return repr(text if len(text) <= at_most else text[: at_most - 3] + "...")


def _is_integer(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _three(name: str, value: Any, kind: type[int | float]) -> tuple[Any, Any, Any]:
    try:
        x, y, z = value
        converted = kind(x), kind(y), kind(z)
        if kind is int and converted != (x, y, z):
            raise ValueError
    except (TypeError, ValueError):
        word = "integers" if kind is int else "numbers"
        raise InputError(f"{name} must be three {word} (x, y, z), got {value!r}.") from None
    return converted
