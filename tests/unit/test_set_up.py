"""The set-up of a checkout: what is installed when, and what is said when it cannot be."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

SCRIPTS = Path(__file__).parent.parent.parent / "scripts"


class Machine:
    """Stands in for subprocesses: notes each command, makes what it would make, may refuse."""

    def __init__(self, checkout: Path) -> None:
        self.venv = checkout / ".venv"
        self.commands: list[list[str]] = []
        self.refuse = ""

    def run(self, command: list[str], **options: object) -> SimpleNamespace:
        self.commands.append(command)
        if self.refuse and self.refuse in command:
            return SimpleNamespace(returncode=1)
        if "venv" in command:
            (self.venv / "bin").mkdir(parents=True, exist_ok=True)
            (self.venv / "bin" / "python").touch()
            (self.venv / "pyvenv.cfg").write_text("version = 3.12.1\n")
        return SimpleNamespace(returncode=0)

    def take(self) -> list[str]:
        """The last word of each command since the last call."""
        words = [command[-1] for command in self.commands]
        self.commands.clear()
        return words


@pytest.fixture
def set_up(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The script as a module."""
    monkeypatch.syspath_prepend(str(SCRIPTS))
    return importlib.import_module("set_up")


@pytest.fixture
def machine(set_up: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Machine:
    """A checkout in a folder of its own, on a machine with all system libraries."""
    (tmp_path / "pyproject.toml").write_text("[project]\n")
    monkeypatch.setattr(set_up, "CHECKOUT", tmp_path)
    monkeypatch.setattr(set_up, "VENV", tmp_path / ".venv")
    monkeypatch.setattr(set_up, "STAMP", tmp_path / ".venv" / "stamp.json")
    monkeypatch.setattr(set_up, "LOCK", tmp_path / ".venv" / "lock")
    monkeypatch.setattr(set_up, "venv_python", lambda: tmp_path / ".venv" / "bin" / "python")
    monkeypatch.setenv("VOLVIZ_SKIP_SYSTEM", "1")
    lod_mesh = Machine(tmp_path)
    monkeypatch.setattr(set_up.subprocess, "run", lod_mesh.run)
    return lod_mesh


def test_the_first_start_makes_an_environment_and_installs(set_up: ModuleType, machine: Machine) -> None:
    set_up.set_up("window")
    assert machine.take() == [str(machine.venv), str(machine.venv.parent), "volviz.kernels.warm_up"]


def test_kernels_that_do_not_compile_stop_nobody(set_up: ModuleType, machine: Machine) -> None:
    machine.refuse = "volviz.kernels.warm_up"
    set_up.set_up("window")
    assert machine.take()[-1] == "volviz.kernels.warm_up"
    machine.refuse = ""
    set_up.set_up("window")
    assert machine.take() == []


def test_a_second_start_runs_nothing_at_all(set_up: ModuleType, machine: Machine) -> None:
    set_up.set_up("test")
    machine.take()
    set_up.set_up("test")
    set_up.set_up("window")
    assert machine.take() == []


def test_tests_add_their_packages_to_an_environment_made_for_running(
    set_up: ModuleType, machine: Machine
) -> None:
    set_up.set_up("window")
    machine.take()
    set_up.set_up("test")
    assert machine.take() == [f"{machine.venv.parent}[test]"]


def test_what_the_linters_need_includes_what_tests_need(set_up: ModuleType, machine: Machine) -> None:
    set_up.set_up("check")
    machine.take()
    set_up.set_up("test")
    assert machine.take() == []


def test_changed_requirements_are_installed_again(set_up: ModuleType, machine: Machine) -> None:
    set_up.set_up("test")
    machine.take()
    (machine.venv.parent / "pyproject.toml").write_text("[project]\nname = 'other'\n")
    set_up.set_up("test")
    assert machine.take() == [f"{machine.venv.parent}[test]"]
    set_up.set_up("test")
    assert machine.take() == []


def test_an_installation_that_failed_is_tried_again(set_up: ModuleType, machine: Machine) -> None:
    machine.refuse = "pip"
    with pytest.raises(set_up.NotReadyError, match="pip could not install"):
        set_up.set_up("test")
    machine.refuse = ""
    machine.take()
    set_up.set_up("test")
    assert f"{machine.venv.parent}[test]" in machine.take()


def test_an_environment_whose_interpreter_is_gone_is_made_anew(set_up: ModuleType, machine: Machine) -> None:
    set_up.set_up("window")
    machine.take()
    (machine.venv / "bin" / "python").unlink()
    set_up.set_up("window")
    assert machine.take()[:2] == [str(machine.venv), str(machine.venv.parent)]


@pytest.fixture
def debian(monkeypatch: pytest.MonkeyPatch, machine: Machine) -> ModuleType:
    """The script that installs Debian packages, on a machine that has apt-get and sudo."""
    module = importlib.import_module("debian")
    monkeypatch.setattr(module.subprocess, "run", machine.run)
    monkeypatch.setattr(module.shutil, "which", lambda name: f"/usr/bin/{name}")
    monkeypatch.setattr(module, "APT_LISTS", machine.venv.parent / "lists")
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(isatty=lambda: False))
    return module


