"""The store: equal values, the history, and gestures of which several run at once."""

from __future__ import annotations

from dataclasses import replace

import pytest

from volviz.custom_gl.registry import technique
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.layers import ImageLayer
from volviz.model.light import Light
from volviz.model.scene import Scene, SceneView
from volviz.model.store import Store
from volviz.volume_data.references import VolumeRef

CAMERA = Camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0))
FAR = replace(CAMERA, position=(0.0, 0.0, 9.0))


@pytest.fixture
def store() -> Store:
    layer = ImageLayer(VolumeRef("array:1"))
    return Store(Scene(layers=(layer,), views=(SceneView(camera=CAMERA),)))


def set_opacity(store: Store, opacity: float, gesture: str | None = None) -> None:
    store.update(lambda scene: scene.with_layer(opacity=opacity), label="Opacity", gesture=gesture)


def set_light(store: Store, x: float, gesture: str | None = None) -> None:
    light = Light(headlight=False, position=(x, 0.0, 0.0))
    store.update(lambda scene: replace(scene, light=light), label="Light", gesture=gesture)


def move_camera(store: Store, camera: Camera) -> None:
    store.update(lambda scene: scene.with_camera(camera), label="Camera", record=False)


def opacity(store: Store) -> float:
    layer = store.scene.layer
    assert layer is not None
    return layer.opacity


# ------------------------------------------------------------------ equal values


def test_settings_that_are_set_again_in_another_order_change_nothing(store: Store) -> None:
    ray, surface = technique("raycast").settings, technique("isosurface").settings
    wide, shiny = ray(step=2.0), surface(isovalues=(0.5,))
    store.update(lambda scene: scene.with_view(settings=SceneView().with_settings("raycast", wide).settings))
    both = store.scene.view.with_settings("isosurface", shiny)
    store.update(lambda scene: scene.with_view(settings=both.settings))
    told: list[object] = []
    store.changed.connect(lambda *scenes: told.append(scenes))
    store.history_changed.connect(lambda: told.append("history"))
    assert not store.update(
        lambda scene: scene.with_view(settings=scene.view.with_settings("raycast", wide).settings)
    )
    assert told == []
    assert (
        SceneView().with_settings("isosurface", shiny).with_settings("raycast", wide).settings
        == both.settings
    )


def test_defaults_are_the_same_as_no_settings() -> None:
    kind = technique("raycast").settings
    assert SceneView().with_settings("raycast", kind()) == SceneView()
    assert (
        SceneView().with_settings("raycast", kind(step=2.0)).with_settings("raycast", kind()) == SceneView()
    )


def test_hints_in_another_order_name_the_same_volume() -> None:
    assert VolumeRef("a", (("time", 1), ("channel", 2))) == VolumeRef("a", (("channel", 2), ("time", 1)))


def test_a_drag_that_ends_where_it_began_leaves_no_step(store: Store) -> None:
    store.begin_gesture("drag")
    set_opacity(store, 0.5, "drag")
    move_camera(store, FAR)
    set_opacity(store, 1.0, "drag")
    store.end_gesture("drag")
    assert store.undo_label is None
    assert store.scene.view.camera == FAR


# ------------------------------------------------------------------ gestures


def test_what_is_changed_in_a_gesture_is_one_step(store: Store) -> None:
    store.begin_gesture("drag")
    for value in (0.9, 0.7, 0.5):
        set_opacity(store, value, "drag")
    store.end_gesture("drag")
    set_opacity(store, 0.2, "drag")  # not running: a step of its own
    store.undo()
    assert opacity(store) == 0.5
    store.undo()
    assert opacity(store) == 1.0
    assert store.undo_label is None
    store.redo()
    assert opacity(store) == 0.5


def test_the_end_of_another_gesture_does_not_cut_a_drag_in_two(store: Store) -> None:
    store.begin_gesture("wheel")
    store.begin_gesture("drag")
    set_opacity(store, 0.7, "drag")
    store.end_gesture("wheel")
    move_camera(store, FAR)
    set_opacity(store, 0.5, "drag")
    store.end_gesture("drag")
    store.undo()
    assert opacity(store) == 1.0
    assert store.undo_label is None
    assert store.scene.view.camera == FAR


def test_cancelling_takes_the_whole_gesture_back_and_keeps_the_camera(store: Store) -> None:
    store.begin_gesture("wheel")
    store.begin_gesture("drag")
    set_opacity(store, 0.7, "drag")
    store.end_gesture("wheel")
    move_camera(store, FAR)
    set_opacity(store, 0.5, "drag")
    store.cancel_gesture("drag")
    assert opacity(store) == 1.0
    assert store.scene.view.camera == FAR
    assert store.undo_label is None
    assert store.redo_label is None


