"""Every uniform is read by a shader: those that are set, and those that shader files declare."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import volviz
import volviz.custom_gl
from tests.render.scenes import function, shown, volume
from volviz.custom_gl.arguments import spec_of
from volviz.custom_gl.gpu.programs import Program
from volviz.custom_gl.registry import techniques
from volviz.custom_gl.settings import MODES
from volviz.custom_gl.shader_source import GLSL, ShaderText
from volviz.custom_gl.vtk.vtk_imports import pyvista
from volviz.model.render_spec import DEFAULT_TECHNIQUE
from volviz.model.surface_values import SurfaceColors, SurfaceValues
from volviz.model.transfer.function_2d import Region, TransferFunction2D
from volviz.volume_data.budgets import set_budgets

SIZE = (64, 48)
_DECLARATION = re.compile(r"^\s*uniform\s+\w+\s+(\w+)\s*(?:\[\w+\])?\s*;", re.MULTILINE)


class Record:
    """What was set and what was read while images were drawn.

    Attributes
    ----------
    shared : set of str
        Names that the host sets for every program.
    technique : str
        Which one is being drawn.
    own : dict of str to set of str
        Names that a technique sets for its programs, by its id.
    read_by : dict of str to set of str
        Names that the linked programs of a technique have, likewise.
    declared : dict of Path to set of str
        Names by the file that declares them.
    read_in : dict of Path to set of str
        Those of them that a program reads in which the file takes part.
    planes : set of (int, int)
        For each linked program how many clip planes it was made for, and how many it reads.
    """

    def __init__(self) -> None:
        self.shared: set[str] = set()
        self.technique = ""
        self.own: dict[str, set[str]] = defaultdict(set)
        self.read_by: dict[str, set[str]] = defaultdict(set)
        self.declared: dict[Path, set[str]] = defaultdict(set)
        self.read_in: dict[Path, set[str]] = defaultdict(set)
        self.planes: set[tuple[int, int]] = set()

    def linked(self, program: Program, *texts: ShaderText) -> None:
        """Note what a new program reads and what its files declare."""
        self.read_by[self.technique] |= set(program.gl)
        for path in {path for text in texts for path in text.files}:
            names = set(_DECLARATION.findall(path.read_text(encoding="utf-8")))
            self.declared[path] |= names
            self.read_in[path] |= names & set(program.gl)
        made_for = re.search(r"#define CLIP_PLANES (\d)", texts[-1].text)
        if made_for:
            read = program.gl["u_planes"].array_length if "u_planes" in program else 0
            self.planes.add((int(made_for[1]), read))


@pytest.fixture(scope="module")
def record() -> Record:
    """What happened while every technique of ours was drawn with settings that reach all of its shaders."""
    found = Record()
    create, assign = Program.__init__, Program.set

    def recorded(self: Any, context: Any, vertex: Any, fragment: Any, label: str, **rest: Any) -> None:
        create(self, context, vertex, fragment, label, **rest)
        found.linked(self, vertex, fragment)

    def setting(self: Any, uniforms: Mapping[str, Any], layer: int = 0) -> None:
        if "u_clip_to_texture" in uniforms:
            found.shared |= set(uniforms)
        else:
            found.own[found.technique] |= set(uniforms)
        assign(self, uniforms, layer)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Program, "__init__", recorded)
        patch.setattr(Program, "set", setting)
        for technique, info in techniques().items():
            if info.kind == "image":
                found.technique = technique
                draw(technique)
        found.technique = DEFAULT_TECHNIQUE
        draw_whole_numbers()
        draw_bricks()
    return found


def draw_whole_numbers() -> None:
    """Values of 8 and 16 bits, which are stored in other ways where OpenGL is computed on the processor."""
    for dtype in (np.uint8, np.uint16):
        of = volume(dtype)
        with shown(of, DEFAULT_TECHNIQUE, SIZE, transfer_function=function(of)) as (window, handle):
            window.render()
            handle.raise_error()


def draw_bricks() -> None:
    """A volume that is larger than the texture it may have."""
    of = volviz.Volume(np.arange(80**3, dtype=np.float32).reshape(80, 80, 80))
    before = set_budgets(texture=1 << 20)
    try:
        with shown(of, DEFAULT_TECHNIQUE, SIZE, transfer_function=function(of)) as (window, handle):
            window.render()
            handle.raise_error()
            assert handle.status.bricks is not None
    finally:
        set_budgets(texture=before.texture)


def draw(technique: str) -> None:
    """Draw a technique with representative settings: with light, cuts and a mesh beside the volume, and without."""
    of = volume(np.float32, spacing=(1.0, 1.1, 0.9))
    curve = function(of)
    with shown(of, technique, SIZE, transfer_function=curve) as (window, handle):
        names = {p.name for p in handle.technique.parameters}

        def show(**values: Any) -> None:
            if values.keys() - {"transfer_function", "clip_planes"} <= names:
                handle.update(**values)
                window.render()
                handle.raise_error()

        for mode, _ in MODES:
            show(mode=mode)
        show(mode="composite", shading=True, gradient_opacity=0.5)
        show(preintegrated=True)
        show(preintegrated=False, mode="composite")
        low, high = of.range
        steepest = (high - low) / min(of.spacing)
        region = Region("rectangle", (low + high) / 2, high - low, 0.0, steepest)
        show(
            transfer_function=volviz.TransferFunction(curve.points, by_gradient=TransferFunction2D((region,)))
        )
        # narrower than two entries of the usual table
        narrow = [
            (low, (0, 0, 0, 0)),
            *((low + 1e-4 * i, (1, 0, 0, i % 2)) for i in (1, 2, 3)),
            (high, (0, 0, 0, 1)),
        ]
        show(transfer_function=volviz.TransferFunction.from_points(narrow))
        show(transfer_function=curve)
        for display, _ in handle.technique.debug_views:
            show(display=display)
        show(display="image")
        show(surface="mesh", cut_out=False)
        show(lighting="vertex")
        show(two_passes=True)
        show(two_passes=False, surface="box", normal_source="bricks", color_source="flat")
        show(footprint="gaussian")
        show(color_by="transfer_function", normals="flat")
        show(scattering=0.4)
        show(interpolation="cubic", slab=3.0, slab_mode="composite")
        show(interpolation="linear")
        if handle.technique.colors_surface:
            corners = np.asarray(of.corners[:3], np.float64)
            values = SurfaceValues(corners, np.array([[0, 1, 2]], np.int32), np.arange(3.0), np.ones(1))
            handle.color_surface(SurfaceColors(values, 0.0, 2.0, np.zeros((256, 3), np.uint8)))
            window.render()
            handle.raise_error()
        show(clip_planes=((of.center, (1.0, 0.2, 0.1)),))
        window.add_mesh(pyvista.Sphere(radius=2.0, center=of.center))
        show(clip_planes=())
        show(footprint="disc")
        if handle.technique.draws_layers:
            layers = (
                volviz.ImageLayer(of, curve), volviz.ImageLayer(of, color="red"),
                volviz.ImageLayer(volume(np.float32), curve), volviz.ImageLayer(of, curve, mode="mask"),
            )  # fmt: skip
            numbers = volviz.Volume((of.array > of.array.mean()).astype(np.uint8))
            labels = volviz.LabelLayer(numbers)
            modes = [{"mode": mode} for mode, _ in MODES] if "mode" in names else [{}]
            lit: dict[str, Any] = {"shading": True} if "shading" in names else {}
            several = [((*layers, labels), lit | mode) for mode in modes]
            for shown_layers, values in [*several, ((labels,), {})]:
                handle.show(spec_of(shown_layers, technique, **values))
                window.render()
                handle.raise_error()
        # one that is enlarged beside a mesh is drawn while something moves only
        handle.gpu.programs.get(
            GLSL / "fullscreen.vert", GLSL / "composite.frag", {"ENLARGE": True, "SCENE_DEPTH": True}
        )


def test_every_uniform_that_is_set_is_read_by_a_shader(record: Record) -> None:
    unread = record.shared - set().union(*record.read_by.values())
    assert not unread, "set for every program and read by none"
    unread_own = {key: names - record.read_by[key] for key, names in record.own.items()}
    assert not {key: names for key, names in unread_own.items() if names}


def test_every_uniform_that_a_shader_file_declares_is_read_where_it_stands(record: Record) -> None:
    unread = {
        path.name: sorted(names - record.read_in[path])
        for path, names in record.declared.items()
        if names - record.read_in[path]
    }
    assert not unread


def test_programs_read_as_many_clip_planes_as_there_are(record: Record) -> None:
    # a program without rays or surfaces of the volume reads none
    assert record.planes == {(0, 0), (1, 0), (1, 1)}


def test_every_shader_file_was_looked_at(record: Record) -> None:
    folder = Path(volviz.custom_gl.__file__).parent
    files = {path for kind in ("frag", "vert", "glsl") for path in folder.rglob(f"*.{kind}")}
    assert {path.name for path in files - set(record.declared)} <= {"filter_probe.frag"}


def test_no_technique_takes_its_data_from_uniforms() -> None:
    folder = Path(volviz.custom_gl.__file__).parent
    sources = [*folder.joinpath("techniques").rglob("*.py"), *folder.joinpath("mesh_drawing").rglob("*.py")]
    assert len(sources) > 50
    assert not [path.name for path in sources if "frame.uniforms" in path.read_text(encoding="utf-8")]
