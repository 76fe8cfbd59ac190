"""`save`: a volume, or a source with its time points and channels, into a file that other programs read."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import InputError
from volviz.io.writers.content import Content, WiderValuesError
from volviz.io.writers.request import SaveRequest
from volviz.io.writers.table import WRITERS
from volviz.new_files import check_target, written_beside
from volviz.volume_data.array_source import ArraySource
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume

if TYPE_CHECKING:
    from volviz.io.writers.table import Writer
    from volviz.volume_data.source import Cancel, Progress


def save(
    data: Volume | VolumeSource,
    path: str | os.PathLike[str],
    *,
    level: int = 0,
    time: int | None = None,
    channel: int | str | None = None,
    box: Sequence[int] | None = None,
    spacing: Sequence[float] | None = None,
    format: str | None = None,  # noqa: A002 - what it is
    compress: bool = True,
    overwrite: bool = False,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> tuple[str, ...]:
    """Write a volume, or what `volviz.open` gives, to a file; the ending of its name chooses the format.

    Values keep their type. Large sources are read and written one time point and channel after another. The file
    appears complete or not at all.

    Parameters
    ----------
    data : Volume or VolumeSource
        What is written.
    path : str or path
        Ends in .nrrd, .nii, .nii.gz, .mha, .vti, .tif (ImageJ, OME for types that it does not know), .ome.tif,
        .ome.zarr or .npy.
    level : int
        Level of resolution, 0 is the finest.
    time, channel : int, optional
        The one that is written, from 0 (a channel by its name, too). Default: all of them, of colours all components.
    box : sequence of 6 ints, optional
        Voxels (i0, i1, j0, j1, k0, k1) to write, those of i1, j1 and k1 no more.
    spacing : sequence of 3 floats, optional
        Resample to these distances along the volume's own axes (x, y, z), in its unit of length: linearly, smoothed
        before where that is coarser; labels by the nearest voxel.
    format : str, optional
        Id of a writer, where the ending leaves a choice: "imagej", "ome-tiff", "ome-zarr", "ome-zarr-0.4", ...
    compress : bool
        Pack the values without loss. TIFF for ImageJ and .npy are never packed, .nii.gz always.
    overwrite : bool
        Replace what is there.
    progress : callable(fraction, text), optional
        Told of the progress, fraction 0..1.
    cancel : callable() -> bool, optional
        Asked between blocks; True stops the writing, and what was there before stays.

    Returns
    -------
    tuple of str
        Sentences for the user: what the format cannot say of the data, what was converted.

    Raises
    ------
    InputError
        An unknown ending or format, a part that is not there, something that is not to be replaced, values or axes that
        the format does not hold.
    VolvizError
        It cannot be written.
    LoadError
        The source cannot be read.
    Cancelled
    """
    source = data if isinstance(data, VolumeSource) else ArraySource(data)
    target = check_volume_target(Path(os.fspath(path)).expanduser(), format, overwrite=overwrite)
    fitting = writers_for(target, format)
    request = SaveRequest(target, target, compress, progress, cancel)
    content = Content(source, request, level=level, time=time, channel=channel, box=box, spacing=spacing)
    writer = _chosen(fitting, content, request)
    tell_losses(writer, content, request)
    while True:
        try:
            with written_beside(target, folder=writer.folder) as part:
                request.path = part
                writer.write(content, request)
                request.report(1.0, "ready")
                if writer.folder:
                    # asked again: something may have appeared there meanwhile
                    check_target(target, overwrite=overwrite, folder=True)
            return tuple(request.notes)
        except WiderValuesError as wider:
            content.begin(wider.dtype)
            writer = _chosen(fitting, content, request)


def losses(writer: Writer, source: VolumeSource, **part: Any) -> tuple[str, ...]:
    """What would be lost of a source, or of a part of it, in sentences; nothing is read.

    Parameters
    ----------
    writer : Writer
    source : VolumeSource
    **part
        ``level``, ``time``, ``channel``, ``box``, ``spacing`` as for `save`.
    """
    request = SaveRequest(Path(writer.name), Path(writer.name))
    tell_losses(writer, Content(source, request, **part), request)
    return tuple(request.notes)


def check_volume_target(path: Path, format: str | None = None, *, overwrite: bool = False) -> Path:  # noqa: A002
    """The path, if a volume can be written there; asked before long work as well.

    Raises
    ------
    InputError
        An unknown ending or format, or something that is not to be replaced.
    VolvizError
        There is no such folder, or it cannot be written to.
    """
    return check_target(path, overwrite=overwrite, folder=writers_for(path, format)[0].folder)


def writers_for(path: Path, format: str | None = None) -> list[Writer]:  # noqa: A002 - as in `save`
    """The writers that a name allows, the preferred one first.

    Raises
    ------
    InputError
        None of them, or an unknown format.
    """
    name = path.name.lower()
    found = [(len(s), writer) for writer in WRITERS for s in writer.suffixes if name.endswith(s)]
    if format is not None:
        known = {writer.id: writer for writer in WRITERS}
        if format not in known:
            raise InputError(f"no format is called {format!r}; choose one of {', '.join(known)}.")
        if not any(writer.id == format for _, writer in found):
            endings = " or ".join(known[format].suffixes)
            raise InputError(f"{path.name}: {known[format].name} ends in {endings}; choose such a name.")
        return [known[format]]
    if not found:
        endings = ", ".join(dict.fromkeys(s for writer in WRITERS for s in writer.suffixes))
        raise InputError(f"{path.name}: volumes are written as {endings}; choose one of these endings.")
    longest = max(length for length, _ in found)
    return [writer for length, writer in found if length == longest]


def _chosen(fitting: list[Writer], content: Content, request: SaveRequest) -> Writer:
    """The first that holds the values; refuses what none of them holds."""
    first = fitting[0]
    writer = next((each for each in fitting if each.takes(content.dtype)), None)
    others = ", ".join(
        each.name for each in WRITERS if each.takes(content.dtype) and (each.time or not content.time_count)
    )
    if writer is None:
        raise InputError(
            f"{request.target.name}: {first.name} holds no values of type {content.dtype}; choose another format "
            f"({others})."
        )
    if writer is not first:
        request.note(f"{first.name} knows no values of type {content.dtype}; it is written as {writer.name}.")
    if content.time_count and not writer.time:
        raise InputError(
            f"{request.target.name}: {writer.name} holds one time point and there are {content.time_count}; choose "
            f"one (time=0..{content.time_count - 1}, --time), or another format ({others})."
        )
    return writer


def tell_losses(writer: Writer, content: Content, request: SaveRequest) -> None:
    """A sentence for everything that is known of the values and that the format cannot say."""
    lattice, keeps, name = content.lattice, writer.keeps, writer.name

    def lost(what: str) -> None:
        request.note(f"{name} cannot hold {what}.")

    if "spacing" not in keeps and lattice.spacing != (1.0, 1.0, 1.0):
        lost(
            f"the distance of voxels ({' x '.join(f'{s:.6g}' for s in lattice.spacing)} {content.length_unit}".rstrip()
            + ")"
        )
    if "origin" not in keeps and any(lattice.origin):
        lost(f"where the volume lies (first voxel at {', '.join(f'{v:.6g}' for v in lattice.origin)})")
    if "direction" not in keeps and not np.allclose(lattice.direction, np.eye(3), atol=1e-6):
        lost("the direction of its axes: it will lie along x, y, z when it is read again")
    if "length unit" not in keeps and "spacing" in keeps and content.length_unit not in ("", "mm"):
        lost(f"the unit of lengths ({content.length_unit})")
    if "unit" not in keeps and content.unit:
        lost(f"the unit of the values ({content.unit})")
    if "channel names" not in keeps and not content.is_colour and any(c.name for c in content.channels):
        lost(f"the names of channels ({', '.join(content.channel_names())})")
    if "colours" not in keeps and content.is_colour:
        lost("colours as such: their components are written as channels")
    if "labels" not in keeps and any(label.name for label in content.labels):
        lost("the names of labels")
    even = content.even_times
    kept = {
        "any": True,
        "even": even is not None,
        "even from 0": even is not None and even[0] == 0,
        "none": False,
    }[writer.seconds]
    if content.times is not None and not kept:
        lost("the seconds of the time points")
