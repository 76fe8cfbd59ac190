"""Make a checkout ready: system libraries, virtual environment, Python packages.

Runs with the system's Python and its standard library alone. Everything is done once; a stamp in `.venv`
tells later starts that nothing changed, and they need neither time nor network.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType

sys.path.insert(0, str(Path(__file__).parent))
import debian

CHECKOUT = Path(__file__).resolve().parent.parent
VENV = CHECKOUT / ".venv"
STAMP = VENV / "volviz-stamp.json"
LOCK = VENV / "volviz-set-up.lock"
SUPPORTED = ((3, 11), (3, 14))

# What is to be done -> (what of the system it needs, the extra of pyproject.toml).
TASKS: dict[str, tuple[str | None, str | None]] = {
    "render": ("render", None),
    "window": ("window", None),
    "test": ("test", "test"),
    "check": (None, "dev"),
}


class NotReadyError(Exception):
    """The set-up cannot go on; the message says what to do."""


def venv_python(venv: Path = VENV) -> Path:
    """Interpreter of the virtual environment."""
    return venv / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def set_up(task: str) -> Path:
    """Prepare everything for a task and give the interpreter to run it with.

    Parameters
    ----------
    task : {"render", "window", "test", "check"}
        What is to be done next.

    Raises
    ------
    NotReadyError, debian.NotInstalledError
        With a message for the person at the keyboard.
    """
    if not SUPPORTED[0] <= sys.version_info[:2] <= SUPPORTED[1]:
        raise NotReadyError(
            f"VolViz needs Python 3.11 to 3.14; {sys.executable} is {sys.version.split()[0]}. "
            "Choose another with: make PYTHON=/path/to/python3"
        )
    purpose, extra = TASKS[task]
    install_system_packages(purpose)
    VENV.mkdir(exist_ok=True)
    with one_at_a_time():
        stamp = read_stamp()
        if not venv_works():
            make_venv()
            stamp = {}
            say("The Python packages are some 500 MB to download, once; this takes a few minutes.")
        if stamp.get("key") != stamp_key():
            stamp = {"key": stamp_key(), "extras": []}
            install_python_packages(None if extra is None else [extra])
        elif extra is not None and extra not in stamp["extras"]:
            install_python_packages([extra])
        else:
            return venv_python()
        # Extras that were installed for an older pyproject.toml are stale: only what was installed now
        # counts.
        stamp["extras"] = sorted({*stamp["extras"], *includes(extra)})
        STAMP.write_text(json.dumps(stamp), encoding="utf-8")
        if task == "window":
            compile_kernels()
    return venv_python()


def includes(extra: str | None) -> set[str]:
    """Extras that one installation fulfils: `dev` contains `test`."""
    if extra is None:
        return set()
    return {"dev", "test"} if extra == "dev" else {extra}


def install_system_packages(purpose: str | None) -> None:
    """Find the system libraries that are missing, and `venv`, which Debian ships apart, and install them.

    VOLVIZ_SKIP_SYSTEM=1 in the environment leaves the system as it is.
    """
    if os.environ.get("VOLVIZ_SKIP_SYSTEM"):
        return
    packages = []
    if not venv_python().exists() and importlib.util.find_spec("ensurepip") is None:
        packages.append(f"python{sys.version_info[0]}.{sys.version_info[1]}-venv")
    if purpose is None:
        debian.install(packages)
        return
    # What one round brings along can differ between releases; the second round names the rest.
    for _ in range(2):
        packages += system_libraries().missing_packages(purpose)
        if not debian.install(packages):
            return
        packages = []
    if left := system_libraries().missing_packages(purpose):
        raise NotReadyError(
            f"These system packages were installed, yet their libraries do not load: {' '.join(left)}"
        )


def system_libraries() -> ModuleType:
    """The table of libraries."""
    return load_by_path("volviz_system_libraries", CHECKOUT / "volviz" / "doctor" / "system_libraries.py")


def load_by_path(name: str, path: Path) -> ModuleType:
    """Load one file of the package, which is not installed yet, under a name of its own."""
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, path)
        if spec is None or spec.loader is None:
            raise NotReadyError(f"{path} cannot be read; is the checkout complete?")
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module  # dataclasses look their module up while it is being executed
        spec.loader.exec_module(module)
    return sys.modules[name]


def stamp_key() -> str:
    """Key that changes with the requirements, the place of the checkout and the version of Python."""
    parts = [
        (CHECKOUT / "pyproject.toml").read_bytes(),
        str(CHECKOUT).encode(),
        venv_version().encode(),
    ]
    return hashlib.sha256(b"\0".join(parts)).hexdigest()


def venv_version() -> str:
    """What `pyvenv.cfg` says of the interpreter; empty without one."""
    with contextlib.suppress(OSError):
        for line in (VENV / "pyvenv.cfg").read_text(encoding="utf-8").splitlines():
            if line.startswith("version"):
                return line
    return ""


def read_stamp() -> dict[str, Any]:
    """The stamp of the last complete set-up; empty when there was none."""
    try:
        stamp = json.loads(STAMP.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return stamp if isinstance(stamp, dict) and isinstance(stamp.get("extras"), list) else {}


def venv_works() -> bool:
    """Whether the virtual environment is complete; an upgrade of the system's Python can break one."""
    python = venv_python()
    if not (VENV / "pyvenv.cfg").exists() or not python.exists():
        return False
    if STAMP.exists() and python.resolve().exists():
        return True
    command = [str(python), "-m", "pip", "--version"]
    return subprocess.run(command, check=False, capture_output=True).returncode == 0


