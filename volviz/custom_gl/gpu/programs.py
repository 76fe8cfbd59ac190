"""Programs from assembled shader files, with errors that name file and line."""

from __future__ import annotations

import re
import weakref
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from volviz.custom_gl.shader_source import ShaderText, assemble, layer_name
from volviz.custom_gl.uniform_forwarding import forward_uniforms
from volviz.errors import ShaderError

#: Texture unit of every shared sampler; samplers of different types never meet on one unit.
UNITS = {
    "t_scalars": 0,
    "t_table": 1,
    "t_scene_depth": 2,
    "t_distance": 3,
    "t_preintegrated": 4,
    "t_segments": 1,  # a program reads the curve or regions
}
#: First unit that is free for a technique's own samplers.
FIRST_FREE_UNIT = 5


class Program:
    """A linked program. Uniforms that the compiler removed are silently absent, unknown types are not.

    Attributes
    ----------
    forwarded : bool
        The fragment shader's uniforms come through the vertex shader.
    """

    def __init__(
        self, context: Any, vertex: ShaderText, fragment: ShaderText, label: str, *, forwarded: bool = False
    ) -> None:
        linked = _linked_forwarding(context, vertex, fragment) if forwarded else None
        self.forwarded = linked is not None
        try:
            self.gl = linked or context.program(vertex_shader=vertex.text, fragment_shader=fragment.text)
        except Exception as error:  # noqa: BLE001 - moderngl raises plain ones
            raise _shader_error(str(error), vertex, fragment, label) from None
        self.label = label
        # weak: programs live as long as their window, a frame holds its volume
        self._user: weakref.ref[Any] | None = None
        self._members = {name: self.gl[name] for name in self.gl}
        free = FIRST_FREE_UNIT
        self.units: dict[str, int] = {}
        for name in sorted(self._members):
            if name.startswith("t_"):
                unit = UNITS.get(name)
                if unit is None:
                    unit, free = free, free + 1
                self._members[name].value = unit
                self.units[name] = unit

    def __contains__(self, name: str) -> bool:
        return name in self._members

    def is_taken_over(self, user: object) -> bool:
        """Whether somebody else has set the uniforms last; from now on it is this user (a frame).

        Programs are shared by everything in a window.
        """
        if self._user is not None and self._user() is user:
            return False
        self._user = weakref.ref(user)
        return True

    def set(self, uniforms: Mapping[str, Any], layer: int = 0) -> None:
        """Set the uniforms that the program has, those of a layer by their plain names; the others are left out.

        Matrices are given as (4, 4) or (3, 3) arrays in row-major order and transposed here.
        """
        members = self._members
        for name, value in uniforms.items():
            member = members.get(layer_name(name, layer))
            if member is None:
                continue
            if isinstance(value, np.ndarray):
                matrix = value.T if value.ndim == 2 and value.shape[0] == value.shape[1] else value
                member.write(np.ascontiguousarray(matrix, dtype=np.float32).tobytes())
            else:
                member.value = value

    def use_texture(self, name: str, texture: Any, layer: int = 0) -> None:
        """Bind a texture to the unit of a sampler, when the program has it."""
        unit = self.units.get(layer_name(name, layer))
        if unit is not None:
            texture.use(unit)

    def release(self) -> None:
        """Release the program; the context must be current."""
        self.gl.release()


class ProgramCache:
    """Programs by shader files, defines and hooks; a program is compiled once per context.

    Parameters
    ----------
    context : moderngl.Context
        Where they are compiled.
    forwards_uniforms : bool
        Reading a uniform in a fragment shader is expensive (see `volviz.custom_gl.uniform_forwarding`).
    """

    def __init__(self, context: Any, *, forwards_uniforms: bool = False) -> None:
        self._context = context
        self.forwards_uniforms = forwards_uniforms
        self._programs: dict[Any, Program] = {}
        self.overrides: dict[Path, str] = {}
        self.compiled = 0

    def get(
        self,
        vertex: Path,
        fragment: Path,
        defines: Mapping[str, object] | None = None,
        hooks: Mapping[str, str | Path] | None = None,
        *,
        many_vertices: bool = False,
    ) -> Program:
        """The program of these files; with many vertices their shader is kept free of other work.

        Raises
        ------
        ShaderError
            A file does not compile, named with its line.
        """
        key = (
            vertex,
            fragment,
            tuple(sorted((defines or {}).items())),
            tuple(sorted((k, str(v)) for k, v in (hooks or {}).items())),
        )
        program = self._programs.get(key)
        if program is None:
            texts = [assemble(path, defines, hooks, self.overrides) for path in (vertex, fragment)]
            forwarded = self.forwards_uniforms and not many_vertices
            program = Program(self._context, texts[0], texts[1], fragment.name, forwarded=forwarded)
            self._programs[key] = program
            self.compiled += 1
        return program

    @property
    def all(self) -> Iterator[Program]:
        """Those that have been compiled."""
        yield from self._programs.values()

    def forget(self) -> None:
        """Release every program, for example after a shader was edited."""
        for program in self._programs.values():
            program.release()
        self._programs.clear()


def _linked_forwarding(context: Any, vertex: ShaderText, fragment: ShaderText) -> Any:
    """The program with carried uniforms; None where that does not link, an edited shader for example."""
    forwarding = forward_uniforms(vertex, fragment)
    try:
        return context.program(vertex_shader=forwarding[0].text, fragment_shader=forwarding[1].text)
    except Exception:  # noqa: BLE001 - moderngl raises plain ones; what is wrong is told of the shaders as they are
        return None


def _shader_error(log: str, vertex: ShaderText, fragment: ShaderText, label: str) -> ShaderError:
    text = vertex if "vertex_shader" in log else fragment
    path, line = text.locate(log)
    reason = next((row for row in log.splitlines() if "error" in row.lower() and ":" in row), log.strip())
    reason = re.split(r"error(?: C\d+)?:", reason, maxsplit=1)[-1].strip() or "the driver gave no reason"
    where = f"{path.name}, line {line}" if path is not None else label
    return ShaderError(f"{where}: {reason}", file=path.name if path else label, line=line, log=log)