def test_root_installs_at_once_and_fetches_empty_lists_first(
    debian: ModuleType, machine: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(debian.os, "geteuid", lambda: 0)
    assert debian.install(["libegl1"])
    assert machine.take() == ["update", "libegl1"]
    (machine.venv.parent / "lists").mkdir()
    (machine.venv.parent / "lists" / "mirror_main_binary-amd64_Packages.lz4").touch()
    assert debian.install(["libegl1", "libgl1"])
    assert machine.take() == ["libgl1"]


def test_lists_that_are_too_old_are_fetched_and_the_installation_tried_again(
    debian: ModuleType, machine: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(debian.os, "geteuid", lambda: 0)
    (machine.venv.parent / "lists").mkdir()
    (machine.venv.parent / "lists" / "old_Packages").touch()
    machine.refuse = "libegl1"
    with pytest.raises(debian.NotInstalledError, match="apt-get could not install: libegl1"):
        debian.install(["libegl1"])
    assert machine.take() == ["libegl1", "update", "libegl1"]


def test_others_get_the_exact_command_and_nothing_is_run(
    debian: ModuleType, machine: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(debian.os, "geteuid", lambda: 1000)
    with pytest.raises(debian.NotInstalledError) as error:
        debian.install(["libegl1", "xvfb"])
    assert "sudo apt-get install -y --no-install-recommends libegl1 xvfb" in str(error.value)
    assert machine.take() == []


@pytest.mark.parametrize(("answer", "runs"), [("y", True), ("", False), ("no", False)])
def test_on_a_terminal_sudo_is_used_only_after_a_yes(
    debian: ModuleType, machine: Machine, monkeypatch: pytest.MonkeyPatch, answer: str, runs: bool
) -> None:
    terminal = SimpleNamespace(isatty=lambda: True, write=lambda text: None, flush=lambda: None)
    monkeypatch.setattr(debian.os, "geteuid", lambda: 1000)
    monkeypatch.setattr(sys, "stdin", terminal)
    monkeypatch.setattr(sys, "stdout", terminal)
    monkeypatch.setattr("builtins.input", lambda question: answer)
    if runs:
        assert debian.install(["libegl1"])
        assert all(command[0] == "sudo" for command in machine.commands)
        assert machine.take() == ["update", "libegl1"]
    else:
        with pytest.raises(debian.NotInstalledError):
            debian.install(["libegl1"])
        assert machine.take() == []


def test_a_system_without_apt_is_told_the_names_and_goes_on(
    debian: ModuleType, machine: Machine, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(debian.shutil, "which", lambda name: None)
    assert not debian.install(["libegl1"])
    assert "libegl1" in capsys.readouterr().out
    assert machine.take() == []