def make_venv() -> None:
    """Create `.venv` anew."""
    say(f"Making a virtual environment in {VENV.relative_to(CHECKOUT)} with Python {sys.version.split()[0]}")
    STAMP.unlink(missing_ok=True)
    options = ["--clear"] if venv_python().exists() else []
    if subprocess.run([sys.executable, "-m", "venv", *options, str(VENV)], check=False).returncode != 0:
        raise NotReadyError(f"{sys.executable} -m venv {VENV} failed; see the message above.")


def install_python_packages(extras: list[str] | None) -> None:
    """Install VolViz (editable) and all that it needs; mirrors and proxies are pip's own configuration."""
    target = str(CHECKOUT) + (f"[{','.join(extras)}]" if extras else "")
    say("Installing Python packages" + (f" for {extras[0]}" if extras else ""))
    STAMP.unlink(missing_ok=True)
    command = [str(venv_python()), "-m", "pip", "install", "--disable-pip-version-check", "--no-input"]
    if not sys.stdout.isatty():
        command.append("--quiet")
    if subprocess.run([*command, "--editable", target], check=False).returncode != 0:
        raise NotReadyError(
            "pip could not install the Python packages; see its message above, then start again."
        )


def compile_kernels() -> None:
    """Put the kernels' machine code on disk, so that nobody waits for it in the window; no harm when it fails."""
    say("Compiling kernels, once; this takes half a minute or so.")
    subprocess.run([str(venv_python()), "-m", "volviz.kernels.warm_up"], check=False)


@contextlib.contextmanager
def one_at_a_time() -> Iterator[None]:
    """Let a second set-up of the same checkout wait for the first."""
    try:
        import fcntl
    except ImportError:
        yield
        return
    with LOCK.open("w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def say(text: str) -> None:
    """Print at once, so that lines stay in order with those of subprocesses."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def stop(error: Exception) -> int:
    """Print what to do and give the exit status."""
    sys.stdout.flush()
    sys.stderr.write(f"\n{error}\n")
    return 2


def main() -> int:
    """Command line of the set-up."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--for", dest="task", choices=sorted(TASKS), required=True, help="what is to be done next"
    )
    try:
        set_up(parser.parse_args().task)
    except (NotReadyError, debian.NotInstalledError) as error:
        return stop(error)
    return 0


if __name__ == "__main__":
    sys.exit(main())
