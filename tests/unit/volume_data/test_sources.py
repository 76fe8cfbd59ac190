"""Sources: what can be asked before anything is read, and parts that lie where they lie in the whole."""

from __future__ import annotations

import gc
import threading
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from volviz.errors import Cancelled, InputError
from volviz.volume_data.array_source import ArraySource
from volviz.volume_data.description import Channel, Description, Label, Level, Statistics
from volviz.volume_data.references import content_id
from volviz.volume_data.source import ReadRequest, VolumeSource
from volviz.volume_data.volume import Volume

TURNED = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])


def test_an_array_of_five_axes_tells_its_axes_times_and_channels():
    array = np.arange(2 * 3 * 4 * 5 * 6).reshape(2, 3, 4, 5, 6)
    red = Channel("DAPI", (0, 0, 1), (0, 100), 461.0)
    source = ArraySource(array, times=(0, 0.5), channels=(red, Channel(), Channel()), unit="V", name="cells")
    assert source.axes == ("t", "c", "z", "y", "x")
    assert source.sizes == {"t": 2, "c": 3, "z": 4, "y": 5, "x": 6}
    assert source.units == {"t": "s", "c": "", "z": "", "y": "", "x": ""}
    assert (source.times, source.channels[0].name) == ((0, 0.5), "DAPI")
    volume = source.read(time=1, channel=2)
    np.testing.assert_array_equal(volume.array, array[1, 2])
    assert (volume.unit, volume.name) == ("V", "cells")
    np.testing.assert_array_equal(source.read(time=1).array, array[1, 0])
    assert source.statistics(1, 2) == Statistics(array[1, 2].min(), array[1, 2].max())


def test_axes_may_stand_in_any_order():
    array = np.arange(2 * 3 * 4 * 5).reshape(4, 5, 3, 2)
    source = ArraySource(array, "yxzc")
    assert source.sizes == {"c": 2, "z": 3, "y": 4, "x": 5}
    np.testing.assert_array_equal(source.read(channel=1).array, array[..., 1].transpose(2, 0, 1))


def test_a_volume_is_a_source_and_comes_back_as_itself():
    volume = Volume(np.zeros((2, 3, 4)), (1, 2, 3), (4, 5, 6), TURNED, unit="HU", name="head")
    source = ArraySource(volume)
    assert source.axes == ("z", "y", "x")
    assert source.read() is volume
    assert (source.name, source.unit, source.times) == ("head", "HU", None)
    assert source.channels == (Channel(),)
    (level,) = source.levels
    assert (level.dimensions, level.spacing, level.origin) == ((4, 3, 2), (1, 2, 3), (4, 5, 6))
    np.testing.assert_array_equal(level.direction, volume.direction)


intervals = st.tuples(st.integers(0, 7), st.integers(0, 9)).map(lambda p: (p[0], min(p[0] + 2 + p[1], 9)))


@given(intervals, intervals, intervals)
def test_a_box_is_that_part_of_the_whole_at_its_place(i, j, k):
    whole = Volume(np.arange(729).reshape(9, 9, 9), (0.5, 2, 3), (10, 20, 30), TURNED)
    part = ArraySource(whole).read(box=(*i, *j, *k))
    np.testing.assert_array_equal(part.array, whole.array[slice(*k), slice(*j), slice(*i)])
    assert np.allclose(part.index_to_world @ (0, 0, 0, 1), whole.index_to_world @ (i[0], j[0], k[0], 1))
    last = np.array([i[1] - 1, j[1] - 1, k[1] - 1, 1])
    assert np.allclose(part.corners[7], (whole.index_to_world @ last)[:3])


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"level": 3}, "v: there is only one level, got 3."),
        ({"level": -1}, "only one level"),
        ({"time": 12}, r"time must lie in 0\.\.9, got 12"),
        ({"channel": 1}, "only one channel"),
        ({"time": 1.0}, "time must be an integer"),
        ({"channel": "red"}, "no channel is called .red."),
        ({"box": (0, 4, 0, 4, 0, 5)}, "from 0 to 5 along k, outside the 4 voxels"),
        ({"box": (-1, 4, 0, 4, 0, 4)}, "from -1 to 4 along i"),
        ({"box": (2, 2, 0, 4, 0, 4)}, "0 <= i0 < i1 <= 4"),
        ({"box": (0, 4, 1, 2, 0, 4)}, "one voxel along j"),
        ({"box": (0, 4, 0, 4)}, "six integers"),
        ({"box": (0, 4, 0, 4, 0, 3.5)}, "six integers"),
        ({"box": 5}, "six integers"),
        ({"box": (0, 4, 0, 4, 0, float("inf"))}, "six integers"),
    ],
)
def test_what_is_not_there_is_refused_in_one_true_sentence(asked, words):
    source = ArraySource(np.zeros((10, 4, 4, 4)), name="v")
    with pytest.raises(InputError, match=words) as caught:
        source.read(**asked)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("array", "given", "words"),
    [
        (np.zeros((3, 3)), {}, "2"),
        (np.zeros((3, 3, 3)), {"axes": "zyc"}, "axes must be"),
        (np.zeros((3, 3, 3, 3)), {"axes": "zyxx"}, "axes must be"),
        (np.zeros((3, 3, 3)), {"axes": "tzyx"}, "has 4 dimensions, got 3"),
        (np.zeros((3, 3, 1)), {}, "at least 2 voxels"),
        (np.zeros((3, 3, 3)), {"spacing": (1, 0, 1)}, "greater than 0"),
        (np.zeros((3, 3, 3)), {"direction": np.eye(2)}, "3 x 3"),
        (np.zeros((4, 3, 3, 3)), {"times": (1, 2)}, "4 times"),
        (np.zeros((3, 3, 3)), {"channels": (Channel(), Channel())}, "1 channels"),
    ],
)
def test_arrays_that_are_no_volumes_are_refused(array, given, words):
    with pytest.raises(InputError, match=words):
        ArraySource(array, **given)


