"""The shared pool: order, errors, and compiled code that really runs side by side."""

from __future__ import annotations

import subprocess
import sys
import threading

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from volviz.errors import InputError
from volviz.kernels.arrays import check_scalars, native_slab
from volviz.kernels.bricks import brick_min_max
from volviz.kernels.threads import executor, map_ranges, split_range, worker_count


@given(count=st.integers(0, 200), parts=st.integers(1, 40))
def test_pieces_cover_the_range_once_and_evenly(count, parts):
    pieces = split_range(count, parts)
    assert [i for a, b in pieces for i in range(a, b)] == list(range(count))
    lengths = [b - a for a, b in pieces]
    assert len(pieces) <= parts
    assert not lengths or max(lengths) - min(lengths) <= 1


def test_results_come_in_order_whatever_finishes_first():
    gate = threading.Event()

    def work(first, last):
        if first == 0 and worker_count() > 1:
            assert gate.wait(10)
        else:
            gate.set()
        return first, last

    assert map_ranges(work, 10, pieces=4) == split_range(10, 4)


def test_an_empty_range_calls_nothing():
    assert map_ranges(lambda a, b: pytest.fail("called"), 0) == []


def test_errors_reach_the_caller():
    def work(first, last):
        raise InputError("no")

    with pytest.raises(InputError, match="no"):
        map_ranges(work, 8)


def test_there_is_one_pool_and_the_leak_checks_know_it():
    assert executor() is executor()
    names = executor().submit(lambda: threading.current_thread().name).result()
    assert names.startswith("volviz-shared")


def test_kernels_may_be_called_from_many_threads_at_once():
    array = np.random.default_rng(1).integers(0, 255, (64, 64, 64), dtype=np.uint8)
    expected = brick_min_max(array)
    results = []

    def call():
        results.extend(brick_min_max(array) for _ in range(20))

    threads = [threading.Thread(target=call) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 80
    for mins, maxs in results:
        np.testing.assert_array_equal(mins, expected[0])
        np.testing.assert_array_equal(maxs, expected[1])


def test_slabs_are_views_where_possible_and_never_writeable():
    array = np.zeros((4, 5, 6), np.int16)
    slab = native_slab(array, 1, 3)
    assert np.shares_memory(slab, array)
    assert not slab.flags.writeable
    assert native_slab(array.astype(">i2"), 0, 2).dtype == np.int16
    assert native_slab(array.T, 0, 2).flags.c_contiguous
    assert native_slab(array > 0, 0, 2).dtype == np.uint8
    assert native_slab(array.astype(np.float16), 0, 2).dtype == np.float32


@pytest.mark.parametrize("array", [np.zeros((2, 2)), np.zeros((0, 2, 2)), np.zeros((2, 2, 2), complex)])
def test_what_is_not_a_volume_of_numbers_is_refused(array):
    with pytest.raises(InputError):
        check_scalars(array)


def test_kernels_load_neither_qt_nor_opengl_nor_vtk():
    code = """if True:
        import sys
        import volviz.kernels.bricks, volviz.kernels.brick_gradients, volviz.kernels.slices
        import volviz.reference.image, volviz.reference.isosurface, volviz.reference.shadows
        import volviz.kernels.preintegration, volviz.kernels.histogram, volviz.kernels.gradient
        import volviz.kernels.splats, volviz.kernels.statistics
        loaded = {name.split(".")[0] for name in sys.modules}
        print(sorted(loaded & {"PySide6", "vtk", "vtkmodules", "pyvista", "moderngl"}))
    """
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"
