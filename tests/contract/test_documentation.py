"""What the documentation shows: links lead somewhere, command lines and code are understood, settings exist."""

from __future__ import annotations

import ast
import importlib
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest

import volviz
from volviz.cli import COMMANDS, make_parser, window_parser
from volviz.commands.drawing import parse_values
from volviz.custom_gl.settings import SharedSettings
from volviz.custom_gl.technique import TechniqueInfo
from volviz.model.parameters import parameters_of

ROOT = Path(__file__).parents[2]
PAGES = sorted(
    [
        *ROOT.glob("*.md"),
        *ROOT.glob("docs/**/*.md"),
        *ROOT.glob("volviz/**/README.md"),
        *ROOT.glob("data/**/*.md"),
        *ROOT.glob("benchmarks/**/*.md"),
    ]
)
#: Keywords of `volviz.render` and `volviz.add_volume` that are no settings.
KEYWORDS = {
    "technique", "transfer_function", "size", "camera", "background", "dtype", "settings", "light", "clipping",
    "classic", "look", "show", "title",
}  # fmt: skip


def named(page: Path) -> str:
    return str(page.relative_to(ROOT))


def blocks(page: Path) -> Iterator[str]:
    """Indented and fenced pieces of a page, without their margin."""
    text = page.read_text(encoding="utf-8")
    yield from (match[1] for match in re.finditer(r"^```\w*\n(.*?)^```", text, re.MULTILINE | re.DOTALL))
    for match in re.finditer(r"(?<=\n\n)((?: {4}.*\n|\n)+)", text):
        yield re.sub(r"^ {4}", "", match[1], flags=re.MULTILINE)


def command_lines() -> list[tuple[str, str]]:
    return [
        (named(page), line)
        for page in PAGES
        for block in blocks(page)
        for line in block.splitlines()
        if line.startswith("volviz ")
    ]


def python_blocks() -> list[tuple[str, str]]:
    return [
        (named(page), "\n".join(line for line in block.splitlines() if not line.startswith("volviz ")))
        for page in PAGES
        for block in blocks(page)
        if re.search(r"^(import|from) \w|volviz\.\w+\(", block, re.MULTILINE)
    ]


def information(technique: str) -> TechniqueInfo:
    return volviz.techniques()[technique]


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_every_link_leads_somewhere(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    targets = re.findall(r"\]\(([^)\s]+)\)", text)
    local = [target.split("#")[0] for target in targets if not re.match(r"https?:|mailto:|#", target)]
    assert [target for target in local if target and not (page.parent / target).exists()] == []


@pytest.mark.parametrize(("page", "line"), command_lines())
def test_every_command_line_is_understood(page: str, line: str) -> None:
    words = shlex.split(line, comments=True)[1:]
    if words and words[0] not in COMMANDS and not words[0].startswith("-"):
        # the window, with a file
        assert len(window_parser().parse_args(words).files) == 1
        return
    options = make_parser().parse_args(words)
    chosen = getattr(options, "technique", None) or getattr(options, "techniques", None) or []
    for one in [chosen] if isinstance(chosen, str) else chosen:
        for technique in one.split(","):
            name, *values = technique.split(":")
            parse_values(information(name), [*values, *(getattr(options, "values", None) or [])])
    if getattr(options, "preset", None):
        assert options.preset in volviz.presets()


@pytest.mark.parametrize(("page", "code"), python_blocks())
def test_every_piece_of_code_names_what_there_is(page: str, code: str) -> None:
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.ImportFrom):
            module = importlib.import_module(str(node.module))
            assert [name.name for name in node.names if not hasattr(module, name.name)] == []
        if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)):
            continue
        if not (isinstance(node.func.value, ast.Name) and node.func.value.id == "volviz"):
            continue
        assert hasattr(volviz, node.func.attr)
        if node.func.attr in ("render", "add_volume"):
            given = {keyword.arg: keyword.value for keyword in node.keywords}
            technique = given.get("technique", ast.Constant("raycast"))
            assert isinstance(technique, ast.Constant)
            known = KEYWORDS | {p.name for p in parameters_of(SharedSettings)}
            known |= {p.name for p in information(str(technique.value)).parameters}
            assert set(given) <= known


@pytest.mark.parametrize(
    "page", [p for p in PAGES if p.name == "README.md" and p.parent.name in volviz.techniques()], ids=named
)
def test_every_setting_in_a_table_exists_and_is_called_as_in_the_window(page: Path) -> None:
    labels = {
        p.name: p.label for p in (*information(page.parent.name).parameters, *parameters_of(SharedSettings))
    }
    rows = re.findall(r"^\| ([^|]*`\w[^|]*) \|", page.read_text(encoding="utf-8"), re.MULTILINE)
    for row in rows:
        names = [name.split("=")[0] for name in re.findall(r"`(\w+(?:=[^`]*)?)`", row)]
        assert [name for name in names if name not in labels] == []
        shown = re.findall(r"\*([^*]+)\*", row)
        if len(shown) == len(names):
            assert [(name, labels[name]) for name in names] == list(zip(names, shown, strict=True))
