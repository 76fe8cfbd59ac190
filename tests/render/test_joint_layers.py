"""Several image layers in one ray integral, against the float64 oracle and against one layer alone."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import volviz
from tests.render.scenes import SIZE, blobs, camera, function, image, matrices, psnr, volume
from volviz import ImageLayer
from volviz.custom_gl.registry import technique
from volviz.custom_gl.resolve import resolve
from volviz.custom_gl.settings import CLASSIFYING_MODES
from volviz.errors import InputError
from volviz.model.render_spec import RenderSpec
from volviz.model.transfer.function import table_size
from volviz.reference.image import MODES, Shading
from volviz.reference.layer_rays import ReferenceLayer, Sampling
from volviz.reference.layer_shadows import reference_layer_shadows
from volviz.reference.layers import reference_layers

MAX_ERROR, MEAN_ERROR = 2 / 255, 0.5 / 255

#: Visible everywhere, for the modes that classify one scalar of a ray.
RAMP = [(0.0, (0.2, 0.2, 0.6, 0.15)), (0.3, (0.2, 1.0, 0.4, 0.5)), (1.0, (1.0, 0.2, 0.1, 0.9))]
#: One colour that fades in.
FADES = [(0.3, (0.0, 0.0, 0.0, 0.0)), (0.9, (0.0, 0.0, 0.0, 0.3))]


def colored(red: float, green: float, blue: float) -> Any:
    """`FADES` in a colour."""
    return [(value, (red, green, blue, opacity)) for value, (_, _, _, opacity) in FADES]


def exact(
    layers: list[ImageLayer], view: volviz.Camera, technique_id: str = "raycast", **values: Any
) -> npt.NDArray[np.float64]:
    """The oracle's image of layers for the values that `volviz.render` takes."""
    info = technique(technique_id)
    settings = {p.name: p.default for p in info.parameters} | values
    shown = resolve(RenderSpec(tuple(layers), technique_id, info.settings()))
    # the near plane lies before the box around all of them
    low, high = shown.box_corners.min(axis=0), shown.box_corners.max(axis=0)
    around: Any = SimpleNamespace(bounds=[end for pair in zip(low, high, strict=True) for end in pair])
    view_matrix, projection = matrices(around, view, SIZE)
    found = []
    for layer in shown.layers:
        of, curve = layer.volume, layer.drawn_function
        first_value, last_value = of.range
        entries = table_size(of.range, of.array.dtype.kind in "iu")
        found.append(
            ReferenceLayer(
                of.array,
                of.index_to_world,
                curve.bake((first_value, last_value), entries),
                of.range,
                of.range,
                settings["opacity_unit_distance"] or of.mean_spacing,
                layer.mode,
                values.get("crop"),
            )
        )
    step = settings["step"] * min(min(layer.volume.spacing) for layer in shown.layers)
    where = {"view": view_matrix, "projection": projection, "size": SIZE, "step_world": step}
    if technique_id == "half_angle":
        return reference_layer_shadows(
            found, **where, light_position=values["light_position"], kappa=settings["attenuation_color"],
            ambient=settings["ambient"], clip_planes=values.get("clip_planes", ()),
        )  # fmt: skip
    shading = None
    if settings["shading"]:
        shading = Shading(
            settings["ambient"], settings["diffuse"], settings["specular"], settings["shininess"],
            values.get("light_position"), (1.0, 1.0, 1.0), settings["gradient_delta"],
        )  # fmt: skip
    return reference_layers(
        found, **where, first_sample=settings["first_sample"], mode=settings["mode"],
        attenuation=settings["attenuation"], early_termination=settings["early_termination"],
        sampling=Sampling(
            settings["interpolation"], settings["gradient_delta"], settings["gradient_opacity"],
            settings["density_threshold"], shading,
        ),
        clip_planes=values.get("clip_planes", ()),
    )  # fmt: skip


def drawn(layers: Any, view: volviz.Camera, technique_id: str = "raycast", **values: Any) -> Any:
    """Our image: premultiplied, (H, W, 4)."""
    straight = volviz.render(layers, technique_id, size=SIZE, camera=view, dtype="float32", **values)
    return np.concatenate([straight[..., :3] * straight[..., 3:], straight[..., 3:]], axis=2)


