"""Checks of Python, packages, kernels and disk."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import shutil
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from packaging.requirements import Requirement

from volviz.doctor.check import Check
from volviz.doctor.child import run_python
from volviz.doctor.system_libraries import install_command, package_for

if TYPE_CHECKING:
    from collections.abc import Iterator

GIB = 1 << 30
ENOUGH_DISK = GIB
"""Free space (bytes) below which caches and exports soon fail."""


def check_system() -> Iterator[Check]:
    """Operating system, processors, memory, Python."""
    detail = f"{platform.platform(terse=True)}, {platform.machine()}, {os.cpu_count()} processors"
    if memory := _memory():
        detail += f", {memory / GIB:.0f} GiB of memory"
    yield Check("system", "ok", detail)
    yield Check("Python", "ok", f"{platform.python_version()} at {sys.executable}")


def check_packages() -> Iterator[Check]:
    """Whether each package that VolViz requires is there in a version it is tested with."""
    try:
        distribution = importlib.metadata.distribution("volviz")
    except importlib.metadata.PackageNotFoundError:
        yield Check(
            "packages",
            "fail",
            "VolViz is imported from a folder and not installed, so its requirements are not known.",
            f"{sys.executable} -m pip install -e CHECKOUT",
        )
        return
    requirements = [Requirement(text) for text in distribution.requires or ()]
    found = [f"volviz {distribution.version}"]
    for requirement in requirements:
        if requirement.marker is not None and not requirement.marker.evaluate({"extra": ""}):
            continue
        problem = package_problem(requirement)
        if problem is None:
            found.append(f"{requirement.name} {importlib.metadata.version(requirement.name)}")
        else:
            requirement.marker = None
            yield Check("packages", "fail", problem, f'{sys.executable} -m pip install "{requirement}"')
    yield Check("packages", "ok", ", ".join(found))


def package_problem(requirement: Requirement) -> str | None:
    """What is wrong with an installed package, in a sentence; None when nothing is."""
    try:
        version = importlib.metadata.version(requirement.name)
    except importlib.metadata.PackageNotFoundError:
        return f"{requirement.name} is not installed."
    if requirement.specifier.contains(version, prereleases=True):
        return None
    return f"{requirement.name} {version} is installed; VolViz is tested with {requirement.specifier}."


def check_kernels() -> Iterator[Check]:
    """numba: whether it compiles, and whether its OpenMP layer loads."""
    compiled = run_python(
        "import numba; f = numba.njit(lambda x: x + 1); print(f(41), numba.__version__)", timeout=120
    )
    if compiled.status != 0 or not compiled.output.startswith("42"):
        detail = f"numba cannot compile: {compiled.last_error()}"
        yield Check("kernels", "fail", detail, f"{sys.executable} -m pip install --force-reinstall numba")
        return
    detail = f"numba {compiled.output.split()[1]} compiles; "
    layer = run_python("import numba.np.ufunc.omppool")
    if layer.status == 0:
        yield Check("kernels", "ok", detail + "OpenMP threads")
        return
    package = package_for(layer.errors)
    yield Check(
        "kernels",
        "warn",
        detail
        + f"its OpenMP threads do not load ({layer.last_error()}). VolViz's own kernels do without, but "
        "code that runs parallel numba loops on two threads beside it would end the process.",
        install_command([package]) if package else "",
    )


def check_disk() -> Iterator[Check]:
    """Whether compiled kernels and caches can be written, and whether there is room."""
    folder = kernel_cache()
    if not is_writable(folder):
        yield Check(
            "disk cache",
            "warn",
            f"{folder} is not writable: kernels are compiled anew in each process, which takes seconds.",
            "set NUMBA_CACHE_DIR to a folder that is",
        )
        return
    free = shutil.disk_usage(_existing(folder)).free
    detail = f"compiled kernels in {folder}, {free / GIB:.1f} GiB free"
    if free < ENOUGH_DISK:
        yield Check("disk cache", "warn", detail, "make room, or set NUMBA_CACHE_DIR to a folder elsewhere")
    else:
        yield Check("disk cache", "ok", detail)


def kernel_cache() -> Path:
    """Folder of the compiled kernels, chosen as numba does: the override, beside the source, the user's."""
    if override := os.environ.get("NUMBA_CACHE_DIR"):
        return Path(override)
    beside = Path(__file__).parent.parent / "kernels" / "__pycache__"
    if is_writable(beside):
        return beside
    base = os.environ.get("XDG_CACHE_HOME") or str(Path("~/.cache").expanduser())
    return Path(base) / "numba"


def is_writable(folder: Path) -> bool:
    """Whether a file can be made in a folder, or the folder itself can be made; found out by trying."""
    try:
        with tempfile.TemporaryFile(dir=_existing(folder)):
            return True
    except OSError:
        return False


def _existing(folder: Path) -> Path:
    """The folder itself, or the nearest one above it that exists."""
    return next((place for place in (folder, *folder.parents) if place.is_dir()), Path.cwd())


def _memory() -> int:
    """Physical memory in bytes, 0 where the system does not tell."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return 0
