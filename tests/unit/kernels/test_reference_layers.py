"""The oracle of several layers: its law, and the oracle of one volume where there is one layer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.unit.kernels.scenes import colorful_table, scene, smooth_field
from volviz.errors import InputError
from volviz.reference.image import MODES, Shading, reference_render
from volviz.reference.layer_rays import ReferenceLayer, Sampling
from volviz.reference.layers import reference_layers

RANGE = (-150.0, 650.0)
STEP = 0.73


@pytest.fixture(scope="module")
def seen():
    """A camera, and the layer of a smooth field before it."""
    geometry, camera, matrix = scene()
    layer = ReferenceLayer(
        smooth_field() * 900 - 200,
        matrix,
        colorful_table(),
        RANGE,
        RANGE,
        float(np.mean(geometry["spacing"])),
    )
    return geometry, camera, layer


def moved(layer, seed):
    """The same kind of layer elsewhere: turned, shifted and of other values."""
    random = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    matrix = layer.index_to_world.copy()
    middle = matrix[:3, :3] @ (np.array(layer.array.shape[::-1]) / 2) + matrix[:3, 3]
    matrix[:3, :3] = turn @ matrix[:3, :3]
    matrix[:3, 3] = middle - matrix[:3, :3] @ (np.array(layer.array.shape[::-1]) / 2) + random.normal(size=3)
    return replace(layer, array=layer.array[::-1, :, ::-1].copy(), index_to_world=matrix)


def plain(layer, color, opacity):
    """One colour and opacity everywhere."""
    return replace(layer, table=np.array([[*color, opacity]] * 2, float))


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"first_sample": 1.0},
        {"early_termination": 0.6},
        *({"mode": mode} for mode in MODES[1:]),
        {"clip_planes": (((4.0, -7.0, 11.0), (-0.6, 0.8, 0.3)),)},
    ],
    ids=str,
)
def test_one_layer_is_what_the_oracle_of_one_volume_draws(seen, options):
    geometry, camera, layer = seen
    alone = reference_render(
        layer.array, **geometry, **camera, table=layer.table, value_range=RANGE, step_world=STEP, **options
    )
    assert alone.max() > 0.2
    np.testing.assert_allclose(
        reference_layers([layer], **camera, step_world=STEP, **options), alone, atol=2e-6
    )


@pytest.mark.parametrize(
    "values",
    [
        {"gradient_opacity": 0.7},
        {"density_threshold": 0.45},
        {"interpolation": "nearest"},
        {"shading": Shading(0.2, 0.6, 0.4, 12.0)},
        {"shading": Shading(0.2, 0.6, 0.4, 12.0, (30.0, -20.0, 40.0), (1.0, 0.8, 0.5))},
    ],
    ids=lambda values: next(iter(values)),
)
def test_one_layer_is_sampled_and_lit_as_one_volume(seen, values):
    geometry, camera, layer = seen
    alone = reference_render(
        layer.array, **geometry, **camera, table=layer.table, value_range=RANGE, step_world=STEP, **values
    )
    drawn = reference_layers([layer], **camera, step_world=STEP, sampling=Sampling(**values))
    np.testing.assert_allclose(drawn, alone, atol=2e-6)


@pytest.mark.parametrize("mode", MODES)
def test_the_order_of_layers_means_nothing(seen, mode):
    _, camera, layer = seen
    layers = [layer, moved(layer, 1), moved(layer, 2), replace(moved(layer, 3), mode="modulate")]
    drawn = reference_layers(layers, **camera, step_world=STEP, mode=mode)
    assert drawn.max() > 0.1
    other = reference_layers(layers[::-1], **camera, step_world=STEP, mode=mode)
    np.testing.assert_allclose(other, drawn, atol=1e-12)


def test_red_and_green_are_yellow_and_add_their_extinctions(seen):
    _, camera, layer = seen
    red, green = plain(layer, (1, 0, 0), 0.05), plain(layer, (0, 1, 0), 0.05)
    yellow = plain(layer, (0.5, 0.5, 0.0), 1.0 - 0.95**2)
    both = reference_layers([red, green], **camera, step_world=STEP)
    np.testing.assert_allclose(both, reference_layers([yellow], **camera, step_world=STEP), atol=1e-12)
    assert both[..., 0].max() > 0.2


def test_a_layer_at_half_its_extinction_beside_itself_is_one_layer(seen):
    _, camera, layer = seen
    # the table is finer than the curve bends: extinctions of its entries are halved, not those between
    fine = np.stack(
        [
            np.interp(np.linspace(0, 1, 20001), np.linspace(0, 1, len(layer.table)), layer.table[:, c])
            for c in range(4)
        ],
        axis=1,
    )
    half = fine.copy()
    half[:, 3] = 1.0 - np.sqrt(1.0 - fine[:, 3])
    twice = reference_layers([replace(layer, table=half)] * 2, **camera, step_world=STEP)
    one = reference_layers([replace(layer, table=fine)], **camera, step_world=STEP)
    np.testing.assert_allclose(twice, one, atol=1e-6)


def test_a_turned_copy_that_is_registered_lies_on_the_first(seen):
    _, camera, layer = seen
    turned = replace(
        layer,
        array=np.ascontiguousarray(layer.array.transpose(2, 1, 0)),
        index_to_world=layer.index_to_world[:, [2, 1, 0, 3]],
    )
    one, other = (reference_layers([each], **camera, step_world=STEP) for each in (layer, turned))
    np.testing.assert_allclose(other, one, atol=1e-9)


def test_complementary_masks_add_up_to_the_whole(seen):
    _, camera, layer = seen
    labels = (layer.array > np.median(layer.array)).astype(float)
    inside = replace(
        moved(layer, 4), array=labels, index_to_world=layer.index_to_world, value_range=(0.0, 1.0),
        table=np.array([[1, 1, 1, 0], [1, 1, 1, 1]], float), table_range=(0.0, 1.0), mode="mask",
    )  # fmt: skip
    outside = replace(inside, table=inside.table[::-1])
    layer = replace(layer, unit_distance=40.0)
    whole = reference_layers([layer], **camera, step_world=STEP, mode="additive")
    assert whole.max() < 1.0
    parts = [
        reference_layers([layer, mask], **camera, step_world=STEP, mode="additive")
        for mask in (inside, outside)
    ]
    assert min(part.max() for part in parts) > 0.02
    np.testing.assert_allclose(sum(parts), whole, atol=1e-9)


def test_a_modulating_layer_multiplies_extinctions(seen):
    _, camera, layer = seen
    quarter = replace(plain(layer, (0, 0, 0), 0.25), mode="modulate")
    red = plain(layer, (1, 0, 0), 0.2)
    weak = plain(layer, (1, 0, 0), 1.0 - 0.8**0.25)
    np.testing.assert_allclose(
        reference_layers([red, quarter], **camera, step_world=STEP),
        reference_layers([weak], **camera, step_world=STEP),
        atol=1e-12,
    )


def test_layers_side_by_side_are_seen_through_the_gap_between_them(seen):
    _, camera, layer = seen
    far = layer.index_to_world.copy()
    far[:3, 3] += 300.0 * camera["view"][2, :3] * -1.0
    behind = replace(plain(layer, (0, 1, 0), 0.05), index_to_world=far)
    before = plain(layer, (1, 0, 0), 0.05)
    both, first = (
        reference_layers(layers, **camera, step_world=STEP) for layers in ([behind, before], [before])
    )
    np.testing.assert_allclose(both[..., 0], first[..., 0], atol=1e-12)
    assert both[..., 1].max() > 0.05


def test_masks_alone_are_refused(seen):
    _, camera, layer = seen
    with pytest.raises(InputError, match="masks alone show nothing"):
        reference_layers([replace(layer, mode="mask")], **camera, step_world=STEP)
