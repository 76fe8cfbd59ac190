"""Techniques are blind to VTK, except those that are VTK's own mappers."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent.parent.parent / "volviz" / "custom_gl" / "techniques"
IDS = sorted(path.name for path in FOLDER.iterdir() if (path / "__init__.py").exists())
VTK = {"vtk", "vtkmodules", "pyvista", "pyvistaqt"}


def imported_packages(source: str) -> set[str]:
    """First parts of all absolute imports, also those inside functions."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module is not None and node.level == 0:
            names.add(node.module)
    return {name.partition(".")[0] for name in names}


def test_imports_inside_functions_are_seen() -> None:
    assert imported_packages("def f():\n    from vtkmodules.util import x\n    import pyvista as pv\n") == {
        "vtkmodules",
        "pyvista",
    }


@pytest.mark.parametrize("technique", [name for name in IDS if not name.startswith("vtk_")])
def test_our_techniques_import_neither_vtk_nor_pyvista(technique: str) -> None:
    for path in (FOLDER / technique).rglob("*.py"):
        assert imported_packages(path.read_text(encoding="utf-8")) & VTK == set(), path
