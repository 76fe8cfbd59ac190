"""What the public functions say to values of the wrong kind."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import pyvista

import volviz
from volviz.custom_gl.framing import default_camera
from volviz.errors import InputError, RenderError, VolvizError

VOLUME = volviz.Volume(np.arange(27.0).reshape(3, 3, 3))


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"transfer_function": "ct-bone"}, "transfer_function must be a volviz.TransferFunction, got str"),
        ({"light": (1.0, 2.0, 3.0)}, "light must be a volviz.Light, got tuple"),
        ({"clipping": (0, 1, 0, 1, 0, 1)}, "clipping must be a volviz.Clipping, got tuple"),
        ({"settings": {"step": 1.0}}, "raycast takes RaycastSettings, got dict"),
        ({"volume": VOLUME.array}, "volume must be a volviz.Volume, got ndarray"),
        ({"volume": None}, "no volume to show"),
    ],
)
def test_a_value_of_another_kind_is_refused_before_anything_is_drawn(
    values: dict[str, Any], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        volviz.render(**({"volume": VOLUME} | values))


def test_a_handle_refuses_what_it_cannot_show_and_keeps_what_it_shows() -> None:
    plotter = pyvista.Plotter(off_screen=True, window_size=(16, 16))
    try:
        handle = volviz.add_volume(plotter, VOLUME)
        for values, words in (
            ({"quality": "best"}, "quality must be one of fast, balanced, full"),
            ({"volume": VOLUME.array}, "volume must be a volviz.Volume"),
            ({"settings": 3}, "raycast takes RaycastSettings"),
        ):
            with pytest.raises(VolvizError, match=words):
                handle.update(**values)
        assert (handle.quality, handle.volume) == ("balanced", VOLUME)
    finally:
        plotter.close()


def test_a_picture_of_an_earlier_state_is_not_read_for_one_of_the_present() -> None:
    plotter = pyvista.Plotter(off_screen=True, window_size=(16, 16))
    try:
        handle = volviz.add_volume(plotter, VOLUME)
        with pytest.raises(RenderError, match="no full picture"):
            handle.read_image()
        plotter.show(auto_close=False)
        assert handle.read_image().shape == (16, 16, 4)
        handle.update(step=1.0)
        with pytest.raises(RenderError, match="no full picture"):
            handle.read_image()
        plotter.render()
        assert handle.read_image().shape == (16, 16, 4)
    finally:
        plotter.close()


def test_a_closed_plotter_is_told_in_words() -> None:
    plotter = pyvista.Plotter(off_screen=True, window_size=(16, 16))
    handle = volviz.add_volume(plotter, VOLUME)
    plotter.show()
    with pytest.raises(RenderError, match="plotter closed"):
        handle.read_image()
    with pytest.raises(InputError, match="plotter is closed"):
        volviz.add_volume(plotter, VOLUME)


def test_a_look_brings_technique_function_and_a_light_beside_the_eye() -> None:
    axis = np.linspace(-1.0, 1.0, 24)
    distance = np.sqrt(axis[:, None, None] ** 2 + axis[:, None] ** 2 + axis**2)
    ball = volviz.Volume((0.7 - distance).astype(np.float32))
    (first, *_) = volviz.looks(ball).values()
    by_name, by_look = (volviz.render(ball, look=look, size=(48, 48)) for look in ("best", first))
    by_hand = volviz.render(
        ball, first.technique, transfer_function=first.transfer_function, light_beside_eye=True,
        size=(48, 48), **first.settings,
    )  # fmt: skip
    assert np.array_equal(by_name, by_hand)
    assert np.array_equal(by_look, by_hand)
    left, right = by_hand[24, 8, :3].mean(), by_hand[24, 39, :3].mean()
    assert left > 1.2 * right > 0
    back = default_camera(ball, (48, 48), azimuth=180.0, transfer_function=first.transfer_function)
    behind = volviz.render(ball, look="best", size=(48, 48), camera=back)
    assert behind[24, 8, :3].mean() > 1.2 * behind[24, 39, :3].mean()
    red = volviz.render(ball, look="best", colors=((1.0, 0.0, 0.0),), specular=0.0, size=(48, 48))
    assert red[24, 24, 0] > 50 > red[24, 24, 1]


def test_a_look_is_refused_where_it_cannot_be() -> None:
    layers = [volviz.ImageLayer(VOLUME), volviz.ImageLayer(VOLUME)]
    for values, words in (
        ({"volume": VOLUME, "technique": "slicing", "look": "best"}, "a look brings technique and settings"),
        ({"volume": layers, "look": "best"}, "a look is made for one volume"),
        ({"volume": VOLUME, "look": "vein"}, "no look 'vein'"),
        ({"volume": VOLUME, "look": 3}, "look must be a name or one of volviz.looks, got int"),
    ):
        with pytest.raises(InputError, match=words):
            volviz.render(**values)


@pytest.mark.parametrize("thin", [0, 1, 2])
def test_with_a_look_a_stack_is_seen_from_the_face_of_its_slices(thin: int) -> None:
    shape = [24, 24, 24]
    shape[thin] = 3
    stack = volviz.Volume(np.random.default_rng(0).normal(100.0, 20.0, shape).astype(np.float32))
    look = volviz.looks(stack)["brightest"]
    seen = volviz.render(stack, look=look, size=(64, 64))[..., 3] > 0
    plain = volviz.render(stack, technique="raycast", transfer_function=look.transfer_function, size=(64, 64))
    assert seen.mean() > 0.4
    if thin == 0:
        assert (plain[..., 3] > 0).mean() < 0.6 * seen.mean()
