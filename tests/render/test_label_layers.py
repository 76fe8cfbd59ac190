"""Layers of labels: surfaces against the float64 oracle, palettes, and what they cost."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import volviz
from tests.render.scenes import SIZE, camera, matrices, shown
from volviz import ImageLayer, LabelLayer
from volviz.custom_gl.arguments import spec_of
from volviz.custom_gl.registry import technique
from volviz.custom_gl.resolve import resolve
from volviz.errors import InputError
from volviz.model.label_palette import LabelLook, label_colors
from volviz.model.render_spec import RenderSpec
from volviz.reference.image import Shading
from volviz.reference.labels import ReferenceLabels
from volviz.reference.layer_rays import ReferenceLayer, Sampling
from volviz.reference.layers import reference_layers
from volviz.volume_data.label_indices import label_indices_of

#: Two balls that cut one another, and a slab behind them.
BALLS = (((11.0, 14.0, 13.0), 8.2, 3), ((21.0, 12.0, 15.0), 7.0, 500))


def labels(dtype: Any = np.uint16, **geometry: Any) -> volviz.Volume:
    z, y, x = np.mgrid[:28, :30, :32]
    array = np.zeros(x.shape, dtype)
    array[3:6, 3:-3, 3:-3] = 40
    for (i, j, k), radius, label in BALLS:
        array[(x - i) ** 2 + (y - j) ** 2 + (z - k) ** 2 <= radius**2] = label
    return volviz.Volume(array, **geometry)


def fog(of: volviz.Volume) -> ImageLayer:
    """A veil over the box of a volume."""
    veil = volviz.Volume(np.zeros(of.array.shape, np.uint8), of.spacing, of.origin, of.direction)
    curve = volviz.TransferFunction.from_points([(0, (0.2, 0.4, 1.0, 0.03)), (1, (0.2, 0.4, 1.0, 0.03))])
    return ImageLayer(veil, curve)


def both(layers: Any, **values: Any) -> tuple[Any, Any]:
    """Our image and the oracle's, premultiplied, (H, W, 4)."""
    view = camera(labels())
    straight = volviz.render(layers, size=SIZE, camera=view, dtype="float32", **values)
    ours = np.concatenate([straight[..., :3] * straight[..., 3:], straight[..., 3:]], axis=2)
    found = resolve(spec_of(layers, **values))
    common = found.common
    given: list[Any] = []
    for image in found.layers:
        table = image.drawn_function.bake((0.0, 1.0), 16)
        given.append(
            ReferenceLayer(
                image.volume.array,
                image.volume.index_to_world,
                table,
                (0.0, 1.0),
                (0.0, 1.0),
                image.volume.mean_spacing,
            )
        )
    for each in found.labels:
        known = label_indices_of(each.volume)
        palette = each.shown.look.palette(known.labels).astype(np.float64)
        given.append(
            ReferenceLabels(known.indices, each.volume.index_to_world, palette, each.shown.smooth, each.mode)
        )
    around: Any = found.volume
    view_matrix, projection = matrices(around, view, SIZE)
    lit = Shading(common.ambient, common.diffuse, common.specular, common.shininess)
    oracle = reference_layers(
        given, view=view_matrix, projection=projection, size=SIZE,
        step_world=common.step * min(found.volume.spacing), early_termination=common.early_termination,
        sampling=Sampling(surface_shading=lit), clip_planes=values.get("clip_planes", ()),
    )  # fmt: skip
    return ours, np.clip(oracle, 0.0, 1.0)


@pytest.mark.parametrize("smooth", [True, False], ids=["smooth", "voxels"])
@pytest.mark.parametrize("opacity", [1.0, 0.4])
def test_surfaces_are_those_of_the_oracle(smooth: bool, opacity: float) -> None:
    of = labels()
    ours, oracle = both([LabelLayer(of, {3: "red"}, smooth=smooth, opacity=opacity), fog(of)])
    difference = np.abs(np.clip(ours, 0, 1) - oracle).max(axis=-1)
    assert oracle[..., 3].max() > 0.9
    # a ray along the rim of a surface meets it or not; the others agree
    assert np.quantile(difference, 0.97) <= 2 / 255
    assert difference.mean() <= 1 / 255


