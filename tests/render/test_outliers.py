"""One hot voxel changes nothing but what lies next to it; one label among 65536 is seen."""

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


def test_labels_one_wide_are_seen_among_65536() -> None:
    def label(value: float, color: tuple[float, ...]) -> list[tuple[float, tuple[float, ...]]]:
        clear = (0.0, 0.0, 0.0, 0.0)
        return [(value - 0.5, clear), (value - 0.5, color), (value + 0.5, color), (value + 0.5, clear)]

    labels = np.zeros((12, 12, 12), np.uint16)
    labels[2:10, 2:10, 2:6], labels[2:10, 2:10, 6:10] = 300, 65000
    labels[0, 0, 0] = 65535
    function = volviz.TransferFunction.from_points([*label(300, (1, 0, 0, 1)), *label(65000, (0, 1, 0, 1))])
    image = volviz.render(
        volviz.Volume(labels), "raycast", size=(40, 30), background="black",
        camera=[(5.5, 5.5, 40), (5.5, 5.5, 5.5), (0, 1, 0)], transfer_function=function,
        interpolation="nearest", shading=False,
    )  # fmt: skip
    red, green = (np.asarray(image)[..., k] > 200 for k in range(2))
    assert abs(int(red.sum()) - int(green.sum())) <= 0.2 * green.sum()
    assert red.sum() > 50
