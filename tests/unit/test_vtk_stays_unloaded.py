"""Listing techniques and matching their settings loads no VTK: it takes a second."""

from __future__ import annotations

import subprocess
import sys

CODE = """
import sys, volviz
from volviz.compare.matching import match
from volviz.model.parameters import make_settings
info = volviz.techniques()["raycast"]
match("raycast", make_settings(info.settings, {}, owner="raycast"), "vtk_gpu")
loaded = [name for name in ("vtkmodules", "pyvista", "PySide6") if name in sys.modules]
print(",".join(loaded))
"""


def test_techniques_are_listed_and_matched_without_vtk() -> None:
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""
