"""The one thread on which libraries read that cannot be interrupted and let only one call in at a time.

Whoever reads hands pieces of work to it and can be cancelled between them, and while another one reads.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import cache
from typing import TypeVar

Result = TypeVar("Result")


@cache
def _thread() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, thread_name_prefix="volviz-shared-reader")


def submit(work: Callable[[], Result]) -> Future[Result]:
    """Have work done after what was handed over before."""
    return _thread().submit(work)
