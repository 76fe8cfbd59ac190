"""One hot voxel changes nothing but what lies next to it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import volviz

CAMERA = [(80, 60, 70), (15.5, 15.5, 15.5), (0, 0, 1)]
FUNCTION = volviz.TransferFunction.from_points(
    [(0.3, (1, 0, 0, 0)), (0.4, (1, 0, 0, 0.5)), (0.9, (0, 1, 0, 0.9))]
)


def picture(hot: float | None, technique: str, **settings: Any) -> Any:
    z, y, x = np.mgrid[-1:1:32j, -1:1:32j, -1:1:32j]
    array = np.clip(1 - np.sqrt(x * x + y * y + z * z), 0, 1).astype(np.float32)
    if hot is not None:
        array[1, 1, 1] = hot
    image = volviz.render(
        volviz.Volume(array), technique, size=(120, 90), camera=CAMERA, background="black",
        transfer_function=FUNCTION, **settings,
    )  # fmt: skip
    return np.asarray(image)[..., :3].astype(int)


@pytest.mark.parametrize(
    ("technique", "settings"),
    [
        ("isosurface", {"isovalues": (0.45,)}), ("raycast", {"shading": True}), ("raycast", {"mode": "minimum"}),
        ("raycast", {"preintegrated": True}), ("half_angle", {}), ("vtk_fixed_point", {}),
    ],
)  # fmt: skip
def test_one_hot_voxel_leaves_the_picture_of_the_rest(technique: str, settings: dict[str, Any]) -> None:
    clean = picture(None, technique, **settings)
    assert clean.max() > 100 or settings == {"mode": "minimum"}
    for hot in (1e6, -1e6):
        changed = np.abs(picture(hot, technique, **settings) - clean).max(axis=-1) > 20
        assert changed.mean() < 0.01
