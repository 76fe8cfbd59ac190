"""The package and its metadata tell the same version."""

from __future__ import annotations

from importlib.metadata import version

import volviz


def test_the_package_reports_the_version_of_its_metadata() -> None:
    assert volviz.__version__ == version("volviz")
