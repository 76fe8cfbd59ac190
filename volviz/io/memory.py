"""Whether a volume fits into memory, asked before it is read.

Linux hands out memory that it does not have and ends the process when that is used: a file that is too large would
take the window along. So its size is compared with what is free beforehand.
"""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from volviz.volume_data.budgets import budgets

if TYPE_CHECKING:
    from volviz.errors import VolvizError

MEMINFO = Path("/proc/meminfo")
CGROUP = Path("/sys/fs/cgroup")


class Job(Protocol):
    """What is read or written: it makes an error that names the file."""

    def error(self, what: str) -> VolvizError:
        """Why it cannot be done."""


def free_bytes() -> int | None:
    """Bytes of memory that a volume may take, None where neither the user nor the system tells.

    The user tells by a budget (`volviz.volume_data.budgets`), the system by what can be had without ending another
    program. Linux alone tells (``MemAvailable`` of the kernel, and the limit of a container); elsewhere a request that
    cannot be met fails by itself.
    """
    found: list[int] = []
    with contextlib.suppress(OSError, ValueError, IndexError):
        found = [
            1024 * int(line.split()[1])
            for line in MEMINFO.read_text(encoding="ascii").splitlines()
            if line.startswith(("MemAvailable:", "SwapFree:"))
        ]
    allowed = budgets().memory
    if not found:
        return allowed
    free = sum(found)
    with contextlib.suppress(OSError, ValueError):
        # "max" means no limit, and is no number
        limit = int((CGROUP / "memory.max").read_text(encoding="ascii"))
        used = int((CGROUP / "memory.current").read_text(encoding="ascii"))
        free = min(free, limit - used)
    free = max(free, 0)
    return free if allowed is None else min(free, allowed)


def free_in_words(free: int) -> str:
    """What `free_bytes` gave, as the end of a sentence: "1.5 GiB are free"."""
    amount = f"{free / 2**30:.3g} GiB"
    return f"the memory budget is {amount}" if free == budgets().memory else f"{amount} are free"


def check_memory(request: Job, wanted: int) -> None:
    """Refuse what does not fit.

    Parameters
    ----------
    request : LoadRequest, SaveRequest
    wanted : int
        Bytes of the array that is to be made.

    Raises
    ------
    VolvizError
        `LoadError` where something is read.
    """
    free = free_bytes()
    if free is not None and wanted > free:
        raise request.error(
            f"it needs {wanted / 2**30:.3g} GiB of memory and {free_in_words(free)}; "
            "close other programs, crop it or save it with fewer voxels."
        )
