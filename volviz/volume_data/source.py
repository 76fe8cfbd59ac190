"""What data can be asked before it is read, and the one way to read a part of it."""

from __future__ import annotations

import math
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from weakref import WeakValueDictionary

import numpy as np

from volviz.errors import Cancelled, InputError
from volviz.volume_data.description import Box, Channel, Description, Label, Level, Statistics
from volviz.volume_data.finer_levels import FinerLevels, tell_levels_behind
from volviz.volume_data.volume import Volume

if TYPE_CHECKING:
    import numpy.typing as npt

Cancel = Callable[[], bool]
Progress = Callable[[float, str], object]


@dataclass(frozen=True)
class ReadRequest:
    """What a source is asked to read, checked; see `VolumeSource.read`."""

    level: int = 0
    time: int = 0
    channel: int | None = None
    box: Box | None = None
    cancel: Cancel | None = None
    progress: Progress | None = None
    #: Whether anybody has asked for this time point.
    time_chosen: bool = False


class VolumeSource(ABC):
    """Data that can be read in parts: a file, an array in memory, or anything that a program makes.

    A subclass says what there is by a `Description` and reads in `read_volume`; what is asked for was checked
    before. Attributes and methods may be used from any thread.

    Parameters
    ----------
    description : Description
    """

    def __init__(self, description: Description) -> None:
        self.description = description
        self._alive: WeakValueDictionary[tuple[int, int, int | None], Volume] = WeakValueDictionary()
        self._fitting: WeakValueDictionary[tuple[int, int | None], Volume] = WeakValueDictionary()
        self._lock = threading.Lock()

    def __repr__(self) -> str:
        sizes = ", ".join(f"{axis}: {size}" for axis, size in self.sizes.items())
        return f"<{type(self).__name__} {self.name!r} {sizes}>"

    # ------------------------------------------------------------------ asking

    @property
    def name(self) -> str:
        """What to call the data set."""
        return self.description.name

    @property
    def axes(self) -> tuple[str, ...]:
        """Names among "t", "c", "z", "y", "x", in this order; always the last three."""
        return tuple(self.sizes)

    @property
    def sizes(self) -> dict[str, int]:
        """Size of each axis, at the finest level."""
        said = self.description
        x, y, z = said.levels[0].dimensions
        found = {"t": said.time_count, "c": said.channel_count, "z": z, "y": y, "x": x}
        return {axis: size for axis, size in found.items() if size is not None}

    @property
    def units(self) -> dict[str, str]:
        """Unit of each axis: "s" where the times are known, the unit of length, or an empty text."""
        known = {"t": "s" if self.times is not None else "", "c": ""}
        return {axis: known.get(axis, self.description.length_unit) for axis in self.axes}

    @property
    def unit(self) -> str:
        """Unit of the values; empty when unknown."""
        return self.description.unit

    @property
    def levels(self) -> tuple[Level, ...]:
        """Resolutions, the finest first, each with a geometry of its own."""
        return self.description.levels

    @property
    def entries(self) -> Sequence[Any]:
        """Images or arrays of the same file (`volviz.io.entries.Entry`); empty where this one is alone."""
        return ()

    @property
    def default_level(self) -> int:
        """Number of the level to show when nobody has chosen one: the finest, unless it is too large."""
        return 0

    @property
    def times(self) -> tuple[float, ...] | None:
        """Seconds of the time points, None when they are not known."""
        return self.description.times

    @property
    def channels(self) -> tuple[Channel, ...]:
        """What is known of each channel; one entry for data without channels."""
        said = self.description
        return said.channels or (Channel(),) * (said.channel_count or 1)

    @property
    def is_labels(self) -> bool:
        """Whether the values are numbers that stand for something (see `labels`)."""
        return self.description.is_labels

    @property
    def labels(self) -> tuple[Label, ...]:
        """What the labels stand for, as far as the file says it."""
        return self.description.labels

    @property
    def is_colour(self) -> bool:
        """Whether the channels are red, green, blue (and alpha) of colours."""
        return self.description.is_colour

    @property
    def length_unit(self) -> str:
        """Unit of spacing and origin ("mm", "µm"); empty when unknown."""
        return self.description.length_unit

    @property
    def content_id(self) -> str:
        """Changes when the data changes; part of the keys of caches."""
        return self.description.content_id

    @property
    def metadata(self) -> Mapping[str, Any]:
        """What else the reader tells: ``"source"``, ``"format"``, ``"notes"``."""
        return self.description.metadata

    def statistics(self, time: int = 0, channel: int | str | None = None) -> Statistics | None:
        """Range of the values where it is known without reading them; None where it is not.

        Raises
        ------
        InputError
            There is no such time point or channel.
        """
        self._checked(0, time, channel)
        return self.description.statistics

    # ------------------------------------------------------------------ reading

    def read(
        self,
        level: int = 0,
        time: int | None = None,
        channel: int | str | None = None,
        box: Sequence[int] | None = None,
        cancel: Cancel | None = None,
        progress: Progress | None = None,
    ) -> Volume:
        """Read one channel at one time point, or a part of it.

        Parameters
        ----------
        level : int
            Number of the level of resolution, 0 is the finest.
        time : int or None
            Number of the time point, from 0; None takes the first one, with a note where there are more.
        channel : int, str or None
            Number of the channel, from 0, or its name. None takes what the file shows by itself: its first channel, the
            brightness of colours.
        box : sequence of 6 ints, optional
            Voxels (i0, i1, j0, j1, k0, k1) of that level, those of i1, j1 and k1 no more, at least two along
            each axis; None reads all.
        cancel : callable() -> bool, optional
            Asked now and then; True stops the reading.
        progress : callable(fraction, text), optional
            Told of the progress, fraction 0..1.

        Returns
        -------
        Volume
            With the geometry of the level, or of the box in it. As long as a whole volume is in use, reading
            the same again gives the same object.

        Raises
        ------
        InputError
            A number outside what there is.
        LoadError
            The file is damaged or cannot be read.
        Cancelled
        """
        time_chosen = time is not None
        level, time, channel = self._checked(level, time or 0, channel)
        part = None if box is None else checked_box(box, self.levels[level].dimensions, self.name)
        if cancel is not None and cancel():
            raise Cancelled(f"{self.name}: reading was cancelled.")
        request = ReadRequest(level, time, channel, part, cancel, progress, time_chosen)
        if part is not None:
            return self.read_volume(request)
        key = level, time, channel
        with self._lock:
            alive = self._alive.get(key)
        if alive is not None:
            return alive
        volume = self.read_volume(request)
        with self._lock:
            # another thread may have been faster: all get the same object
            return self._alive.setdefault(key, volume)

    def read_fitting(
        self,
        time: int | None = None,
        channel: int | str | None = None,
        cancel: Cancel | None = None,
        progress: Progress | None = None,
    ) -> Volume:
        """All of one channel at one time point, at the finest level that fits into memory.

        Where there are several levels, techniques that can read the finer ones while they draw.

        Parameters
        ----------
        time, channel, cancel, progress
            As for `read`.
        """
        level = self.default_level
        volume = self.read(level, time, channel, None, cancel, progress)
        if len(self.levels) < 2 or self.is_labels:
            return volume
        _, time_point, number = self._checked(level, time or 0, channel)
        key = time_point, number
        with self._lock:
            fitting = self._fitting.get(key)
            if fitting is None:
                fitting = self._fitting[key] = Volume(
                    volume.array, volume.spacing, volume.origin, volume.direction, unit=volume.unit,
                    name=volume.name, metadata=volume.metadata,
                )  # fmt: skip

                def read(level: int, box: Box, cancel: Cancel | None) -> npt.NDArray[Any]:
                    return self.read(level, time_point, number, box, cancel).array

                tell_levels_behind(fitting, FinerLevels(self.levels, read, volume.array, level))
        return fitting

    @abstractmethod
    def read_volume(self, request: ReadRequest) -> Volume:
        """What is asked for: values of shape (z, y, x) as `placed` makes a volume of them."""

    def placed(self, array: npt.ArrayLike, request: ReadRequest, **metadata: Any) -> Volume:
        """Values that were read, shape (z, y, x), with the geometry of their level or box."""
        level = self.levels[request.level]
        lattice = level if request.box is None else level.part(request.box)
        scalars = np.asanyarray(array)
        described = {**self.metadata, **metadata}
        if not self.is_labels:
            described["notes"] = (*described.get("notes", ()), *_notes_on_values(scalars))
        return Volume(
            scalars,
            lattice.spacing,
            lattice.origin,
            lattice.direction,
            unit=self.unit,
            name=self.name,
            metadata=described,
        )

    def channel_number(self, channel: int | str) -> int:
        """The number of a channel, from 0, by its number or name (upper or lower case, if that is clear).

        Raises
        ------
        InputError
            There is no such channel, or several are called so.
        """
        if not isinstance(channel, str):
            return checked_number("channel", channel, self.sizes.get("c", 1), self.name)
        names = [each.name for each in self.channels]
        found = [n for n, name in enumerate(names) if name == channel]
        found = found or [n for n, name in enumerate(names) if name.lower() == channel.lower()]
        if len(found) != 1:
            known = ", ".join(name for name in names if name)
            which = "several channels are" if found else "no channel is"
            there = f"; its channels are {known}" if known else "; its channels have no names"
            raise InputError(f"{self.name}: {which} called {channel!r}{there}: give a number from 0.")
        return found[0]

    def _checked(self, level: int, time: int, channel: int | str | None) -> tuple[int, int, int | None]:
        sizes = self.sizes
        return (
            checked_number("level", level, len(self.levels), self.name),
            checked_number("time", time, sizes.get("t", 1), self.name),
            None if channel is None else self.channel_number(channel),
        )


