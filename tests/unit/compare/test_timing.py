"""Frame times taken in turn: order, medians, spread, ratios, stopping early. No clock is asked here."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from volviz.compare.timing import FrameTimer, FrameTimes, ratio, time_frames
from volviz.errors import InputError


def recorder(log: list[tuple[str, int]], name: str, seconds: float) -> Callable[[int], float]:
    def draw(frame: int) -> float:
        log.append((name, frame))
        return seconds

    return draw


def test_sides_take_turns_and_the_order_is_turned_round() -> None:
    log: list[tuple[str, int]] = []
    time_frames({name: recorder(log, name, 1.0) for name in "ab"}, rounds=3, warm_up=1)
    assert log == [("a", 0), ("b", 0), ("b", 1), ("a", 1), ("a", 2), ("b", 2), ("b", 3), ("a", 3)]


def test_frames_for_warming_up_are_not_counted() -> None:
    times = time_frames({"a": lambda frame: 100.0 if frame < 2 else 1.0 + frame}, rounds=3, warm_up=2)
    assert times["a"].seconds == (3.0, 4.0, 5.0)


def test_median_spread_and_ratio_are_what_they_say() -> None:
    base = FrameTimes("ours", (1.0, 2.0, 3.0, 4.0, 5.0))
    side = FrameTimes("theirs", (3.0, 6.0, 9.0, 12.0, 20.0))
    assert base.median == 3.0
    assert base.quartiles == (2.0, 4.0)
    assert base.spread == pytest.approx(2 / 3)
    found = ratio(side, base)
    assert (found.median, found.low, found.high) == (3.0, 3.0, 3.0)
    assert ratio(base, side).median == pytest.approx(1 / 3)


def test_the_gpu_clock_is_kept_beside_the_wall_clock() -> None:
    times = time_frames({"a": lambda _: (0.5, 0.2), "b": lambda _: 0.3}, rounds=2)
    assert (times["a"].median, times["a"].gpu_median) == (0.5, 0.2)
    assert (times["b"].median, times["b"].gpu_median) == (0.3, None)


def test_progress_rises_to_one_and_a_stop_keeps_what_is_measured() -> None:
    timer = FrameTimer({"a": lambda _: 1.0, "b": lambda _: 2.0}, rounds=4, warm_up=1, first={"a": 9.0})
    steps = timer.steps()
    fractions = [next(steps) for _ in range(7)]
    assert fractions == sorted(fractions)
    assert fractions[-1] == pytest.approx(0.7)
    steps.close()
    assert len(timer.times["a"].seconds) + len(timer.times["b"].seconds) == 5
    assert timer.times["a"].first == 9.0
    assert list(FrameTimer({"a": lambda _: 1.0}, rounds=2).steps())[-1] == 1.0


def test_a_side_that_is_slow_draws_as_many_frames_as_there_is_time_for() -> None:
    log: list[tuple[str, int]] = []
    draws = {name: recorder(log, name, seconds) for name, seconds in (("fast", 0.5), ("slow", 4.0))}
    times = time_frames(draws, rounds=9, warm_up=1, patience=13.0)
    assert len(times["fast"].seconds) == 9
    # one for warming up, then two: a fourth would end after 16 seconds
    assert len(times["slow"].seconds) == 2
    assert [frame for name, frame in log if name == "slow"] == [0, 1, 2]


def test_a_frame_for_warming_up_counts_where_there_is_no_time_for_another() -> None:
    timer = FrameTimer({"a": lambda _: (30.0, 20.0)}, rounds=9, warm_up=1, patience=15.0)
    assert list(timer.steps()) == [1.0]
    assert timer.times["a"].seconds == (30.0,)
    assert timer.times["a"].gpu_seconds == (20.0,)


def test_progress_never_goes_back_when_sides_drop_out() -> None:
    timer = FrameTimer({"a": lambda _: 1.0, "b": lambda _: 5.0}, rounds=4, warm_up=1, patience=6.0)
    fractions = list(timer.steps())
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0


def test_times_without_frames_are_no_numbers_and_no_ratio() -> None:
    empty = FrameTimes("ours", ())
    assert all(math.isnan(v) for v in (empty.median, *empty.quartiles, empty.spread))
    with pytest.raises(InputError, match=r"^[^\n]+\.$"):
        ratio(empty, FrameTimes("theirs", (1.0,)))


def test_timing_nothing_is_refused() -> None:
    with pytest.raises(InputError):
        FrameTimer({})
    with pytest.raises(InputError):
        FrameTimer({"a": lambda _: 1.0}, rounds=0)
