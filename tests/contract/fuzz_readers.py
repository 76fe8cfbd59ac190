"""Damages a small file of every reader in many ways and loads it, in a process of its own with limited memory.

    python -m tests.contract.fuzz_readers FOLDER CASES [SEED] [READER]

What is allowed is a volume or one sentence. The case at hand stands in FOLDER/case, so that a crash or a hang tells
which one it was; `test_fuzz` runs this with fixed seeds.
"""

from __future__ import annotations

import re
import resource
import shutil
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tests.contract.test_readers import WRITERS
from volviz.errors import VolvizError
from volviz.io import load

#: More than any case may ask for beyond what is there at the start; a promise of terabytes must be noticed before.
MEMORY = 3 << 30
#: Seconds that one case may take.
PATIENCE = 5.0
NUMBERS = (b"-1", b"0", b"99999999999", b"1e400", b"nan", b"-0.0", b"4294967296", b"2147483648")
WORDS = (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x10000)
#: Damage is mostly done where headers lie.
HEADER = 700

Random = np.random.Generator


def flipped(content: bytearray, rng: Random) -> bytearray:
    """A few bytes are others."""
    reach = len(content) if rng.random() < 0.3 else min(len(content), HEADER)
    for place in rng.integers(0, reach, rng.integers(1, 8)):
        content[place] = rng.integers(0, 256)
    return content


def cut(content: bytearray, rng: Random) -> bytearray:
    """The end is missing."""
    return content[: rng.integers(1, len(content))]


def other_words(content: bytearray, rng: Random) -> bytearray:
    """A binary number of a header is huge, negative or zero."""
    place = int(rng.integers(0, max(min(len(content), HEADER) // 4 - 1, 1))) * 4
    width = int(rng.choice([2, 4, 8]))
    value = int(rng.choice(WORDS)) & (1 << 8 * width) - 1
    content[place : place + width] = value.to_bytes(width, "little" if rng.random() < 0.8 else "big")
    return content


def other_numbers(content: bytearray, rng: Random) -> bytearray:
    """A number of a text header is huge, negative or none; binary files lose a byte that looks like one."""
    found = list(re.finditer(rb"-?\d+\.?\d*", bytes(content[: 4 * HEADER])))
    if found:
        start, end = found[int(rng.integers(0, len(found)))].span()
        content[start:end] = NUMBERS[int(rng.integers(0, len(NUMBERS)))]
    return content


def repeated(content: bytearray, rng: Random) -> bytearray:
    """A piece stands there twice, or is gone."""
    start = int(rng.integers(0, len(content)))
    piece = content[start : start + int(rng.integers(1, 200))]
    content[start : start + len(piece)] = piece * int(rng.choice([0, 2]))
    return content


DAMAGES: tuple[Callable[[bytearray, Random], bytearray], ...] = (
    flipped, cut, other_words, other_numbers, repeated,
)  # fmt: skip


def run(folder: Path, cases: int, seed: int, only: str = "") -> list[str]:
    """Sentences on what went wrong."""
    wrong: list[str] = []
    for name, write in WRITERS.items():
        if only and name != only:
            continue
        whole = folder / name.replace(" ", "_")
        whole.mkdir()
        original = write(whole)
        target = min(p for p in original.rglob("*") if p.is_file()) if original.is_dir() else original
        content = target.read_bytes()
        for case in range(cases):
            rng = np.random.default_rng([seed, case, len(name)])
            damage = DAMAGES[case % len(DAMAGES)]
            target.write_bytes(damage(bytearray(content), rng))
            what = f"{name}, case {case} ({damage.__name__}), seed {seed}"
            (folder / "case").write_text(what)
            begin = time.perf_counter()
            try:
                load(original)
            except VolvizError as error:
                if "\n" in str(error) or not str(error).endswith("."):
                    wrong.append(f"{what}: not one sentence: {error}")
            except BaseException:  # noqa: BLE001 - whatever it is, it is a fault
                wrong.append(f"{what}: {traceback.format_exc()}")
            if time.perf_counter() - begin > PATIENCE:
                wrong.append(f"{what}: took {time.perf_counter() - begin:.1f} s")
        shutil.rmtree(whole)
    return wrong


def main() -> int:
    """Run, and print what went wrong."""
    folder, cases, *rest = sys.argv[1:]
    seed, only = int(rest[0]) if rest else 0, rest[1] if len(rest) > 1 else ""
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))
    wrong = run(Path(folder), int(cases), seed, only)
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
