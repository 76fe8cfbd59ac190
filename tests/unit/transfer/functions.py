"""Hypothesis strategies for transfer functions."""

from __future__ import annotations

from hypothesis import strategies as st

from volviz.model.transfer.function import TransferFunction

unit = st.floats(0.0, 1.0, allow_nan=False).map(lambda v: round(v, 4))
# A grid of values, so that jumps (two points at one value) come up often.
value = st.integers(-400, 400).map(lambda v: v / 4)
point = st.tuples(value, st.tuples(unit, unit, unit, unit))
functions = st.lists(point, min_size=1, max_size=12).map(TransferFunction.from_points)


@st.composite
def with_indices(draw: st.DrawFn, least: int = 1) -> tuple[TransferFunction, tuple[int, ...]]:
    """A function and some of its points."""
    function = draw(st.lists(point, min_size=max(least, 1), max_size=12).map(TransferFunction.from_points))
    chosen = draw(st.sets(st.integers(0, len(function.points) - 1), min_size=least))
    return function, tuple(sorted(chosen))
