"""Isosurfaces of several layers, and those of labels among them, against the oracle of one volume's surfaces."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import volviz
from tests.render.scenes import SIZE, blobs, camera, matrices, volume
from tests.render.test_label_layers import labels
from volviz import ImageLayer, LabelLayer
from volviz.custom_gl.arguments import spec_of
from volviz.custom_gl.layer_set import seen_from
from volviz.custom_gl.registry import technique
from volviz.custom_gl.resolve import resolve
from volviz.reference.isosurface import SurfaceImage, reference_isosurface
from volviz.reference.sampling import Shading

MAX_ERROR = 2 / 255


def layer(of: volviz.Volume, value: float, color: Any, **values: Any) -> ImageLayer:
    """A layer whose matter begins at a value."""
    low, high = value - 0.1, value + 0.1
    return ImageLayer(of, color=color, window=(low, high), **values)


def turned(seed: int) -> volviz.Volume:
    """Other blobs on a lattice of their own, across those of `volume`."""
    random = np.random.default_rng(seed)
    of = volviz.Volume(
        blobs((18, 22, 20), np.float32, seed),
        (1.1, 0.9, 1.3),
        direction=np.linalg.qr(random.normal(size=(3, 3)))[0],
    )
    shift = np.eye(4)
    shift[:3, 3] = np.array([17.0, 15.5, 13.0]) + random.uniform(-4, 4, 3) - of.center
    return of.moved(shift)


def drawn(layers: Any, view: volviz.Camera, **values: Any) -> npt.NDArray[Any]:
    """Our image: premultiplied, (H, W, 4)."""
    straight = volviz.render(layers, "isosurface", size=SIZE, camera=view, dtype="float32", **values)
    return np.concatenate([straight[..., :3] * straight[..., 3:], straight[..., 3:]], axis=2)


def exact(layers: Any, of: volviz.Volume, view: volviz.Camera, **surfaces: Any) -> SurfaceImage:
    """The oracle's surfaces of one volume, seen by the camera of all layers."""
    settings = technique("isosurface").settings()
    corners = resolve(spec_of(layers, "isosurface")).box_corners
    low, high = corners.min(axis=0), corners.max(axis=0)
    around: Any = SimpleNamespace(bounds=[end for pair in zip(low, high, strict=True) for end in pair])
    view_matrix, projection = matrices(around, view, SIZE)
    lit = Shading(settings.ambient, settings.diffuse, settings.specular, settings.shininess)
    return reference_isosurface(
        of.array, of.spacing, of.origin, of.direction, view=view_matrix, projection=projection, size=SIZE,
        step_world=0.05, bisections=10, shading=lit, **surfaces,
    )  # fmt: skip


def test_of_several_lattices_the_nearest_surface_is_seen() -> None:
    volumes, values = (volume(np.float32), turned(4), turned(5)), (0.7, 0.6, 0.4)
    colors = ((1.0, 0.2, 0.1), (0.1, 0.9, 0.2), (0.2, 0.3, 1.0))
    layers = [layer(of, value, color) for of, value, color in zip(volumes, values, colors, strict=True)]
    view = camera(volumes[0])
    ours = drawn(layers, view, step=0.1)
    each = [
        exact(layers, of, view, isovalues=(value,), colors=color)
        for of, value, color in zip(volumes, values, colors, strict=True)
    ]
    nearest = np.argmin([found.depth for found in each], axis=0)
    oracle = np.choose(nearest[..., None], [found.color for found in each])
    assert all(np.mean((nearest == n) & (oracle[..., 3] > 0)) > 0.01 for n in range(3))
    assert np.abs(ours - np.clip(oracle, 0.0, None)).max() <= MAX_ERROR
    assert np.array_equal(ours, drawn(layers[::-1], view, step=0.1))


def test_translucent_surfaces_of_two_layers_are_those_of_two_isovalues_of_one() -> None:
    of, view = volume(np.float32), camera(volume())
    values, colors, opacities = (0.3, 0.6), ((1.0, 0.5, 0.2), (0.3, 0.4, 1.0)), (0.4, 0.7)
    layers = [
        layer(of, value, color, opacity=opacity)
        for value, color, opacity in zip(values, colors, opacities, strict=True)
    ]
    surfaces = {"isovalues": values, "colors": colors, "opacities": opacities}
    ours, one = drawn(layers, view), drawn(of, view, **surfaces)
    assert one[..., 3].max() > 0.8
    assert np.abs(ours - one).max() <= MAX_ERROR
    exactly = exact(layers, of, view, **surfaces).color
    assert np.quantile(np.abs(ours - exactly).max(axis=-1), 0.99) <= MAX_ERROR


def test_isovalues_that_are_set_are_those_of_the_first_layer() -> None:
    of, view = volume(np.float32), camera(volume())
    surfaces: Any = {
        "isovalues": (0.35, 0.7),
        "colors": ((1.0, 0.5, 0.2), (0.3, 0.4, 1.0)),
        "opacities": (0.4, 1.0),
    }
    beyond = layer(turned(4), 5.0, "red")
    assert (
        np.abs(drawn([ImageLayer(of), beyond], view, **surfaces) - drawn(of, view, **surfaces)).max()
        <= MAX_ERROR
    )


def test_labels_are_surfaces_among_them_and_masks_leave_what_they_hold() -> None:
    of = labels()
    view = camera(of)
    ball = layer(turned(4), 0.5, "orange")
    material = {"ambient": 0.1, "diffuse": 0.9, "specular": 0.2, "shininess": 32.0}
    rays = volviz.render([LabelLayer(of)], size=SIZE, camera=view, dtype="float32", **material)
    surfaces = volviz.render(
        [LabelLayer(of)], "isosurface", size=SIZE, camera=view, dtype="float32", **material
    )
    assert np.quantile(np.abs(rays - surfaces).max(axis=-1), 0.97) <= MAX_ERROR
    mask = LabelLayer(of, hidden=(3, 500), mode="mask")
    whole, part = (drawn(layers, view) for layers in ([ball, LabelLayer(of, opacity=0.0)], [ball, mask]))
    assert whole[..., 3].mean() > 0.02
    assert part[..., 3].mean() < 0.2 * whole[..., 3].mean()


def test_surfaces_lie_where_functions_begin_to_be_seen() -> None:
    curve = volviz.TransferFunction.from_points(
        [(10.0, (1, 0, 0, 0.0)), (20.0, (1, 0, 0, 0.8)), (90.0, (0, 0, 1, 0.6))]
    )
    assert seen_from(curve, (0.0, 100.0)) == pytest.approx(15.0, abs=0.02)
    nothing = volviz.TransferFunction.from_points([(0.0, (1, 1, 1, 0.0)), (1.0, (1, 1, 1, 0.0))])
    assert seen_from(nothing, (0.0, 1.0)) == np.inf
