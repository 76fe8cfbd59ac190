"""Shader texts: includes, hooks, defines, places of errors, and uniforms that are carried through the vertex shader."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from volviz.custom_gl.carried_uniforms import carry
from volviz.custom_gl.shader_source import GLSL, ShaderText, assemble
from volviz.errors import ShaderError

VERTEX = "#version 330 core\n#line 1 0\nuniform mat4 u_m;\nin vec3 a_p;\nvoid main() {\n}\n"
FRAGMENT = """#version 330 core
#define SHADING 1
#line 1 0
uniform sampler2D t_picture;
uniform mat4 u_m;     // rows
uniform mat3 u_turn;
uniform vec4 u_planes[6];
uniform vec3 u_low;
uniform vec3 u_high;
uniform float u_step;
uniform bool u_jitter;
uniform ivec2 u_axis;
out vec4 f_color;
void main() { f_color = u_m * vec4(u_low, u_step); }
"""


def texts(vertex: str = VERTEX, fragment: str = FRAGMENT) -> tuple[str, str]:
    made = carry(ShaderText(vertex, (Path("a.vert"),)), ShaderText(fragment, (Path("a.frag"),)))
    return made[0].text, made[1].text


def test_every_file_is_included_once_and_lines_keep_their_numbers(tmp_path: Path) -> None:
    (tmp_path / "part.glsl").write_text("float part;\n")
    (tmp_path / "whole.frag").write_text('#include "part.glsl"\n#include "part.glsl"\nfloat whole;\n')
    text = assemble(tmp_path / "whole.frag", {"SHADING": True, "TAPS": 3})
    assert text.text.count("float part;") == 1
    assert "#define SHADING 1" in text.text
    assert "#define TAPS 3" in text.text
    after = text.text.split("#line 2 0\n")[1].split("\n")
    assert after[1] == "float whole;", "it stands in line 3 of its file"
    assert [path.name for path in text.files] == ["whole.frag", "part.glsl"]


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        ('float a;\n#include "nowhere.glsl"\n', "wrong.frag, line 2: there is no file nowhere.glsl"),
        ("#include <mode>\n", "wrong.frag, line 1: nothing was chosen for the hook <mode>"),
        ("\n#version 130\n", "wrong.frag, line 2: shader files have no #version line"),
    ],
)
def test_what_is_wrong_in_a_shader_file_is_told_with_its_line(
    tmp_path: Path, content: str, complaint: str
) -> None:
    (tmp_path / "wrong.frag").write_text(content)
    with pytest.raises(ShaderError, match=complaint):
        assemble(tmp_path / "wrong.frag")


@pytest.mark.parametrize(
    "log",
    ["0:3(7): error: syntax error", "0(3) : error C0000: syntax error", "ERROR: 0:3: 'x' : syntax error"],
)
def test_the_first_error_of_a_compiler_is_found_in_its_file(log: str) -> None:
    path, line = assemble(GLSL / "composite.frag").locate(f"some words\n{log}\n")
    assert (path.name if path else None, line) == ("composite.frag", 3)


def test_uniforms_of_the_fragment_shader_are_declared_by_the_vertex_shader_once() -> None:
    vertex, fragment = texts()
    assert vertex.count("uniform mat4 u_m;") == 1
    for declaration in ("vec3 u_low", "float u_step", "bool u_jitter", "ivec2 u_axis", "mat3 u_turn"):
        assert f"uniform {declaration};" in vertex
        assert f"uniform {declaration};" not in fragment
    for kept in ("uniform sampler2D t_picture;", "uniform vec4 u_planes[6];"):
        assert kept in fragment, "samplers and arrays are not carried"
    assert "own_main()" in vertex


def test_every_component_has_a_place_of_its_own() -> None:
    vertex, fragment = texts()
    loads = [line for line in vertex.split("\n") if line.startswith("carried_")]
    assert len(loads) == 10, "4 + 3 columns and two vectors, of which five have room for a number, and a pair"
    macros = {line.split()[1]: line for line in fragment.split("\n") if line.startswith("#define u_")}
    assert set(macros) == {"u_m", "u_turn", "u_low", "u_high", "u_step", "u_jitter", "u_axis"}
    places = [
        f"{name}.{component}"
        for line in macros.values()
        for name, components in re.findall(r"(carried_\d+)\.([xyzw]+)", line)
        for component in components
    ]
    assert len(places) == len(set(places)) == 16 + 9 + 3 + 3 + 1 + 1 + 2


def test_carrying_leaves_lines_where_they_are() -> None:
    _, fragment = texts()
    after = fragment.split("#line 1 0\n")[1].split("\n")
    assert after == [
        "" if "uniform" in line and "[" not in line and "sampler" not in line else line
        for line in [part.replace("uniform mat4 u_m;     // rows", "     // rows") for part in
                     FRAGMENT.split("#line 1 0\n")[1].split("\n")]
    ]  # fmt: skip


def test_nothing_to_carry_changes_nothing_in_the_fragment_shader() -> None:
    plain = "#version 330 core\n#line 1 0\nout vec4 f;\nvoid main() { f = vec4(1.0); }\n"
    _, fragment = texts(fragment=plain)
    assert fragment == plain
