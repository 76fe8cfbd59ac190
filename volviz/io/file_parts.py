"""References to a file, or to a level or a box of it: what they name is opened and read, made finer, and made whole."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from volviz.io.loading import open as open_file
from volviz.io.memory import free_bytes
from volviz.model.clipping import Crop
from volviz.volume_data.boxes import between_levels, finest_box
from volviz.volume_data.description import Box
from volviz.volume_data.references import VolumeKey, VolumeRef
from volviz.volume_data.source import Cancel, Progress, VolumeSource
from volviz.volume_data.volume import Volume


def whole_of(ref: VolumeRef) -> VolumeRef:
    """The reference to all of a file, where this one names a level or a box of it."""
    return replace(ref, hints=tuple(pair for pair in ref.hints if pair[0] not in ("level", "box")))


def shown_part(source: VolumeSource, ref: VolumeRef) -> tuple[int, Box | None]:
    """Which level a reference names, and which box of its voxels: without one the finest that fits, and all of it."""
    hints: dict[str, Any] = dict(ref.hints)
    box = hints.get("box")
    return hints.get("level", source.default_level if box is None else 0), box


def open_reference(
    ref: VolumeRef, *, progress: Progress | None = None, cancel: Cancel | None = None
) -> VolumeSource:
    """The file that a reference names, all of it.

    Raises
    ------
    VolvizError
        As from `volviz.open`.
    """
    hints: dict[str, Any] = dict(whole_of(ref).hints)
    return open_file(ref.source, progress=progress, cancel=cancel, **hints)


def read_key(
    source: VolumeSource, key: VolumeKey, *, progress: Progress | None = None, cancel: Cancel | None = None
) -> Volume:
    """The values that a key names, of what `open_reference` gives for its reference.

    Raises
    ------
    VolvizError
        The file has no such part, or cannot be read.
    """
    if whole_of(key.ref) == key.ref:
        return source.read_fitting(key.time, key.channel, cancel, progress)
    level, box = shown_part(source, key.ref)
    return source.read(level, key.time, key.channel, box, cancel, progress)


def box_in_full(source: VolumeSource, ref: VolumeRef, crop: Crop) -> VolumeRef:
    """What a crop box shows, at the finest level at which it fits.

    Parameters
    ----------
    source : VolumeSource
    ref : VolumeRef
        What is shown of it, all of a level.
    crop : tuple of 6 floats
        In voxels of that level.
    """
    level, _ = shown_part(source, ref)
    finest, box = finest_box(source, crop, level, free_bytes())
    whole = whole_of(ref)
    return replace(whole, hints=(*whole.hints, ("level", finest), ("box", box)))


def box_again(source: VolumeSource, ref: VolumeRef) -> tuple[VolumeRef, Crop | None]:
    """The whole of what a reference shows a box of, and the crop box that is that box."""
    level, box = shown_part(source, ref)
    whole = whole_of(ref)
    if box is None:
        return whole, None
    shown = source.levels[shown_part(source, whole)[0]]
    # from the first voxel to the last, not to the one behind it
    extent = (box[0], box[1] - 1, box[2], box[3] - 1, box[4], box[5] - 1)
    return whole, between_levels(extent, source.levels[level], shown)
