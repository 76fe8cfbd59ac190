"""`volviz doctor`: what this machine has, what is missing, and how to get it.

    for check in volviz.doctor.run_checks():
        print(check.line())

Nothing here raises because of what it finds, and nothing takes the process down: whatever could crash (VTK
without a usable OpenGL does) is tried in a process of its own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from volviz.doctor import graphics, machine
from volviz.doctor.check import Check, Status

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

__all__ = ["Check", "Status", "report", "run_checks", "worst"]

CHECKS: tuple[Callable[[], Iterable[Check]], ...] = (
    machine.check_system,
    machine.check_packages,
    machine.check_kernels,
    machine.check_disk,
    graphics.check_libraries,
    graphics.check_display,
    graphics.check_window_system,
    graphics.check_drawing,
    graphics.check_window_drawing,
)


def run_checks() -> Iterator[Check]:
    """Run all checks one after the other, some 3 s in all; each is given out as soon as it is done."""
    for check in CHECKS:
        yield from check()


def worst(checks: Iterable[Check]) -> Status:
    """The gravest status among checks: "fail" before "warn" before "ok"."""
    found = {check.status for check in checks}
    return "fail" if "fail" in found else "warn" if "warn" in found else "ok"


def report(checks: Iterable[Check]) -> str:
    """All checks as text for a terminal or a bug report, with one closing sentence."""
    done = list(checks)
    closing = {
        "ok": "Everything that VolViz needs is here.",
        "warn": "VolViz works here; the lines marked ! say what could be better.",
        "fail": "VolViz does not fully work here; the lines marked x say what to do.",
    }[worst(done)]
    return "\n".join([*(check.line() for check in done), "", closing])