def _notes_on_values(scalars: npt.NDArray[Any]) -> tuple[str, ...]:
    """What the user must know of the values themselves: which of them are no data."""
    from volviz.kernels.outliers import no_data_of

    if scalars.ndim != 3 or not scalars.size or scalars.dtype.kind not in "iuf":
        return ()
    found = no_data_of(scalars)
    if not found.values:
        return ()
    numbers = " and ".join(f"{value:.7g}" for value in found.values)
    stand, out = ("stands", "it") if len(found.values) == 1 else ("stand", "them")
    share = f"about {found.share:.0%}" if found.share >= 0.01 else "less than 1%"
    return (
        f'{numbers} {stand} for "no data", it seems ({share} of the voxels); the first look leaves {out} out.',
    )


def checked_number(what: str, value: int, count: int, name: str) -> int:
    """The number of one of `count` levels, time points or channels.

    Raises
    ------
    InputError
        It is no integer within 0..count - 1.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise InputError(f"{what} must be an integer, got {value!r}.")
    if not 0 <= value < count:
        words = {"time": "time point"}
        some = (
            f"{what} must lie in 0..{count - 1}"
            if count > 1
            else f"there is only one {words.get(what, what)}"
        )
        raise InputError(f"{name}: {some}, got {value}.")
    return int(value)


def checked_box(box: Sequence[int], dimensions: tuple[int, int, int], name: str) -> Box:
    """A box of voxels (i0, i1, j0, j1, k0, k1) inside so many voxels along (x, y, z).

    Raises
    ------
    InputError
        Not six integers, fewer than two voxels along an axis, or not inside.
    """
    try:
        numbers = [int(v) for v in box]
        whole = len(numbers) == 6 and all(
            math.isclose(n, v, abs_tol=0.0) for n, v in zip(numbers, box, strict=True)
        )
    except (TypeError, ValueError, OverflowError):
        whole = False
    if not whole:
        raise InputError(f"box must be six integers (i0, i1, j0, j1, k0, k1) in voxels, got {box!r}.")
    for axis, first, last, count in zip("ijk", numbers[::2], numbers[1::2], dimensions, strict=True):
        if not 0 <= first < last <= count:
            raise InputError(
                f"{name}: box goes from {first} to {last} along {axis}, outside the {count} voxels there; "
                f"choose 0 <= {axis}0 < {axis}1 <= {count}."
            )
        if last - first < 2:
            raise InputError(f"{name}: box holds one voxel along {axis}; a volume needs at least 2.")
    return numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]
