"""Switching between techniques leaves nothing behind on the GPU."""

from __future__ import annotations

import ctypes
import ctypes.util
import gc
import weakref
from typing import Any

import pytest

import volviz
from tests.render.scenes import Requests, camera, function, volume
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.vtk.vtk_imports import pyvista

ROUNDS = 6


def living_objects(gl: Any) -> dict[str, int]:
    """How many OpenGL objects of each kind there are in the current context, ours and VTK's."""
    library = ctypes.util.find_library("GL") or ctypes.util.find_library("OpenGL")
    if library is None:
        pytest.skip("there is no library of OpenGL whose functions could be called directly")
    functions = ctypes.CDLL(library)
    # names are given out in ascending order and freed ones not always again: the newest is the largest
    newest = gl.texture((1, 1), 4)
    buffer = gl.buffer(reserve=16)
    program = gl.program(
        vertex_shader="#version 330\nin vec2 p; void main() { gl_Position = vec4(p, 0.0, 1.0); }",
        fragment_shader="#version 330\nout vec4 c; void main() { c = vec4(1.0); }",
    )
    array = gl.vertex_array(program, [(buffer, "2f", "p")])
    target = gl.framebuffer([newest])
    limits = {
        "Texture": newest.glo,
        "Buffer": buffer.glo,
        "Framebuffer": target.glo,
        "Program": program.glo,
        "VertexArray": array.glo,
    }
    for thing in (target, array, program, buffer, newest):
        thing.release()
    counts = {}
    for kind, limit in limits.items():
        exists = getattr(functions, f"glIs{kind}")
        exists.restype, exists.argtypes = ctypes.c_ubyte, [ctypes.c_uint]
        counts[kind] = sum(bool(exists(name)) for name in range(1, limit + 1))
    return counts


@pytest.mark.parametrize("moving", [False, True], ids=["at rest", "while something moves"])
def test_going_through_all_techniques_again_and_again_leaves_no_object(moving: bool) -> None:
    of = volume()
    window = pyvista.Plotter(off_screen=True, window_size=(64, 48))
    window.render_window.SetMultiSamples(0)
    try:
        handle = volviz.add_volume(window, of, "raycast", transfer_function=function(of))
        apply_camera(window.camera, camera(of))
        window.reset_camera_clipping_range()
        window.show(auto_close=False, interactive=False)
        handle.show_manipulators()
        if moving:
            handle.scheduler = Requests()
        ids = [name for name, info in volviz.techniques().items() if info.kind == "image"]
        seen = []
        for turn in range(ROUNDS):
            for number, name in enumerate(ids):
                handle.update(technique=name, headlight=bool((turn + number) % 2))
                if moving:
                    handle.begin_interaction()
                window.camera.azimuth += 7.0
                window.render()
                if moving:
                    handle.end_interaction()
                handle.raise_error()
            # everything of the last technique goes with the next drawing
            handle.update(technique="raycast")
            window.render()
            assert handle.status.complete != moving
            window.render_window.MakeCurrent()
            seen.append(living_objects(handle.gpu.gl))
        # the first rounds fill caches that are meant to stay: programs, tables, levels of detail
        assert seen[-1] == seen[2]
        assert min(seen[-1].values()) > 0
    finally:
        window.close()


def test_a_volume_that_is_no_longer_shown_is_let_go() -> None:
    last = volume()
    window = pyvista.Plotter(off_screen=True, window_size=(24, 16))
    held = []
    try:
        handle = volviz.add_volume(window, last)
        window.show(auto_close=False, interactive=False)
        for technique in volviz.techniques():
            of = volume()
            weak = weakref.ref(of)
            handle.update(volume=of, technique=technique)
            window.render()
            handle.raise_error()
            # another technique follows, so that nothing of the first one is made anew
            handle.update(volume=last, technique="slicing" if technique == "raycast" else "raycast")
            window.render()
            del of
            gc.collect()
            if weak() is not None:
                held.append(technique)
    finally:
        window.close()
    assert held == []
