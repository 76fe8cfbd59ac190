"""An array in memory as a source: the simplest one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from volviz.errors import InputError
from volviz.volume_data.description import Channel, Description, Level, Statistics
from volviz.volume_data.source import ReadRequest, VolumeSource
from volviz.volume_data.volume import Volume, checked_direction

if TYPE_CHECKING:
    import numpy.typing as npt

#: Axes in the order in which they are named, slowest first: time, channel, and the three of space.
AXES = ("t", "c", "z", "y", "x")


class ArraySource(VolumeSource):
    """Values in memory, with time points and channels where there are any.

    Parameters
    ----------
    values : Volume or array_like
        A volume, or an array of three to five axes. It is not copied and must not be changed afterwards.
    axes : str, optional
        Names of the axes of an array, one letter each out of "tczyx", in any order. Default: "zyx" for three
        axes, "tzyx" for four, "tczyx" for five.
    spacing, origin, direction
        As for `Volume`; a volume brings its own.
    times : sequence of float, optional
        Seconds of the time points.
    channels : sequence of Channel, optional
        What is known of each channel.
    is_labels : bool
        The values are numbers that stand for something.
    unit, name : str
        As for `Volume`; a volume brings its own.

    Raises
    ------
    InputError
        Axes that do not fit the array, or what `Volume` refuses.
    """

    def __init__(
        self,
        values: Volume | npt.ArrayLike,
        axes: str | None = None,
        *,
        spacing: Sequence[float] = (1.0, 1.0, 1.0),
        origin: Sequence[float] = (0.0, 0.0, 0.0),
        direction: npt.ArrayLike | None = None,
        times: Sequence[float] | None = None,
        channels: Sequence[Channel] = (),
        is_labels: bool = False,
        unit: str = "",
        name: str = "volume",
    ) -> None:
        self._volume = values if isinstance(values, Volume) else None
        if isinstance(values, Volume):
            array, spacing, origin, direction = values.array, values.spacing, values.origin, values.direction
            unit, name = values.unit, values.name
        else:
            array = np.asanyarray(values)
        if axes is None:
            axes = {4: "tzyx", 5: "tczyx"}.get(array.ndim, "zyx")
        if len(set(axes)) != len(axes) or not set("zyx") <= set(axes) <= set(AXES):
            raise InputError(f"axes must be z, y, x and at most t and c, each once, got {axes!r}.")
        if array.ndim != len(axes):
            raise InputError(
                f"{name}: an array with the axes {axes!r} has {len(axes)} dimensions, got {array.ndim}."
            )
        # slowest first, so that one time point and channel is one index after the other
        self._has = [axis for axis in AXES if axis in axes]
        self._array = np.moveaxis(array, [axes.index(axis) for axis in self._has], range(len(axes)))
        sizes = dict(zip(self._has, self._array.shape, strict=True))
        first, second, third = checked_direction(direction, name).tolist()
        level = Level(
            (sizes["x"], sizes["y"], sizes["z"]),
            (spacing[0], spacing[1], spacing[2]),
            (origin[0], origin[1], origin[2]),
            (tuple(first), tuple(second), tuple(third)),
        )
        metadata = {} if self._volume is None else self._volume.metadata
        super().__init__(
            Description(
                (level,),
                sizes.get("t"),
                sizes.get("c"),
                None if times is None else tuple(float(t) for t in times),
                tuple(channels),
                is_labels=is_labels,
                name=name,
                unit=unit,
                metadata=metadata,
                length_unit=str(metadata.get("length_unit", "")),
            )
        )

    def statistics(self, time: int = 0, channel: int | str | None = None) -> Statistics | None:
        """Range of the values; it is counted once for each channel and time point that is in use."""
        return Statistics(*self.read(0, time, channel).range)

    def read_volume(self, request: ReadRequest) -> Volume:
        """A view of the array, or the volume itself; nothing is copied."""
        if self._volume is not None and request.box is None:
            return self._volume
        array = self._array
        if "t" in self._has:
            array = array[request.time]
        if "c" in self._has:
            array = array[request.channel or 0]
        if request.box is not None:
            i0, i1, j0, j1, k0, k1 = request.box
            array = array[k0:k1, j0:j1, i0:i1]
        return self.placed(array, request)