class Pyramid(VolumeSource):
    """A field of world coordinates, computed when it is asked for: x + 10 y + 100 z."""

    def __init__(self) -> None:
        # not halved alike, and each level half of its own voxel off, as averaging leaves it
        levels = (
            Level((64, 48, 20), (1, 1, 3), (0, 0, 0)),
            Level((32, 24, 20), (2, 2, 3), (0.5, 0.5, 0)),
            Level((10, 8, 7), (6, 6, 9), (2.5, 2.5, 3)),
        )
        self.reads: list[Any] = []
        super().__init__(
            Description(
                levels, 5, 2, name="field", is_labels=True, labels=(Label(3, "liver", (1, 0, 0)),),
                length_unit="µm", content_id="1", metadata={"format": "computed"},
            )
        )  # fmt: skip

    def read_volume(self, request: ReadRequest) -> Volume:
        self.reads.append((request.level, request.time, request.channel, request.box))
        level = self.levels[request.level]
        lattice = level if request.box is None else level.part(request.box)
        x, y, z = (
            o + s * np.arange(n)
            for o, s, n in zip(lattice.origin, lattice.spacing, lattice.dimensions, strict=True)
        )
        field = x + 10 * y[:, None] + 100 * z[:, None, None]
        if request.cancel is not None and request.cancel():
            raise Cancelled("stopped")
        return self.placed(field + 1e4 * request.time + 1e5 * (request.channel or 0), request)


def test_levels_have_a_geometry_of_their_own():
    source = Pyramid()
    assert source.sizes == {"t": 5, "c": 2, "z": 20, "y": 48, "x": 64}
    assert [level.dimensions for level in source.levels] == [(64, 48, 20), (32, 24, 20), (10, 8, 7)]
    assert (source.is_labels, source.labels[0].name, source.content_id) == (True, "liver", "1")
    assert source.units["x"] == "µm"
    for level, at in ((0, (6, 6, 12)), (1, (8.5, 8.5, 12)), (2, (8.5, 8.5, 12))):
        for box in (None, (1, 10, 1, 8, 1, 6)):
            volume = source.read(level, time=1, channel=1, box=box)
            assert volume.value_at(at) == pytest.approx(at[0] + 10 * at[1] + 100 * at[2] + 1.1e5)
            assert volume.metadata["format"] == "computed"
    assert source.statistics(4, 1) is None
    with pytest.raises(InputError, match=r"field: level must lie in 0\.\.2, got 3"):
        source.read(3)
    with pytest.raises(InputError, match="outside the 7 voxels"):
        source.read(2, box=(0, 5, 0, 5, 0, 20))
    with pytest.raises(InputError, match=r"time must lie in 0\.\.4, got 5"):
        source.statistics(5)


def test_a_volume_in_use_is_read_once_and_pins_no_memory():
    source = Pyramid()
    volume = source.read(1)
    assert source.read(1) is volume
    assert source.read(1, box=(0, 2, 0, 2, 0, 2)) is not source.read(1, box=(0, 2, 0, 2, 0, 2))
    assert source.reads.count((1, 0, None, None)) == 1
    del volume
    gc.collect()
    source.read(1)
    assert source.reads.count((1, 0, None, None)) == 2


def test_threads_that_read_the_same_get_the_same():
    source, found = Pyramid(), []
    start = threading.Barrier(4)

    def work() -> None:
        start.wait()
        found.append(source.read(2))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({id(volume) for volume in found}) == 1


def test_reading_can_be_cancelled():
    with pytest.raises(Cancelled):
        ArraySource(np.zeros((2, 2, 2))).read(cancel=lambda: True)
    asked = iter((False, True))
    with pytest.raises(Cancelled, match="stopped"):
        Pyramid().read(cancel=lambda: next(asked))


def test_the_identity_of_content_changes_with_the_file(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"1")
    before = content_id(str(path))
    path.write_bytes(b"12")
    assert before
    assert content_id(str(path)) != before
    assert content_id("sample:engine") == ""
