"""The wheel and the source archive hold everything that the checkout holds."""

from __future__ import annotations

import subprocess
import tarfile
import zipfile
from pathlib import Path

import pytest
from hatchling.builders.sdist import SdistBuilder
from hatchling.builders.wheel import WheelBuilder

CHECKOUT = Path(__file__).parent.parent.parent
# Folder of the checkout -> where it lies in the wheel.
PLACES = {"volviz/": "volviz/", "ui/volviz_ui/": "volviz_ui/", "data/": "volviz/data/"}


@pytest.fixture(scope="module")
def tracked() -> set[str]:
    """Files that git knows, with / as separator."""
    command = ["git", "-C", str(CHECKOUT), "ls-files", *PLACES]
    listed = subprocess.run(command, check=False, capture_output=True, text=True)
    if listed.returncode != 0:
        pytest.skip("this is no git checkout, so that there is no list to compare with")
    return {name for name in listed.stdout.splitlines() if (CHECKOUT / name).exists()}


def test_the_wheel_holds_every_module_shader_and_volume(tracked: set[str], tmp_path: Path) -> None:
    wheel = next(WheelBuilder(str(CHECKOUT)).build(directory=str(tmp_path), versions=["standard"]))
    held = set(zipfile.ZipFile(wheel).namelist())
    expected = {
        place + name.removeprefix(folder)
        for name in tracked
        for folder, place in PLACES.items()
        if name.startswith(folder)
    }
    assert expected
    assert expected - held == set()


def test_the_source_archive_holds_them_too(tracked: set[str], tmp_path: Path) -> None:
    archive = next(SdistBuilder(str(CHECKOUT)).build(directory=str(tmp_path), versions=["standard"]))
    with tarfile.open(archive) as opened:
        held = {name.partition("/")[2] for name in opened.getnames()}
    assert tracked - held == set()