def test_slices_have_the_surfaces_of_the_oracle() -> None:
    of = labels()
    ours, oracle = both([LabelLayer(of, {3: "red"}, opacity=0.7), fog(of)], technique="slicing", step=0.5)
    assert oracle[..., 3].max() > 0.8
    assert np.quantile(np.abs(np.clip(ours, 0, 1) - oracle).max(axis=-1), 0.97) <= 2 / 255
    # borders along voxels, just where slabs meet
    x, y, z = of.center
    along = volviz.Camera((x, y, z + 90), (x, y, z), (0, 1, 0), parallel=True, parallel_scale=16.0)
    rays, slices = (
        volviz.render(
            [LabelLayer(of, smooth=False)], each, size=SIZE, camera=along, dtype="float32", step=0.5
        )
        for each in ("raycast", "slicing")
    )
    assert np.mean(np.abs(rays - slices).max(axis=-1) > 2 / 255) < 0.01


def test_half_angle_slices_have_the_surfaces_of_the_oracle_where_light_goes_everywhere() -> None:
    of = labels()
    light = {"headlight": True, "attenuation_color": (0, 0, 0), "light_buffer_size": 32}
    ours, oracle = both([LabelLayer(of, {3: "red"}), fog(of)], technique="half_angle", step=0.5, **light)
    assert oracle[..., 3].max() > 0.9
    assert np.quantile(np.abs(np.clip(ours, 0, 1) - oracle).max(axis=-1), 0.97) <= 2 / 255


def test_surfaces_of_labels_throw_shadows() -> None:
    array = np.zeros((24, 24, 24), np.uint8)
    array[16:20, 6:18, 6:18] = 1
    wall = np.zeros(array.shape, np.float32)
    wall[:4] = 1.0
    plate, ground = LabelLayer(volviz.Volume(array)), volviz.Volume(wall)
    curve = volviz.TransferFunction.from_points([(0.0, (1, 1, 1, 0.0)), (1.0, (1, 1, 1, 0.9))])
    below = volviz.Camera((11.5, 11.5, 9.0), (11.5, 11.5, 0.0), (0, 1, 0), view_angle=70.0)

    def drawn(opacity: float) -> Any:
        return volviz.render(
            [replace(plate, opacity=opacity), ImageLayer(ground, curve)], "half_angle", size=(49, 49), camera=below,
            light_position=(11.5, 11.5, 5000.0), attenuation_color=(0.5, 0.5, 0.5), ambient=0.2, light_buffer_size=64,
            dtype="float32",
        )[..., 0]  # fmt: skip

    lit, half, dark = (drawn(opacity) for opacity in (0.0, 0.75, 1.0))
    assert dark[24, 24] == pytest.approx(0.2, abs=0.01)
    # two surfaces, each of which lets (1 - 0.75)^0.5 pass
    assert (half[24, 24] - 0.2) / (lit[24, 24] - 0.2) == pytest.approx(0.25, abs=0.02)
    edge = np.abs(dark - lit) > 0.1
    assert edge[24].sum() == pytest.approx(edge[:, 24].sum(), abs=1)


def test_cut_labels_have_faces_and_masks_leave_only_what_they_hold() -> None:
    of = labels()
    plane = ((of.center, (-0.4, 1.0, 0.2)),)
    ours, oracle = both([LabelLayer(of)], clip_planes=plane)
    assert np.quantile(np.abs(np.clip(ours, 0, 1) - oracle).max(axis=-1), 0.97) <= 2 / 255
    ours, oracle = both([LabelLayer(of, hidden=(40,), mode="mask"), fog(of)])
    assert oracle[..., 3].max() > 0.1
    assert np.abs(ours - oracle).max() <= 4 / 255


def test_masks_of_complementary_labels_add_up_to_the_whole() -> None:
    of = labels()
    veil, values = fog(of), {"mode": "additive", "opacity_unit_distance": 20.0}
    view = camera(of)

    def drawn(*layers: Any) -> Any:
        straight = volviz.render(list(layers), size=SIZE, camera=view, dtype="float32", **values)
        return straight[..., :3] * straight[..., 3:]

    everything = LabelLayer(volviz.Volume(of.array + 1), mode="mask")
    parts = [drawn(veil, replace(everything, hidden=hidden)) for hidden in ((4, 41), (1, 501))]
    assert min(part.max() for part in parts) > 0.02
    assert np.abs(sum(parts) - drawn(veil)).max() <= 1 / 255


