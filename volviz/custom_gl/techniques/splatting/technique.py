"""Splatting: lit points with depth, melted together by a Gaussian; or translucent Gaussians from back to front."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import moderngl
import numpy as np

from volviz.custom_gl.gpu.programs import Program
from volviz.custom_gl.gpu.targets import Target
from volviz.custom_gl.shader_source import GLSL
from volviz.custom_gl.splat_selection import SIGMA_PER_DIAMETER, lattice_steps
from volviz.custom_gl.technique import Frame
from volviz.custom_gl.techniques.splatting.store import Ready, SplatRequest, SplatStore

_HERE = Path(__file__).parent

#: Splats that one chunk draws: about 20 ms on software OpenGL.
BLOCK = 65536
#: Rows of the image that one chunk of the blur covers.
STRIP = 64
#: Splats that are drawn in any case while something moves.
FEWEST_SPLATS = 20000
#: Lattice of translucent splats while something moves.
COARSE_LATTICE = 48
#: Where it is cut off, in standard deviations; as in ``splat.frag``.
REACH = 2.5

_OVER = (moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA)
_OFF = moderngl.NOTHING


@dataclass(frozen=True)
class _Layout:
    """How the splats of a frame are drawn.

    Attributes
    ----------
    quads : bool
        As quads instead of points.
    count : int
        Number of splats, from the first on.
    diameter : float
        Of the drawn footprint, world units.
    sigma : float
        Standard deviation of a Gaussian footprint, world units.
    cell : float
        World volume that a splat stands for.
    region : tuple of 4 ints
        Part of the target (x, y, width, height) that splats and blur may touch.
    """

    quads: bool = False
    count: int = 0
    diameter: float = 1.0
    sigma: float = 1.0
    cell: float = 1.0
    region: tuple[int, int, int, int] = (0, 0, 0, 0)


class Splatting:
    """Draws blocks of splats into a target of its own and blurs that into the image."""

    #: Discs are surfaces: the host writes their depth.
    writes_depth = True

    def __init__(self) -> None:
        self._stores = {False: SplatStore("splats"), True: SplatStore("coarse splats")}
        self._blocks: list[Any] = []
        self._held: Ready | None = None
        self._arrays: dict[tuple[int, int], tuple[Any, Any]] = {}
        self._layout = _Layout()
        self._pool: Any = None

    # ------------------------------------------------------------------ planning

    def plan(self, frame: Frame) -> int:
        """Blocks of splats, then strips of the blur; 0 while splats are being made."""
        self._pool = frame.gpu.targets
        if not frame.tiles:
            self._layout = _Layout()
            return 1
        ready = self._splats(frame)
        if ready is None:
            return 0
        self._upload(frame, ready)
        self._layout = self._arrange(frame, ready)
        if not self._translucent(frame):
            for purpose in ("splats", "blurred"):
                self._target(frame, purpose).clear()
        return max(self._block_count() + len(self._strips(frame)), 1)

    def _translucent(self, frame: Frame) -> bool:
        return bool(frame.settings.footprint == "gaussian")

    def _splats(self, frame: Frame) -> Ready | None:
        settings, volume = frame.settings, frame.volume
        translucent = self._translucent(frame)
        whole = frame.crop == tuple(float(v) for n in volume.dimensions for v in (0, n - 1))
        eye = None
        if translucent:
            camera = frame.camera
            x, y, z = -camera.direction if camera.parallel else camera.eye
            eye = (float(x), float(y), float(z), 0.0 if camera.parallel else 1.0)
        per_axis = settings.splats_per_axis
        coarse = translucent and frame.interactive
        if coarse:
            per_axis = min(per_axis or COARSE_LATTICE, COARSE_LATTICE)
        # a cut lays bare what would be hidden
        cull = not translucent and whole and not frame.planes
        request = SplatRequest(volume, frame.isovalues[0], per_axis, cull, eye)
        return self._stores[coarse].get(frame.tasks, request, may_follow=frame.interactive)

    def _upload(self, frame: Frame, ready: Ready) -> None:
        if self._held is ready:
            return
        self._release_blocks()
        packed = ready.packed
        self._blocks = [
            frame.gpu.gl.buffer(packed[start : start + BLOCK].tobytes())
            for start in range(0, len(packed), BLOCK)
        ]
        self._held = ready
        frame.gpu.uploads += len(self._blocks)

    def _arrange(self, frame: Frame, ready: Ready) -> _Layout:
        settings, volume = frame.settings, frame.volume
        total = count = len(ready.packed)
        steps = lattice_steps(volume, ready.request.per_axis)
        diameter = settings.splat_size * float((steps * volume.spacing).max())
        cell = float(abs(np.linalg.det(volume.index_to_world[:3, :3])) * np.prod(steps))
        fraction = frame.size[1] / frame.window_size[1]
        if frame.interactive and not self._translucent(frame) and total:
            count = min(max(round(total * fraction**2), FEWEST_SPLATS), total)
            # fewer splats on the same surface: each is larger
            diameter *= math.sqrt(total / count)
        sigma = diameter * SIGMA_PER_DIAMETER
        if self._translucent(frame):
            diameter = 2 * REACH * sigma
        largest, within = self._largest_splat(frame, diameter)
        quads = largest > min(frame.gpu.limits.max_point_size, 255.0) or not within
        taps = self._blur(frame)[1]
        region = self._region(frame, math.ceil(largest / 2) + taps + 2)
        return _Layout(quads, count, diameter, sigma, cell, region)

    def _largest_splat(self, frame: Frame, diameter: float) -> tuple[float, bool]:
        """Pixels of the nearest splat, and whether every splat lies well within the view."""
        clip = np.c_[frame.box_corners, np.ones(8)] @ frame.camera.view_projection.T
        w = clip[:, 3]
        if w.min() <= 1e-6 * abs(w).max():
            return float(max(frame.size)), False
        pixels = diameter * self._pixels_per_unit(frame) / float(w.min())
        # a point whose centre is outside vanishes whole; before the near plane a quad would do so as well
        within = bool(np.all(np.abs(clip[:, :2]) <= w[:, None]))
        return min(pixels, float(max(frame.size))), within

    def _pixels_per_unit(self, frame: Frame) -> float:
        return float(frame.camera.projection[1, 1]) * frame.size[1] / 2

    def _region(self, frame: Frame, margin: int) -> tuple[int, int, int, int]:
        """The part of the target that splats and their blur may touch."""
        tiles = np.array(frame.tiles)
        low = np.maximum(tiles[:, :2].min(axis=0) - margin, 0)
        high = np.minimum((tiles[:, :2] + tiles[:, 2:]).max(axis=0) + margin, frame.size)
        return int(low[0]), int(low[1]), int(high[0] - low[0]), int(high[1] - low[1])

    def _blur(self, frame: Frame) -> tuple[float, int]:
        """Sigma and taps to either side, in pixels of the target."""
        if self._translucent(frame) or frame.settings.display == "splats":
            return 0.0, 0
        sigma = frame.settings.blur_radius * frame.size[1] / frame.window_size[1]
        return sigma, math.ceil(3 * sigma)

    def _block_count(self) -> int:
        return -(-self._layout.count // BLOCK)

    def _strips(self, frame: Frame) -> list[tuple[bool, tuple[int, int, int, int]]]:
        """(last pass?, scissor) of each chunk of the blur."""
        if self._translucent(frame) or not self._layout.count:
            return []
        x, y, width, height = self._layout.region
        rows = [(x, row, width, min(STRIP, y + height - row)) for row in range(y, y + height, STRIP)]
        first = [(False, strip) for strip in rows] if self._blur(frame)[1] else []
        return first + [(True, strip) for strip in rows]

    # ------------------------------------------------------------------ drawing

    def draw(self, frame: Frame, chunk: int) -> None:
        """A block of splats or a strip of the blur."""
        blocks = self._block_count()
        if chunk < blocks:
            self._draw_block(frame, chunk)
        elif strips := self._strips(frame):
            last, scissor = strips[chunk - blocks]
            self._draw_strip(frame, scissor, last=last)

    def _draw_block(self, frame: Frame, block: int) -> None:
        gl = frame.gpu.gl
        layout = self._layout
        program = self._splat_program(frame)
        size = min(layout.count - block * BLOCK, BLOCK)
        if self._translucent(frame):
            gl.enable_only(moderngl.BLEND | moderngl.PROGRAM_POINT_SIZE)
            gl.blend_func = _OVER
            gl.blend_equation = moderngl.FUNC_ADD
        else:
            self._target(frame, "splats").fbo.use()
            gl.enable_only(moderngl.DEPTH_TEST | moderngl.PROGRAM_POINT_SIZE)
            gl.depth_func = "<"
        array = self._array(frame, program, block)
        if layout.quads:
            array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=size)
        else:
            array.render(moderngl.POINTS, vertices=size)
        gl.enable_only(_OFF)

    def _splat_program(self, frame: Frame) -> Program:
        volume = frame.volume
        layout = self._layout
        translucent = self._translucent(frame)
        program = frame.program(
            _HERE / "splat.vert",
            _HERE / "splat.frag",
            {"QUADS": layout.quads, "GAUSSIAN": translucent},
            many_vertices=True,
        )
        matrix = volume.index_to_world
        program.set(
            {
                "u_index_to_centred": frame.recentred(matrix),
                "u_index_to_clip": frame.camera.view_projection @ matrix,
                "u_diameter": layout.diameter,
                "u_pixels_per_unit": self._pixels_per_unit(frame),
                "u_classic_color": frame.settings.splat_color == "classic",
                "u_depth_per_extinction": layout.cell / (2 * math.pi * layout.sigma**2),
            }
        )
        return program

    def _draw_strip(self, frame: Frame, scissor: tuple[int, int, int, int], *, last: bool) -> None:
        gl = frame.gpu.gl
        sigma, taps = self._blur(frame)
        program = frame.program(GLSL / "fullscreen.vert", _HERE / "blur.frag", {"FINAL": last})
        source = self._target(frame, "blurred" if last and taps else "splats")
        (frame.target if last else self._target(frame, "blurred")).fbo.use()
        gl.scissor = scissor
        program.use_texture("t_splats", source.color)
        program.use_texture("t_splat_depth", source.depth)
        program.set(
            {
                "u_axis": (1, 0) if last else (0, 1),
                "u_taps": taps,
                "u_falloff": 1.0 / (2 * sigma**2) if taps else 0.0,
            }
        )
        gl.enable_only(moderngl.DEPTH_TEST)
        # "1": depth is written without being compared
        gl.depth_func = "1"
        frame.gpu.draw_fullscreen(program)
        gl.depth_func = "<"
        gl.enable_only(_OFF)
        gl.scissor = None

    # ------------------------------------------------------------------ objects on the GPU

    def _target(self, frame: Frame, purpose: str) -> Target:
        target: Target = frame.gpu.targets.get(
            self._purpose(purpose, interactive=frame.interactive), frame.size
        )
        return target

    def _purpose(self, purpose: str, *, interactive: bool) -> str:
        return f"splatting {purpose} {'interactive' if interactive else 'full'} {id(self)}"

    def _array(self, frame: Frame, program: Program, block: int) -> Any:
        """The vertex array of a block for a program; quads advance once per splat."""
        key = (program.gl.glo, block)
        held = self._arrays.get(key)
        if held is None or held[1] is not program:
            if held is not None:
                held[0].release()
            layout = "3f 3f 1f/i" if self._layout.quads else "3f 3f 1f"
            names = ("a_index", "a_normal", "a_value")
            # attributes that a variant does not use are left out by the driver, their room in the buffer is not
            content = " ".join(
                part if name in program else _skipped(part)
                for part, name in zip(layout.removesuffix("/i").split(), names, strict=True)
            )
            if layout.endswith("/i"):
                content += "/i"
            used = [name for name in names if name in program]
            array = frame.gpu.gl.vertex_array(program.gl, [(self._blocks[block], content, *used)])
            held = self._arrays[key] = (array, program)
        return held[0]

    def _release_blocks(self) -> None:
        for array, _ in self._arrays.values():
            array.release()
        self._arrays.clear()
        for buffer in self._blocks:
            buffer.release()
        self._blocks.clear()
        self._held = None

    def release(self) -> None:
        """Release splats and targets."""
        for store in self._stores.values():
            store.clear()
        self._release_blocks()
        if self._pool is not None:
            for purpose in ("splats", "blurred"):
                for interactive in (False, True):
                    self._pool.drop(self._purpose(purpose, interactive=interactive))
            self._pool = None


def _skipped(part: str) -> str:
    """Padding of the same size as an attribute of floats such as "3f"."""
    return f"{4 * int(part[0])}x"
