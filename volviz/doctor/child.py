"""Run a few lines of Python in a process of their own, which may crash."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass


@dataclass(frozen=True)
class ChildResult:
    """What became of the process.

    Parameters
    ----------
    status : int
        Exit status; below zero the number of the signal that ended it; 124 when it took too long.
    output, errors : str
        Standard output and standard error.
    """

    status: int
    output: str
    errors: str

    def last_error(self) -> str:
        """The last line of standard error, where Python names the exception; else how the process ended."""
        lines = [line.strip() for line in self.errors.splitlines() if line.strip()]
        if self.status < 0:
            return f"the process was ended by signal {-self.status}"
        return lines[-1] if lines else f"the process ended with status {self.status}"


def run_python(code: str, *arguments: str, timeout: float = 60.0) -> ChildResult:
    """Run `code` with this interpreter and environment.

    Parameters
    ----------
    code : str
        Python code.
    *arguments : str
        Given to it as ``sys.argv[1:]``.
    timeout : float
        Seconds after which the process is ended.
    """
    command = [sys.executable, "-c", code, *arguments]
    try:
        done = subprocess.run(
            command,
            check=False,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=timeout,
            stdin=subprocess.DEVNULL,
        )
    except subprocess.TimeoutExpired:
        return ChildResult(124, "", f"no answer within {timeout:.0f} s")
    return ChildResult(done.returncode, done.stdout, done.stderr)
