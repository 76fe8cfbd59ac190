"""What is special to a technique is said in its folder: nobody else asks for one by its id."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from volviz.custom_gl.registry import techniques
from volviz.model.render_spec import DEFAULT_TECHNIQUE

ROOT = Path(__file__).parent.parent.parent
FOLDERS = ROOT / "volviz" / "custom_gl" / "techniques"
IDS = frozenset(techniques())

#: Texts that are spelt like an id and mean something else, by file.
OTHER_MEANINGS = {
    "ui/volviz_ui/commands/technique.py": {"slice"},  # a part of the names of debug views
    "volviz/io/axes.py": {"slice"},  # a name of an axis
    "volviz/__init__.py": {"marching_cubes"},  # the function
    "volviz/cli.py": {"isosurface"},  # the command
    "volviz/commands/measure.py": {"isosurface"},  # what is measured
    "volviz/commands/meshes.py": {"isosurface"},
    "volviz/custom_gl/vtk_props/volume_props.py": {"isosurface"},  # a blend mode of VTK's mapper
    "volviz/kernels/marching/__init__.py": {"marching_cubes"},
    "volviz/kernels/marching/extract.py": {"marching_cubes", "marching_tetrahedra"},  # names of methods
    "volviz/model/looks/look.py": {"raycast", "isosurface"},  # looks are drawn by one of these
    "volviz/model/render_spec.py": {DEFAULT_TECHNIQUE},  # what draws unless a technique is named
}


def ids_named(source: str) -> set[str]:
    """Ids of techniques among the texts of a Python file."""
    texts = (node.value for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Constant))
    return {text for text in texts if isinstance(text, str) and text in IDS}


def folders_imported(source: str) -> set[str]:
    """Folders of techniques that are imported from, also inside functions."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            found.update(f"{node.module}.{alias.name}" for alias in node.names)
    names = {name.split(".")[3] for name in found if name.startswith("volviz.custom_gl.techniques.")}
    return names & IDS


def sources() -> Iterator[Path]:
    for folder in (ROOT / "volviz", ROOT / "ui" / "volviz_ui"):
        yield from (path for path in folder.rglob("*.py") if FOLDERS not in path.parents)


def test_ids_and_imports_are_seen() -> None:
    assert ids_named("def f(info):\n    return info.id == 'slicing' or 'not slicing'\n") == {"slicing"}
    package = "volviz.custom_gl.techniques"
    lines = f"from {package}.slicing.settings import A\nfrom {package} import raycast\n"
    assert folders_imported(lines) == {"slicing", "raycast"}


def test_no_id_is_named_outside_the_folders_of_techniques() -> None:
    named = {path.relative_to(ROOT).as_posix(): ids_named(path.read_text("utf-8")) for path in sources()}
    assert {path: ids for path, ids in named.items() if ids} == OTHER_MEANINGS


def test_nobody_imports_from_the_folder_of_a_technique() -> None:
    imports = {
        path.relative_to(ROOT).as_posix(): folders_imported(path.read_text("utf-8")) for path in sources()
    }
    assert {path: folders for path, folders in imports.items() if folders} == {}


@pytest.mark.parametrize("technique", sorted(IDS))
def test_what_a_technique_refers_to_is_there(technique: str) -> None:
    info = techniques()[technique]
    assert set(info.counterpart_of) <= IDS - {technique}
    assert set(info.matching.other_meaning) <= set(info.counterpart_of)
