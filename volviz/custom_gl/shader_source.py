"""GLSL from files: ``#include``, defines and a line map, so that errors name file and line. Text only, no GPU.

``#include "name.glsl"`` takes the file beside the including one or, failing that, from ``custom_gl/glsl``; every file
is included once. ``#include <hook>`` takes the file that the caller names for that hook: this is how a shader is a
template whose parts (the compositing mode, say) are exchanged as whole files instead of branches.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from volviz.errors import ShaderError

GLSL = Path(__file__).parent / "glsl"
VERSION = "#version 330 core"

_INCLUDE = re.compile(r'^\s*#\s*include\s+(?:"([^"]+)"|<([^>]+)>)\s*$')
_NAME = re.compile(r"^[A-Z][A-Z0-9_]*$")
# Mesa "0:12(3): error: ...", NVIDIA "0(12) : error C0000: ...", Apple/AMD "ERROR: 0:12: ..."
_LOG = re.compile(r"^(?:ERROR:\s*)?(\d+)(?::(\d+)|\((\d+)\))(?![^\n]*warning)[^\n]*:[^\n]*$", re.MULTILINE)


@dataclass(frozen=True)
class ShaderText:
    """An assembled shader.

    Attributes
    ----------
    text : str
        Complete GLSL with ``#version`` and ``#line`` directives.
    files : tuple of Path
        Source files by the number that ``#line`` gives them.
    """

    text: str
    files: tuple[Path, ...]

    def locate(self, log: str) -> tuple[Path | None, int]:
        """File and line of the first error in a compiler's log; (None, 0) when it names none."""
        for match in _LOG.finditer(log):
            number = int(match[1])
            if number < len(self.files):
                return self.files[number], int(match[2] or match[3])
        return None, 0


@cache
def _read(path: Path, _modified: int) -> tuple[str, ...]:
    return tuple(path.read_text(encoding="utf-8").splitlines())


def read_lines(path: Path) -> tuple[str, ...]:
    """Lines of a file, from a cache as long as the file is unchanged."""
    return _read(path, path.stat().st_mtime_ns)


def assemble(
    path: Path,
    defines: Mapping[str, object] | None = None,
    hooks: Mapping[str, str | Path] | None = None,
    overrides: Mapping[Path, str] | None = None,
) -> ShaderText:
    """Read a shader, insert its includes and its defines.

    Parameters
    ----------
    path : Path
        The shader's file (``.vert`` or ``.frag``), without a ``#version`` line.
    defines : mapping
        Macros in UPPER_CASE; True becomes 1, False 0.
    hooks : mapping
        File for each ``#include <hook>``, a path or a name in ``custom_gl/glsl``.
    overrides : mapping of Path to str
        Edited text that takes the place of a file, for live editing.

    Raises
    ------
    ShaderError
        A file, hook or define that does not exist or is malformed, named with file and line.
    """
    defines = defines or {}
    files: list[Path] = []
    out = [VERSION]
    for name, value in sorted(defines.items()):
        if not _NAME.match(name):
            raise ShaderError(f"a shader define is written in UPPER_CASE, got {name!r} for {path.name}.")
        out.append(f"#define {name} {int(value) if isinstance(value, bool) else value}")
    _insert(path, out, files, hooks or {}, overrides or {})
    return ShaderText("\n".join(out) + "\n", tuple(files))


def _insert(
    path: Path,
    out: list[str],
    files: list[Path],
    hooks: Mapping[str, str | Path],
    overrides: Mapping[Path, str],
) -> None:
    number = len(files)
    files.append(path)
    try:
        lines = tuple(overrides[path].splitlines()) if path in overrides else read_lines(path)
    except OSError:
        raise ShaderError(f"the shader file {path} cannot be read.", file=path.name) from None
    out.append(f"#line 1 {number}")
    for line_number, line in enumerate(lines, start=1):
        if line.lstrip().startswith("#version"):
            raise ShaderError(
                f"{path.name}, line {line_number}: shader files have no #version line, it is added.",
                file=path.name,
                line=line_number,
            )
        match = _INCLUDE.match(line)
        if not match:
            out.append(line)
            continue
        included = _find(path, line_number, match, hooks)
        if included not in files:
            _insert(included, out, files, hooks, overrides)
            out.append(f"#line {line_number + 1} {number}")
        else:
            out.append("")


def _find(path: Path, line: int, match: re.Match[str], hooks: Mapping[str, str | Path]) -> Path:
    if match[2] is not None:
        if match[2] not in hooks:
            raise ShaderError(
                f"{path.name}, line {line}: nothing was chosen for the hook <{match[2]}>.",
                file=path.name,
                line=line,
            )
        chosen = Path(hooks[match[2]])
        candidates = [chosen] if chosen.is_absolute() else [GLSL / chosen]
    else:
        candidates = [path.parent / match[1], GLSL / match[1]]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    raise ShaderError(
        f"{path.name}, line {line}: there is no file {candidates[0].name} to include.",
        file=path.name,
        line=line,
    )
