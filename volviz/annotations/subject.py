"""What annotations tell of: the volume that is seen, its colours, its layers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.resolve import ResolvedSpec, Volumes
from volviz.model.label_palette import LabelLook
from volviz.model.layers import ImageLayer, LabelLayer, volume_of
from volviz.model.measurements import Measurement
from volviz.model.surface_values import SurfaceColors
from volviz.model.transfer.first_look import grey_window
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.label_indices import are_labels_known, label_indices_of
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.vectors import Vector
from volviz.volume_data.volume import Volume

Color = tuple[float, float, float]
Floats = npt.NDArray[np.float64]

#: Formats of medicine, whose world axes are those of a patient.
ANATOMICAL = frozenset({"DICOM", "NIfTI", "NRRD", "MetaImage", "MGH", "MINC", "AFNI", "PAR/REC", "GIPL"})
#: Strips of a colour bar.
STRIPS = 128


@dataclass(frozen=True)
class BarColors:
    """What a colour bar shows.

    Attributes
    ----------
    low, high : float
        Values at its ends.
    colors : tuple of colours
        From low to high, evenly spaced.
    unit : str
        Of the values; may be empty.
    """

    low: float
    high: float
    colors: tuple[Color, ...]
    unit: str = ""


@dataclass(frozen=True, eq=False)
class Subject:
    """What annotations tell of.

    Attributes
    ----------
    corners : ndarray of shape (8, 3)
        World corners of the volume; bit 0 of the row is x, bit 1 y, bit 2 z.
    length_unit : str
        Of world coordinates; may be empty.
    is_anatomical : bool
        Whether the world axes are those of a patient.
    bar : BarColors or None
        Colours of the values.
    legend : tuple of (words, colour)
        Labels, or layers.
    facing : pair of vectors or None
        Direction towards the viewer, and up, where a plane is faced.
    lines : tuple of (colour, ndarray of shape (N, 3))
        World points, joined by lines, of the planes of other views.
    measurements : tuple of (Measurement, str)
        What is measured and marked, each with the words that stand beside it.
    plane : (point, normal, float) or None
        Where a plane is faced, a point of it, its normal, and how far from it things still lie in it, in world units.
    note : str
        A line at the lower edge.
    """

    corners: Floats
    length_unit: str = ""
    is_anatomical: bool = False
    bar: BarColors | None = None
    legend: tuple[tuple[str, Color], ...] = ()
    facing: tuple[Vector, Vector] | None = None
    lines: tuple[tuple[Color, Floats], ...] = ()
    measurements: tuple[tuple[Measurement, str], ...] = ()
    plane: tuple[Vector, Vector, float] | None = None
    note: str = ""

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest world coordinates."""
        return self.corners.min(axis=0), self.corners.max(axis=0)


def subject_of(shown: ResolvedSpec, volumes: Volumes | None = None) -> Subject:
    """What can be told of a picture; `volumes` as for `volviz.custom_gl.resolve.resolve`."""
    volume = shown.volume
    facing = shown.info.facing(shown.settings) if shown.info.facing is not None else None
    return Subject(
        corners=np.asarray(volume.corners, np.float64),
        length_unit=str(volume.metadata.get("length_unit", "mm")),
        is_anatomical=is_anatomical(volume),
        bar=bar_of(shown),
        legend=legend_of(shown.spec.layers, volumes or {}),
        facing=facing,
    )


def is_anatomical(volume: Volume) -> bool:
    """Whether the world axes of a volume are those of a patient, as far as the kind of its file says so."""
    return volume.metadata.get("format") in ANATOMICAL


# ---------------------------------------------------------------------- colours


def bar_of(shown: ResolvedSpec) -> BarColors | None:
    """The colours of the values in a picture: of a surface, of a grey window, or of the transfer function."""
    volume = shown.volume
    if shown.surface_colors is not None:
        return surface_bar(shown.surface_colors, str(volume.metadata.get("length_unit", "mm")))
    if not shown.layers:
        return None
    if getattr(shown.settings, "coloring", "") == "window":
        low, high = grey_window(volume, shown.settings.window_level, shown.settings.window_width)
        return BarColors(
            low, high, _colors(np.repeat(np.linspace(0.0, 1.0, STRIPS)[:, None], 3, axis=1)), volume.unit
        )
    return function_bar(shown.transfer_function, volume)


def function_bar(function: TransferFunction, volume: Volume) -> BarColors:
    """The colours of a transfer function over the values of a volume."""
    low, high = volume.range
    if not low < high:
        high = low + max(abs(low) * 1e-6, 1.0)
    return BarColors(low, high, _colors(function.bake((low, high), STRIPS)), volume.unit)


def surface_bar(colors: SurfaceColors, unit: str) -> BarColors:
    """The colours of values on a surface."""
    return BarColors(colors.low, colors.high, _colors(colors.table / 255.0), unit)


def _colors(table: Any) -> tuple[Color, ...]:
    return tuple(
        (float(r), float(g), float(b)) for r, g, b in np.clip(np.asarray(table, float)[:, :3], 0.0, 1.0)
    )


# ---------------------------------------------------------------------- names


def legend_of(layers: Sequence[ImageLayer | LabelLayer], volumes: Volumes) -> tuple[tuple[str, Color], ...]:
    """Names and colours of the labels that are seen, and of the image layers where there are several."""
    seen = [layer for layer in layers if layer.visible and layer.opacity > 0]
    images = [layer for layer in seen if isinstance(layer, ImageLayer) and layer.mode == "add"]
    entries: list[tuple[str, Color]] = []
    if len(images) > 1:
        entries = [(layer.name or f"Layer {n + 1}", _layer_color(layer)) for n, layer in enumerate(images)]
    for layer in seen:
        if isinstance(layer, LabelLayer) and layer.mode == "add":
            entries += _label_entries(layer, volumes)
    return tuple(entries)


def _layer_color(layer: ImageLayer) -> Color:
    if layer.transfer_function is not None:
        # the colour of what is least transparent says most
        r, g, b, _a = max((point.rgba for point in layer.transfer_function.points), key=lambda rgba: rgba[3])
        return float(r), float(g), float(b)
    return layer.color or (1.0, 1.0, 1.0)


def _label_entries(layer: LabelLayer, volumes: Volumes) -> list[tuple[str, Color]]:
    names, colors = dict(layer.names), dict(layer.colors)
    if isinstance(layer.volume, VolumeSource):
        for label in layer.volume.labels:
            names.setdefault(label.number, label.name)
            if label.color is not None:
                colors.setdefault(label.number, label.color)
    if not names:
        volume = volume_of(layer, volumes)
        if are_labels_known(volume):
            names = {int(label): "" for label in label_indices_of(volume).labels if label}
    shown = np.array(sorted(number for number in names if number and number not in layer.hidden), np.int64)
    if not len(shown):
        return []
    palette = LabelLook(tuple(sorted(colors.items()))).palette(np.concatenate([[0], shown]))[1:, :3]
    return [
        (names[int(number)] or f"Label {number}", (float(r), float(g), float(b)))
        for number, (r, g, b) in zip(shown, palette, strict=True)
    ]
