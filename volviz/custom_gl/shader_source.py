"""GLSL from files: ``#include``, hooks, layers, defines and a line map, so that errors name file and line. Text only.

``#include "name.glsl"`` takes the file beside the including one or, failing that, from ``custom_gl/glsl``; every file
is included once. ``#include <hook>`` takes the file that the caller names for that hook, or the hook's default: this is
how a shader is a template whose parts (fetching, classification, shading, compositing) are exchanged as whole files
instead of branches.

A file with the line ``#pragma per_layer`` belongs to one volume. ``#include "layer.glsl" LAYER1`` includes it, and the
files of this kind that it includes, once more with ``_1`` after every name that they declare: samplers, uniforms,
functions, structs, variables and macros (fields of structs keep theirs, and must not be called like one of these). So
two volumes stand in one loop. Layer 0 keeps the names as they are written. A hook of layer 1 is looked for as
``hook_1`` first, and so is a define: where the caller gives ``MODE_1``, ``MODE`` in the text of layer 1 means that.

Lines between ``#pragma each_layer`` and ``#pragma end`` stand there once for each layer (the define ``LAYERS`` says how
many there are, 1 unless it is given), as text of that layer: names of its files get its number, and the word ``LAYER``
becomes the number itself. ``#pragma each_label`` is the same for layers of labels (``LABELS``, 0 unless it is given),
which are counted on from those, and ``#pragma each_lattice`` for the layers that stand for a lattice: those whose
define ``LATTICE`` is their own number.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import takewhile
from pathlib import Path

from volviz.errors import ShaderError

GLSL = Path(__file__).parent / "glsl"
VERSION = "#version 330 core"

#: Files of the hooks that need not be chosen.
DEFAULT_HOOKS = {
    "march": "march.glsl",
    "fetch": "fetch/texture.glsl",
    "classify": "classify/curve.glsl",
    "shade": "shade/unlit.glsl",
    "occlusion": "occlusion/none.glsl",
}

_INCLUDE = re.compile(r'^\s*#\s*include\s+(?:"([^"]+)"|<([^>]+)>)(?:\s+LAYER(\d+))?\s*$')
_PER_LAYER = re.compile(r"^\s*#\s*pragma\s+per_layer\s*$")
_EACH = re.compile(r"^\s*#\s*pragma\s+each_(layer|label|lattice)\s*$")
_END = re.compile(r"^\s*#\s*pragma\s+end\s*$")
_OF_LAYER = re.compile(r"^(\w+?)_(\d+)$")
_DECLARED = re.compile(
    r"^\s*(?:#\s*define\s+(\w+)|struct\s+(\w+)|(?:uniform\s+|const\s+)?\w+\s+(\w+)\s*[\[;=(,])"
)
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


def layer_name(name: str, layer: int) -> str:
    """What a sampler, uniform or function of a chunk is called in a layer."""
    return f"{name}_{layer}" if layer else name


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
        File for each ``#include <hook>``, a path or a name in ``custom_gl/glsl``; ``name_1`` is that of layer 1.
    overrides : mapping of Path to str
        Edited text that takes the place of a file, for live editing.

    Raises
    ------
    ShaderError
        A file, hook or define that does not exist or is malformed, named with file and line.
    """
    defines = defines or {}
    out = [VERSION]
    for name, value in sorted(defines.items()):
        if not _NAME.match(name):
            raise ShaderError(f"a shader define is written in UPPER_CASE, got {name!r} for {path.name}.")
        out.append(f"#define {name} {int(value) if isinstance(value, bool) else value}")
    assembly = _Assembly(out, DEFAULT_HOOKS | dict(hooks or {}), overrides or {}, defines)
    assembly.insert(path, 0)
    return ShaderText("\n".join(out) + "\n", tuple(assembly.files))