def test_recolouring_and_hiding_upload_a_palette_and_nothing_else() -> None:
    z, y, x = np.mgrid[:32, :32, :32]
    blocks = volviz.Volume((x // 2 + 16 * (y // 2) + 256 * (z // 2) + 5).astype(np.int32) * 7)
    layer = LabelLayer(blocks)
    assert len(label_indices_of(blocks).labels) == 16**3 + 1
    with shown(blocks, "raycast", SIZE, transfer_function=volviz.TransferFunction.auto(blocks)) as (
        window,
        handle,
    ):
        handle.show(spec_of([layer]))
        window.render()
        handle.raise_error()
        before, uploads = handle.read_image(), handle.gpu.uploads
        programs = handle.gpu.programs.compiled
        handle.show(spec_of([replace(layer, colors=tuple((7 * n, (1.0, 0.0, 0.0)) for n in range(5, 4101)))]))
        window.render()
        red = handle.read_image()
        handle.show(spec_of([replace(layer, hidden=tuple(7 * n for n in range(5, 2053)))]))
        window.render()
        handle.raise_error()
        half = handle.read_image()
        # palette, and the field of empty space
        assert handle.gpu.uploads - uploads <= 4
        assert handle.gpu.programs.compiled == programs
    assert np.all(red[..., 1][red[..., 3] > 0.5] <= red[..., 0][red[..., 3] > 0.5])
    assert np.abs(red - before).max() > 0.2
    assert half[..., 3].sum() < 0.8 * before[..., 3].sum()


def test_labels_lie_on_the_lattice_and_transform_that_are_their_own() -> None:
    of = labels(np.int16)
    coarse = volviz.Volume(of.array[::2, ::2, ::2], spacing=(2.0, 2.0, 2.0))
    turn = np.eye(4)
    turn[:3, 3] = (100.0, -20.0, 5.0)
    moved = coarse.moved(np.linalg.inv(turn))
    view = camera(of)
    alone = volviz.render([LabelLayer(coarse)], size=SIZE, camera=view)
    here = volviz.render(
        [LabelLayer(moved, transform=turn), fog(of)], size=SIZE, camera=view, early_termination=1.0
    )
    seen = alone[..., 3] > 250
    assert seen.mean() > 0.1
    assert np.mean(np.abs(here.astype(int) - alone)[seen].max(axis=-1) < 120) > 0.97


def test_what_labels_cannot_be_is_said_in_words() -> None:
    of = labels()
    half = volviz.Volume(of.array / 2.0)
    for layers, options, words in (
        ([LabelLayer(half)], {}, "labels are whole numbers, and it holds 1.5"),
        ([LabelLayer(of)], {"mode": "maximum"}, 'labels are surfaces, which the mode "maximum"'),
        ([LabelLayer(of, mode="mask")], {}, '"mask" acts on others and shows nothing'),
        ([LabelLayer(of)], {"technique": "splatting"}, "Splatting draws no labels"),
    ):
        with pytest.raises(InputError, match=words):
            volviz.render(layers, size=SIZE, **options)


def test_modes_without_surfaces_leave_labels_out_and_say_so() -> None:
    of = labels()
    layers = (LabelLayer(of), fog(of))
    found = resolve(RenderSpec(layers, "raycast", technique("raycast").settings(mode="maximum")))
    assert (len(found.layers), len(found.labels)) == (1, 0)
    assert found.notice == "Labels are surfaces and are seen by compositing only."


def test_a_palette_knows_its_labels() -> None:
    known = label_indices_of(volviz.Volume(np.array([[[-4, 7], [7, 9]], [[9, 9], [9, 200]]], np.int16)))
    assert known.labels.tolist() == [0, -4, 7, 9, 200]
    assert known.indices.dtype == np.uint8
    look = LabelLook(((7, (1.0, 0.5, 0.0)), (8, (0.0, 0.0, 0.0))), (9, 10), 0.5)
    palette = look.palette(known.labels)
    assert palette[:, 3].tolist() == [0.0, 0.5, 0.5, 0.0, 0.5]
    assert palette[2, :3].tolist() == [1.0, 0.5, 0.0]
    np.testing.assert_allclose(palette[4, :3], label_colors(np.array([200]))[0], atol=1e-6)


def test_the_palette_of_a_hundred_thousand_labels_is_timed(benchmark) -> None:
    numbers = np.concatenate([[0], np.arange(1, 100_001) * 3])
    palette = benchmark(lambda: LabelLook(hidden=tuple(range(3, 90_000, 3))).palette(numbers))
    assert np.count_nonzero(palette[:, 3]) == 100_000 - 29_999
