"""Which frames make one volume: one series, one size and orientation, one time point or echo."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import InputError
from volviz.io.dicom.lattice import same_places
from volviz.io.entries import Entry

if TYPE_CHECKING:
    from collections.abc import Sequence

    from volviz.io.dicom.headers import Frame
    from volviz.io.reader import LoadRequest

#: Directions whose cosines differ by less belong to one orientation, and spacings that differ by less, as a fraction:
#: over 1000 pixels either moves a voxel by less than one.
ALIKE = 1e-3


def all_series(frames: Sequence[Frame]) -> list[list[Frame]]:
    """The frames of each series, those with most pixels first."""
    groups: dict[str, list[Frame]] = defaultdict(list)
    for frame in frames:
        groups[frame.file.series].append(frame)
    return sorted(groups.values(), key=lambda g: -sum(f.rows * f.columns for f in g))


def entries_of(frames: Sequence[Frame]) -> list[Entry]:
    """What is told of each series of more than one slice where one chooses: modality and size, nothing of a person."""
    return [
        Entry(str(n), (len(group), group[0].rows, group[0].columns), "", group[0].file.modality or "image")
        for n, group in enumerate(all_series(frames))
        if len(group) > 1
    ]


def one_series(request: LoadRequest, frames: Sequence[Frame]) -> list[Frame]:
    """The frames of one series: the one asked for, else the one with most pixels."""
    ordered = all_series(frames)
    asked = request.hints.series
    if asked is None:
        if len(ordered) > 1:
            sizes = ", ".join(f"{n}: {_words(group)}" for n, group in enumerate(ordered[:8]))
            request.note(f"The largest of {len(ordered)} series is shown; choose with series= ({sizes}).")
        return ordered[0]
    named = next((group for group in ordered if group[0].file.series == asked), None)
    if named is not None:
        return named
    if str(asked).isdecimal() and int(asked) < len(ordered):
        return ordered[int(asked)]
    raise InputError(f"{request.path.name}: series must be 0..{len(ordered) - 1} or a UID, got {asked!r}.")


def _words(group: Sequence[Frame]) -> str:
    first = group[0]
    return f"{first.file.modality or 'image'} {first.columns} x {first.rows} x {len(group)}"


def alike(a: Frame, b: Frame) -> bool:
    """Whether two frames fit together in size, components, spacing and orientation."""
    if (a.rows, a.columns, a.file.samples) != (b.rows, b.columns, b.file.samples):
        return False
    for ours, theirs, scale in (
        (a.pixel_spacing, b.pixel_spacing, a.pixel_spacing),
        (a.orientation, b.orientation, None),
    ):
        if (ours is None) != (theirs is None):
            return False
        if ours is not None and theirs is not None:
            limit = ALIKE * (1.0 if scale is None else min(scale))
            if max(abs(x - y) for x, y in zip(ours, theirs, strict=True)) > limit:
                return False
    return True


def one_kind(request: LoadRequest, frames: Sequence[Frame]) -> list[Frame]:
    """The frames that fit together; scout images are left out.

    Raises
    ------
    LoadError
        No two of them do.
    """
    groups: list[list[Frame]] = []
    for frame in frames:
        group = next((g for g in groups if alike(g[0], frame)), None)
        if group is None:
            groups.append([frame])
        else:
            group.append(frame)
    largest = max(groups, key=len)
    if len(groups) > 1 and len(largest) == 1:
        raise request.error(
            f"it holds {len(groups)} images of different orientation or size, one each (a localizer, say); "
            "that is no volume, choose another series."
        )
    if len(groups) > 1:
        left = len(frames) - len(largest)
        request.note(f"{left} slices of another size or orientation (scout images, say) were left out.")
    return largest


def volumes(request: LoadRequest, frames: Sequence[Frame]) -> list[list[Frame]]:
    """The frames as volumes: time points, echoes or the like, each sorted along the stack."""
    if any(f.position is None or f.orientation is None for f in frames):
        return [sorted(frames, key=lambda f: (f.instance, f.file.path.name, f.number, f.tile))]
    normal = frames[0].normal
    depths = np.array([float(np.dot(normal, np.asarray(f.position))) for f in frames])
    places = same_places(depths)
    count = int(places.max()) + 1
    if count == len(frames):
        return [[frames[n] for n in np.argsort(depths, kind="stable")]]
    stacks = _stacks_by_dimensions(frames, places, count) or _stacks_by_order(frames, places, count)
    if stacks is None:
        request.note("Some slices lie at one and the same position; the first of them was taken.")
        firsts: dict[int, Frame] = {}
        for frame, place in sorted(
            zip(frames, places.tolist(), strict=True), key=lambda pair: _order(pair[0])
        ):
            firsts.setdefault(place, frame)
        return [[firsts[place] for place in sorted(firsts)]]
    words = _what_differs(stacks)
    if words:
        request.note(f"What is called a time point here is another {words}.")
    return stacks


def _order(frame: Frame) -> tuple[Any, ...]:
    values = tuple(value for _, value in frame.dimensions)
    return (values, frame.instance, frame.file.path.name, frame.number)


def _stacks_by_dimensions(frames: Sequence[Frame], places: Any, count: int) -> list[list[Frame]] | None:
    """Volumes told apart by what the headers say of them; None unless each fills every place just once."""
    width = min(len(f.dimensions) for f in frames)
    # the weaker ones may differ from slice to slice: as few are used as will do
    for used in range(1, width + 1):
        groups: dict[tuple[Any, ...], list[tuple[int, Frame]]] = defaultdict(list)
        for frame, place in zip(frames, places.tolist(), strict=True):
            groups[tuple(value for _, value in frame.dimensions[:used])].append((place, frame))
        if all(sorted(p for p, _ in group) == list(range(count)) for group in groups.values()):
            return [[f for _, f in sorted(groups[key], key=lambda pair: pair[0])] for key in sorted(groups)]
    return None


def _stacks_by_order(frames: Sequence[Frame], places: Any, count: int) -> list[list[Frame]] | None:
    """Volumes by the order of the frames at each place; None unless there are equally many everywhere."""
    at: list[list[Frame]] = [[] for _ in range(count)]
    for frame, place in zip(frames, places.tolist(), strict=True):
        at[place].append(frame)
    if len({len(group) for group in at}) != 1:
        return None
    ordered = [sorted(group, key=_order) for group in at]
    return [list(stack) for stack in zip(*ordered, strict=True)]


def _what_differs(stacks: Sequence[Sequence[Frame]]) -> str:
    """Words and values of what tells volumes apart; empty where it is time."""
    firsts = [dict(stack[0].dimensions) for stack in stacks]
    words = [word for word in firsts[0] if len({first.get(word) for first in firsts}) > 1]
    words = [word for word in words if word not in ("frame set", "acquisition")]
    if not words or "time point" in words:
        return ""
    values = ", ".join(
        f"{first[words[0]]:g}" if not isinstance(first[words[0]], str) else first[words[0]]
        for first in firsts[:6]
    )
    return f"{words[0]} {values}{', …' if len(firsts) > 6 else ''}"