def test_two_gestures_at_once_are_two_steps(store: Store) -> None:
    store.begin_gesture("light")
    set_light(store, 1.0, "light")
    store.begin_gesture("drag")
    set_opacity(store, 0.7, "drag")
    set_light(store, 2.0, "light")
    set_opacity(store, 0.5, "drag")
    store.end_gesture("light")
    store.end_gesture("drag")
    assert (store.scene.light.position, opacity(store)) == ((2.0, 0.0, 0.0), 0.5)
    store.undo()
    assert (store.scene.light.position, opacity(store)) == ((2.0, 0.0, 0.0), 1.0)
    store.undo()
    assert (store.scene.light, opacity(store)) == (Light(), 1.0)
    assert store.undo_label is None
    store.redo()
    store.redo()
    assert (store.scene.light.position, opacity(store)) == ((2.0, 0.0, 0.0), 0.5)


@pytest.mark.parametrize("cancelled", ["light", "drag"])
def test_cancelling_one_of_two_gestures_keeps_the_other(store: Store, cancelled: str) -> None:
    store.begin_gesture("light")
    set_light(store, 1.0, "light")
    store.begin_gesture("drag")
    set_opacity(store, 0.5, "drag")
    set_light(store, 2.0, "light")
    store.cancel_gesture(cancelled)
    assert store.is_interacting
    lit, dim = store.scene.light == Light(headlight=False, position=(2.0, 0.0, 0.0)), opacity(store) == 0.5
    assert (lit, dim) == ((False, True) if cancelled == "light" else (True, False))
    store.undo()
    assert (store.scene.light, opacity(store)) == (Light(), 1.0)
    assert store.undo_label is None


def test_a_step_between_keeps_what_it_changed_when_the_drag_goes_on(store: Store) -> None:
    store.begin_gesture("drag")
    set_opacity(store, 0.7, "drag")
    store.update(lambda scene: scene.with_view_count(2), label="Two views")
    set_opacity(store, 0.5, "drag")
    store.update(lambda scene: replace(scene, clipping=Clipping(crop=(0, 1, 0, 1, 0, 1))), label="Crop")
    set_opacity(store, 0.3, "drag")
    store.end_gesture("drag")
    store.undo()
    assert (opacity(store), store.scene.clipping, len(store.scene.views)) == (0.3, Clipping(), 2)
    store.undo()
    assert (opacity(store), len(store.scene.views)) == (0.3, 1)
    store.undo()
    assert opacity(store) == 1.0


def test_changes_that_do_not_go_together_leave_a_scene_that_can_be_shown(store: Store) -> None:
    """Two gestures move both ends of the same crop box past each other."""
    store.begin_gesture("low")
    store.begin_gesture("high")
    for low, high, key in ((0, 9, "low"), (0, 2, "high"), (1, 2, "low"), (1, 7, "high"), (5, 7, "low")):
        crop = (float(low), float(high), 0.0, 9.0, 0.0, 9.0)
        store.update(lambda scene, crop=crop: replace(scene, clipping=Clipping(crop=crop)), gesture=key)
    store.end_gesture("low")
    store.end_gesture("high")
    assert store.scene.clipping.crop == (5.0, 7.0, 0.0, 9.0, 0.0, 9.0)
    while store.undo():
        pass
    assert store.scene.clipping == Clipping()


def test_undo_in_the_middle_of_a_drag_leaves_the_rest_of_it_a_step(store: Store) -> None:
    store.begin_gesture("drag")
    set_opacity(store, 0.7, "drag")
    store.undo()
    assert opacity(store) == 1.0
    set_opacity(store, 0.5, "drag")
    store.cancel_gesture("drag")
    assert opacity(store) == 1.0
    assert store.undo_label is None


def test_the_store_says_when_the_first_gesture_begins_and_the_last_ends(store: Store) -> None:
    told: list[bool] = []
    store.interaction_changed.connect(told.append)
    store.end_gesture("nothing")
    store.begin_gesture("a")
    store.begin_gesture("a")
    store.begin_gesture("b")
    store.end_gesture("a")
    store.cancel_gesture("c")
    assert told == [True]
    assert store.is_interacting
    assert store.has_gesture("b")
    store.cancel_gesture("b")
    assert told == [True, False]
    assert not store.is_interacting
