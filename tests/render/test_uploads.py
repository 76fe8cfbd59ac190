"""A change of the transfer function computes and uploads the one table that is drawn with."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.render.scenes import POINTS, function, shown, volume
from volviz.custom_gl.gpu import resources
from volviz.custom_gl.gpu.context import Gpu


@pytest.mark.parametrize(
    ("technique", "values"),
    [
        ("raycast", {}),
        ("raycast", {"gradient_opacity": 0.5}),
        ("raycast", {"preintegrated": True}),
        ("raycast", {"mode": "maximum"}),
        ("two_pass_raycast", {}),
        ("slicing", {"mode": "average"}),
        ("half_angle", {}),
    ],
)
def test_a_change_of_the_function_uploads_one_table(
    technique: str, values: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    uploaded: list[int] = []
    for name in ("table_texture", "segments_texture"):
        upload = getattr(Gpu, name)
        monkeypatch.setattr(
            Gpu, name, lambda gpu, table, upload=upload: uploaded.append(1) or upload(gpu, table)
        )
    computed: list[int] = []
    bake = resources.baked
    monkeypatch.setattr(resources, "baked", lambda *a, **k: computed.append(1) or bake(*a, **k))
    of = volume(np.float32)
    with shown(of, technique, (64, 48), transfer_function=function(of), **values) as (window, handle):
        for opacity in (0.2, 0.8):
            uploaded.clear()
            computed.clear()
            handle.update(transfer_function=function(of, [*POINTS[:-1], (1.0, (1.0, 0.2, 0.1, opacity))]))
            window.render()
            handle.raise_error()
            assert len(uploaded) == 1
            assert len(computed) == 1, "texture and empty space come from one table"
