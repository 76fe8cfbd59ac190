"""Splitting work over z: the one place where the kernels start threads.

numba's own parallel loops are not used: its default threading layer ends the process when two threads enter
parallel kernels at the same time, which a window with workers does. Compiled functions that release the
interpreter lock run side by side on ordinary threads just as fast.
"""

from __future__ import annotations

import itertools
import os
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

Result = TypeVar("Result")


class _Shared:
    """The pool, made when first needed."""

    lock = threading.Lock()
    pool: ThreadPoolExecutor | None = None


def worker_count() -> int:
    """Number of processors this process may use, at least 1."""
    if hasattr(os, "sched_getaffinity"):
        return max(1, len(os.sched_getaffinity(0)))
    return os.cpu_count() or 1


def executor() -> ThreadPoolExecutor:
    """The pool that all kernels of the process share; its threads end when the interpreter does.

    Never submit work to it from a task that runs in it and then wait: with all threads waiting none is left
    to work.
    """
    with _Shared.lock:
        if _Shared.pool is None:
            _Shared.pool = ThreadPoolExecutor(worker_count(), thread_name_prefix="volviz-shared-kernel")
        return _Shared.pool


def split_range(count: int, parts: int) -> list[tuple[int, int]]:
    """Cut ``range(count)`` into at most `parts` contiguous pieces that are not empty.

    Parameters
    ----------
    count : int
        Length of the range, 0 or more.
    parts : int
        Largest number of pieces, at least 1.

    Returns
    -------
    list of (start, stop)
        In ascending order; lengths differ by at most 1.
    """
    parts = max(1, min(parts, count))
    edges = [count * i // parts for i in range(parts + 1)]
    return [(a, b) for a, b in itertools.pairwise(edges) if b > a]


def map_ranges(
    function: Callable[[int, int], Result], count: int, *, pieces: int | None = None
) -> list[Result]:
    """Call ``function(start, stop)`` on pieces of ``range(count)``, on threads, results in order.

    Parameters
    ----------
    function : callable
        Does its work with the interpreter lock released for most of the time; must not use `map_ranges`
        itself.
    count : int
        Length of the range (slices or bricks along z, rows of an image).
    pieces : int, optional
        Number of pieces; default four per processor, so that uneven work spreads.

    Returns
    -------
    list
        One result per piece, in ascending order whatever the order of completion.
    """
    workers = worker_count()
    ranges = split_range(count, pieces if pieces is not None else 4 * workers)
    if len(ranges) <= 1 or workers == 1:
        return [function(a, b) for a, b in ranges]
    pool = executor()
    return [future.result() for future in [pool.submit(function, a, b) for a, b in ranges]]
