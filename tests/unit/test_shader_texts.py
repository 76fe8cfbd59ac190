"""Shader texts: includes, hooks, defines, places of errors, and uniforms that are carried through the vertex shader."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from volviz.custom_gl.shader_source import GLSL, ShaderText, assemble
from volviz.custom_gl.uniform_forwarding import forward_uniforms
from volviz.errors import ShaderError

VERTEX = "#version 330 core\n#line 1 0\nuniform mat4 u_m;\nin vec3 a_p;\nvoid main() {\n}\n"
FRAGMENT = """#version 330 core
#define SHADING 1
#line 1 0
uniform sampler2D t_image;
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
    made = forward_uniforms(ShaderText(vertex, (Path("a.vert"),)), ShaderText(fragment, (Path("a.frag"),)))
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
    for kept in ("uniform sampler2D t_image;", "uniform vec4 u_planes[6];"):
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


@pytest.fixture
def layered(tmp_path: Path) -> Path:
    """A loop over two layers: each has a sampler, a hook and functions that call one another."""
    (tmp_path / "layer.glsl").write_text(
        '#pragma per_layer\n#include "table.glsl"\n#include <fetch>\n#include "noise.glsl"\n'
        "#define LEVELS 3\nstruct Place { float x; };\nfloat g_sum;\n"
        "float color(float x,\n            float y) {\n    Place place;\n    return place.x + fetch(x)"
        " * u_scale * noise(y) + g_sum + LEVELS; // color\n}\n"
    )
    (tmp_path / "table.glsl").write_text("#pragma per_layer\nuniform float u_scale;\n")
    (tmp_path / "noise.glsl").write_text("float noise(float x) { return x; }\n")
    for name in ("one", "two"):
        (tmp_path / f"{name}.glsl").write_text(
            f"#pragma per_layer\nuniform sampler3D t_{name};\nfloat fetch(float x) {{ return x; }}\n"
        )
    (tmp_path / "loop.frag").write_text(
        '#include "layer.glsl"\n#include "layer.glsl" LAYER1\n#include "table.glsl" LAYER1\n'
        "float sum = color(1.0, 2.0) + color_1(1.0, 2.0);\n"
    )
    return tmp_path


def numbered(text: ShaderText) -> dict[str, tuple[str, int]]:
    """File and line number of every line of code, as a compiler counts them; equal lines count once."""
    found: dict[str, tuple[str, int]] = {}
    number, line = 0, 0
    for row in text.text.split("\n"):
        if row.startswith("#line"):
            line, number = (int(word) for word in row.split()[1:])
            continue
        if row.strip() and text.files and line:
            found.setdefault(row, (text.files[number].name, line))
        line += 1 if line else 0
    return found


def test_a_layer_is_included_once_for_each_number_and_its_names_end_in_it(layered: Path) -> None:
    hooks = {"fetch": layered / "one.glsl", "fetch_1": layered / "two.glsl"}
    text = assemble(layered / "loop.frag", hooks=hooks)
    for plain, second in (
        ("uniform float u_scale;", "uniform float u_scale_1;"),
        ("uniform sampler3D t_one;", "uniform sampler3D t_two_1;"),
        ("float fetch(float x) { return x; }", "float fetch_1(float x) { return x; }"),
        ("struct Place { float x; };", "struct Place_1 { float x; };"),
        ("float g_sum;", "float g_sum_1;"),
        ("#define LEVELS 3", "#define LEVELS_1 3"),
        ("float color(float x,", "float color_1(float x,"),
        ("    Place place;", "    Place_1 place;"),
    ):
        assert text.text.count(plain + "\n") == 1, plain
        assert text.text.count(second + "\n") == 1, second
    assert "fetch_1(x) * u_scale_1 * noise(y) + g_sum_1 + LEVELS_1;" in text.text
    assert "float sum = color(1.0, 2.0) + color_1(1.0, 2.0);" in text.text
    assert text.text.count("float noise(float x)") == 1, "a file without the pragma is shared"
    assert "t_two;" not in text.text
    assert "t_one_1;" not in text.text


