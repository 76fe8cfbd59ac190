"""What is written: which time points and channels of a source, on which lattice, in which type."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.memory import check_memory
from volviz.io.writers.resampling import Resampling
from volviz.volume_data.source import checked_box, checked_number

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.writers.request import SaveRequest
    from volviz.volume_data.description import Channel
    from volviz.volume_data.source import VolumeSource

#: Millimetres per unit of length.
_MILLIMETRES = {"Å": 1e-7, "nm": 1e-6, "µm": 1e-3, "mm": 1.0, "cm": 10.0, "m": 1000.0}


class WiderValuesError(Exception):
    """A later part has values that the type of the first does not hold; `dtype` holds both."""

    def __init__(self, dtype: np.dtype[Any]) -> None:
        super().__init__(str(dtype))
        self.dtype = dtype


class Content:
    """A source, or a part of it, as a writer asks for it: one array after another.

    Parameters
    ----------
    source : VolumeSource
    level : int
    time, channel : int or None
        The one (a channel by its name, too) that is written; None writes all, of colours all components.
    box : sequence of 6 ints, optional
        Voxels (i0, i1, j0, j1, k0, k1) of the level, as in `VolumeSource.read`.
    spacing : sequence of 3 floats, optional
        Distances along (x, y, z) of the lattice on which values are resampled.
    request : SaveRequest

    Attributes
    ----------
    lattice : Level
        Where what is written lies.
    dtype : numpy dtype
        Of what is written; asking for it reads the first part.
    time_count, channel_count : int or None
        Sizes of the axes that are written; None = no such axis.
    times : tuple of float or None
        Seconds of the time points that are written.
    channels : tuple of Channel
        One for every channel, one without that axis.
    is_colour : bool
        All components of colours are written.
    """

    def __init__(
        self,
        source: VolumeSource,
        request: SaveRequest,
        *,
        level: int = 0,
        time: int | None = None,
        channel: int | str | None = None,
        box: Sequence[int] | None = None,
        spacing: Sequence[float] | None = None,
    ) -> None:
        sizes = source.sizes
        self.source = source
        self.name, self.unit, self.length_unit = source.name, source.unit, source.length_unit
        self.is_labels, self.labels = source.is_labels, source.labels
        self.level = checked_number("level", level, len(source.levels), source.name)
        lattice = source.levels[self.level]
        self.box = None if box is None else checked_box(box, lattice.dimensions, source.name)
        if self.box is not None:
            lattice = lattice.part(self.box)
        self._resampling = (
            None if spacing is None else Resampling.onto(lattice, spacing, is_labels=self.is_labels)
        )
        self.lattice = lattice if self._resampling is None else self._resampling.lattice
        if time is not None:
            time = checked_number("time", time, sizes.get("t", 1), source.name)
        self._times = range(sizes.get("t", 1)) if time is None else range(time, time + 1)
        # a source without channels, or one that chooses by itself
        self._channels: Sequence[int | None] = [None if channel is None else source.channel_number(channel)]
        if channel is None and "c" in sizes:
            self._channels = range(sizes["c"])
        self.time_count = len(self._times) if "t" in sizes and len(self._times) > 1 else None
        self.channel_count = len(self._channels) if len(self._channels) > 1 else None
        known = source.times
        self.times = None if known is None or self.time_count is None else known
        self.channels: tuple[Channel, ...] = tuple(source.channels[number or 0] for number in self._channels)
        self.is_colour = source.is_colour and self.channel_count is not None
        self._request = request
        self._held: npt.NDArray[Any] | None = None
        self._dtype: np.dtype[Any] | None = None
        self._done = 0

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of what is written."""
        if self._dtype is None:
            # kept: it will be asked for next
            self._held = self._read(0, 0, self._request)
            self._dtype = self._held.dtype
        return self._dtype

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels along (z, y, x)."""
        x, y, z = self.lattice.dimensions
        return z, y, x

    @property
    def parts(self) -> int:
        """How many arrays are written: one for each time point and channel."""
        return len(self._times) * len(self._channels)

    @property
    def nbytes(self) -> int:
        """Bytes of all values."""
        return self.parts * int(np.prod(self.shape)) * self.dtype.itemsize

    @property
    def even_times(self) -> tuple[float, float] | None:
        """Seconds of the first time point and from one to the next, None when they are not even or not known."""
        if self.times is None:
            return None
        steps = np.diff(self.times)
        if np.any(steps <= 0) or np.ptp(steps) > 1e-6 * steps.max():
            return None
        return self.times[0], float(self.times[-1] - self.times[0]) / len(steps)

    @property
    def frames(self) -> range:
        """Numbers of the time points that are written, from 0."""
        return range(self.time_count or 1)

    def to_millimetres(self, request: SaveRequest) -> float:
        """Millimetres per unit of length, for formats whose lengths are millimetres; 1 when the unit is not known."""
        if self.length_unit in ("mm", ""):
            return 1.0
        if self.length_unit not in _MILLIMETRES:
            request.note(f"Lengths in {self.length_unit} are written as they are; others take them for mm.")
            return 1.0
        request.note(f"Lengths are in mm there: those in {self.length_unit} are converted.")
        return _MILLIMETRES[self.length_unit]

    def array(self, time: int, channel: int, request: SaveRequest) -> npt.NDArray[Any]:
        """One time point and channel of those that are written, counted from 0; shape (z, y, x), type `dtype`.

        Raises
        ------
        WiderValuesError
            It does not fit `dtype`: begin anew with the wider one.
        """
        array = self._read(time, channel, request)
        if array.dtype != self.dtype:
            wider = np.result_type(array.dtype, self.dtype)
            if wider != self.dtype:
                raise WiderValuesError(wider)
            array = array.astype(self.dtype)
        return array

    def all_channels(self, time: int, request: SaveRequest) -> npt.NDArray[Any]:
        """All channels of one time point, shape (z, y, x, c): for formats that hold them side by side."""
        count = self.channel_count or 1
        check_memory(request, count * int(np.prod(self.shape)) * self.dtype.itemsize)
        result = np.empty((*self.shape, count), self.dtype)
        for channel in range(count):
            result[..., channel] = self.array(time, channel, request)
        return result

    def pieces(self, request: SaveRequest) -> Iterator[tuple[npt.NDArray[Any], tuple[float, float]]]:
        """What is written one after another: all components of a colour, or one channel, of one time point.

        Yields
        ------
        array : ndarray of shape (z, y, x, c) or (z, y, x)
        span : tuple of 2 floats
            Progress while it is written.
        """
        if self.is_colour:
            for time in self.frames:
                yield self.all_channels(time, request), self.span(time, len(self.frames))
            return
        channels = self.channel_count or 1
        for number in range(len(self.frames) * channels):
            yield self.array(*divmod(number, channels), request), self.span(number)

    def span(self, number: int, count: int | None = None) -> tuple[float, float]:
        """Progress while one of so many equal pieces (default: of the parts) is written; reading comes before."""
        pieces = count or self.parts
        return (number + 0.5) / pieces, (number + 1) / pieces

    def begin(self, dtype: np.dtype[Any] | None = None) -> None:
        """Start over, with another type if there is one."""
        self._done = 0
        if dtype is not None:
            self._dtype = dtype

    def _read(self, time: int, channel: int, request: SaveRequest) -> npt.NDArray[Any]:
        """Values of one part."""
        if self._held is not None and (time, channel) == (0, 0):
            held, self._held = self._held, None
            return held
        first = self._done / self.parts
        self._done += 1
        share = 0.5 / self.parts
        volume = self.source.read(
            self.level,
            self._times[time],
            self._channels[channel],
            self.box,
            request.cancel,
            lambda fraction, _text: request.report(first + share * fraction, "reading"),
        )
        array = volume.array
        if self._resampling is not None:
            array = self._resampling.of(array, request)
        return array

    def channel_names(self) -> list[str]:
        """A name for each channel, different from one another: "channel 1" where the source gives none."""
        names: list[str] = []
        for number, channel in enumerate(self.channels):
            name = channel.name or (f"channel {number + 1}" if len(self.channels) > 1 else "values")
            names.append(name if name not in names else f"{name} ({number + 1})")
        return names
