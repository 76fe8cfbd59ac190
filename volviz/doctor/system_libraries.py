"""Shared libraries that VTK, Qt and numba take from the system, and the Debian packages that hold them.

Used in two places: the set-up of a checkout, before any package is installed, and `volviz doctor`. Therefore
only the standard library is imported, and nothing of VolViz.

Figures: found on a Debian 12 root with nothing but Python, make and git, by loading VTK 9.7.2, PySide6 6.11.3
and numba 0.68 and installing what each complained of. The same names hold on Ubuntu 22.04 and 24.04 (which
renamed some packages, but provides the old names too).
"""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

Purpose = Literal["render", "window", "test"]
PURPOSES: tuple[Purpose, ...] = ("render", "window", "test")
"""What is to be done; each needs all that the ones before it need."""


@dataclass(frozen=True)
class SystemLibrary:
    """One shared library.

    Parameters
    ----------
    soname : str
        Name that the dynamic loader looks for, or ``dri/NAME`` for a driver of Mesa.
    package : str
        Debian package that holds it.
    purpose : {"render", "window", "test"}
        The first purpose that needs it.
    with_package : str
        Package that brings this one along on Debian 12, so that it need not be named when both are missing.
    """

    soname: str
    package: str
    purpose: Purpose
    with_package: str = ""


LIBRARIES = (
    SystemLibrary("libEGL.so.1", "libegl1", "render"),
    SystemLibrary("libGL.so.1", "libgl1", "render"),
    SystemLibrary("dri/swrast_dri.so", "libgl1-mesa-dri", "render", "libgl1"),
    SystemLibrary("libgomp.so.1", "libgomp1", "render"),
    SystemLibrary("libX11.so.6", "libx11-6", "window", "libgl1"),
    SystemLibrary("libxcb.so.1", "libxcb1", "window", "libgl1"),
    SystemLibrary("libxkbcommon.so.0", "libxkbcommon0", "window", "libxkbcommon-x11-0"),
    SystemLibrary("libxkbcommon-x11.so.0", "libxkbcommon-x11-0", "window"),
    SystemLibrary("libfontconfig.so.1", "libfontconfig1", "window"),
    SystemLibrary("libfreetype.so.6", "libfreetype6", "window", "libfontconfig1"),
    SystemLibrary("libdbus-1.so.3", "libdbus-1-3", "window"),
    SystemLibrary("libglib-2.0.so.0", "libglib2.0-0", "window"),
    SystemLibrary("libgthread-2.0.so.0", "libglib2.0-0", "window"),
    SystemLibrary("libX11-xcb.so.1", "libx11-xcb1", "window", "libgl1"),
    SystemLibrary("libxcb-cursor.so.0", "libxcb-cursor0", "window"),
    SystemLibrary("libxcb-glx.so.0", "libxcb-glx0", "window", "libgl1"),
    SystemLibrary("libxcb-icccm.so.4", "libxcb-icccm4", "window"),
    SystemLibrary("libxcb-image.so.0", "libxcb-image0", "window", "libxcb-cursor0"),
    SystemLibrary("libxcb-keysyms.so.1", "libxcb-keysyms1", "window"),
    SystemLibrary("libxcb-randr.so.0", "libxcb-randr0", "window", "libegl1"),
    SystemLibrary("libxcb-render.so.0", "libxcb-render0", "window", "libxcb-cursor0"),
    SystemLibrary("libxcb-render-util.so.0", "libxcb-render-util0", "window", "libxcb-cursor0"),
    SystemLibrary("libxcb-shape.so.0", "libxcb-shape0", "window"),
    SystemLibrary("libxcb-shm.so.0", "libxcb-shm0", "window", "libgl1"),
    SystemLibrary("libxcb-sync.so.1", "libxcb-sync1", "window", "libgl1"),
    SystemLibrary("libxcb-util.so.1", "libxcb-util1", "window", "libxcb-cursor0"),
    SystemLibrary("libxcb-xfixes.so.0", "libxcb-xfixes0", "window", "libgl1"),
    SystemLibrary("libxcb-xkb.so.1", "libxcb-xkb1", "window", "libxkbcommon-x11-0"),
)
"""Every library that is looked for, one by one. The loader does not search Mesa's folder `dri`."""

PACKAGE_OF = {library.soname: library.package for library in LIBRARIES}

_DRIVER_FOLDERS = ("lib/*", "lib64", "lib", "local/lib")
_LOADER_MESSAGE = re.compile(
    r"(?P<soname>(?:dri/|lib)[\w.+-]+?\.so(?:\.\d+)*): cannot open shared object file"
)


def is_needed_for(library: SystemLibrary, purpose: Purpose) -> bool:
    """Whether a purpose, or one that it includes, needs the library."""
    return PURPOSES.index(library.purpose) <= PURPOSES.index(purpose)


def missing_libraries(purpose: Purpose) -> list[SystemLibrary]:
    """Libraries that the dynamic loader does not find, in the order of `LIBRARIES`; none outside of Linux."""
    if not sys.platform.startswith("linux"):
        return []
    return [
        library
        for library in LIBRARIES
        if is_needed_for(library, purpose) and load_error(library.soname) is not None
    ]


def missing_packages(purpose: Purpose) -> list[str]:
    """Debian packages to install for a purpose: those of the missing libraries, and Xvfb for tests.

    Packages that come along with another one are left out. Where a release of Debian or Ubuntu sorts that
    otherwise, the next call names what is left.
    """
    missing = missing_libraries(purpose)
    named = {library.package for library in missing}
    packages = [library.package for library in missing if library.with_package not in named]
    if purpose == "test" and sys.platform.startswith("linux") and shutil.which("Xvfb") is None:
        packages.append("xvfb")
    return list(dict.fromkeys(packages))


def load_error(library: str) -> str | None:
    """What the dynamic loader says of a library; None when it loads.

    Parameters
    ----------
    library : str
        Name, absolute path, or ``dri/NAME``. Mesa's drivers count as present too when another vendor's EGL
        is.
    """
    if library.startswith("dri/"):
        return _driver_error(library)
    try:
        ctypes.CDLL(library)
    except OSError as error:
        return str(error)
    return None


def _driver_error(driver: str) -> str | None:
    if any(found for folder in _DRIVER_FOLDERS for found in Path("/usr").glob(f"{folder}/{driver}")):
        return None
    if load_error("libEGL_nvidia.so.0") is None:
        return None
    return f"{driver}: cannot open shared object file: No such file or directory"


def package_for(message: str) -> str | None:
    """Debian package behind a message of the dynamic loader, or None when the message names no known library.

    Parameters
    ----------
    message : str
        For example ``libxcb-icccm.so.4: cannot open shared object file: No such file or directory``.
    """
    found = _LOADER_MESSAGE.search(message)
    soname = found["soname"] if found else ""
    while soname and soname not in PACKAGE_OF:
        # Some wheels ask for the full version: libgomp.so.1.0.0 is what the table calls libgomp.so.1.
        soname = soname.rpartition(".")[0]
    return PACKAGE_OF.get(soname)


def install_command(packages: list[str]) -> str:
    """The command that installs Debian packages, with `sudo` for those who need it."""
    prefix = "" if hasattr(os, "geteuid") and os.geteuid() == 0 else "sudo "
    return prefix + "apt-get install -y --no-install-recommends " + " ".join(packages)
