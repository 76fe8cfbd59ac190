"""Memory that is used again: never while somebody can still see it."""

from __future__ import annotations

import gc
import threading

import numpy as np
import pytest

from volviz.kernels.marching import buffers, marching_cubes

from .meshes import noise

COUNT = 2**20


@pytest.fixture(autouse=True)
def nothing_is_kept():
    buffers.release_kept_memory()
    yield
    buffers.release_kept_memory()


def address(array):
    return array.__array_interface__["data"][0]


def test_memory_is_given_out_again_when_the_array_is_gone():
    array = buffers.new_array(COUNT, np.float32)
    place = address(array)
    assert array.shape == (COUNT,)
    assert array.flags.writeable
    del array
    assert address(buffers.new_array(COUNT - 1000, np.int32)) == place


@pytest.mark.parametrize(
    "view",
    [
        lambda a: a[10:20],
        lambda a: a.reshape(-1, 4)[:, 1],
        lambda a: a.view(np.int32)[::2],
        lambda a: memoryview(a)[5:9],
        lambda a: a[3:].reshape(-1)[1:][2:],
    ],
)
def test_a_view_of_any_kind_keeps_the_memory(view):
    array = buffers.new_array(COUNT, np.float32)
    array.fill(7.0)
    seen = view(array)
    place = address(array)
    del array
    gc.collect()
    other = buffers.new_array(COUNT, np.float32)
    assert address(other) != place
    other.fill(1.0)
    assert (np.ascontiguousarray(seen).view(np.float32) == 7.0).all()
    del seen
    gc.collect()
    assert address(buffers.new_array(COUNT, np.float32)) == place


def test_small_arrays_and_very_large_ones_are_not_kept(monkeypatch):
    monkeypatch.setattr(buffers, "KEPT_BYTES", 3 * 2**20)
    buffers.new_array(10, np.float32)
    buffers.new_array(2**21, np.uint8)
    assert buffers._pool == []
    arrays = [buffers.new_array(2**20, np.uint8) for _ in range(6)]
    del arrays
    assert 0 < sum(b.nbytes for b in buffers._pool) <= 3 * 2**20


def test_much_larger_memory_is_not_taken_for_a_small_array():
    buffers.new_array(8 * COUNT, np.uint8)
    assert len(buffers._pool) == 1
    array = buffers.new_array(COUNT, np.uint8)
    assert len(buffers._pool) == 1
    assert array.nbytes == COUNT


def test_a_mesh_stays_as_it_is_while_others_are_made_and_dropped():
    array = noise((40, 41, 42), np.uint8)
    kept = marching_cubes(array, 99.5)
    copies = [part.copy() for part in kept]
    for isovalue in (90.5, 100.5, 110.5, 99.5):
        marching_cubes(array, isovalue)
    assert all(np.array_equal(a, b) for a, b in zip(kept, copies, strict=True))


def test_threads_never_share_memory():
    wrong = []

    def work(number):
        for _ in range(30):
            array = buffers.new_array(2**17, np.float32)
            array.fill(number)
            if not (array == number).all():
                wrong.append(number)

    threads = [threading.Thread(target=work, args=(n,)) for n in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []
