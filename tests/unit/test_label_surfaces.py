"""Surfaces of labels as meshes: closed, facing outwards, with the same triangles where labels touch."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from volviz.cli import main
from volviz.errors import Cancelled, InputError
from volviz.meshes.label_surfaces import LabelSurface, label_surfaces
from volviz.meshes.reading import read_triangles
from volviz.volume_data.volume import Volume

SPACING = (0.5, 1.0, 2.0)


@pytest.fixture
def labels() -> Volume:
    """A ball of two halves around a third label, and a block at the border, sparse numbers."""
    z, y, x = np.indices((24, 24, 24)) - 11.5
    radius = np.sqrt(x**2 + y**2 + z**2)
    array = np.zeros((24, 24, 24), np.int16)
    array[(radius < 9) & (x < 0)], array[(radius < 9) & (x > 0)], array[radius < 4] = 5, 900, 7
    array[:3, :3, :3] = -2
    return Volume(array, SPACING, (3.0, 4.0, 5.0))


def edges(surface: LabelSurface) -> np.ndarray:
    f = surface.faces
    return np.concatenate([f[:, [0, 1]], f[:, [1, 2]], f[:, [2, 0]]])


def enclosed(surface: LabelSurface) -> float:
    a, b, c = (surface.vertices[surface.faces[:, n]] for n in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def test_each_label_has_a_closed_surface_of_about_its_volume(labels: Volume) -> None:
    found = label_surfaces(labels)
    assert list(found) == [-2, 5, 7, 900]
    for label, surface in found.items():
        there = edges(surface)
        np.testing.assert_array_equal(np.unique(there, axis=0), np.unique(there[:, ::-1], axis=0))
        if label != -2:
            assert enclosed(surface) == pytest.approx((labels.array == label).sum(), rel=0.15)
    steps = label_surfaces(labels, smoothing=0)
    assert enclosed(steps[-2]) == pytest.approx(27.0, rel=1e-5)


def test_neighbours_share_their_border(labels: Volume) -> None:
    found = label_surfaces(labels)

    def corners(label: int) -> set[tuple[float, ...]]:
        return set(map(tuple, found[label].vertices[found[label].faces].reshape(-1, 9).round(9)))

    def backwards(label: int) -> set[tuple[float, ...]]:
        turned = found[label].vertices[found[label].faces[:, ::-1]].reshape(-1, 9).round(9)
        return {tuple(np.roll(row, 3 * n)) for row in turned for n in range(3)}

    shared = corners(5) & backwards(900)
    # the plane between the halves, a ring around the third label
    assert len(shared) > 100
    middle = np.array(sorted(shared)).reshape(-1, 3)[:, 0]
    np.testing.assert_allclose(middle, 3.0 + 11.5 * 0.5, atol=0.3)


def test_mirrored_lattices_face_outwards_too(labels: Volume) -> None:
    mirrored = Volume(labels.array, SPACING, direction=np.diag([-1.0, 1.0, 1.0]))
    assert enclosed(label_surfaces(mirrored, [5])[5]) > 0


def test_a_label_that_is_not_there_and_a_cancel_end_it(labels: Volume) -> None:
    with pytest.raises(InputError, match="no label 6"):
        label_surfaces(labels, [5, 6])
    with pytest.raises(InputError, match="no label, 0 stands"):
        label_surfaces(Volume(np.zeros((4, 4, 4), np.uint8)))
    with pytest.raises(Cancelled):
        label_surfaces(labels, cancel=lambda: True)


def test_the_command_writes_a_file_for_each(
    labels: Volume, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    np.save("seg.npy", labels.array)
    Path("names.csv").write_text("label,name\n5,Left / upper\n")
    assert main(["labels", "seg.npy", "--names", "names.csv", "--meshes", "out", "--mesh-type", "ply"]) == 0
    assert sorted(path.name for path in Path("out").iterdir()) == [
        "-2.ply", "5 Left upper.ply", "7.ply", "900.ply",
    ]  # fmt: skip
    mesh = read_triangles("out/7.ply")
    found = label_surfaces(Volume(labels.array), [7])[7]
    assert len(mesh.faces) == len(found.faces)
    assert main(["labels", "seg.npy", "--meshes", "out", "--mesh-type", "ply"]) == 2
