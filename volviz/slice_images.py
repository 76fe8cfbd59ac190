"""Slices as arrays: `volviz.slice_image` and the world positions of its pixels, computed without OpenGL."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.arguments import layers_of
from volviz.custom_gl.layer_set import layer_function
from volviz.custom_gl.offscreen import checked_dtype, checked_size, finished
from volviz.errors import InputError
from volviz.kernels.slices import crop_corners
from volviz.model.label_palette import LabelLook
from volviz.model.layers import ImageLayer, LabelLayer, volume_of
from volviz.model.slice_plane import SlicePlane, slice_plane
from volviz.model.transfer.first_look import automatic_window
from volviz.model.transfer.function import TransferFunction
from volviz.reference.slices import SLAB_MODES, composited, projected, slab_offsets, slab_samples, whole_crop
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume

Float64Array = npt.NDArray[np.float64]
Plane = str | Sequence[Sequence[float]]
At = float | Sequence[float] | None
Extent = float | Sequence[float] | None

#: Samples across a slab lie no farther apart than this share of the smallest spacing.
STEP = 0.5


def slice_image(
    volume: Volume | VolumeSource | ImageLayer | Sequence[ImageLayer | LabelLayer],
    plane: Plane = "axial",
    *,
    at: At = None,
    size: tuple[int, int] = (512, 512),
    extent: Extent = None,
    slab: float = 0.0,
    mode: Literal["mean", "maximum", "minimum", "composite"] = "mean",
    interpolation: Literal["nearest", "linear", "cubic"] = "linear",
    window: Sequence[float] | None = None,
    transfer_function: TransferFunction | None = None,
    dtype: Literal["uint8", "float32"] = "uint8",
) -> npt.NDArray[Any]:
    """A slice, or a projection of a slab, through a volume at any angle.

    Parameters
    ----------
    volume : Volume, VolumeSource, ImageLayer or sequence of layers
        What is cut. Of several layers the first is opaque, and each lies over those before it with its opacity.
    plane : str or pair of vectors
        "axial", "coronal", "sagittal" (`volviz.model.slice_plane.NAMED_PLANES`), or the normal towards the viewer and
        what is up, in the world.
    at : float or 3 floats, optional
        World coordinate of the plane (z of an axial, y of a coronal, x of a sagittal one, else the distance from the
        world's origin along the normal) or a world point on it; the default goes through the middle.
    size : tuple of 2 ints
        Width and height in pixels.
    extent : float or 2 floats, optional
        Width, or width and height, of the picture in world units, around the point `at`, else around the middle. The
        default shows the whole volume with square pixels.
    slab : float
        Thickness in world units, half of it to either side.
    mode : {"mean", "maximum", "minimum", "composite"}
        What is made of the values across the slab; "composite" classifies and composites them.
    interpolation : {"nearest", "linear", "cubic"}
        Cubic is the B-spline of third order that passes through the voxels.
    window : 2 floats, optional
        Values shown black and white. The default leaves out the outermost thousandth of the values.
    transfer_function : TransferFunction, optional
        Colours instead of grey; slices are opaque, so its opacities count in the mode "composite" only.
    dtype : {"uint8", "float32"}
        "float32" without window and function, of one volume, gives the values themselves.

    Returns
    -------
    ndarray of shape (H, W, 4) or (H, W)
        Red, green, blue, alpha (straight), 0..255 or 0..1, transparent outside the volume; or values in data units,
        float32, NaN outside. Row 0 at the top.

    Raises
    ------
    InputError
        Values that are none of these.
    """
    checked_dtype(dtype)
    if mode not in SLAB_MODES:
        raise InputError(f"mode of a slab must be {', '.join(SLAB_MODES)}, got {mode!r}.")
    if not 0.0 <= float(slab) < np.inf:
        raise InputError(f"slab must be a thickness of 0 or more world units, got {slab!r}.")
    given = layers_of(volume, transfer_function)
    shown = [_Shown.of(layer) for layer in given if layer.visible]
    if not shown:
        raise InputError("all layers are hidden; make one visible.")
    points, towards_viewer = _points(shown, plane, at, checked_size(size), extent)
    cut = _Cut(points, towards_viewer, float(slab), mode, interpolation)
    first = shown[0]
    if dtype == "float32" and len(shown) == 1 and window is None and not first.has_colors:
        if mode == "composite":
            raise InputError("compositing needs colours: give a window, a transfer function or dtype uint8.")
        return projected(cut.samples(first), mode).astype(np.float32)
    image = np.zeros((*points.shape[:2], 4))
    for n, layer in enumerate(shown):
        over = (
            cut.labels(layer)
            if isinstance(layer.layer, LabelLayer)
            else cut.image(layer, window, opaque=n == 0)
        )
        image = over + (1.0 - over[..., 3:]) * image
    return finished(image.astype(np.float32), None, dtype)


def plane_points(
    volume: Volume | VolumeSource | ImageLayer | Sequence[ImageLayer | LabelLayer],
    plane: Plane = "axial",
    at: At = None,
    size: tuple[int, int] = (512, 512),
    extent: Extent = None,
) -> Float64Array:
    """World positions of the centres of the pixels of `slice_image` with the same arguments.

    Returns
    -------
    ndarray of shape (H, W, 3), float64
        (x, y, z) in world units; row 0 at the top.

    Raises
    ------
    InputError
        As from `slice_image`.
    """
    shown = [_Shown.of(layer) for layer in layers_of(volume) if layer.visible]
    if not shown:
        raise InputError("all layers are hidden; make one visible.")
    return _points(shown, plane, at, checked_size(size), extent)[0]


@dataclass(frozen=True)
class _Shown:
    """A layer with its values, and where they are shown."""

    layer: ImageLayer | LabelLayer
    volume: Volume
    index_to_world: Float64Array

    @classmethod
    def of(cls, layer: ImageLayer | LabelLayer) -> _Shown:
        """The layer read, its own transform applied."""
        volume = volume_of(layer)
        matrix = volume.index_to_world
        return cls(layer, volume, matrix if layer.transform is None else np.asarray(layer.transform) @ matrix)

    @property
    def has_colors(self) -> bool:
        """Whether it is more than bare values."""
        layer = self.layer
        if isinstance(layer, LabelLayer):
            return True
        return layer.transfer_function is not None or layer.color is not None or layer.window is not None

    @property
    def corners(self) -> Float64Array:
        """World corners of its voxels' faces, shape (8, 3)."""
        dimensions = self.volume.dimensions
        return crop_corners(self.index_to_world, whole_crop(dimensions), dimensions)


@dataclass(frozen=True)
class _Cut:
    """A slab through pixels: how layers are sampled on it."""

    points: Float64Array
    towards_viewer: Float64Array
    thickness: float
    mode: str
    interpolation: str

    def _offsets(self, shown: _Shown) -> Float64Array:
        return slab_offsets(self.thickness, STEP * min(shown.volume.spacing))

    def samples(self, shown: _Shown, interpolation: str | None = None) -> Any:
        """Values on the planes of the slab, front to back."""
        return slab_samples(
            shown.volume.array, np.asarray(np.linalg.inv(shown.index_to_world), np.float64), self.points,
            -self.towards_viewer, self._offsets(shown), interpolation or self.interpolation,
        )  # fmt: skip

    def image(self, shown: _Shown, window: Sequence[float] | None, *, opaque: bool) -> Float64Array:
        """Premultiplied colours of an image layer."""
        layer, volume = shown.layer, shown.volume
        assert isinstance(layer, ImageLayer)
        function = grey_function(_checked_window(window, volume))
        if shown.has_colors and window is None:
            function = layer_function(replace(layer, opacity=1.0), volume).resolved(volume.range)
        # a colour fades in from black, functions and windows colour every value
        ramp = layer.color is not None or (layer.window is not None and window is None)
        fades = ramp or (layer.transfer_function is not None and window is None)
        if self.mode == "composite":
            samples = list(self._offsets(shown))
            length = self.thickness / len(samples) if self.thickness else volume.mean_spacing
            image = composited(self.samples(shown), function.evaluate, length, volume.mean_spacing)
            return image * layer.opacity
        values = projected(self.samples(shown), self.mode)
        inside = np.isfinite(values)
        image = np.zeros((*values.shape, 4))
        color = function.evaluate(values[inside])
        if opaque or not fades:
            image[inside, :3], image[inside, 3] = color[:, :3] * (color[:, 3:] if ramp else 1.0), 1.0
        else:
            image[inside, :3], image[inside, 3] = color[:, :3] * color[:, 3:], color[:, 3]
        return image * layer.opacity

    def labels(self, shown: _Shown) -> Float64Array:
        """Premultiplied colours of a label layer: the nearest voxel's on the middle plane."""
        layer = shown.layer
        assert isinstance(layer, LabelLayer)
        middle = replace(self, thickness=0.0)
        found = next(iter(middle.samples(shown, "nearest")))
        inside = np.isfinite(found)
        values = found[inside].astype(np.int64)
        others = np.unique(values[values != 0])
        palette = LabelLook(layer.colors, layer.hidden, layer.opacity, layer.opacities).palette(
            np.append(0, others)
        )
        colors = palette[np.where(values == 0, 0, np.searchsorted(others, values) + 1)]
        image = np.zeros((*found.shape, 4))
        image[inside] = np.concatenate([colors[:, :3] * colors[:, 3:], colors[:, 3:]], axis=1)
        return image


def grey_function(window: tuple[float, float]) -> TransferFunction:
    """Black to white over a window, opaque."""
    low, high = window
    return TransferFunction.from_points([(low, (0.0, 0.0, 0.0, 1.0)), (high, (1.0, 1.0, 1.0, 1.0))])


def _checked_window(window: Sequence[float] | None, volume: Volume) -> tuple[float, float]:
    if window is None:
        return automatic_window(volume)
    try:
        low, high = (float(v) for v in window)
    except (TypeError, ValueError):
        low = high = np.nan
    if not (np.isfinite([low, high]).all() and low < high):
        raise InputError(f"window must be two numbers (low, high) with low < high, got {window!r}.")
    return low, high


def _points(
    shown: Iterable[_Shown], plane: Plane, at: At, size: tuple[int, int], extent: Extent
) -> tuple[Float64Array, Float64Array]:
    """World positions of pixels, and the direction towards the viewer."""
    corners = np.concatenate([layer.corners for layer in shown])
    low, high = corners.min(axis=0), corners.max(axis=0)
    x, y, z = (float(v) for v in (low + high) / 2)
    cut = slice_plane(plane, at, (x, y, z))
    width, height = _extent(extent, size, cut, corners)
    if extent is None or at is None or np.ndim(at) == 0:
        cut = _centred(cut, corners)
    return cut.points(size, (width, height)), np.asarray(cut.normal)


def _centred(cut: SlicePlane, corners: Float64Array) -> SlicePlane:
    """The same plane with the middle of what it shows as its point."""
    point = np.asarray(cut.point)
    for axis in (np.asarray(cut.right), np.asarray(cut.up)):
        along = corners @ axis
        point = point + ((along.min() + along.max()) / 2 - point @ axis) * axis
    x, y, z = (float(v) for v in point)
    return replace(cut, point=(x, y, z))


def _extent(
    extent: Extent, size: tuple[int, int], cut: SlicePlane, corners: Float64Array
) -> tuple[float, float]:
    """Width and height of a picture in world units."""
    columns, rows = size
    if extent is None:
        width, height = (float(np.ptp(corners @ np.asarray(axis))) for axis in (cut.right, cut.up))
        pixel = max(width / columns, height / rows)
        return pixel * columns, pixel * rows
    try:
        values = np.asarray(extent, np.float64)
        width, height = (float(v) for v in (values if values.ndim else (values, values * rows / columns)))
    except (TypeError, ValueError):
        width = height = np.nan
    if not (0 < width < np.inf and 0 < height < np.inf):
        raise InputError(
            f"extent must be a width, or width and height, greater than 0 in world units, got {extent!r}."
        )
    return width, height
