"""Edits of the views of a scene: values in, values out."""

from __future__ import annotations

from dataclasses import replace

import pytest

from volviz.errors import InputError
from volviz.model.comparison import Comparison
from volviz.model.scene import Scene, SceneView
from volviz.model.view_edits import (
    with_active,
    with_comparison,
    with_counterpart,
    with_mode,
    with_next_active,
    with_pair_swapped,
    with_side,
    with_views,
)


def scene_of(*techniques: str, active: int = 0, **comparison: object) -> Scene:
    """A scene with a view for each technique."""
    return Scene(
        views=tuple(SceneView(technique) for technique in techniques),
        active=active,
        comparison=Comparison(**comparison),  # type: ignore[arg-type]
    )


def techniques_of(scene: Scene) -> list[str]:
    return [view.technique for view in scene.views]


def test_new_views_begin_as_the_active_one_and_more_than_two_come_side_by_side() -> None:
    scene = scene_of("a", "b", active=1, mode="wipe")
    four = with_views(scene, 4)
    assert techniques_of(four) == ["a", "b", "b", "b"]
    assert four.comparison.mode == "side_by_side"
    assert with_views(scene, 2).comparison.mode == "wipe"
    assert techniques_of(with_views(four, 1)) == ["a"]


def test_a_counterpart_stands_beside_the_active_view() -> None:
    scene = with_counterpart(scene_of("a", "b", "c", active=1), "vtk")
    assert techniques_of(scene) == ["b", "vtk"]
    assert scene.active_index == 0
    assert scene.pair == (0, 1)


def test_a_and_b_change_places_and_nothing_else_does() -> None:
    scene = scene_of("a", "b", "c", pair=(2, 0))
    swapped = with_pair_swapped(scene)
    assert techniques_of(swapped) == ["c", "b", "a"]
    assert swapped.pair == scene.pair
    assert with_pair_swapped(swapped) == scene
    assert with_pair_swapped(scene_of("a")) == scene_of("a")


def test_the_next_view_is_the_next_of_those_that_are_seen() -> None:
    scene = scene_of("a", "b", "c")
    assert [s.active_index for s in (with_next_active(scene), with_next_active(with_active(scene, 2)))] == [
        1,
        0,
    ]
    overlaid = scene_of("a", "b", "c", active=0, mode="blink", pair=(2, 0))
    assert with_next_active(overlaid).active_index == 2
    assert with_next_active(with_next_active(overlaid)).active_index == 0


def test_no_view_beyond_the_last_one_becomes_active() -> None:
    assert with_active(scene_of("a", "b"), 7).active_index == 1


def test_a_mode_that_hides_the_active_view_makes_another_one_active() -> None:
    scene = scene_of("a", "b", "c", active=2)
    assert with_mode(scene, "wipe").active_index == 0
    assert with_mode(scene, "side_by_side").active_index == 2
    assert with_mode(with_active(scene, 1), "difference").active_index == 1


def test_a_side_is_given_to_a_view_and_the_two_may_exchange_letters() -> None:
    scene = scene_of("a", "b", "c")
    assert with_side(scene, 1, 2).pair == (0, 2)
    assert with_side(scene, 0, 1).pair == (1, 0)
    assert with_side(scene, 0, 3) == scene
    assert with_side(scene_of("a"), 0, 0) == scene_of("a")
    wiped = replace(with_mode(scene, "wipe"), active=0)
    assert with_side(wiped, 0, 2).active_index == 2


def test_a_comparison_refuses_what_its_fields_do_not_take() -> None:
    assert with_comparison(scene_of("a", "b"), divider=0.25).comparison.divider == 0.25
    with pytest.raises(InputError, match="divider"):
        with_comparison(scene_of("a", "b"), divider=2.0)
