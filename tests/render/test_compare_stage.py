"""Sides of a comparison, drawn off-screen: pictures, times against another clock."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

import volviz
from tests.render.scenes import POINTS, blobs
from volviz.compare.pictures import compare_pictures
from volviz.compare.stage import Stage, View, nudged
from volviz.compare.timing import stage_timer
from volviz.errors import SettingError
from volviz.framing import default_camera


def small_view(size: tuple[int, int] = (120, 90)) -> View:
    volume = volviz.Volume(blobs(dtype=np.float32), name="blobs")
    function = volviz.TransferFunction.from_points(POINTS)
    return View(volume, function, default_camera(volume, size, transfer_function=function), size)


@pytest.fixture(scope="module")
def view() -> View:
    return small_view()


@pytest.fixture
def stages(view: View) -> Iterator[dict[str, Stage]]:
    made = {name: Stage(view, name, {"step": 0.5}) for name in ("raycast", "slicing")}
    yield made
    for stage in made.values():
        stage.close()


def test_a_stage_shows_what_render_draws(view: View, stages: dict[str, Stage]) -> None:
    for name, stage in stages.items():
        rendered = volviz.render(
            view.volume, name, transfer_function=view.transfer_function, camera=view.camera, size=view.size,
            background=(0, 0, 0), step=0.5,
        )  # fmt: skip
        np.testing.assert_array_equal(stage.picture(), rendered[..., :3])


def test_two_stages_side_by_side_are_nearly_equal_and_each_equals_itself(stages: dict[str, Stage]) -> None:
    raycast, slicing = stages["raycast"].picture(), stages["slicing"].picture()
    assert compare_pictures(raycast, slicing).psnr > 40
    assert compare_pictures(raycast, stages["raycast"].picture()).max_difference == 0


def test_the_picture_is_right_after_times_were_taken(stages: dict[str, Stage]) -> None:
    before = {name: stage.picture() for name, stage in stages.items()}
    for _ in stage_timer(stages, rounds=2).steps():
        pass
    for name, stage in stages.items():
        np.testing.assert_array_equal(before[name], stage.picture())


def test_frame_times_are_those_of_an_outside_clock(stages: dict[str, Stage]) -> None:
    timer = stage_timer(stages, rounds=3, warm_up=0)
    steps, outside = timer.steps(), 0.0
    for _ in range(6):
        begin = time.perf_counter()
        next(steps)
        outside += time.perf_counter() - begin
    inside = sum(sum(times.seconds) for times in timer.times.values())
    assert 0.9 * outside <= inside <= outside
    assert all(times.first and times.first > 0 for times in timer.times.values())


def test_the_gpu_clock_can_be_asked(view: View, stages: dict[str, Stage]) -> None:
    wall, gpu = stages["raycast"].draw_on_gpu_clock(nudged(view.camera, 3))
    assert 0 < gpu <= wall


def test_every_nudged_camera_is_a_new_one_about_the_old_one(view: View) -> None:
    cameras = [nudged(view.camera, frame) for frame in range(6)]
    assert len({camera.position for camera in cameras}) == 6
    assert all(camera.direction @ np.array(view.camera.direction) > 0.99 for camera in cameras)


def test_settings_change_between_frames(view: View, stages: dict[str, Stage]) -> None:
    coarse = stages["raycast"]
    fine = coarse.picture()
    coarse.update(step=4.0)
    assert compare_pictures(fine, coarse.picture()).max_difference > 2


def test_a_stage_with_an_unusable_setting_leaves_nothing_behind(view: View) -> None:
    with pytest.raises(SettingError):
        Stage(view, "raycast", {"steps": 3})


def test_the_background_is_under_the_picture(view: View) -> None:
    with Stage(replace(view, background=(1.0, 0.0, 0.0)), "raycast") as stage:
        assert (stage.picture()[0, 0] == (255, 0, 0)).all()
        assert stage.picture("float32")[0, 0].tolist() == [1.0, 0.0, 0.0]
