"""Which two views are compared: what happens to A and B when views come, go and change places."""

from __future__ import annotations

from dataclasses import replace

import pytest

from volviz.errors import InputError
from volviz.model.comparison import Comparison
from volviz.model.scene import Scene, SceneView
from volviz.model.session import scene_from_dict, scene_to_dict


def scene_of(*techniques: str, pair: tuple[int, int] = (0, 1), active: int = 0, mode: str = "wipe") -> Scene:
    views = tuple(SceneView(technique) for technique in techniques)
    return Scene(views=views, active=active, comparison=Comparison(mode, pair))


def compared(scene: Scene) -> list[str]:
    assert scene.pair is not None
    return [scene.views[view].technique for view in scene.pair]


def test_one_view_is_compared_with_nothing() -> None:
    assert scene_of("a").pair is None
    assert scene_of("a").seen == (0,)


def test_side_by_side_all_views_are_seen_otherwise_the_pair() -> None:
    assert scene_of("a", "b", "c", pair=(2, 0)).seen == (2, 0)
    assert scene_of("a", "b", "c", pair=(2, 0), mode="side_by_side").seen == (0, 1, 2)


@pytest.mark.parametrize("pair", [(a, b) for a in range(4) for b in range(4) if a != b])
@pytest.mark.parametrize("count", [2, 3, 4])
def test_whatever_was_compared_two_different_views_are(pair: tuple[int, int], count: int) -> None:
    first, second = Comparison(pair=pair).pair_of(count)
    assert first != second
    assert {first, second} <= set(range(count))
    if max(pair) < count:
        assert (first, second) == pair


def test_closing_a_view_that_is_not_compared_leaves_the_pair() -> None:
    scene = scene_of("a", "b", "c", "d", pair=(3, 1)).without_view(0)
    assert compared(scene) == ["d", "b"]


@pytest.mark.parametrize("closed", range(4))
@pytest.mark.parametrize("pair", [(0, 1), (1, 3), (2, 0)])
def test_closing_any_of_four_keeps_two_that_are_there_and_what_stays_of_the_pair(
    closed: int, pair: tuple[int, int]
) -> None:
    before = scene_of("a", "b", "c", "d", pair=pair)
    after = before.without_view(closed)
    kept = set(compared(before)) - {before.views[closed].technique}
    assert len(set(compared(after))) == 2
    assert kept <= set(compared(after))


def test_after_one_view_alone_the_first_is_a_again() -> None:
    scene = scene_of("a", "b", pair=(1, 0)).with_view_count(1).with_view_count(2)
    assert scene.pair == (0, 1)


def test_choosing_the_other_side_exchanges_the_letters() -> None:
    comparison = Comparison(pair=(0, 2))
    assert comparison.with_side(0, 2, 4).pair == (2, 0)
    assert comparison.with_side(1, 3, 4).pair == (0, 3)
    assert comparison.with_side(1, 2, 4).pair == (0, 2)


def test_a_session_keeps_the_pair_and_older_ones_compare_the_first_two() -> None:
    scene = replace(scene_of("a", "b", "c", pair=(2, 1)), layers=())
    data = scene_to_dict(scene)
    assert scene_from_dict(data, lambda _technique: None).pair == (2, 1)
    del data["comparison"]["pair"]
    assert scene_from_dict({**data, "version": 1}, lambda _technique: None).pair == (0, 1)


@pytest.mark.parametrize("pair", [(1, 1), (-1, 0)])
def test_a_view_is_not_compared_with_itself(pair: tuple[int, int]) -> None:
    with pytest.raises(InputError, match="two different views"):
        Comparison(pair=pair)