def assert_like_the_oracle(
    layers: list[ImageLayer], view: volviz.Camera, technique_id: str = "raycast", **values: Any
) -> None:
    ours, oracle = drawn(layers, view, technique_id, **values), exact(layers, view, technique_id, **values)
    assert oracle[..., 3].max() > 0.1, "the scene is empty and proves nothing"
    difference = np.abs(ours - np.clip(oracle, 0.0, None))
    # straight colours that are not clamped may exceed what uint8 shows
    assert difference.max() <= MAX_ERROR
    assert difference.mean() <= MEAN_ERROR


def channel(number: int, points: Any, dtype: Any = np.uint8, **geometry: Any) -> ImageLayer:
    """A layer of other blobs in a colour."""
    of = volviz.Volume(blobs(dtype=dtype, seed=number), **geometry)
    return ImageLayer(of, function(of, points))


def four(dtype: Any = np.uint8, **geometry: Any) -> list[ImageLayer]:
    """Four channels on one lattice."""
    colors = ((1.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 0.2, 1.0), (0.8, 0.8, 0.8))
    return [channel(n, colored(*color), dtype, **geometry) for n, color in enumerate(colors)]


def elsewhere(seed: int, mode: Any = "add") -> ImageLayer:
    """A layer on a random lattice, moved by a random transform, not far from the others."""
    random = np.random.default_rng(seed)
    shape = tuple(random.integers(12, 30, 3))
    of = volviz.Volume(
        blobs(shape, np.float32, seed), random.uniform(0.7, 1.6, 3), random.uniform(-3, 3, 3),
        np.linalg.qr(random.normal(size=(3, 3)))[0],
    )  # fmt: skip
    transform = np.eye(4)
    transform[:3, :3] = np.linalg.qr(random.normal(size=(3, 3)))[0] + random.uniform(-0.2, 0.2, (3, 3))
    target = np.array([17.0, 16.0, 13.0]) + random.uniform(-6, 6, 3)
    transform[:3, 3] = target - transform[:3, :3] @ of.center
    return ImageLayer(
        of, function(of, colored(*random.uniform(0, 1, 3))), transform=transform, mode=mode, opacity=0.9
    )


@pytest.mark.parametrize("mode", MODES)
def test_channels_of_one_lattice_draw_what_the_oracle_draws(mode: str) -> None:
    layers = [*four()[:2], channel(5, RAMP)]
    assert_like_the_oracle(layers, camera(volume()), mode=mode)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_random_lattices_and_transforms_draw_what_the_oracle_draws(seed: int) -> None:
    layers = [channel(seed, None), elsewhere(10 + seed), elsewhere(20 + seed)]
    assert_like_the_oracle(layers, camera(volume()))


@pytest.mark.parametrize("mode", ["maximum", "additive"])
def test_modes_on_random_lattices_draw_what_the_oracle_draws(mode: str) -> None:
    assert_like_the_oracle([elsewhere(31), elsewhere(32)], camera(volume()), mode=mode)


def test_averages_on_random_lattices_are_those_of_the_oracle() -> None:
    layers = [
        replace(each, transfer_function=function(each.volume, RAMP)) for each in map(elsewhere, (31, 32))
    ]
    ours, oracle = (draw(layers, camera(volume()), mode="average") for draw in (drawn, exact))
    difference = np.abs(ours - oracle).max(axis=-1)
    # however short a ray is inside a layer, its mean counts: one along an edge of a box has it or not
    assert np.count_nonzero(difference > MAX_ERROR) <= 2
    assert difference.mean() <= MEAN_ERROR


@pytest.mark.parametrize(
    "values",
    [
        {"shading": True},
        {"shading": True, "light_position": (-40.0, -5.0, 60.0)},
        {"gradient_opacity": 0.8},
        {"first_sample": 1.0, "step": 0.7},
        {"clip_planes": (((17.0, 15.0, 13.0), (1.0, 0.3, 0.2)),)},
    ],
    ids=str,
)
def test_settings_draw_what_the_oracle_draws(values: dict[str, Any]) -> None:
    layers = [channel(3, None, np.float32), elsewhere(41)]
    assert_like_the_oracle(layers, camera(volume()), **values)


