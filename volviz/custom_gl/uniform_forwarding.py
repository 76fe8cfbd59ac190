"""Uniforms that reach the fragment shader through the vertex shader; text only, no GPU.

llvmpipe computes eight pixels together, but reads a uniform for each of them alone: about twenty instructions a
component, anew in every turn of a loop, and as expensive as a fetch from a texture (Mesa 22.3, seen in the code that it
makes). A value that the vertex shader hands on without interpolation is read once for all eight. Where OpenGL is
computed in software, `forward_uniforms` therefore rewrites the two stages of a program: what the fragment shader
declares as uniform is declared by the vertex shader, packed into ``flat`` outputs, and a macro of the uniform's name
unpacks it. Shader files know nothing of it. Arrays and samplers stay uniforms, and so do the widest ones (matrices,
which most shaders read once) where there are more than the stages can exchange.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from volviz.custom_gl.shader_source import ShaderText

_DECLARATION = re.compile(r"^\s*uniform\s+(\w+)\s+(\w+)\s*;")
_MAIN = re.compile(r"^(\s*void\s+)main(\s*\(\s*\))", re.MULTILINE)

#: Components and columns of the types that can be carried, and how they come back from floats.
_VECTORS = {
    "float": (1, "{0}"),
    "bool": (1, "({0} > 0.5)"),
    "int": (1, "int({0})"),
    "vec2": (2, "{0}"),
    "ivec2": (2, "ivec2({0})"),
    "vec3": (3, "{0}"),
    "ivec3": (3, "ivec3({0})"),
    "vec4": (4, "{0}"),
}
_MATRICES = {"mat3": 3, "mat4": 4}

#: Groups of four components that are carried; OpenGL exchanges at least 32 between the stages, and those of the shader
#: itself are among them. Mesa does not refuse more, it crashes.
MOST_CARRIED = 30


@dataclass
class _Varying:
    """Four components on their way."""

    name: str
    parts: list[str] = field(default_factory=list)
    used: int = 0

    def take(self, expression: str, components: int) -> str:
        """Load an expression of so many components and say how it is read."""
        begin = self.used
        self.parts.append(expression)
        self.used += components
        return f"{self.name}.{'xyzw'[begin : self.used]}"

    @property
    def assignment(self) -> str:
        rest = ["0.0"] * (4 - self.used)
        return f"{self.name} = vec4({', '.join(self.parts + rest)});"


def forward_uniforms(vertex: ShaderText, fragment: ShaderText) -> tuple[ShaderText, ShaderText]:
    """The same two stages with the fragment shader's uniforms carried; lines keep their numbers."""
    lines = fragment.text.split("\n")
    found: dict[str, str] = {}
    for line in lines:
        match = _DECLARATION.match(line)
        if match and (match[1] in _VECTORS or match[1] in _MATRICES):
            found[match[2]] = match[1]
    forwarded = _carried(found)
    for number, line in enumerate(lines):
        match = _DECLARATION.match(line)
        if match and match[2] in forwarded:
            lines[number] = line[match.end() :]
    varyings: list[_Varying] = []
    macros = [f"#define {name} {_loaded(kind, name, varyings)}" for name, kind in _widest_first(forwarded)]
    inputs = [f"flat in vec4 {c.name};" for c in varyings]
    known = {match[2] for line in vertex.text.split("\n") if (match := _DECLARATION.match(line))}
    outputs = [f"uniform {kind} {name};" for name, kind in forwarded.items() if name not in known]
    outputs += [f"flat out vec4 {c.name};" for c in varyings]
    load = "\n".join(["void main() {", "own_main();", *(c.assignment for c in varyings), "}"])
    return (
        ShaderText(_headed(_MAIN.sub(r"\1own_main\2", vertex.text), outputs) + load + "\n", vertex.files),
        ShaderText(_headed("\n".join(lines), [*inputs, *macros]), fragment.files),
    )


def _carried(found: dict[str, str]) -> dict[str, str]:
    """As many of the uniforms as can be carried, narrow ones first, in their own order."""
    left = 4 * MOST_CARRIED
    chosen = set()
    for name, kind in sorted(found.items(), key=lambda entry: _components(entry[1])):
        # a column of three components takes the room of four, unless a single one fills it
        left -= (
            4 * _MATRICES[kind] if kind in _MATRICES else 4 if _VECTORS[kind][0] == 3 else _VECTORS[kind][0]
        )
        if left < 0:
            break
        chosen.add(name)
    return {name: kind for name, kind in found.items() if name in chosen}


def _components(kind: str) -> int:
    return _MATRICES[kind] ** 2 if kind in _MATRICES else _VECTORS[kind][0]


def _widest_first(forwarded: dict[str, str]) -> list[tuple[str, str]]:
    def width(entry: tuple[str, str]) -> int:
        return -_MATRICES.get(entry[1], 0) or -_VECTORS[entry[1]][0]

    return sorted(forwarded.items(), key=width)


def _loaded(kind: str, name: str, varyings: list[_Varying]) -> str:
    """Load a uniform into carriers with room for it; the expression that reads it."""
    columns = _MATRICES.get(kind)
    if columns:
        taken = [_with_room(columns, varyings).take(f"{name}[{n}]", columns) for n in range(columns)]
        return f"{kind}({', '.join(taken)})"
    components, back = _VECTORS[kind]
    whole = f"vec{components}({name})" if components > 1 else f"float({name})"
    return back.format(_with_room(components, varyings).take(whole, components))


def _with_room(components: int, varyings: list[_Varying]) -> _Varying:
    for varying in varyings:
        if varying.used + components <= 4:
            return varying
    varyings.append(_Varying(f"carried_{len(varyings)}"))
    return varyings[-1]


def _headed(text: str, head: list[str]) -> str:
    """Text with lines in front of its first numbered one."""
    return text.replace("\n#line", "\n" + "\n".join([*head, "#line"]), 1) if head else text
