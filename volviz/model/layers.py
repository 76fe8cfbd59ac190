"""Layers: what a scene shows, one volume each, and how it is seen."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Literal, get_args

from volviz.errors import InputError
from volviz.model.transfer_function import TransferFunction

Color = tuple[float, float, float]
#: A 4 x 4 matrix as rows; world position of the volume to world position where it is shown.
Transform = tuple[
    tuple[float, float, float, float],
    tuple[float, float, float, float],
    tuple[float, float, float, float],
    tuple[float, float, float, float],
]
LayerMode = Literal["add", "mask", "modulate"]


@dataclass(frozen=True)
class VolumeRef:
    """Where a volume comes from, without its array.

    Attributes
    ----------
    source : str
        Path of a file or folder, ``sample:<name>``, or ``array:<number>`` for one handed over by a program.
    hints : tuple of (name, value)
        How to read it (raw dimensions, channel, time point), sorted by name.
    content_id : str
        Changes when the file changes; part of the cache key.
    """

    source: str
    hints: tuple[tuple[str, Hashable], ...] = ()
    content_id: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "hints", tuple(sorted(self.hints)))


@dataclass(frozen=True)
class ImageLayer:
    """One volume of measured values and how it is classified.

    Attributes
    ----------
    volume : VolumeRef, Volume or VolumeSource
        What is shown. Scenes hold references, so that their history pins no memory; whoever draws without a
        window may give the volume itself, or a source that reads it.
    transfer_function : TransferFunction or None
        Colour and opacity of the values; None chooses one from the data, or from `color` and `window`.
    name : str
        What people call it.
    visible : bool
        Hidden layers cost nothing.
    channel, time : int
        Which channel and time point of the source, counted from 0.
    color : tuple of 3 floats, or None
        Red, green, blue (0..1) of a layer without a transfer function.
    window : tuple of 2 floats, or None
        Values at which a layer without a transfer function begins to be seen and is fully seen, in data units.
    opacity : float
        Factor on the opacity, 0..1.
    transform : Transform or None
        Moves the volume in the world; None leaves it where its file says.
    mode : {"add", "mask", "modulate"}
        How it joins the others: its matter is added, or it decides where or how strongly they are seen.

    Raises
    ------
    InputError
        A value that is none of these.
    """

    volume: VolumeRef
    transfer_function: TransferFunction | None = None
    name: str = ""
    visible: bool = True
    channel: int = 0
    time: int = 0
    color: Color | None = None
    window: tuple[float, float] | None = None
    opacity: float = 1.0
    transform: Transform | None = None
    mode: LayerMode = "add"

    def __post_init__(self) -> None:
        if self.mode not in get_args(LayerMode):
            raise InputError(
                f"mode of a layer must be one of {', '.join(get_args(LayerMode))}, got {self.mode!r}."
            )
        if not 0.0 <= self.opacity <= 1.0:
            raise InputError(f"opacity of a layer must be from 0 to 1, got {self.opacity!r}.")


@dataclass(frozen=True)
class LabelLayer:
    """A volume of labels: whole numbers that name what each voxel belongs to.

    Attributes
    ----------
    volume : VolumeRef, Volume or VolumeSource
        What is shown, as in `ImageLayer`.
    colors : tuple of (label, (red, green, blue))
        Colours 0..1 of labels; the others have colours of a fixed sequence.
    names : tuple of (label, name)
        What people call them.
    hidden : tuple of int
        Labels that are not shown.
    smooth : bool
        Surfaces pass where the interpolated indicator of a label is one half, instead of along voxels.
    name, visible, channel, time, opacity, transform
        As in `ImageLayer`.
    """

    volume: VolumeRef
    colors: tuple[tuple[int, Color], ...] = ()
    names: tuple[tuple[int, str], ...] = ()
    hidden: tuple[int, ...] = ()
    smooth: bool = True
    name: str = ""
    visible: bool = True
    channel: int = 0
    time: int = 0
    opacity: float = 1.0
    transform: Transform | None = None
