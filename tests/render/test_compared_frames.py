"""Sides of a comparison, drawn off-screen: images, times against another clock."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace

import numpy as np
import pytest

import volviz
from tests.render.scenes import POINTS, blobs
from volviz.compare.image_metrics import compare_images
from volviz.compare.timing import Drawn, frame_timer, nudged
from volviz.custom_gl.arguments import spec_of
from volviz.custom_gl.framing import default_camera
from volviz.model.render_spec import RenderSpec, View

SIZE = (120, 90)


@dataclass(frozen=True)
class Scene:
    """A volume, its function, and from where it is seen."""

    volume: volviz.Volume
    function: volviz.TransferFunction
    view: View

    def spec(self, technique: str, **values: object) -> RenderSpec:
        return spec_of(self.volume, technique, transfer_function=self.function, **values)


@pytest.fixture(scope="module")
def scene() -> Scene:
    volume = volviz.Volume(blobs(dtype=np.float32), name="blobs")
    function = volviz.TransferFunction.from_points(POINTS)
    camera = default_camera(volume, SIZE, transfer_function=function)
    return Scene(volume, function, View(camera, SIZE, (0.0, 0.0, 0.0)))


@pytest.fixture
def sides(scene: Scene) -> Iterator[dict[str, Drawn]]:
    with ExitStack() as stack:
        yield {
            name: Drawn.first(
                stack.enter_context(volviz.Renderer(SIZE)), scene.spec(name, step=0.5), scene.view
            )
            for name in ("raycast", "slicing")
        }


def image(side: Drawn) -> np.ndarray:
    return side.renderer.draw(side.spec, side.view)[..., :3]


def test_two_sides_are_nearly_equal_and_each_equals_itself(sides: dict[str, Drawn]) -> None:
    raycast, slicing = image(sides["raycast"]), image(sides["slicing"])
    assert compare_images(raycast, slicing).psnr > 40
    assert compare_images(raycast, image(sides["raycast"])).max_difference == 0


def test_the_picture_is_right_after_times_were_taken(scene: Scene, sides: dict[str, Drawn]) -> None:
    for _ in frame_timer(sides, rounds=2).steps():
        pass
    for name, side in sides.items():
        rendered = volviz.render(
            scene.volume, name, transfer_function=scene.function, camera=scene.view.camera, size=SIZE,
            background=(0, 0, 0), step=0.5,
        )  # fmt: skip
        np.testing.assert_array_equal(image(side), rendered[..., :3])


def test_frame_times_are_those_of_an_outside_clock(sides: dict[str, Drawn]) -> None:
    timer = frame_timer(sides, rounds=3, warm_up=0)
    steps, outside = timer.steps(), 0.0
    for _ in range(6):
        begin = time.perf_counter()
        next(steps)
        outside += time.perf_counter() - begin
    inside = sum(sum(times.seconds) for times in timer.times.values())
    assert 0.9 * outside <= inside <= outside
    assert all(times.first and times.first > 0 for times in timer.times.values())


def test_the_gpu_clock_can_be_asked(scene: Scene, sides: dict[str, Drawn]) -> None:
    turned = replace(scene.view, camera=nudged(scene.view.camera, 3))
    wall, gpu = sides["raycast"].renderer.timed(sides["raycast"].spec, turned, on_gpu_clock=True)
    assert gpu is not None
    assert 0 < gpu <= wall
    assert sides["raycast"].renderer.timed(sides["raycast"].spec, scene.view, on_gpu_clock=False)[1] is None


def test_every_nudged_camera_is_a_new_one_about_the_old_one(scene: Scene) -> None:
    camera = scene.view.camera
    cameras = [nudged(camera, frame) for frame in range(6)]
    assert len({each.position for each in cameras}) == 6
    assert all(each.direction @ np.array(camera.direction) > 0.99 for each in cameras)


def test_settings_change_between_frames(scene: Scene, sides: dict[str, Drawn]) -> None:
    side = sides["raycast"]
    coarse = replace(side, spec=scene.spec("raycast", step=4.0))
    assert compare_images(image(side), image(coarse)).max_difference > 2


def test_the_background_is_under_the_picture(scene: Scene, sides: dict[str, Drawn]) -> None:
    red = replace(sides["raycast"], view=replace(scene.view, background=(1.0, 0.0, 0.0)))
    assert (image(red)[0, 0] == (255, 0, 0)).all()
    exact = red.renderer.draw(red.spec, red.view, dtype="float32")
    assert exact[0, 0].tolist() == [1.0, 0.0, 0.0, 1.0]
