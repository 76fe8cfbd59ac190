"""A volume in a file: what its header said, and the way to its values."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import InputError, LoadError
from volviz.io.axes import are_colours, to_zyx
from volviz.io.geometry import Geometry
from volviz.io.memory import free_bytes, free_in_words
from volviz.io.resampling import Rectangular
from volviz.volume_data.description import Channel, Description, Label, Level, Statistics
from volviz.volume_data.orientation import direction_of
from volviz.volume_data.references import content_id
from volviz.volume_data.source import ReadRequest, VolumeSource
from volviz.volume_data.volume import (
    SHEAR_LIMIT,
    Volume,
    check_dimensions,
    checked_direction,
    checked_spacing,
    shear_of,
)

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.entries import Entry
    from volviz.io.reader import LoadOptions, LoadRequest

_COLOURS = (
    Channel("red", (1.0, 0.0, 0.0)), Channel("green", (0.0, 1.0, 0.0)), Channel("blue", (0.0, 0.0, 1.0)),
    Channel("alpha"),
)  # fmt: skip

#: A sheared lattice becomes at most so many times as large when it is resampled.
MOST_GROWTH = 8.0

Values = Callable[["LoadRequest"], "npt.NDArray[Any]"]


class FileSource(VolumeSource):
    """What a reader makes of a file whose header it has read; every `read` goes to the file.

    Parameters
    ----------
    load : LoadRequest
        What was opened; its hints take the place of what the file says, its notes come with every volume.
    description : Description
    values : callable(LoadRequest) -> ndarray of shape (z, y, x)
        Reads the level, time point, channel and box of a job, from any thread.
    entries : sequence of Entry
        All that the file holds, where it holds several images or arrays.
    is_rescaled : bool, default: False
        Whole numbers are rescaled to the smallest type that holds all of them (`volviz.io.scaling.rescaled`).
    """

    def __init__(
        self,
        load: LoadRequest,
        description: Description,
        values: Values,
        entries: Sequence[Entry] = (),
        *,
        is_rescaled: bool = False,
    ) -> None:
        super().__init__(description)
        # who opened it need not be told of what is read
        self.load = replace(load, progress=None, cancel=None)
        self.values = values
        self._entries = tuple(entries)
        self._is_rescaled = is_rescaled
        self._types: dict[tuple[int, int, int | None], np.dtype[Any]] = {}

    @property
    def entries(self) -> tuple[Entry, ...]:
        """All that the file holds, this one included; empty where it is alone."""
        return self._entries

    @cached_property
    def default_level(self) -> int:
        """The finest level that fits into memory together with what drawing needs; a coarser one is told."""
        free = free_bytes()
        if free is None or len(self.levels) < 2 or not self.description.dtype:
            return 0
        # beside the values stand those that the graphics card gets, real numbers of four bytes at most
        bytes_each = np.dtype(self.description.dtype).itemsize + 4
        needed = [bytes_each * math.prod(level.dimensions) for level in self.levels]
        chosen = next((n for n, wanted in enumerate(needed) if wanted <= free), len(needed) - 1)
        if chosen:
            finer = needed[chosen - 1]
            self.load.note(
                f"Level {chosen} is shown, of 0 (finest) to {len(needed) - 1}: level {chosen - 1} needs "
                f"{finer / 2**30:.3g} GiB of memory to be drawn and {free_in_words(free)}."
            )
            told = {**self.description.metadata, "notes": tuple(self.load.notes)}
            self.description = replace(self.description, metadata=told)
        return chosen

    def read_volume(self, request: ReadRequest) -> Volume:
        """The values with their geometry, and with what was noted at opening and reading."""
        load = replace(
            self.load, level=request.level, time=request.time if request.time_chosen else None,
            channel=request.channel, box=request.box,
            progress=request.progress, cancel=request.cancel, notes=list(self.load.notes),
        )  # fmt: skip
        if request.box is not None and len(self.levels) > 1:
            finest = "the finest" if request.level == 0 else f"where 0 is the finest of {len(self.levels)}"
            load.note(f"This is a box of level {request.level}, {finest}.")
        with told_in_a_sentence(load):
            array = self.values(load)
            if self._is_rescaled and array.dtype.kind in "iu":
                array = array.astype(self._type_of_all(request, load, array.dtype), copy=False)
        if array.dtype.kind == "f" and array.dtype.itemsize > 8:
            # nothing that draws takes more than doubles
            array = array.astype(np.float64)
        try:
            return self.placed(array, request, notes=tuple(load.notes))
        except InputError as error:
            raise LoadError(str(error)) from None

    def _type_of_all(self, request: ReadRequest, load: LoadRequest, found: np.dtype[Any]) -> np.dtype[Any]:
        """The type that all values of a time point and channel have, also where a box of them needs a smaller one."""
        part = request.level, request.time, request.channel
        if request.box is None:
            self._types[part] = found
        elif part not in self._types:
            try:
                self._types[part] = self.values(replace(load, box=None, notes=[])).dtype
            except LoadError:
                # the rest is damaged, or does not fit into memory
                return found
        return self._types[part]


@contextmanager
def told_in_a_sentence(load: LoadRequest) -> Iterator[None]:
    """What the system complains about while a file is opened or read becomes one sentence."""
    try:
        yield
    except PermissionError:
        raise load.error("you may not read it; change its permissions or copy it.") from None
    except MemoryError:
        raise load.error("it does not fit into memory; crop it or save it with fewer voxels.") from None
    except OSError as error:
        reason = (error.strerror or "unknown reason").lower()
        raise load.error(f"the system cannot read it ({reason}); check disk and path.") from None


def _resampled(values: Values, upright: Rectangular) -> Values:
    """The values of a sheared lattice on a rectangular one."""

    def read(load: LoadRequest) -> npt.NDArray[Any]:
        return to_zyx(upright.resampled(values(replace(load, box=None))), "ZYX", load)

    return read


def file_source(
    load: LoadRequest,
    values: Values,
    axes: str,
    shape: Sequence[int],
    geometry: Geometry,
    *,
    format: str,  # noqa: A002 - the key of the metadata
    name: str,
    dtype: npt.DTypeLike | None = None,
    colour: bool | None = None,
    channels: Sequence[Channel] = (),
    times: Sequence[float] | None = None,
    is_labels: bool = False,
    is_rescaled: bool = False,
    statistics: Statistics | None = None,
    labels: Sequence[Label] = (),
    unit: str = "",
    length_unit: str = "",
    coarser: Sequence[tuple[tuple[int, int, int], Geometry]] = (),
    entries: Sequence[Entry] = (),
    content: str | None = None,
    **metadata: Any,
) -> FileSource:
    """The source that a reader gives.

    Parameters
    ----------
    load : LoadRequest
    values : callable(LoadRequest) -> ndarray of shape (z, y, x)
    axes : str
        One letter for each entry of `shape`: "Z", "Y", "X", "T" (time), "C" (channel), "S" (component).
        Axes of time or channels with one entry are none.
    geometry : Geometry
        Of the finest level, as the file says it.
    dtype, colour
        Type of the values as the file stores them. Both decide whether components are colours (see `to_zyx`).
    channels, times, is_labels, labels, statistics, unit, length_unit
        As in `Description`; what does not fit the axes is left out.
    is_rescaled
        As in `FileSource`.
    coarser : sequence of (dimensions, Geometry)
        Further levels, each coarser than the one before. They are left out of sheared lattices.
    entries : sequence of Entry
        See `FileSource`.
    content : str, optional
        What changes when the data changes; default: size and date of the file.

    Raises
    ------
    LoadError
        `Volume` would refuse the sizes or the geometry.
    """
    hints = load.hints
    sizes = dict(zip(axes, (int(n) for n in shape), strict=True))
    letter = "C" if "C" in sizes else "S"
    count, time_count = (n if n is not None and n > 1 else None for n in (sizes.get(letter), sizes.get("T")))
    is_colour = letter == "S" and are_colours(axes, tuple(shape), dtype, colour)
    if is_colour:
        channels = _COLOURS[:count]
    dimensions = sizes["X"], sizes["Y"], sizes.get("Z", 1)
    if hints.orientation is not None:
        coarser = [(each, _turned(own, geometry, hints.orientation)) for each, own in coarser]
        geometry = _turned(geometry, geometry, hints.orientation)
    length_unit = length_unit if hints.length_unit is None else hints.length_unit
    shear = shear_of(np.asarray(geometry.direction, np.float64).reshape(3, 3))
    if shear > SHEAR_LIMIT and min(dimensions) > 1:
        upright = Rectangular.around(dimensions, geometry)
        growth = math.prod(upright.dimensions) / math.prod(dimensions)
        if growth > MOST_GROWTH:
            raise load.error(
                f"its axes are sheared by {shear:.1f} degrees, and on a rectangular lattice it would be {growth:.3g} "
                "times as large; the header is damaged, or it must be resampled first."
            )
        dimensions, geometry, values = upright.dimensions, upright.geometry, _resampled(values, upright)
        coarser = ()
        load.note(
            f"The axes of the file are sheared by {shear:.1f} degrees (a tilted gantry, say); "
            "it is resampled onto a rectangular lattice."
        )
    called = hints.name or name
    try:
        check_dimensions(dimensions, called)
        levels = [
            _level(each, own, geometry, hints, called) for each, own in ((dimensions, geometry), *coarser)
        ]
    except InputError as error:
        raise LoadError(str(error)) from None
    description = Description(
        tuple(levels),
        time_count,
        count,
        times=tuple(times) if times is not None and len(times) == time_count else None,
        channels=tuple(channels) if len(channels) == (count or 1) else (),
        is_labels=is_labels,
        labels=tuple(labels),
        is_colour=is_colour,
        name=called,
        unit=unit if hints.unit is None else hints.unit,
        length_unit=length_unit,
        content_id=content_id(str(load.path)) if content is None else content,
        dtype="" if dtype is None else np.dtype(dtype).name,
        statistics=statistics if count is None and time_count is None else None,
        metadata={
            "source": load.source, "format": format, "length_unit": length_unit,
            "notes": tuple(load.notes), **metadata,
        },
    )  # fmt: skip
    return FileSource(load, description, values, entries, is_rescaled=is_rescaled)


def _turned(own: Geometry, finest: Geometry, code: str) -> Geometry:
    """A level with the axes of an orientation code, around the first voxel of the finest one."""
    away = np.linalg.solve(np.reshape(finest.direction, (3, 3)), np.subtract(own.origin, finest.origin))
    turned = direction_of(code)
    x, y, z = (float(v) for v in np.asarray(finest.origin) + turned @ away)
    return Geometry(own.spacing, (x, y, z), tuple(float(v) for v in turned.flat))


def _level(
    dimensions: tuple[int, int, int], own: Geometry, finest: Geometry, hints: LoadOptions, called: str
) -> Level:
    """A level where the file places it, moved and stretched as the hints move and stretch the finest one."""
    stretch = np.divide(hints.spacing or finest.spacing, finest.spacing)
    spacing = checked_spacing((np.asarray(own.spacing) * stretch).tolist(), called)
    axes = checked_direction(own.direction, called)
    # in the axes of the lattice, so that the stretch leaves directions as they are
    away = axes.T @ np.subtract(own.origin, finest.origin)
    origin = np.asarray(hints.origin or finest.origin) + axes @ (away * stretch)
    first, second, third = axes.tolist()
    x, y, z = (float(v) for v in origin)
    return Level(
        dimensions, (spacing[0], spacing[1], spacing[2]), (x, y, z),
        (tuple(first), tuple(second), tuple(third)),
    )  # fmt: skip
