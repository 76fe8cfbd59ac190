"""Install missing Debian packages: as root directly, on a terminal after a question, else in words."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

APT_LISTS = Path("/var/lib/apt/lists")
APT_INSTALL = ["apt-get", "install", "-y", "--no-install-recommends"]


class NotInstalledError(Exception):
    """System packages are missing and could not be installed; the message says what to type."""


def install(packages: list[str]) -> bool:
    """Install Debian packages, or raise `NotInstalledError` with the exact command.

    Parameters
    ----------
    packages : list of str
        Names of Debian packages; nothing happens when there are none. Without apt-get they are only named:
        other systems sort the same libraries into other packages.

    Returns
    -------
    bool
        Whether something was installed.
    """
    if not packages:
        return False
    names = " ".join(packages)
    if shutil.which("apt-get") is None:
        _say(f"Some libraries are missing. If the program does not start, install what Debian calls: {names}")
        return False
    prefix = [] if os.geteuid() == 0 else ["sudo"]
    install_line = shlex.join([*prefix, *APT_INSTALL, *packages])
    by_hand = f"{shlex.join([*prefix, 'apt-get', 'update'])} && {install_line}"
    if prefix and not _may_use_sudo(names, by_hand):
        raise NotInstalledError(
            f"These system packages are missing: {names}\nInstall them with:\n\n  {by_hand}\n"
        )
    _say(f"Installing system packages: {names}")
    fresh = False
    if not any(APT_LISTS.glob("*Packages*")):
        _apt(prefix, ["apt-get", "-q", "update"])
        fresh = True
    done = _apt(prefix, [*APT_INSTALL, "-q", *packages])
    if not done and not fresh:
        # Package lists that are too old name versions that the mirror no longer has.
        _apt(prefix, ["apt-get", "-q", "update"])
        done = _apt(prefix, [*APT_INSTALL, "-q", *packages])
    if not done:
        raise NotInstalledError(
            f"apt-get could not install: {names}\nSee its messages above, then try:\n\n  {by_hand}\n"
        )
    return True


def _may_use_sudo(names: str, command: str) -> bool:
    """Ask on a terminal; anywhere else the answer is no, since nobody could type a password."""
    if shutil.which("sudo") is None or not (sys.stdin.isatty() and sys.stdout.isatty()):
        return False
    _say(f"These system packages are missing: {names}\nThis would install them:\n\n  {command}\n")
    try:
        return input("Run it now? [y/N] ").strip().lower() in {"y", "yes"}
    except (EOFError, KeyboardInterrupt):
        return False


def _apt(prefix: list[str], command: list[str]) -> bool:
    # sudo drops the environment, so the setting travels as an argument of env.
    quiet = ["env", "DEBIAN_FRONTEND=noninteractive"]
    try:
        return subprocess.run([*prefix, *quiet, *command], check=False).returncode == 0
    except KeyboardInterrupt:
        return False


def _say(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()