def test_a_hook_of_a_layer_is_the_shared_one_unless_it_has_its_own(layered: Path) -> None:
    text = assemble(layered / "loop.frag", hooks={"fetch": layered / "one.glsl"}).text
    assert "uniform sampler3D t_one;" in text
    assert "uniform sampler3D t_one_1;" in text


def test_errors_in_every_layer_are_found_in_the_same_line_of_the_same_file(layered: Path) -> None:
    text = assemble(layered / "loop.frag", hooks={"fetch": layered / "one.glsl"})
    lines = numbered(text)
    assert lines["float g_sum;"] == lines["float g_sum_1;"] == ("layer.glsl", 7)
    assert lines["uniform float u_scale;"] == lines["uniform float u_scale_1;"] == ("table.glsl", 2)
    assert lines["float sum = color(1.0, 2.0) + color_1(1.0, 2.0);"] == ("loop.frag", 4)
    row = text.text.split("\n").index("float g_sum_1;")
    number = int([r for r in text.text.split("\n")[:row] if r.startswith("#line")][-1].split()[2])
    path, line = text.locate(f"{number}:7(3): error: something\n")
    assert (path.name if path else None, line) == ("layer.glsl", 7)


def test_the_ray_loop_takes_two_layers() -> None:
    shader = GLSL / "two_layers.frag"
    text = assemble(
        shader,
        {"SCENE_DEPTH": False},
        {"composite": "composite/maximum.glsl", "shade_1": "shade/lit.glsl"},
        {shader: '#include "march.glsl"\n#include "layer.glsl" LAYER1\n'},
    ).text
    for declared in (
        "uniform sampler3D t_scalars{};",
        "uniform isampler2D t_segments{};",
        "uniform vec2 u_scalar_map{};",
        "float sample_scalar{}(vec3 p) {{",
        "vec4 layer_color{}(float front, float back, vec3 p) {{",
        "return fetch{}(p) * u_scalar_map{}.x",
    ):
        for suffix in ("", "_1"):
            assert declared.format(suffix, suffix) in text
    assert "u_light_centred_1" in text
    assert not re.search(r"\bu_light_centred\b", text), "the first layer is unlit"
    assert text.count("uniform vec3 u_box_low;") == 1


def test_lines_for_each_layer_stand_there_once_for_each_with_its_names_and_defines(layered: Path) -> None:
    loop = layered / "each.frag"
    loop.write_text(
        '#pragma each_layer\n#include "layer.glsl"\n#pragma end\n'
        "float at[LAYERS];\n"
        "#pragma each_layer\nat[LAYER] = color(KIND, u_scale);\n#pragma end\n"
        "#pragma each_label\nuint label_LAYER;\nint number = LAYER;\n#pragma end\n"
        "#pragma each_lattice\nint lattice = LAYER;\n#pragma end\nint last;\n"
    )
    defines = {"LAYERS": 2, "LABELS": 1, "LATTICE": 0, "LATTICE_1": 0, "LATTICE_2": 2, "KIND": 5, "KIND_1": 6}
    hooks = {"fetch": layered / "one.glsl", "fetch_1": layered / "two.glsl"}
    text = assemble(loop, defines, hooks)
    for line in (
        "at[0] = color(KIND, u_scale);",
        "at[1] = color_1(KIND_1, u_scale_1);",
        "uniform sampler3D t_one;",
        "uniform sampler3D t_two_1;",
        "int number = 2;",
        "int lattice = 0;",
        "int lattice = 2;",
    ):
        assert text.text.count(line + "\n") == 1, line
    assert "int lattice = 1;" not in text.text
    lines = numbered(text)
    assert lines["at[1] = color_1(KIND_1, u_scale_1);"] == ("each.frag", 6)
    assert lines["int last;"] == ("each.frag", 15)
