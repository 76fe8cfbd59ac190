"""What techniques share whose rays begin at pixels: the ray caster's program (``glsl/march.glsl``), tiles."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from volviz.custom_gl.gpu.programs import Program
from volviz.custom_gl.technique import Frame


def march_program(
    frame: Frame, vertex: Path, fragment: Path, defines: Mapping[str, object] | None = None
) -> Program:
    """A program whose fragment shader includes ``march.glsl``, with its hooks, tables and uniforms set.

    Parameters
    ----------
    frame : Frame
        Its settings have the fields of `volviz.custom_gl.settings.SamplingSettings`, `ShadingSettings` and
        `PreintegrationSettings`.
    vertex, fragment : Path
        The technique's shaders.
    defines : mapping, optional
        Further defines of the technique's own.
    """
    if frame.joint is not None:
        return _joint_program(frame, vertex, fragment, defines)
    settings = frame.settings
    composites = settings.mode == "composite"
    preintegrated = composites and settings.preintegrated and frame.transfer_function.by_gradient is None
    # opacities per step in the table save a power per sample; gradient opacity must act before the correction
    per_step = composites and not preintegrated and not settings.gradient_opacity
    hooks = {"composite": f"composite/{settings.mode}.glsl"}
    if preintegrated:
        hooks["classify"] = "classify/preintegrated.glsl"
    program = frame.program(
        vertex,
        fragment,
        {"TABLE_PER_STEP": per_step} | dict(defines or {}),
        hooks,
        table_length=frame.step_world / frame.unit_distance if per_step else None,
    )
    if per_step:
        program.set({"u_inverse_unit_distance": 1.0 / frame.step_world})
    return program


#: Files of the hook <composite> for several layers by mode; the other modes make one scalar of each.
JOINT_COMPOSITES = {"composite": "composite/joint.glsl", "additive": "composite/joint_additive.glsl"}


def _joint_program(
    frame: Frame, vertex: Path, fragment: Path, defines: Mapping[str, object] | None
) -> Program:
    """The same for several layers in one integral (``march_layers.glsl``)."""
    mode = frame.settings.mode
    hooks = {
        "march": "march_layers.glsl",
        "composite": JOINT_COMPOSITES.get(mode, "composite/each.glsl"),
        "scalar": f"composite/{mode}.glsl",
    }
    return frame.program(vertex, fragment, defines, hooks)


def draw_tile(frame: Frame, program: Program, tile: int) -> None:
    """Draw the pixels of one of the frame's tiles with a program from `Frame.program` with ``fullscreen.vert``."""
    gl = frame.gpu.gl
    gl.scissor = frame.tiles[tile]
    frame.gpu.draw_fullscreen(program)
    gl.scissor = None