class _Assembly:
    """A shader in the making.

    Attributes
    ----------
    files : list of Path
        Included files by number; one that is included for two layers has two.
    """

    def __init__(
        self,
        out: list[str],
        hooks: Mapping[str, str | Path],
        overrides: Mapping[Path, str],
        defines: Mapping[str, object],
    ) -> None:
        self.files: list[Path] = []
        self._out = out
        self._hooks = hooks
        self._overrides = overrides
        self._included: set[tuple[Path, int]] = set()
        self._names: dict[int, set[str]] = {}
        for name in defines:
            match = _OF_LAYER.match(name)
            if match:
                self._names.setdefault(int(match[2]), set()).add(match[1])
        layers, labels = (int(str(defines.get(*count))) for count in (("LAYERS", 1), ("LABELS", 0)))
        all_layers = range(layers + labels)
        self._numbers: dict[str, Sequence[int]] = {
            "layer": all_layers[:layers],
            "label": all_layers[layers:],
            "lattice": [n for n in all_layers if int(str(defines.get(layer_name("LATTICE", n), n))) == n],
        }

    def insert(self, path: Path, layer: int) -> None:
        """Append a file and what it includes; names of a layer other than 0 get its number."""
        number = len(self.files)
        self.files.append(path)
        self._included.add((path, layer))
        self._out.append(f"#line 1 {number}")
        lines = list(enumerate(self._lines(path), start=1))
        while lines:
            line_number, line = lines.pop(0)
            each = _EACH.match(line)
            if not each:
                self._insert_line(path, number, line_number, line, layer)
                continue
            block = list(takewhile(lambda numbered: not _END.match(numbered[1]), lines))
            del lines[: len(block) + 1]
            for n in self._numbers[each[1]]:
                self._out.append(f"#line {line_number + 1} {number}")
                for inner_number, inner_line in block:
                    self._insert_line(path, number, inner_number, inner_line, n, repeated=True)
            self._out.append(f"#line {line_number + len(block) + 2} {number}")

    def _insert_line(
        self, path: Path, number: int, line_number: int, line: str, layer: int, *, repeated: bool = False
    ) -> None:
        """Append a line of a file as text of a layer; `repeated`: it stands there for each of them."""
        if line.lstrip().startswith("#version"):
            raise ShaderError(
                f"{path.name}, line {line_number}: shader files have no #version line, it is added.",
                file=path.name,
                line=line_number,
            )
        match = _INCLUDE.match(line)
        if not match:
            # the compiler warns of pragmas that it does not know
            self._out.append("" if _PER_LAYER.match(line) else self._of_layer(line, layer))
            return
        included = self._find(path, line_number, match, layer)
        inner = int(match[3] or layer) if self._is_per_layer(included) else 0
        if inner and (repeated or not layer):
            self._collect_names(included, inner, set())
        if (included, inner) in self._included:
            self._out.append("")
        else:
            self.insert(included, inner)
            self._out.append(f"#line {line_number + 1} {number}")

    def _lines(self, path: Path) -> tuple[str, ...]:
        if path in self._overrides:
            return tuple(self._overrides[path].splitlines())
        try:
            return read_lines(path)
        except OSError:
            raise ShaderError(f"the shader file {path} cannot be read.", file=path.name) from None

    def _is_per_layer(self, path: Path) -> bool:
        return any(_PER_LAYER.match(line) for line in self._lines(path))

    def _of_layer(self, line: str, layer: int) -> str:
        """A line with the layer's number after the names that belong to it; fields of structs have none."""
        names = self._names.get(layer, ())

        def named(match: re.Match[str]) -> str:
            if match[0] == "LAYER":
                return str(layer)
            return layer_name(match[0], layer) if match[0] in names else match[0]

        return re.sub(r"(?<![.\w])[A-Za-z_]\w*", named, line)

    def _collect_names(self, path: Path, layer: int, seen: set[Path]) -> None:
        """Learn which names a file, and those of the same layer that it includes, declare outside of functions."""
        seen.add(path)
        depth = 0
        for line_number, line in enumerate(self._lines(path), start=1):
            code = line.split("//")[0]
            declared = _DECLARED.match(code) if depth == 0 else None
            if declared:
                self._names.setdefault(layer, set()).add(next(filter(None, declared.groups())))
            depth += sum(code.count(c) for c in "({") - sum(code.count(c) for c in ")}")
            match = _INCLUDE.match(line)
            if match:
                included = self._find(path, line_number, match, layer)
                if included not in seen and self._is_per_layer(included):
                    self._collect_names(included, layer, seen)

    def _find(self, path: Path, line: int, match: re.Match[str], layer: int) -> Path:
        """The file that an include means."""
        hook = match[2]
        if hook is not None:
            chosen = self._hooks.get(layer_name(hook, int(match[3] or layer)), self._hooks.get(hook))
            if chosen is None:
                raise ShaderError(
                    f"{path.name}, line {line}: nothing was chosen for the hook <{hook}>.",
                    file=path.name,
                    line=line,
                )
            candidates = [GLSL / chosen]
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
