"""How long a kernel takes, whatever else the machine does."""

from __future__ import annotations

import time


def processor_seconds(call, repeats=5):
    """Least processor time of several calls, all threads together: no more than this on an idle machine."""

    def once():
        start = time.process_time()
        call()
        return time.process_time() - start

    return min(once() for _ in range(repeats))