def test_a_crop_box_cuts_all_layers_of_its_lattice() -> None:
    assert_like_the_oracle(four()[:2], camera(volume()), crop=(4.5, 25.0, 0.0, 20.25, 3.0, 26.0))


@pytest.mark.parametrize("mode", ["mask", "modulate"])
def test_masks_and_modulating_layers_draw_what_the_oracle_draws(mode: Any) -> None:
    opaque = [(0.0, (1.0, 1.0, 1.0, 0.0)), (0.6, (1.0, 1.0, 1.0, 1.0))]
    mask = replace(channel(7, opaque, np.float32), mode=mode)
    layers = [channel(3, None, np.float32), mask, elsewhere(51)]
    ours, oracle = drawn(layers, camera(volume())), exact(layers, camera(volume()))
    difference = np.abs(ours - oracle)
    # the border of a mask is a jump: a sample that lies on it by rounding counts or does not
    assert difference.mean() <= MEAN_ERROR
    assert np.quantile(difference, 0.99) <= MAX_ERROR
    assert np.abs(oracle - exact([layers[0], layers[2]], camera(volume()))).max() > 0.1


def test_two_pass_ray_casting_draws_what_the_oracle_draws() -> None:
    layers = [channel(3, None), elsewhere(61)]
    assert_like_the_oracle(layers, camera(volume()), "two_pass_raycast")


def test_a_camera_inside_draws_what_the_oracle_draws() -> None:
    view = volviz.Camera((17.0, 16.0, 13.0), (20.0, 23.0, 15.0), (0.0, 0.0, 1.0), view_angle=60.0)
    assert_like_the_oracle([channel(3, None), elsewhere(71)], view)


def test_sixteen_layers_draw_what_the_oracle_draws() -> None:
    layers = [*(elsewhere(80 + n) for n in range(10)), *four(), *four(np.float32)[:2]]
    assert len(layers) == 16
    assert_like_the_oracle(layers, camera(volume()))


def test_seventeen_layers_are_refused_in_words() -> None:
    with pytest.raises(InputError, match="at most 16 layers are drawn together, got 17"):
        volviz.render([ImageLayer(volume())] * 17, size=SIZE)


def test_the_order_of_layers_changes_no_bit() -> None:
    layers = [*four(), elsewhere(91), replace(elsewhere(92), mode="modulate")]
    view = camera(volume())
    first = volviz.render(layers, size=SIZE, camera=view, dtype="float32")
    for order in ([5, 4, 3, 2, 1, 0], [2, 5, 0, 4, 1, 3]):
        other = volviz.render([layers[n] for n in order], size=SIZE, camera=view, dtype="float32")
        assert np.array_equal(first, other)
    for technique_id in ("slicing", "half_angle"):
        first, other = (
            volviz.render(given, technique_id, size=SIZE, camera=view, dtype="float32")
            for given in (layers, layers[::-1])
        )
        assert np.array_equal(first, other)


def test_hidden_layers_change_no_bit_of_one_alone() -> None:
    layers = [channel(3, None), replace(elsewhere(93), visible=False)]
    view = camera(volume())
    alone = drawn(layers[0].volume, view, transfer_function=layers[0].transfer_function)
    assert np.array_equal(drawn(layers, view), alone)


def test_red_and_green_of_equal_strength_are_yellow() -> None:
    of = volume()
    red, green = (ImageLayer(of, color=color, window=(64, 255), opacity=0.3) for color in ("red", "lime"))
    seen = drawn([red, green], camera(of))
    assert seen[..., 0].max() > 0.3
    np.testing.assert_array_equal(seen[..., 0], seen[..., 1])
    assert seen[..., 2].max() == 0.0


