"""A volume in a file: what its header said, and the way to its values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import InputError, LoadError
from volviz.io.axes import are_colours, to_zyx
from volviz.io.resampling import Rectangular
from volviz.volume_data.description import Channel, Description, Label, Level, Statistics
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

    from volviz.io.geometry import Geometry
    from volviz.io.reader import LoadRequest

_COLOURS = (
    Channel("red", (1.0, 0.0, 0.0)), Channel("green", (0.0, 1.0, 0.0)), Channel("blue", (0.0, 0.0, 1.0)),
    Channel("alpha"),
)  # fmt: skip

Values = Callable[["LoadRequest"], "npt.NDArray[Any]"]


class FileSource(VolumeSource):
    """What a reader makes of a file whose header it has read; every `read` goes to the file.

    Parameters
    ----------
    load : LoadRequest
        What was opened; its hints take the place of what the file says, its notes come with every volume.
    description : Description
    values : callable(LoadRequest) -> ndarray of shape (z, y, x)
        Reads the time point, channel and box of a job, from any thread.
    """

    def __init__(self, load: LoadRequest, description: Description, values: Values) -> None:
        super().__init__(description)
        self.load = load
        self.values = values

    def read_volume(self, request: ReadRequest) -> Volume:
        """The values with their geometry, and with what was noted at opening and reading."""
        load = replace(
            self.load, time=request.time or None, channel=request.channel, box=request.box,
            progress=request.progress, cancel=request.cancel, notes=list(self.load.notes),
        )  # fmt: skip
        with told_in_a_sentence(load):
            array = self.values(load)
        if array.dtype.kind == "f" and array.dtype.itemsize > 8:
            # nothing that draws takes more than doubles
            array = array.astype(np.float64)
        try:
            return self.placed(array, request, notes=tuple(load.notes))
        except InputError as error:
            raise LoadError(str(error)) from None


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
    statistics: Statistics | None = None,
    labels: Sequence[Label] = (),
    unit: str = "",
    length_unit: str = "",
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
        Decide whether components are colours (see `to_zyx`).
    channels, times, is_labels, labels, statistics, unit, length_unit
        As in `Description`; what does not fit the axes is left out.

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
    shear = shear_of(np.asarray(geometry.direction, np.float64).reshape(3, 3))
    if shear > SHEAR_LIMIT and min(dimensions) > 1:
        upright = Rectangular.around(dimensions, geometry)
        dimensions, geometry, values = upright.dimensions, upright.geometry, _resampled(values, upright)
        load.note(
            f"The axes of the file are sheared by {shear:.1f} degrees (a tilted gantry, say); "
            "it is resampled onto a rectangular lattice."
        )
    called = hints.name or name
    try:
        check_dimensions(dimensions, called)
        spacing = checked_spacing(hints.spacing or geometry.spacing, called)
        first, second, third = checked_direction(geometry.direction, called).tolist()
        origin = hints.origin or geometry.origin
        level = Level(dimensions, spacing, origin, (tuple(first), tuple(second), tuple(third)))
    except InputError as error:
        raise LoadError(str(error)) from None
    description = Description(
        (level,),
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
        content_id=content_id(str(load.path)),
        statistics=statistics if count is None and time_count is None else None,
        metadata={
            "source": load.source, "format": format, "length_unit": length_unit,
            "notes": tuple(load.notes), **metadata,
        },
    )  # fmt: skip
    return FileSource(load, description, values)
