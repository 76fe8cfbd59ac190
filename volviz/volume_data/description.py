"""What is known of data before it is read: levels, channels, labels, times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from volviz.errors import InputError
from volviz.volume_data.vectors import finite_vector
from volviz.volume_data.volume import check_dimensions, checked_direction, checked_spacing

Box = tuple[int, int, int, int, int, int]
Color = tuple[float, float, float]
Rows = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class Level:
    """One resolution of the data and where its lattice lies.

    Levels of a pyramid need not be halved, nor halved alike along all axes, and lie half a voxel off when they
    were made by averaging: so each has a geometry of its own.

    Attributes
    ----------
    dimensions : tuple of 3 ints
        Number of voxels along (x, y, z), at least 2 each.
    spacing : tuple of 3 floats
        Distance between voxel centres along (x, y, z), in world units, greater than 0.
    origin : tuple of 3 floats
        World position (x, y, z) of the centre of voxel (0, 0, 0).
    direction : 3 x 3 matrix as rows
        Its columns are the world directions of the index axes i, j, k, of unit length.

    Raises
    ------
    InputError
        What `Volume` refuses.
    """

    dimensions: tuple[int, int, int]
    spacing: tuple[float, float, float] = (1.0, 1.0, 1.0)
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    direction: Rows = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

    def __post_init__(self) -> None:
        check_dimensions(self.dimensions, "level")
        rows = checked_direction(self.direction, "level").tolist()
        for name, value in (
            ("dimensions", tuple(int(n) for n in self.dimensions)),
            ("spacing", checked_spacing(self.spacing, "level")),
            ("origin", finite_vector(self.origin, "level: origin")),
            ("direction", tuple(map(tuple, rows))),
        ):
            object.__setattr__(self, name, value)

    def part(self, box: Box) -> Level:
        """The lattice of the voxels in a box (i0, i1, j0, j1, k0, k1) of this level."""
        steps = np.asarray(self.direction) * self.spacing
        x, y, z = (float(v) for v in np.asarray(self.origin) + steps @ np.asarray(box[::2], float))
        dimensions = (box[1] - box[0], box[3] - box[2], box[5] - box[4])
        return replace(self, dimensions=dimensions, origin=(x, y, z))


@dataclass(frozen=True)
class Channel:
    """One of the quantities that were measured at every voxel.

    Attributes
    ----------
    name : str
        "DAPI" say; empty when unknown.
    color : tuple of 3 floats or None
        Red, green, blue (0..1) that the file suggests.
    window : tuple of 2 floats or None
        Values that the file suggests to show as black and as full, in data units.
    wavelength : float or None
        Of the emitted light, in nanometres.
    """

    name: str = ""
    color: Color | None = None
    window: tuple[float, float] | None = None
    wavelength: float | None = None


@dataclass(frozen=True)
class Label:
    """What a number in a volume of labels stands for: its name, and the colour (0..1) that the file suggests."""

    number: int
    name: str = ""
    color: Color | None = None


@dataclass(frozen=True)
class Statistics:
    """Lowest and highest finite value, in data units."""

    minimum: float
    maximum: float


@dataclass(frozen=True)
class Description:
    """What the header of a file says about its data.

    Attributes
    ----------
    levels : tuple of Level
        Finest first.
    time_count, channel_count : int or None
        Sizes of the axes t and c; None when the data has no such axis.
    times : tuple of float or None
        Seconds of the time points, as many as `time_count`, where the file says so.
    channels : tuple of Channel
        As many as `channel_count`, one without that axis; empty: channels without any name.
    is_labels : bool
        The values are numbers that stand for something (see `labels`), between which nothing lies.
    labels : tuple of Label
    is_colour : bool
        The channels are red, green, blue (and alpha) of colours.
    name : str
        What to call the data set.
    unit, length_unit : str
        Unit of the values, and of spacing and origin ("mm", "µm"); empty when unknown.
    content_id : str
        Changes when the file changes.
    dtype : str
        Type of the stored values, "uint16" say; empty when it is not known before they are read.
    statistics : Statistics or None
        Of data without time points and channels, where the file says it.
    metadata : mapping
        What else the reader tells: it becomes that of the volumes that are read.
    """

    levels: tuple[Level, ...]
    time_count: int | None = None
    channel_count: int | None = None
    times: tuple[float, ...] | None = None
    channels: tuple[Channel, ...] = ()
    is_labels: bool = False
    labels: tuple[Label, ...] = ()
    is_colour: bool = False
    name: str = "volume"
    unit: str = ""
    length_unit: str = ""
    content_id: str = ""
    dtype: str = ""
    statistics: Statistics | None = None
    metadata: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        for what, count, given in (
            ("channels", self.channel_count or 1, len(self.channels)),
            ("times", self.time_count or 1, len(self.times or ())),
        ):
            if given and given != count:
                raise InputError(f"{self.name}: {count} {what} need as many descriptions, got {given}.")
        if not self.levels:
            raise InputError(f"{self.name}: data needs at least one level.")
