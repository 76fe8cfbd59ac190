"""Edits of the views of a scene and of how they are compared, as functions from scene to scene."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from volviz.model.comparison import Mode
from volviz.model.scene import Scene


def with_views(scene: Scene, count: int) -> Scene:
    """The scene with one, two or four views; new ones begin as the active one is.

    Whoever asks for more than two wants to see them, so they come side by side.
    """
    return (with_comparison(scene, mode="side_by_side") if count > 2 else scene).with_view_count(count)


def with_counterpart(scene: Scene, technique: str) -> Scene:
    """The active view and the same drawn with another technique: two views, A and B."""
    view = scene.view
    return replace(scene.with_view_count(2), views=(view, replace(view, technique=technique)), active=0)


def with_active(scene: Scene, view: int) -> Scene:
    """The scene whose panels and keys act on a view, the last one when there are not so many."""
    return replace(scene, active=min(view, len(scene.views) - 1))


def with_next_active(scene: Scene) -> Scene:
    """The scene whose panels and keys act on the next of the views that are seen, the first one after the last."""
    seen = sorted(scene.seen)
    return replace(scene, active=next((view for view in seen if view > scene.active_index), seen[0]))


def with_pair_swapped(scene: Scene) -> Scene:
    """The scene whose compared views, A and B, have changed places; without a pair, as it is."""
    if scene.pair is None:
        return scene
    first, second = scene.pair
    views = list(scene.views)
    views[first], views[second] = views[second], views[first]
    return replace(scene, views=tuple(views))


def with_comparison(scene: Scene, **changes: Any) -> Scene:
    """The scene whose views are looked at together in another way.

    Parameters
    ----------
    **changes
        Fields of `Comparison`.

    Raises
    ------
    InputError
        A value is none of those that the field takes.
    """
    return replace(scene, comparison=replace(scene.comparison, **changes))


def with_mode(scene: Scene, mode: Mode) -> Scene:
    """The scene looked at side by side, or at A and B in another mode; the active view is one of those seen."""
    changed = with_comparison(scene, mode=mode)
    return changed if changed.active_index in changed.seen else replace(changed, active=changed.seen[0])


def with_side(scene: Scene, side: int, view: int) -> Scene:
    """The scene that compares a view as A (side 0) or B (1).

    When it is the other side already, the two exchange their letters. Without such a view the scene stays as it is.
    """
    if scene.pair is None or view >= len(scene.views):
        return scene
    changed = replace(scene, comparison=scene.comparison.with_side(side, view, len(scene.views)))
    return changed if changed.active_index in changed.seen else replace(changed, active=view)
