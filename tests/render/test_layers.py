"""Two layers in one ray loop: what is included as LAYER1 reads a volume of its own and draws it as layer 0 would."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import volviz
from tests.render.scenes import blobs, function, shown, volume
from volviz.custom_gl.gpu.programs import Program
from volviz.custom_gl.gpu.resources import VolumeResources
from volviz.custom_gl.technique import Frame

SIZE = (64, 48)

#: Emission of both layers, or of one of them, at the same texture coordinates.
COMPOSITE = """#define COMPOSITE_SKIPS 0
#include "layer.glsl" LAYER1
vec4 g_sum;
void composite_begin(float ray_length) { g_sum = vec4(0.0); }
void add(vec4 c, float depth) { g_sum += vec4(c.rgb * depth, depth); }
bool composite_add(float front, float back, vec3 p, float segment_length, bool full_step) {
    vec4 c = layer_color(front, back, p);
    float s = sample_scalar_1(p);
    vec4 c_1 = layer_color_1(s, s, p);
    if (%d != 0) add(c, extinction(c.a) * segment_length);
    if (%d != 0) add(c_1, extinction_1(c_1.a) * segment_length);
    return false;
}
vec4 composite_end() { return 0.05 * g_sum; }
"""


class TwoVolumes:
    """Draws a second volume of the same size as layer 1 of every program."""

    def __init__(self, patch: pytest.MonkeyPatch, folder: Path, second: volviz.Volume) -> None:
        self.hook = folder / "both.glsl"
        self._second: VolumeResources | None = None
        self._volume = second
        program, apply = Frame.program, Frame.apply

        def with_hook(
            frame: Any, vertex: Any, fragment: Any, defines: Any = None, hooks: Any = None, **rest: Any
        ) -> Any:
            return program(frame, vertex, fragment, defines, {**hooks, "composite": self.hook}, **rest)

        def with_second(frame: Any, of: Program, table_length: Any = None) -> None:
            apply(frame, of, table_length)
            if self._second is None:
                self._second = VolumeResources(frame.gpu, self._volume)
                self._second.upload()
                self._second.select(0)
            of.set(frame.uniforms, 1)
            self._second.bind(of, frame, table_length, layer=1)

        patch.setattr(Frame, "program", with_hook)
        patch.setattr(Frame, "apply", with_second)

    def release(self) -> None:
        """Release the textures of the second volume; the context is current."""
        if self._second is not None:
            self._second.release()


def test_a_second_layer_draws_its_own_volume(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = volume(np.float32)
    mirrored = volviz.Volume(np.ascontiguousarray(blobs(dtype=np.float32)[:, :, ::-1]))
    curve = function(first)
    values = {"mode": "additive", "shading": True}
    images: dict[tuple[int, int], Any] = {}
    both = TwoVolumes(monkeypatch, tmp_path, mirrored)
    both.hook.write_text(COMPOSITE % (1, 0))
    with shown(first, "raycast", SIZE, transfer_function=curve, **values) as (window, handle):
        for parts in ((1, 0), (0, 1), (1, 1)):
            both.hook.write_text(COMPOSITE % parts)
            handle.gpu.forget_programs()
            handle.invalidate()
            window.render()
            handle.raise_error()
            images[parts] = handle.read_image()
        both.release()
    both.hook.write_text(COMPOSITE % (1, 0))
    both = TwoVolumes(monkeypatch, tmp_path, first)
    both.hook.write_text(COMPOSITE % (1, 0))
    with shown(mirrored, "raycast", SIZE, transfer_function=curve, **values) as (window, handle):
        window.render()
        handle.raise_error()
        alone = handle.read_image()
        both.release()
    assert np.abs(images[1, 0] - images[0, 1]).max() > 0.05, "the volumes differ"
    assert np.abs(images[0, 1] - alone).max() < 1e-5
    assert np.abs(images[1, 1] - images[1, 0] - images[0, 1]).max() < 1e-5
