"""What figures depend on besides the program: processor, graphics, versions. Nothing about whose machine it is."""

from __future__ import annotations

import importlib.metadata
import os
import platform
from pathlib import Path

from volviz import __version__
from volviz.kernels.threads import worker_count

#: Packages whose version may matter to an image or to a time.
PACKAGES = ("numpy", "numba", "scipy", "vtk", "pyvista", "moderngl")


def machine_properties(renderer: str = "") -> dict[str, str]:
    """Processor, memory, system and graphics in words.

    Parameters
    ----------
    renderer : str
        What OpenGL says of itself; left out when empty.
    """
    found = {
        "processor": f"{processor_name()}, {worker_count()} of {os.cpu_count() or 1} logical processors in use",
        "memory": memory_size(),
        "system": f"{platform.system()} {platform.release()}, {platform.machine()}",
        "graphics": renderer,
    }
    return {name: text for name, text in found.items() if text}


def version_properties() -> dict[str, str]:
    """Versions of VolViz, Python and the packages that draw and compute."""
    found = {"volviz": __version__, "python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            # a package may be there without its records, as in a frozen program
            found[name] = "unknown"
    return found


def processor_name() -> str:
    """Name of the processor as the system gives it."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            key, _, value = line.partition(":")
            if key.strip() in ("model name", "Model", "Hardware") and value.strip():
                return value.strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def memory_size() -> str:
    """Physical memory in words; empty where the system does not tell."""
    try:
        return f"{os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES') / 2**30:.1f} GiB"
    except (AttributeError, ValueError, OSError):
        return ""