def test_a_layer_beside_itself_at_half_its_extinction_is_one() -> None:
    of, view = volume(), camera(volume())
    curve = function(of)
    whole = curve.bake(of.range, 4096).astype(np.float64)
    values = np.linspace(*of.range, len(whole))
    half = volviz.TransferFunction.from_points(
        [
            (value, (*rgba[:3], 1.0 - np.sqrt(1.0 - rgba[3])))
            for value, rgba in zip(values, whole.tolist(), strict=True)
        ]
    )
    assert np.abs(drawn([ImageLayer(of, half)] * 2, view) - image(of, curve, view)).max() <= 1 / 255


def test_a_registered_copy_lies_where_the_first_one_does() -> None:
    of, view = volume(np.float32), camera(volume())
    turn = np.eye(4)
    turn[:3, :3] = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    turn[:3, 3] = (5.0, -3.0, 2.0)
    copy = of.moved(np.linalg.inv(turn))
    alone = image(of, function(of), view)
    one = drawn(ImageLayer(copy, function(of), transform=turn), view)
    assert np.abs(one - alone).max() <= 1 / 255
    green, red = colored(0, 1, 0), colored(1, 0, 0)
    both = drawn(
        [ImageLayer(of, function(of, red)), ImageLayer(copy, function(of, green), transform=turn)], view
    )
    assert np.abs(both[..., 0] - both[..., 1]).max() <= 1 / 255


@pytest.mark.parametrize("mode", MODES)
def test_slices_of_every_mode_are_what_the_oracle_draws(mode: str) -> None:
    values = {"step": 0.25, "early_termination": 1.0, "mode": mode}
    layers = [channel(3, None, np.float32), elsewhere(31), elsewhere(32)]
    if mode in CLASSIFYING_MODES:
        assert_like_the_oracle(layers, camera(volume()), "slicing", **values)
        return
    # every ray shows something, and a short one along the silhouette may pass between two slices
    layers = [replace(each, transfer_function=function(each.volume, RAMP)) for each in layers[:2]]
    ours, oracle = (draw(layers, camera(volume()), "slicing", **values) for draw in (drawn, exact))
    assert oracle[..., 3].max() > 0.1
    assert psnr(ours, oracle) >= 45


@pytest.mark.parametrize(
    "values",
    [
        {"shading": True},
        {"clip_planes": (((17.0, 15.0, 13.0), (1.0, 0.3, 0.2)),)},
        {"gradient_opacity": 0.8},
    ],
    ids=str,
)
def test_settings_of_slices_draw_what_the_oracle_draws(values: dict[str, Any]) -> None:
    modulating = replace(channel(7, [(0.0, (1, 1, 1, 0)), (0.6, (1, 1, 1, 1))], np.float32), mode="modulate")
    layers = [channel(3, None, np.float32), elsewhere(41), modulating]
    assert_like_the_oracle(layers, camera(volume()), "slicing", step=0.25, early_termination=1.0, **values)


@pytest.mark.parametrize("case", ["one lattice", "several", "cut and modulated"])
def test_all_layers_throw_shadows_on_all_as_the_oracle_says(
    case: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(globals(), "SIZE", (28, 28))
    modulating = replace(channel(7, [(0.0, (1, 1, 1, 0)), (0.6, (1, 1, 1, 1))], np.float32), mode="modulate")
    layers, values = {
        "one lattice": (four()[:3], {}),
        "several": ([channel(1, None), elsewhere(11)], {}),
        "cut and modulated": (
            [channel(3, None, np.float32), elsewhere(41), modulating],
            {"clip_planes": (((17.0, 15.0, 13.0), (1.0, 0.3, 0.2)),)},
        ),
    }[case]
    assert_like_the_oracle(
        layers, camera(volume()), "half_angle", step=0.4, light_position=(-60.0, -70.0, 80.0), ambient=0.2,
        attenuation_color=(0.3, 0.6, 1.0), light_buffer_size=128, **values,
    )  # fmt: skip


def test_techniques_that_draw_one_layer_say_so() -> None:
    with pytest.raises(InputError, match="Splatting draws one layer and 2 are visible; hide the others"):
        volviz.render(four()[:2], "splatting", size=SIZE)
