"""Damaged files of every format: a volume or a sentence, no traceback, crash or hang, with limited memory."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

#: Damaged files of each reader; some seconds in all.
CASES = 30


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="memory is limited by means of Linux")
def test_damaged_files_of_every_reader_are_opened_or_refused_in_a_sentence(tmp_path: Path) -> None:
    try:
        done = subprocess.run(
            [sys.executable, "-m", "tests.contract.fuzz_readers", str(tmp_path), str(CASES)],
            capture_output=True, text=True, timeout=120, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        pytest.fail(f"no answer: {(tmp_path / 'case').read_text()}")
    at = (tmp_path / "case").read_text() if (tmp_path / "case").exists() else "the start"
    assert done.returncode in (0, 1), (
        f"the process ended with {done.returncode} at {at}: {done.stderr[-2000:]}"
    )
    assert done.returncode == 0, done.stdout
    assert not done.stderr, f"libraries spoke for themselves: {done.stderr[-2000:]}"
