"""Movies as values: what lies between two scenes, moves, words, timelines, files."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from volviz.custom_gl.registry import known_settings, technique
from volviz.errors import InputError
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.layers import ImageLayer
from volviz.model.light import Light
from volviz.model.movie import Movie, Step, Surroundings
from volviz.model.movies.camera_path import CameraPath
from volviz.model.movies.interpolation import between
from volviz.model.movies.moves import Cut, Fade, KeyFrame, Play, Scroll, Swing, Turn, Vary, Zoom, direction_of
from volviz.model.movies.timeline import Timeline
from volviz.model.movies.words import EXAMPLES, steps_of, words_of
from volviz.model.scene import Scene, SceneView
from volviz.model.session import scene_from_dict, scene_to_dict
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.references import VolumeRef

CAMERA = Camera((0.0, -10.0, 0.0), (0.0, 0.0, 0.0))
ABOUT = Surroundings(lambda name: technique(name).settings, (-1.0, 1.0, -2.0, 2.0, -3.0, 3.0), 5)


def scene(**changes: object) -> Scene:
    view = SceneView("isosurface", camera=CAMERA)
    return replace(Scene((ImageLayer(VolumeRef("a.nrrd")),), views=(view,)), **changes)


def filmed(*steps: Step[Scene], fps: int = 10, start: Scene | None = None) -> Timeline:
    return Timeline(replace(start or scene(), movie=Movie(steps, fps)), ABOUT)


# ---------------------------------------------------------------------- between two values


def test_ends_are_the_values_themselves() -> None:
    start, end = scene(), scene(light=Light(False, (1.0, 2.0, 3.0)), background=(0.0, 0.5, 1.0))
    assert between(start, end, 0.0) is start
    assert between(start, end, 1.0) is end


def test_numbers_pass_evenly_and_choices_are_switched() -> None:
    kind = technique("raycast").settings
    start, end = kind(step=0.25, ambient=0.0, mode="composite"), kind(step=1.0, ambient=0.4, mode="maximum")
    early, late = between(start, end, 0.25), between(start, end, 0.75)
    assert early.ambient == pytest.approx(0.1)
    assert (early.mode, late.mode) == ("composite", "maximum")
    assert 0.25 < early.step < late.step < 1.0


def test_layers_that_come_fade_in() -> None:
    hidden = scene(layers=(ImageLayer(VolumeRef("a.nrrd"), opacity=0.8, visible=False),))
    seen = scene(layers=(ImageLayer(VolumeRef("a.nrrd"), opacity=0.8),))
    (layer,) = between(hidden, seen, 0.5).layers
    assert layer.visible
    assert layer.opacity == pytest.approx(0.4)
    (layer,) = between(seen, hidden, 0.75).layers
    assert layer.opacity == pytest.approx(0.2)


def test_clip_planes_and_crop_boxes_move() -> None:
    start = Clipping((0, 10, 0, 10, 0, 10), (((0, 0, 0), (1, 0, 0)),))
    end = Clipping((0, 20, 4, 10, 0, 10), (((2, 0, 0), (0, 1, 0)),))
    middle = between(start, end, 0.5)
    assert middle.crop == (0, 15, 2, 10, 0, 10)
    ((origin, normal),) = middle.planes
    assert origin == (1.0, 0.0, 0.0)
    np.testing.assert_allclose(normal, (np.sqrt(0.5), np.sqrt(0.5), 0.0))


def test_functions_with_the_same_shape_move_their_points() -> None:
    def peak(at: float) -> TransferFunction:
        rows = [(at - 10, (1, 0, 0, 0)), (at, (1, 0, 0, 1)), (at + 10, (1, 0, 0, 0))]
        return TransferFunction.from_points(rows)

    middle = between(peak(50.0), peak(150.0), 0.5)
    assert middle.evaluate(100.0)[3] == pytest.approx(1.0)
    assert middle.evaluate(50.0)[3] == pytest.approx(0.0)


def test_other_functions_are_mixed_value_by_value_and_keep_jumps() -> None:
    step = TransferFunction.from_points(
        [(0, (0, 0, 0, 0)), (50, (0, 0, 0, 0)), (50, (1, 1, 1, 1)), (100, (1, 1, 1, 1))]
    )
    ramp = TransferFunction.from_points([(20, (1, 0, 0, 0.0)), (80, (1, 0, 0, 0.6))])
    for fraction in (0.25, 0.5, 0.9):
        mixed = between(step, ramp, fraction)
        values = np.array([10.0, 30.0, 49.999, 50.0, 70.0, 99.0])
        expected = (1 - fraction) * step.evaluate(values) + fraction * ramp.evaluate(values)
        np.testing.assert_allclose(mixed.evaluate(values), expected, atol=1e-4)


def test_a_camera_turns_the_short_way_at_even_speed() -> None:
    start, end = CAMERA, CAMERA.rotated((0.0, 0.0, 1.0), 90.0)
    middle = between(start, end, 1 / 3)
    np.testing.assert_allclose(middle.position, CAMERA.rotated((0.0, 0.0, 1.0), 30.0).position, atol=1e-9)
    assert middle.distance == pytest.approx(10.0)


def test_distances_pass_by_factors() -> None:
    far = replace(CAMERA, position=(0.0, -40.0, 0.0))
    assert between(CAMERA, far, 0.5).distance == pytest.approx(20.0)


def test_a_path_goes_through_its_places_without_a_jerk() -> None:
    places = [CAMERA.rotated((0.0, 0.0, 1.0), angle) for angle in (0.0, 40.0, 100.0, 130.0)]
    path = CameraPath(places, [0.0, 1.0, 2.0, 3.0])
    for moment, place in enumerate(places):
        assert path.at(moment) == place
    moments = np.linspace(0.0, 3.0, 301)
    directions = np.array([path.at(t).direction for t in moments])
    speed = np.linalg.norm(np.diff(directions, axis=0), axis=1)
    assert np.abs(np.diff(speed)).max() < 0.05 * speed.max()


# ---------------------------------------------------------------------- moves


def test_a_whole_turn_comes_back_to_the_bit() -> None:
    start = scene()
    assert Turn(360.0, "z").at(start, 1.0, ABOUT) == start
    quarter = Turn(360.0, "z").at(start, 0.25, ABOUT).view.camera
    np.testing.assert_allclose(quarter.position, (10.0, 0.0, 0.0), atol=1e-9)
    assert Turn(720.0).closes
    assert not Turn(90.0).closes


def test_a_turn_about_a_slanted_axis_keeps_its_distance() -> None:
    turned = Turn(77.0, (1.0, 1.0, 0.0)).at(scene(), 0.5, ABOUT).view.camera
    assert turned.distance == pytest.approx(10.0)
    axis = np.array([1.0, 1.0, 0.0]) / np.sqrt(2)
    assert np.dot(turned.position, axis) == pytest.approx(np.dot(CAMERA.position, axis))


def test_a_swing_comes_back() -> None:
    start = scene()
    swing = Swing(60.0, "z")
    assert swing.at(start, 1.0, ABOUT) == start
    np.testing.assert_allclose(
        swing.at(start, 0.25, ABOUT).view.camera.position, CAMERA.rotated((0, 0, 1), 30.0).position, atol=1e-9
    )


def test_zoom_comes_nearer() -> None:
    assert Zoom(4.0).at(scene(), 0.5, ABOUT).view.camera.distance == pytest.approx(5.0)
    with pytest.raises(InputError, match="greater than 0"):
        Zoom(0.0)


def test_a_cut_takes_away_what_it_has_passed() -> None:
    cut = Cut("x")
    assert cut.at(scene(), 0.0, ABOUT) == scene()
    ((origin, normal),) = cut.at(scene(), 0.5, ABOUT).clipping.planes
    assert origin[0] == pytest.approx(0.0)
    assert normal == (1.0, 0.0, 0.0)
    ((origin, _),) = cut.at(scene(), 1.0, ABOUT).clipping.planes
    assert origin[0] == pytest.approx(1.0)


def test_sides_of_the_picture_depend_on_who_looks() -> None:
    np.testing.assert_allclose(direction_of("right", CAMERA), (1.0, 0.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(direction_of("front", CAMERA), (0.0, -1.0, 0.0), atol=1e-12)
    assert direction_of("superior", CAMERA) == (0.0, 0.0, 1.0)
    with pytest.raises(InputError, match="one of"):
        direction_of("sideways", CAMERA)


def test_time_passes_through_all_points_once() -> None:
    times = [Play(0, 4).at(scene(), k / 10, ABOUT).layers[0].time for k in range(11)]
    assert times == [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
    with pytest.raises(InputError, match="from 0 to 4"):
        Play(0, 9).at(scene(), 0.5, ABOUT)
    with pytest.raises(InputError, match="one time point"):
        Play().at(scene(), 0.5, replace(ABOUT, times=1))


def test_an_isovalue_goes_from_one_value_to_another() -> None:
    moved = Vary("isovalue", 90.0, 30.0).at(scene(), 0.5, ABOUT)
    assert dict(moved.view.settings)["isosurface"].isovalues == (60.0,)
    with pytest.raises(InputError, match="from which value"):
        Vary("isovalue", 90.0).at(scene(), 0.5, ABOUT)
    with pytest.raises(InputError, match="no setting called"):
        Vary("isovolume", 90.0).at(scene(), 0.5, ABOUT)


def test_layers_appear_and_slices_scroll() -> None:
    assert Fade(0).at(scene(), 0.5, ABOUT).layers[0].opacity == pytest.approx(0.5)
    assert not Fade(0).at(scene(), 0.0, ABOUT).layers[0].visible
    with pytest.raises(InputError, match="no layer 3"):
        Fade(3).at(scene(), 0.5, ABOUT)
    assert Scroll("z").at(scene(), 0.25, ABOUT).cursor == pytest.approx((0.0, 0.0, -1.5))


# ---------------------------------------------------------------------- words


@pytest.mark.parametrize("text", EXAMPLES)
def test_examples_are_understood_and_said_again(text: str) -> None:
    (step,) = steps_of(text)
    assert step.seconds > 0
    for move in step.moves:
        (again,) = steps_of(words_of(move))
        assert again.moves == (move,)


def test_a_sentence_of_several_steps() -> None:
    first, second, third = steps_of(
        "Turn 360 degrees about z in 8 s, then cut from left to right and zoom in by 2 in 4 s; hold 1 s."
    )
    assert first == Step((Turn(360.0, "z"),), 8.0, "even")
    assert second == Step((Cut("right"), Zoom(2.0)), 4.0, "gentle")
    assert third == Step((), 1.0, "gentle")


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("dance in 3 s", "'dance in 3 s' is no move"),
        ("cut from left to top", "opposite"),
        ("turn 90 degrees in 2 s and zoom in by 2 in 3 s", "two lengths"),
        ("", "at least one move"),
        ("turn 90 degrees in 0 s", "more than 0 s"),
    ],
)
def test_what_is_no_movie_is_said(text: str, match: str) -> None:
    with pytest.raises(InputError, match=match):
        steps_of(text)


# ---------------------------------------------------------------------- timelines


def test_frames_of_a_loop_do_not_repeat_the_first() -> None:
    line = filmed(Step((Turn(360.0, "z"),), 1.2, "even"))
    cameras = [line.frame(n).view.camera for n in range(line.movie.frame_count)]
    assert len(cameras) == 12
    for number, camera in enumerate(cameras):
        np.testing.assert_allclose(
            camera.position, CAMERA.rotated((0, 0, 1), 30.0 * number).position, atol=1e-9
        )


def test_other_movies_show_both_ends() -> None:
    line = filmed(Step((Turn(90.0, "z"),), 1.0))
    last = line.frame(line.movie.frame_count - 1).view.camera
    np.testing.assert_allclose(last.position, (10.0, 0.0, 0.0), atol=1e-9)


def test_a_step_begins_where_the_one_before_ended() -> None:
    line = filmed(Step((Turn(90.0, "z"),), 1.0), Step((Cut("x"),), 2.0, "even"))
    middle = line.at(2.0)
    np.testing.assert_allclose(middle.view.camera.position, (10.0, 0.0, 0.0), atol=1e-9)
    assert middle.clipping.planes[0][0][0] == pytest.approx(0.0)


def test_key_frames_on_a_path_are_not_stopped_at() -> None:
    ends = [scene().with_camera(CAMERA.rotated((0, 0, 1), angle)) for angle in (0.0, 40.0, 90.0)]
    line = filmed(*(Step((KeyFrame(end),), 1.0, "path") for end in ends))
    assert line.at(1.0).view.camera == ends[1].view.camera
    just = [np.array(line.at(1.0 + t).view.camera.position) for t in (-0.01, 0.0, 0.01)]
    before, after = just[1] - just[0], just[2] - just[1]
    assert np.linalg.norm(before) > 0.03
    np.testing.assert_allclose(after, before, rtol=0.2, atol=0.02)
    gentle = filmed(*(Step((KeyFrame(end),), 1.0) for end in ends))
    assert (
        np.linalg.norm(np.subtract(gentle.at(0.99).view.camera.position, gentle.at(1.0).view.camera.position))
        < 0.005
    )


def test_a_movie_without_steps_is_none() -> None:
    with pytest.raises(InputError, match="nothing happens"):
        filmed()


def test_a_key_frame_at_the_beginning_is_where_the_movie_begins() -> None:
    first, second = (scene(background=(grey, grey, grey)) for grey in (0.2, 0.6))
    line = filmed(Step((KeyFrame(first),), 5.0), Step((KeyFrame(second),), 1.0, "even"))
    assert line.movie.seconds == 1.0
    assert line.at(0.0).background == (0.2, 0.2, 0.2)
    assert line.at(0.5).background == pytest.approx((0.4, 0.4, 0.4))
    with pytest.raises(InputError, match="nothing happens"):
        filmed(Step((KeyFrame(first),), 5.0))


def test_movies_are_limited() -> None:
    with pytest.raises(InputError, match="frames a second"):
        Movie(fps=0)
    with pytest.raises(InputError, match="a day"):
        Step(seconds=1e9)


# ---------------------------------------------------------------------- files


def test_a_session_keeps_its_movie() -> None:
    later = scene(background=(0.1, 0.2, 0.3))
    steps = (
        Step((Turn(360.0, (0.0, 0.6, 0.8)), Zoom(1.5)), 3.0, "even"),
        Step((Cut("left", 1.0, 0.0), Vary("isovalue", 5.0), Fade(0, appears=False)), 2.0),
        Step((Play(1, 3), Scroll("superior"), Swing(20.0)), 2.0),
        Step((KeyFrame(later, "end"),), 1.0, "path"),
    )
    kept = scene(movie=Movie(steps, 30, "A film", stamp=True))
    assert scene_from_dict(scene_to_dict(kept), known_settings) == kept


def test_sessions_without_movies_have_none() -> None:
    data = scene_to_dict(scene())
    del data["movie"]
    read = partial(scene_from_dict, settings_of=known_settings)
    assert read({**data, "version": 3}).movie == Movie()
