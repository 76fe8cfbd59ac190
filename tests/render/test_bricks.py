"""Volumes drawn through an atlas of bricks against the same in one texture."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import volviz
from volviz.commands.picture_report import write_report
from volviz.errors import LoadError
from volviz.model.layers import ImageLayer
from volviz.volume_data.budgets import budgets, set_budgets
from volviz.volume_data.description import Description, Level
from volviz.volume_data.source import ReadRequest, VolumeSource

pytestmark = pytest.mark.leaks_allowed("the tests share a renderer, which is closed when the file ends")

SIZE = (200, 150)
CAMERA = volviz.Camera((-99.0, -207.0, 126.0), (47.5, 47.5, 47.5), (0.13, 0.48, 0.87))
FUNCTION = volviz.TransferFunction.from_points(
    [(20, (0, 0, 1, 0)), (110, (0, 0.5, 1, 0)), (130, (1, 0.5, 0, 0.08)), (219, (1, 1, 0.9, 0.5))]
)
#: A constant gradient: all levels agree on it.
RAMP_FUNCTION = volviz.TransferFunction.from_points([(0, (0, 0, 1, 0.01)), (190, (1, 0.5, 0, 0.2))])


def rings() -> np.ndarray:
    z, y, x = np.ogrid[:96, :96, :96]
    r = np.sqrt((x - 47.5) ** 2 + (y - 47.5) ** 2 + (z - 47.5) ** 2)
    return (120 + 100 * np.sin(r / 4) * np.exp(-r / 50)).astype(np.uint8)


class Pyramid(VolumeSource):
    """96^3, 48^3 and 24^3 voxels by means; counts what is read, and may fail."""

    def __init__(self, values: np.ndarray, held: int = 2) -> None:
        self.arrays = [values]
        for _ in range(2):
            n = len(self.arrays[-1]) // 2
            means = self.arrays[-1].astype(float).reshape(n, 2, n, 2, n, 2).mean(axis=(1, 3, 5))
            self.arrays.append(np.rint(means).astype(values.dtype) if values.dtype.kind == "u" else means)
        levels = [
            Level((len(a),) * 3, (2.0**n,) * 3, ((2.0**n - 1) / 2,) * 3) for n, a in enumerate(self.arrays)
        ]
        super().__init__(Description(tuple(levels), dtype=values.dtype.name, name="rings"))
        self.held = held
        self.read_voxels = [0, 0, 0]
        self.broken = False

    @property
    def default_level(self) -> int:
        return self.held

    def read_volume(self, request: ReadRequest) -> volviz.Volume:
        array = self.arrays[request.level]
        n = len(array)
        i0, i1, j0, j1, k0, k1 = request.box or (0, n, 0, n, 0, n)
        if self.broken and request.level == 0 and i0 > 40:
            raise LoadError("rings: a chunk is damaged.")
        part = array[k0:k1, j0:j1, i0:i1]
        self.read_voxels[request.level] += part.size
        return self.placed(part.copy(), request)


@pytest.fixture
def atlas():
    """Sets the budget of textures for a test, in MiB."""
    before = budgets().texture
    yield lambda mib: set_budgets(texture=int(mib * 2**20))
    set_budgets(texture=before)


@pytest.fixture(scope="module")
def renderer():
    with volviz.Renderer(SIZE) as made:
        yield made


def draw(renderer, volume, technique="raycast", function=FUNCTION, **values):
    values.setdefault("camera", CAMERA)
    image = renderer.render(
        volume, technique, transfer_function=function, background="black", dtype="float32", **values
    )
    return image[..., :3].astype(float)


CASES = [
    ("raycast", {}),
    ("raycast", {"shading": True}),
    ("raycast", {"preintegrated": True}),
    ("raycast", {"mode": "additive"}),
    ("two_pass_raycast", {}),
    ("slicing", {"shading": True}),
    ("isosurface", {"isovalues": (150.0,)}),
]


@pytest.mark.parametrize(("technique", "values"), CASES, ids=str)
def test_with_all_bricks_the_picture_is_that_of_one_texture(renderer, atlas, technique, values):
    wanted = draw(renderer, volviz.Volume(rings()), technique, **values)
    source = Pyramid(rings())
    atlas(8)
    drawn = draw(renderer, source, technique, **values)
    assert renderer.bricks.level == 0
    assert renderer.bricks.present == renderer.bricks.needed
    assert wanted.std() > 0.02
    assert np.abs(drawn - wanted).max() <= 1 / 255


def test_a_volume_in_memory_that_exceeds_the_texture_is_drawn_in_bricks(renderer, atlas):
    volume = volviz.Volume(rings())
    wanted = draw(renderer, volume)
    atlas(2.9)
    drawn = draw(renderer, volviz.Volume(rings()))
    assert renderer.bricks.level == 1
    assert renderer.bricks.limited
    assert renderer.notice.startswith(
        "Level 1 is shown, and finer ones do not fit into the budget of textures"
    )
    assert renderer.bricks.held_bytes <= 2.9 * 2**20
    assert -10 * np.log10(np.mean((drawn - wanted) ** 2)) >= 50


def test_a_crop_box_gets_the_finest_level_through_an_atlas_that_holds_a_part(renderer, atlas):
    crop = (10.0, 40.0, 30.0, 60.0, 5.0, 90.0)
    wanted = draw(renderer, volviz.Volume(rings()), crop=crop)
    source = Pyramid(rings())
    atlas(2.9)
    # in voxels of the level in memory, a quarter as fine
    drawn = draw(renderer, source, crop=tuple((c - 1.5) / 4 for c in crop))
    assert renderer.bricks.level == 0
    assert np.abs(drawn - wanted).max() <= 1 / 255
    # only what lies in the box was read, in bricks of 16 voxels and their borders
    assert source.read_voxels[0] <= 3 * 3 * 6 * 18**3


def test_levels_meet_without_a_step_where_the_gradient_is_constant(renderer, atlas):
    z, y, x = np.mgrid[:96, :96, :96].astype(np.float32)
    values = x + 0.5 * y + 0.25 * z
    near = volviz.Camera((47.5, -30.0, 47.5), (47.5, 47.5, 47.5), (0, 0, 1), 60.0)
    # inside the outermost voxels, beyond which coarser levels know nothing
    crop = (6.0, 88.0, 6.0, 88.0, 6.0, 88.0)
    shown = {"function": RAMP_FUNCTION, "camera": near, "mode": "additive"}
    wanted = draw(renderer, volviz.Volume(values), crop=crop, **shown)
    source = Pyramid(values)
    atlas(8)
    drawn = draw(renderer, source, crop=tuple((c - 1.5) / 4 for c in crop), **shown)
    assert source.read_voxels[0] > 0
    assert source.read_voxels[1] > 0
    assert np.abs(drawn - wanted).max() <= 1 / 255


def test_what_cannot_be_read_is_seen_coarser_and_told(renderer, atlas):
    source = Pyramid(rings())
    source.broken = True
    atlas(8)
    drawn = draw(renderer, source)
    assert renderer.bricks.failed > 0
    assert renderer.notice == "Parts of the volume are seen coarser: rings: a chunk is damaged."
    wanted = draw(renderer, volviz.Volume(rings()))
    assert np.abs(drawn - wanted).mean() < 0.02


def test_a_report_says_which_levels_and_bricks_are_seen(renderer, atlas, tmp_path: Path):
    source = Pyramid(rings())
    atlas(8)
    draw(renderer, source)
    write_report(tmp_path / "report.json", [ImageLayer(source)], renderer.bricks, 1.5)
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["levels"] == [[96] * 3, [48] * 3, [24] * 3]
    assert (report["level_in_memory"], report["level"]) == (2, 0)
    assert report["bricks"]["present"] == report["bricks"]["needed"] > 200
    assert report["bricks"]["complete"]
