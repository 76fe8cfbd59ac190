"""Layers: what a scene shows, one volume each, and how it is seen."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from volviz.errors import InputError
from volviz.model.named_colors import checked_color
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.references import VolumeKey, VolumeRef
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume

if TYPE_CHECKING:
    import numpy.typing as npt

Color = tuple[float, float, float]
#: A 4 x 4 matrix as rows; world position of the volume to world position where it is shown.
Transform = tuple[
    tuple[float, float, float, float],
    tuple[float, float, float, float],
    tuple[float, float, float, float],
    tuple[float, float, float, float],
]
LayerMode = Literal["add", "mask", "modulate"]
_NOTHING_READ: Mapping[VolumeKey, Volume] = MappingProxyType({})


@dataclass(frozen=True, init=False)
class ImageLayer:
    """One volume of measured values and how it is classified.

    Parameters
    ----------
    volume : Volume, VolumeSource or VolumeRef
        What is shown. Scenes hold references, so that their history pins no memory; whoever draws without a
        window gives the volume itself, or a source that reads it (`volviz.open`).
    transfer_function : TransferFunction, optional
        Colour and opacity of the values; without one it is chosen from the data, or from `color` and `window`.
    name : str
        What people call it.
    visible : bool
        Hidden layers cost nothing.
    channel : int or None
        Channel of the source, counted from 0; None is what the file shows by itself: its first channel, the
        brightness of colours.
    time : int
        Time point of the source, counted from 0.
    color : str or 3 floats, optional
        Of a layer without a transfer function: a name, hexadecimal digits, or red, green, blue in 0..1.
    window : 2 floats, optional
        Values at which a layer without a transfer function begins to be seen and is fully seen, in data units.
    opacity : float
        Factor on the opacity, 0..1.
    transform : array_like of shape (4, 4), optional
        Moves the volume in the world; None leaves it where its file says.
    mode : {"add", "mask", "modulate"}
        How it joins the others: its matter is added, or it decides where or how strongly they are seen.
    linked : bool
        In a scene, an edit of its transfer function changes that of all linked layers.

    Raises
    ------
    InputError
        A value that is none of these, or both a transfer function and a colour or window.
    """

    volume: Volume | VolumeSource | VolumeRef
    transfer_function: TransferFunction | None
    name: str
    visible: bool
    channel: int | None
    time: int
    color: Color | None
    window: tuple[float, float] | None
    opacity: float
    transform: Transform | None
    mode: LayerMode
    linked: bool

    def __init__(
        self,
        volume: Volume | VolumeSource | VolumeRef,
        transfer_function: TransferFunction | None = None,
        name: str = "",
        *,
        color: str | Iterable[float] | None = None,
        window: Sequence[float] | None = None,
        opacity: float = 1.0,
        channel: int | None = None,
        time: int = 0,
        transform: npt.ArrayLike | None = None,
        mode: LayerMode = "add",
        visible: bool = True,
        linked: bool = False,
    ) -> None:
        if transfer_function is not None and not isinstance(transfer_function, TransferFunction):
            raise InputError(
                f"transfer_function of a layer must be a TransferFunction, got {type(transfer_function).__name__}."
            )
        if transfer_function is not None and (color is not None or window is not None):
            raise InputError("a layer takes a transfer function, or a colour and a window, not both.")
        if mode not in get_args(LayerMode):
            raise InputError(
                f"mode of a layer must be one of {', '.join(get_args(LayerMode))}, got {mode!r}."
            )
        _set(
            self,
            **_shared(volume, name, visible, channel, time, opacity, transform),
            transfer_function=transfer_function,
            color=None if color is None else checked_color(color, "color of a layer"),
            window=None if window is None else _window(window),
            mode=mode,
            linked=bool(linked),
        )

    @property
    def key(self) -> VolumeKey:
        """Which values it shows, for caches; `InputError` for a layer whose volume is no reference."""
        return _key(self)


@dataclass(frozen=True, init=False)
class LabelLayer:
    """A volume of labels: whole numbers that name what each voxel belongs to; 0 is nothing.

    Parameters
    ----------
    volume : Volume, VolumeSource or VolumeRef
        What is shown, as in `ImageLayer`.
    colors : mapping from label to colour, optional
        Colours as in `ImageLayer`; the other labels have colours of a fixed sequence.
    names : mapping from label to str, optional
        What people call them.
    hidden : iterable of int
        Labels that are not shown.
    opacities : mapping from label to float, optional
        Factors on the opacity of single labels, 0..1; that of the others is 1.
    smooth : bool
        Surfaces pass where the interpolated indicator of a label is one half, instead of along voxels.
    mode : {"add", "mask"}
        Its surfaces are seen, or the image layers are seen only within the labels that are not hidden.
    name, visible, channel, time, opacity, transform
        As in `ImageLayer`.

    Raises
    ------
    InputError
        A value that is none of these.
    """

    volume: Volume | VolumeSource | VolumeRef
    colors: tuple[tuple[int, Color], ...]
    names: tuple[tuple[int, str], ...]
    hidden: tuple[int, ...]
    opacities: tuple[tuple[int, float], ...]
    smooth: bool
    name: str
    visible: bool
    channel: int | None
    time: int
    opacity: float
    transform: Transform | None
    mode: Literal["add", "mask"]

    def __init__(
        self,
        volume: Volume | VolumeSource | VolumeRef,
        colors: Mapping[int, str | Iterable[float]] | Iterable[tuple[int, Any]] | None = None,
        names: Mapping[int, str] | Iterable[tuple[int, str]] | None = None,
        hidden: Iterable[int] = (),
        *,
        opacities: Mapping[int, float] | Iterable[tuple[int, float]] | None = None,
        smooth: bool = True,
        mode: Literal["add", "mask"] = "add",
        name: str = "",
        opacity: float = 1.0,
        channel: int | None = None,
        time: int = 0,
        transform: npt.ArrayLike | None = None,
        visible: bool = True,
    ) -> None:
        if mode not in ("add", "mask"):
            raise InputError(f"mode of a layer of labels must be add or mask, got {mode!r}.")
        _set(
            self,
            **_shared(volume, name, visible, channel, time, opacity, transform),
            mode=mode,
            colors=_by_label("colors", colors, _checked_color_of),
            names=_by_label("names", names, lambda _label, text: str(text)),
            hidden=hidden if isinstance(hidden, _Labels) else _Labels(_sorted_labels("hidden", hidden)),
            opacities=_by_label("opacities", opacities, _checked_opacity_of),
            smooth=bool(smooth),
        )

    @property
    def key(self) -> VolumeKey:
        """Which values it shows, for caches; `InputError` for a layer whose volume is no reference."""
        return _key(self)


Layer = ImageLayer | LabelLayer


def volume_of(layer: Layer, volumes: Mapping[VolumeKey, Volume] = _NOTHING_READ) -> Volume:
    """The values that a layer shows.

    Parameters
    ----------
    layer : ImageLayer or LabelLayer
    volumes : mapping from VolumeKey to Volume, optional
        What has been read of the references of a scene; sources read by themselves.

    Returns
    -------
    Volume
        Where its file says that it lies: the layer's `transform` is not applied.

    Raises
    ------
    InputError
        The volume has no such channel or time point, or a reference has not been read.
    LoadError
        A source cannot be read.
    """
    volume = layer.volume
    if isinstance(volume, VolumeSource):
        return volume.read_fitting(layer.time, layer.channel)
    if isinstance(volume, Volume):
        if layer.time or layer.channel:
            raise InputError(
                f"{volume.name}: a volume in memory has one time point and one channel, got time "
                f"{layer.time} and channel {layer.channel}; give a source (volviz.open) to choose."
            )
        return volume
    if layer.key not in volumes:
        raise InputError(f"{volume.source} has not been read; draw a layer of a Volume or of volviz.open.")
    return volumes[layer.key]


def changed_layers(layers: Sequence[Layer], number: int, **changes: Any) -> tuple[Layer, ...]:
    """The layers with one of them changed; functions that are linked to its own change with it."""
    layer = layers[number]
    shared = {name: changes[name] for name in ("transfer_function", "color", "window") if name in changes}
    follows = bool(shared) and isinstance(layer, ImageLayer) and layer.linked
    return tuple(
        replace(each, **changes)
        if n == number
        else replace(each, **shared)
        if follows and isinstance(each, ImageLayer) and each.linked
        else each
        for n, each in enumerate(layers)
    )


def holding(layer: Layer, volumes: Mapping[VolumeKey, Volume]) -> Layer:
    """The layer that holds its values instead of naming them, for whoever draws or measures without a window."""
    return replace(layer, volume=volumes[layer.key], channel=None, time=0)


def _key(layer: Layer) -> VolumeKey:
    if not isinstance(layer.volume, VolumeRef):
        raise InputError(
            "the volume of this layer is no reference; scenes and sessions hold references only."
        )
    return VolumeKey(layer.volume, layer.channel, layer.time)


def _set(layer: Layer, **values: Any) -> None:
    for field, value in values.items():
        object.__setattr__(layer, field, value)


def _shared(
    volume: Any, name: str, visible: bool, channel: Any, time: Any, opacity: Any, transform: Any
) -> dict[str, Any]:
    """Checked fields that both kinds of layer have."""
    if not isinstance(volume, Volume | VolumeSource | VolumeRef):
        raise InputError(
            f"a layer shows a Volume or what volviz.open gives, got {type(volume).__name__}; "
            "make a volume of an array by volviz.Volume(array)."
        )
    if channel is not None and not _is_count(channel):
        raise InputError(f"channel of a layer must be an integer from 0, or None, got {channel!r}.")
    if not _is_count(time):
        raise InputError(f"time of a layer must be an integer from 0, got {time!r}.")
    if not isinstance(opacity, Real) or not 0.0 <= float(opacity) <= 1.0:
        raise InputError(f"opacity of a layer must be from 0 to 1, got {opacity!r}.")
    return {
        "volume": volume, "name": str(name), "visible": bool(visible),
        "channel": None if channel is None else int(channel), "time": int(time),
        "opacity": float(opacity), "transform": None if transform is None else _transform(transform),
    }  # fmt: skip


def _is_count(value: object) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool) and int(value) >= 0


def _window(window: Sequence[float]) -> tuple[float, float]:
    try:
        low, high = (float(v) for v in window)
    except (TypeError, ValueError):
        low = high = np.nan
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        raise InputError(
            f"window of a layer must be two numbers (low, high) with low < high, got {window!r}."
        )
    return low, high


def _transform(transform: npt.ArrayLike) -> Transform:
    try:
        matrix = np.array(transform, np.float64)
    except (TypeError, ValueError):
        matrix = np.empty(0)
    if matrix.shape != (4, 4) or not np.all(np.isfinite(matrix)):
        raise InputError("transform of a layer must be a 4 x 4 matrix of finite numbers.")
    if not np.array_equal(matrix[3], (0.0, 0.0, 0.0, 1.0)) or abs(np.linalg.det(matrix[:3, :3])) == 0.0:
        raise InputError(
            "transform of a layer must keep space three-dimensional and end with the row 0, 0, 0, 1."
        )
    a, b, c, d = (tuple(row) for row in matrix.tolist())
    return a, b, c, d


class _Pairs(tuple[tuple[int, Any], ...]):
    """Pairs of label and value that have been checked: a hundred thousand need not be checked at each change."""

    __slots__ = ()


class _Labels(tuple[int, ...]):
    """Labels that have been checked, ascending, each once."""

    __slots__ = ()


def _checked_color_of(label: int, color: Any) -> Color:
    return checked_color(color, f"colour of label {label}")


def _checked_opacity_of(label: int, opacity: Any) -> float:
    if not isinstance(opacity, Real) or not 0.0 <= float(opacity) <= 1.0:
        raise InputError(f"opacity of label {label} must be from 0 to 1, got {opacity!r}.")
    return float(opacity)


def _sorted_labels(what: str, labels: Iterable[Any]) -> list[int]:
    return sorted({_label(what, label) for label in labels})


def _by_label(what: str, values: Any, check: Callable[[int, Any], Any]) -> _Pairs:
    """Pairs of label and checked value, sorted by label; what was checked before is taken as it is."""
    if isinstance(values, _Pairs):
        return values
    pairs = values.items() if isinstance(values, Mapping) else values or ()
    try:
        found = {_label(what, label): value for label, value in pairs}
    except (TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"{what} of a layer must be a mapping from label to value, got {values!r}."
        ) from None
    return _Pairs((label, check(label, value)) for label, value in sorted(found.items()))


def _label(what: str, label: Any) -> int:
    if isinstance(label, bool) or not isinstance(label, int | np.integer):
        raise InputError(f"{what} of a layer names labels by integers, got {label!r}.")
    return int(label)
