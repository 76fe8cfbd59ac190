"""`make run`: set up, then open the window; without a display draw the sample with every technique."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import ModuleType

sys.path.insert(0, str(Path(__file__).parent))
import debian
import set_up

OUT = set_up.CHECKOUT / "out"


def main(arguments: list[str]) -> int:
    """Start the program with the arguments of the command line (files to open)."""
    environment = volviz_environment()
    wanted = environment.has_display()
    try:
        python = set_up.set_up("window" if wanted else "render")
    except (set_up.NotReadyError, debian.NotInstalledError) as error:
        return set_up.stop(error)
    if wanted and environment.display_answers():
        command = [str(python), "-m", "volviz", *arguments]
    else:
        reason = "The display does not answer" if wanted else "There is no display"
        set_up.say(f"{reason}: instead of a window, there will be pictures of every technique in {OUT.name}/")
        command = [
            str(python),
            "-m",
            "volviz",
            "render",
            "--all-techniques",
            "-o",
            f"{OUT.name}/",
            *arguments,
        ]
    try:
        return subprocess.run(command, check=False, cwd=set_up.CHECKOUT).returncode
    except KeyboardInterrupt:
        return 130


def volviz_environment() -> ModuleType:
    """`volviz.environment`, loaded by path: this process has no VolViz installed."""
    return set_up.load_by_path("volviz_environment", set_up.CHECKOUT / "volviz" / "environment.py")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
