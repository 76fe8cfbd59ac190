"""Images do not change when uniforms come through the vertex shader, as they do where OpenGL is software."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import pyvista

from tests.render.scenes import function, shown, volume

SIZE = (88, 72)


def drawn(technique: str, values: dict[str, Any]) -> dict[bool, tuple[Any, list[Any]]]:
    """Image and programs, without and with carried uniforms, of a cut volume with a mesh in it."""
    of = volume(np.float32, spacing=(1.0, 1.2, 0.9))
    with shown(of, technique, SIZE, transfer_function=function(of), **values) as (window, handle):
        window.add_mesh(pyvista.Sphere(radius=3.0, center=of.center), color="white")
        handle.update(clip_planes=[(of.center, (-0.6, -0.3, 0.7))])
        found = {}
        for carries in (False, True):
            handle.gpu.programs.forwards_uniforms = carries
            handle.gpu.forget_programs()
            handle.update(crop=None)
            window.render()
            handle.raise_error()
            found[carries] = handle.read_image(), list(handle.gpu.programs.all)
        return found


@pytest.mark.parametrize(
    ("technique", "values"),
    [
        ("raycast", {}),
        ("raycast", {"shading": True, "gradient_opacity": 0.5, "jitter": True}),
        ("raycast", {"preintegrated": True}),
        ("two_pass_raycast", {"mode": "attenuated_maximum", "attenuation": 0.1}),
        ("slicing", {"shading": True}),
        ("slicing", {"mode": "average"}),
        ("isosurface", {"isovalues": (0.4, 0.7)}),
        ("half_angle", {"shading": True, "scattering": 0.3}),
    ],
)
def test_carried_uniforms_draw_the_same_picture(technique: str, values: dict[str, Any]) -> None:
    found = drawn(technique, values)
    (plain, programs), (forwarded, forwarding) = found[False], found[True]
    assert not any(program.forwarded for program in programs)
    assert forwarding
    assert all(program.forwarded for program in forwarding), [p.label for p in forwarding if not p.forwarded]
    assert np.count_nonzero(plain[..., 3]) > 50
    assert np.abs(forwarded - plain).max() < 1e-5
