"""Labels as a table: counts, volumes, boxes, and the values of an image under them."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from scipy import ndimage

import volviz
from volviz.cli import main
from volviz.errors import Cancelled, InputError, LoadError, VolvizError
from volviz.io.label_files import read_label_file, save_label_file
from volviz.measure.label_table import label_statistics
from volviz.model.label_edits import alone, coloring, described, fading, hiding, naming
from volviz.model.label_palette import LabelLook
from volviz.model.layers import LabelLayer
from volviz.volume_data.description import Label
from volviz.volume_data.references import VolumeRef
from volviz.volume_data.volume import Volume

SPACING = (0.5, 0.75, 2.0)


@pytest.fixture
def labels() -> Volume:
    array = np.random.default_rng(4).choice([0, 3, 700, 12], (7, 8, 9)).astype(np.uint16)
    array[:, :, 0] = 3
    return Volume(array, SPACING, metadata={"length_unit": "µm"})


def test_counts_volumes_and_boxes_are_those_of_the_voxels(labels: Volume) -> None:
    table = label_statistics(labels)
    assert table.labels.tolist() == [3, 12, 700]
    assert table.counts.tolist() == [int((labels.array == label).sum()) for label in (3, 12, 700)]
    np.testing.assert_allclose(table.volumes, table.counts * 0.75)
    assert table.length_unit == "µm"
    for label, (i0, i1, j0, j1, k0, k1) in zip(table.labels, table.boxes, strict=True):
        k, j, i = np.nonzero(labels.array == label)
        assert (i0, i1, j0, j1, k0, k1) == (
            i.min(), i.max() + 1, j.min(), j.max() + 1, k.min(), k.max() + 1,
        )  # fmt: skip


@pytest.mark.parametrize("dtype", [np.int16, np.float32])
def test_values_under_labels_are_those_of_scipy(labels: Volume, dtype: type) -> None:
    image = np.random.default_rng(5).normal(1e4, 3.0, labels.array.shape).astype(dtype)
    values = label_statistics(labels, Volume(image, SPACING, unit="HU")).values
    wanted = [3, 12, 700]
    arguments = image.astype(np.float64), labels.array, wanted
    np.testing.assert_allclose(values.means, ndimage.mean(*arguments))
    np.testing.assert_allclose(values.deviations, ndimage.standard_deviation(*arguments), rtol=1e-9)
    np.testing.assert_array_equal(values.minima, ndimage.minimum(*arguments))
    np.testing.assert_array_equal(values.maxima, ndimage.maximum(*arguments))
    assert values.unit == "HU"


def test_what_is_not_finite_does_not_count(labels: Volume) -> None:
    image = np.where(labels.array == 12, np.nan, 2.0)
    image[0, 0, 0] = np.inf
    values = label_statistics(labels, Volume(image, SPACING)).values
    assert np.isnan([values.means[1], values.deviations[1], values.minima[1], values.maxima[1]]).all()
    assert values.counts[1] == 0
    assert (values.means[0], values.deviations[0], values.maxima[0]) == (2.0, 0.0, 2.0)


def test_an_image_with_voxels_of_its_own_is_met_in_the_world(labels: Volume) -> None:
    """Twice as fine, moved and turned with its labels: each voxel is met eight times."""
    fine = np.repeat(np.repeat(np.repeat(labels.array, 2, 0), 2, 1), 2, 2).astype(np.float32)
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    origin = np.array((5.0, 6.0, 7.0))
    first = origin + turn @ (-0.25 * np.array(SPACING))
    turned = Volume(labels.array, SPACING, origin, turn)
    image = Volume(fine, [s / 2 for s in SPACING], first, turn)
    table = label_statistics(turned, image)
    assert table.values.counts.tolist() == (8 * table.counts).tolist()
    np.testing.assert_array_equal(table.values.means, table.labels)
    away = Volume(fine, SPACING, (500.0, 0.0, 0.0))
    assert label_statistics(turned, away).values.counts.sum() == 0


def test_no_whole_numbers_and_a_cancel_end_it(labels: Volume) -> None:
    with pytest.raises(InputError, match="whole numbers"):
        volviz.label_statistics(Volume(labels.array + 0.5))
    with pytest.raises(Cancelled):
        label_statistics(labels, labels, cancel=lambda: True)


def test_the_command_prints_and_writes_the_table(
    labels: Volume, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    np.save("seg.npy", labels.array)
    np.save("image.npy", labels.array.astype(np.float32))
    Path("names.csv").write_text("label,name,red,green,blue\n3,Liver,255,0,0\n")
    assert main(["labels", "seg.npy", "--image", "image.npy", "--names", "names.csv", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["label"] for row in rows] == [3, 12, 700]
    assert (rows[0]["name"], rows[2]["mean"]) == ("Liver", 700.0)
    assert main(["labels", "seg.npy", "-o", "table.csv"]) == 0
    with Path("table.csv").open(encoding="utf-8") as stream:
        written = list(csv.DictReader(stream))
    assert [int(row["voxels"]) for row in written] == [row["voxels"] for row in rows]
    assert main(["labels", "seg.npy", "-o", "table.csv"]) == 2
    assert main(["labels", "seg.npy"]) == 0
    assert "volume (mm³)" in capsys.readouterr().out


def test_statistics_of_a_tumour_are_the_published_ones(shared_data: Path) -> None:
    """First-order features of the case "brain1" as PyRadiomics gives them."""
    folder = shared_data / "layers"
    values = label_statistics(
        volviz.load(folder / "brain1_label.nrrd"), volviz.load(folder / "brain1_image.nrrd")
    ).values
    found = values.means[0], values.minima[0], values.maxima[0]
    np.testing.assert_allclose(found, (825.2354363065023, 468.0, 1266.0))


# --------------------------------------------------------------------------------------- names and colours

RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


@pytest.mark.parametrize(
    "text",
    [
        (
            '# ITK-SNAP\n    0     0    0    0        0  0  0    "Clear Label"\n  7 255 0 0 1 1 1 "Left kidney"\n'
            '  9 0 0 255 1 1 1 "Aorta"\n'
        ),
        "#No. Label Name: R G B A\n0 Unknown 0 0 0 0\n7 Left_kidney 255 0 0 0\n9 Aorta 0 0 255 0\n",
        "label,name,red,green,blue\n0,,,,\n7,Left kidney,255,0,0\n9,Aorta,0,0,255\n",
        "index\tname\tcolor\n0\tnothing\t#000000\n7\tLeft kidney\t#ff0000\n9\tAorta\t#0000ff\n",
    ],
    ids=["itk-snap", "freesurfer", "csv", "bids"],
)
def test_names_and_colours_are_read_from_the_usual_files(tmp_path: Path, text: str) -> None:
    path = tmp_path / "labels.txt"
    path.write_text(text, encoding="utf-8")
    _, kidney, aorta = read_label_file(path)
    assert (kidney.number, kidney.name.replace("_", " "), kidney.color) == (7, "Left kidney", RED)
    assert aorta == Label(9, "Aorta", BLUE)


def test_what_is_no_table_is_refused_and_a_written_one_is_read(tmp_path: Path) -> None:
    path = tmp_path / "labels.csv"
    for text in ("", "once upon a time\n", "label,name\nx,y\n", "1 2 3\n"):
        path.write_text(text)
        with pytest.raises(LoadError, match="no table of labels"):
            read_label_file(path)
    with pytest.raises(LoadError, match="cannot be read"):
        read_label_file(tmp_path / "missing.txt")
    table = (Label(1, 'Left, "upper" lobe', RED), Label(2, "", None))
    save_label_file(table, path, overwrite=True)
    assert read_label_file(path) == table
    with pytest.raises(VolvizError, match="exists already"):
        save_label_file(table, path)


def test_edits_of_a_layer_change_what_they_name(labels: Volume) -> None:
    layer = LabelLayer(VolumeRef("seg.nii"), {3: "red"}, {3: "Liver"}, hidden=(12,))

    def edited(**changes: object) -> LabelLayer:
        from dataclasses import replace

        return replace(layer, **changes)

    assert edited(**hiding(layer, [3], hidden=True)).hidden == (3, 12)
    assert edited(**hiding(layer, [12, 3], hidden=False)).hidden == ()
    assert edited(**alone([3], [3, 12, 700])).hidden == (12, 700)
    assert edited(**coloring(layer, [700], BLUE)).colors == ((3, RED), (700, BLUE))
    assert edited(**naming(layer, 3, " ")).names == ()
    faded = edited(**fading(layer, [3, 700], 0.25))
    assert faded.opacities == ((3, 0.25), (700, 0.25))
    known = described(layer, [Label(3, "Spleen"), Label(5, "Aorta", BLUE)])
    assert edited(**known).names == ((3, "Spleen"), (5, "Aorta"))
    assert edited(**known).colors == ((3, RED), (5, BLUE))
    look = LabelLook(faded.colors, faded.hidden, 0.5, faded.opacities)
    np.testing.assert_allclose(look.palette(np.array([0, 3, 12, 700]))[:, 3], [0.0, 0.125, 0.0, 0.125])
    with pytest.raises(InputError, match="opacity of label 3"):
        LabelLayer(labels, opacities={3: 2.0})
