"""Many images from one OpenGL context: the same as one by one, tile by tile, in turns, given up half-way."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import volviz
from tests.render.scenes import camera, function, volume
from volviz.compare.distance_colors import colors_of
from volviz.custom_gl.arguments import spec_of
from volviz.custom_gl.registry import techniques
from volviz.errors import Cancelled, InputError, RenderError, SettingError
from volviz.kernels.marching import marching_cubes
from volviz.model.render_spec import View
from volviz.model.surface_values import DistanceColoring
from volviz.volume_data.array_source import ArraySource
from volviz.volume_data.references import VolumeKey, VolumeRef

SIZE = (120, 90)
OURS = [ident for ident, info in techniques().items() if not info.counterpart_of]


@pytest.fixture(scope="module")
def of() -> volviz.Volume:
    return volume()


@pytest.fixture
def renderer() -> Iterator[volviz.Renderer]:
    with volviz.Renderer(SIZE) as made:
        yield made


def alone(of: volviz.Volume, technique: str = "raycast", **values: Any) -> np.ndarray:
    return volviz.render(
        of, technique, **({"size": SIZE, "transfer_function": function(of), "camera": camera(of)} | values)
    )


def test_pictures_of_all_techniques_in_turn_are_those_drawn_alone(
    of: volviz.Volume, renderer: volviz.Renderer
) -> None:
    values = {"transfer_function": function(of), "camera": camera(of)}
    images = {ident: renderer.render(of, ident, **values) for ident in OURS}
    again = {ident: renderer.render(of, ident, **values) for ident in reversed(OURS)}
    for ident in OURS:
        expected = alone(of, ident)
        np.testing.assert_array_equal(images[ident], expected, err_msg=ident)
        np.testing.assert_array_equal(again[ident], expected, err_msg=ident)


def test_a_picture_holds_what_is_to_stand_around_the_volume(of: volviz.Volume) -> None:
    plain = alone(of)
    bare = alone(of, show=())
    np.testing.assert_array_equal(bare, plain)
    shown = alone(of, show=("box", "marker"), title="Head")
    assert shown[0:30, :, 3].max() == 255
    assert plain[0:10, 0:30, 3].max() == 0
    # tiles make the same picture
    values = {"transfer_function": function(of), "camera": camera(of), "show": "box,marker", "title": "Head"}
    with volviz.Renderer(SIZE, largest_tile=50) as renderer:
        tiled = renderer.render(of, **values)
    assert np.abs(tiled.astype(int) - shown).max() <= 3
    with pytest.raises(InputError, match="cannot show 'frame'"):
        alone(of, show="frame")


def test_every_value_of_a_picture_may_change_before_the_next(
    of: volviz.Volume, renderer: volviz.Renderer
) -> None:
    other = volume(np.int16, spacing=(0.9, 1.1, 1.4))
    for shown, values in (
        (of, {}),
        (of, {"background": "red", "step": 1.0}),
        (other, {"dtype": "float32", "camera": camera(other)}),
        (
            of,
            {"crop": (4.0, 25.0, 0.0, 20.0, 3.0, 26.0), "shading": True, "light_position": (80.0, 9.0, 3.0)},
        ),
        (of, {}),
    ):
        given = {"transfer_function": function(shown), "camera": camera(shown)} | values
        np.testing.assert_array_equal(renderer.render(shown, **given), alone(shown, **given))


def test_without_camera_and_function_the_pictures_are_those_of_render(
    of: volviz.Volume, renderer: volviz.Renderer
) -> None:
    np.testing.assert_array_equal(renderer.render(of), volviz.render(of, size=SIZE))


def test_another_size_from_now_on(of: volviz.Volume, renderer: volviz.Renderer) -> None:
    values = {"transfer_function": function(of), "camera": camera(of)}
    for size in (SIZE, (64, 100), (200, 40), SIZE):
        renderer.resize(size)
        assert renderer.size == size
        np.testing.assert_array_equal(renderer.render(of, **values), alone(of, size=size))


@pytest.mark.parametrize("size", [(0, 10), (10, 16385), (10,), "10x10"])
def test_impossible_sizes_are_refused(size: Any, renderer: volviz.Renderer) -> None:
    with pytest.raises(InputError, match="size must"):
        volviz.Renderer(size)
    with pytest.raises(InputError, match="size must"):
        renderer.resize(size)
    assert renderer.size == SIZE


def test_a_mistake_costs_a_picture_and_no_more(of: volviz.Volume, renderer: volviz.Renderer) -> None:
    with pytest.raises(SettingError):
        renderer.render(of, step=-1.0)
    expected = alone(of)
    for wrong in ({"step": -1.0}, {"crop": (100.0, 120.0, 0.0, 1.0, 0.0, 1.0)}, {"dtype": "int8"}):
        with pytest.raises(InputError):
            renderer.render(of, **wrong)
        np.testing.assert_array_equal(
            renderer.render(of, transfer_function=function(of), camera=camera(of)), expected
        )


def test_two_renderers_do_not_mix(of: volviz.Volume, renderer: volviz.Renderer) -> None:
    values = {"transfer_function": function(of), "camera": camera(of)}
    with volviz.Renderer((64, 64)) as other:
        for _ in range(2):
            np.testing.assert_array_equal(renderer.render(of, **values), alone(of))
            np.testing.assert_array_equal(
                other.render(of, "slicing", **values), alone(of, "slicing", size=(64, 64))
            )
    np.testing.assert_array_equal(renderer.render(of, **values), alone(of))


def test_a_closed_renderer_says_so(of: volviz.Volume) -> None:
    made = volviz.Renderer(SIZE)
    made.render(of)
    made.close()
    made.close()
    for use in (lambda: made.render(of), lambda: made.resize((10, 10)), lambda: made.is_software):
        with pytest.raises(RenderError, match="renderer is closed"):
            use()


def test_a_renderer_that_draws_nothing_opens_nothing() -> None:
    with volviz.Renderer(SIZE) as made:
        assert made.notice == ""


# ---------------------------------------------------------------------------------------- many images


def objects_of(renderer: volviz.Renderer) -> dict[str, int]:
    """Numbers of the OpenGL objects of each kind that have not been released, in the context of a renderer."""
    import moderngl

    gl = renderer._window_gpu().gpu.gl
    counted: dict[str, int] = {}
    for each in gc_objects():
        kind = type(each)
        if kind not in (moderngl.Texture, moderngl.Texture3D, moderngl.Buffer, moderngl.Framebuffer):
            continue
        if each.ctx is gl and not isinstance(each.mglo, moderngl.mgl.InvalidObject):
            counted[kind.__name__] = counted.get(kind.__name__, 0) + 1
    return counted


def gc_objects() -> list[Any]:
    import gc

    gc.collect()
    return gc.get_objects()


def test_a_hundred_pictures_leave_no_more_behind_than_three(of: volviz.Volume) -> None:
    values = {"transfer_function": function(of), "shading": True}
    with volviz.Renderer((32, 24)) as renderer:
        for turn in range(3):
            renderer.render(of, camera=camera(of, 40.0 * turn), **values)
        before, uploads = objects_of(renderer), renderer._window_gpu().gpu.uploads
        assert sum(before.values()) > 3
        seen = {renderer.render(of, camera=camera(of, 3.6 * turn), **values).tobytes() for turn in range(100)}
        assert len(seen) > 90
        assert objects_of(renderer) == before
        assert renderer._window_gpu().gpu.uploads == uploads


def test_volumes_and_techniques_that_are_gone_leave_nothing_behind() -> None:
    with volviz.Renderer((32, 24)) as renderer:
        counts = []
        for _ in range(4):
            for ident in ("raycast", "isosurface", "marching_cubes"):
                renderer.render(volume(), ident)
            counts.append(objects_of(renderer))
        assert counts[1] == counts[2] == counts[3]


# ---------------------------------------------------------------------------------------- tiles and turns


@pytest.mark.parametrize("technique", ["raycast", "slicing"])
@pytest.mark.parametrize("parallel", [False, True])
def test_tiles_make_the_picture_that_is_drawn_at_once(
    of: volviz.Volume, technique: str, parallel: bool
) -> None:
    values = {"transfer_function": function(of), "camera": camera(of, parallel=parallel), "dtype": "float32"}
    with volviz.Renderer(SIZE, largest_tile=50) as tiled:
        image = tiled.render(of, technique, **values)
        # the projection of a tile must not stay
        small = tiled.draw(
            spec_of(of, technique, transfer_function=function(of)),
            View(values["camera"], (50, 40)),
            dtype="float32",
        )
    whole = alone(of, technique, **values)
    assert whole[..., 3].max() > 0.3
    np.testing.assert_allclose(image[..., :3] * image[..., 3:], whole[..., :3] * whole[..., 3:], atol=2e-3)
    np.testing.assert_allclose(image[..., 3], whole[..., 3], atol=2e-3)
    np.testing.assert_array_equal(small, alone(of, technique, **(values | {"size": (50, 40)})))


@pytest.mark.parametrize("technique", ["raycast", "marching_cubes"])
def test_turns_make_the_picture_that_is_drawn_at_once(
    of: volviz.Volume, renderer: volviz.Renderer, technique: str
) -> None:
    spec = spec_of(of, technique, transfer_function=function(of))
    fractions, parts = [], []
    for fraction, part in renderer.turns(spec, View(camera(of), SIZE), seconds=0.001):
        fractions.append(fraction)
        parts += [part] if part is not None else []
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    [(region, pixels)] = parts
    assert region == (0, 0, *SIZE)
    assert pixels.dtype == np.float32
    whole = alone(of, technique, dtype="float32")
    np.testing.assert_allclose(pixels[..., 3], whole[..., 3], atol=2e-3)
    np.testing.assert_allclose(pixels[..., :3], whole[..., :3] * whole[..., 3:], atol=2e-3)
    # what follows is drawn at once again
    values = {"transfer_function": function(of), "camera": camera(of)}
    np.testing.assert_array_equal(renderer.render(of, technique, **values), alone(of, technique))


def test_progress_is_told_and_drawing_can_be_cancelled(of: volviz.Volume, renderer: volviz.Renderer) -> None:
    values = {"transfer_function": function(of), "camera": camera(of)}
    told: list[float] = []
    image = renderer.render(of, progress=told.append, **values)
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert np.abs(image.astype(int) - alone(of)).max() <= 1
    renderer.resize((600, 450))
    with pytest.raises(Cancelled):
        renderer.render(of, cancel=lambda: True, step=0.05, **values)
    renderer.resize(SIZE)
    np.testing.assert_array_equal(renderer.render(of, **values), alone(of))


def test_a_picture_that_is_given_up_leaves_nothing_behind(of: volviz.Volume) -> None:
    with volviz.Renderer(SIZE) as renderer:
        turns = renderer.turns(spec_of(of, step=0.05), View(camera(of), (600, 450)), seconds=0.001)
        assert next(turns)[0] < 1.0
        turns.close()


# ---------------------------------------------------------------------------------------- layers


def test_an_image_layer_gives_the_picture_of_its_volume(of: volviz.Volume, renderer: volviz.Renderer) -> None:
    values = {"camera": camera(of)}
    plain = alone(of, transfer_function=None)
    np.testing.assert_array_equal(renderer.render(volviz.ImageLayer(of), **values), plain)
    hidden = volviz.ImageLayer(volume(), visible=False)
    np.testing.assert_array_equal(renderer.render([hidden, volviz.ImageLayer(of)], **values), plain)
    layer = volviz.ImageLayer(of, function(of))
    np.testing.assert_array_equal(volviz.render(layer, size=SIZE, **values), alone(of))
    source = ArraySource(np.stack((of.array // 2, of.array)), spacing=of.spacing, origin=of.origin)
    later = volviz.ImageLayer(source, function(of), time=1)
    np.testing.assert_array_equal(renderer.render(later, **values), alone(of))
    np.testing.assert_array_equal(
        renderer.render(ArraySource(of), transfer_function=function(of), **values), alone(of)
    )


def test_colour_window_and_opacity_of_a_layer_are_a_transfer_function(
    of: volviz.Volume, renderer: volviz.Renderer
) -> None:
    low, high = of.range
    window = (low + 0.2 * (high - low), high)
    ramp = volviz.TransferFunction.from_points([(window[0], (0, 1, 0, 0)), (window[1], (0, 1, 0, 1))])
    layer = volviz.ImageLayer(of, color=(0.0, 1.0, 0.0), window=window, opacity=0.5)
    np.testing.assert_array_equal(
        renderer.render(layer, camera=camera(of)), alone(of, transfer_function=ramp.with_opacity(0.5))
    )
    white = volviz.ImageLayer(of, window=window)
    gray = volviz.TransferFunction.from_points([(window[0], (1, 1, 1, 0)), (window[1], (1, 1, 1, 1))])
    np.testing.assert_array_equal(
        renderer.render(white, camera=camera(of)), alone(of, transfer_function=gray)
    )


def test_references_are_looked_up(of: volviz.Volume, renderer: volviz.Renderer) -> None:
    ref = VolumeRef("array:1")
    spec = spec_of(volviz.ImageLayer(ref, function(of)))
    view = View(camera(of), SIZE)
    with pytest.raises(InputError, match="array:1 has not been read"):
        renderer.draw(spec, view)
    np.testing.assert_array_equal(renderer.draw(spec, view, {VolumeKey(ref): of}), alone(of))
    other = volume(np.int16)
    np.testing.assert_array_equal(
        renderer.draw(spec, view, {VolumeKey(ref): other}),
        alone(other, transfer_function=function(of), camera=camera(of)),
    )  # fmt: skip


# ---------------------------------------------------------------------------------------- distances of surfaces


def test_a_surface_is_coloured_by_its_distance_to_another_one(
    of: volviz.Volume, renderer: volviz.Renderer
) -> None:
    low, high = of.range
    inner, outer = (low + share * (high - low) for share in (0.5, 0.25))
    other = techniques()["marching_cubes"].settings(isovalue=outer)
    request = DistanceColoring("marching_cubes", other, signed=True)
    values = {"camera": camera(of), "isovalue": inner}
    colors = colors_of(spec_of(of, "marching_cubes", isovalue=inner, surface_colors=request))
    colored = renderer.render(of, "marching_cubes", surface_colors=colors, **values)
    plain = renderer.render(of, "marching_cubes", **values)
    assert len(marching_cubes(of.array, inner)[1]) > 0
    np.testing.assert_array_equal(plain[..., 3], colored[..., 3])
    seen = colored[plain[..., 3] > 200].astype(int)
    # the inner surface lies inside of the outer one everywhere: blue
    assert (seen[:, 2] > seen[:, 0]).mean() > 0.95
    with pytest.raises(InputError, match="draws no mesh"):
        colors_of(spec_of(of, "raycast", surface_colors=request))
