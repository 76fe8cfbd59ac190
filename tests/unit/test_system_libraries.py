"""The table of shared libraries, and what it names when some are missing."""

from __future__ import annotations

import sys

import pytest

from volviz.doctor import system_libraries
from volviz.doctor.system_libraries import LIBRARIES, load_error, missing_packages, package_for


@pytest.mark.parametrize(
    ("message", "package"),
    [
        (
            "libxcb-icccm.so.4: cannot open shared object file: No such file or directory",
            "libxcb-icccm4",
        ),
        (
            "ImportError: libEGL.so.1: cannot open shared object file: No such file or directory",
            "libegl1",
        ),
        ("libgomp.so.1.0.0: cannot open shared object file: No such file or directory", "libgomp1"),
        ("libunheard-of.so.3: cannot open shared object file: No such file or directory", None),
        ("Segmentation fault", None),
    ],
)
def test_a_message_of_the_loader_names_its_package(message: str, package: str | None) -> None:
    assert package_for(message) == package


@pytest.mark.skipif(sys.platform != "linux", reason="the loader of Linux")
def test_a_library_that_is_not_there_is_named_by_the_loader() -> None:
    assert load_error("libc.so.6") is None
    message = load_error("libvolviz-does-not-exist.so.1")
    assert message is not None
    assert message.startswith("libvolviz-does-not-exist.so.1: cannot open shared object file")


@pytest.fixture
def lacking(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """Names of libraries that the loader shall not find; the set may be filled by the test."""
    names: set[str] = set()
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(
        system_libraries, "load_error", lambda name: f"{name}: cannot open" if name in names else None
    )
    monkeypatch.setattr(system_libraries.shutil, "which", lambda name: f"/usr/bin/{name}")
    return names


def test_nothing_is_named_when_all_is_there(lacking: set[str]) -> None:
    assert missing_packages("test") == []


def test_each_missing_library_alone_names_exactly_its_own_package(lacking: set[str]) -> None:
    for library in LIBRARIES:
        lacking.clear()
        lacking.add(library.soname)
        assert missing_packages("test") == [library.package]


def test_drawing_needs_less_than_the_window(lacking: set[str]) -> None:
    lacking.update(library.soname for library in LIBRARIES)
    drawing, window = missing_packages("render"), missing_packages("window")
    assert set(drawing) < set(window)
    assert not [package for package in drawing if "xcb" in package]


def test_packages_that_come_along_with_others_are_not_named_twice(lacking: set[str]) -> None:
    lacking.update(library.soname for library in LIBRARIES)
    packages = missing_packages("window")
    assert len(packages) == len(set(packages))
    assert "libgl1" in packages
    assert "libx11-6" not in packages


def test_whatever_a_package_comes_with_is_itself_in_the_table() -> None:
    packages = {library.package for library in LIBRARIES}
    assert {library.with_package for library in LIBRARIES} - {""} <= packages


def test_tests_need_xvfb(lacking: set[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(system_libraries.shutil, "which", lambda name: None)
    assert missing_packages("test") == ["xvfb"]
    assert missing_packages("window") == []
