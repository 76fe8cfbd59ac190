"""The labels of a segmentation: listed, found, shown, coloured, measured, picked, named and written."""

from __future__ import annotations

import csv
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

import volviz
from tests.ui.conftest import is_complete
from volviz.model.layers import LabelLayer
from volviz.volume_data.volume import Volume
from volviz_ui.app.main_window import MainWindow
from volviz_ui.labels.model import LABEL, MEAN, NAME, VOXELS
from volviz_ui.labels.panel import LabelPanel

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def panel(same_window: MainWindow, tmp_path: Path, wait_for: Wait) -> LabelPanel:
    """Three labels over the ball: a left and a right half around it, and one voxel in a corner."""
    array = np.zeros((32, 32, 32), np.uint8)
    array[4:28, 4:28, 4:16], array[4:28, 4:28, 16:28], array[0, 0, 0] = 3, 8, 40
    np.save(tmp_path / "halves.npy", array)
    volviz.save(Volume(array, name="halves"), tmp_path / "halves.nrrd")
    header = (
        "NRRD0005\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 32 32 32\n"
        "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n"
    )
    for number, (name, label, color) in enumerate([("Left", 3, "1 0 0"), ("Right", 8, "0 0 1")]):
        header += f"Segment{number}_ID:=s{number}\nSegment{number}_Name:={name}\n"
        header += f"Segment{number}_LabelValue:={label}\nSegment{number}_Layer:=0\n"
        header += f"Segment{number}_Color:={color}\nSegment{number}_Extent:=0 31 0 31 0 31\n"
    (tmp_path / "halves.seg.nrrd").write_bytes(header.encode() + b"\n" + array.tobytes())
    same_window.documents.add(str(tmp_path / "halves.seg.nrrd"))
    wait_for(lambda: len(same_window.store.scene.layers) == 2)
    found = same_window.label_panel
    wait_for(lambda: found.model.rows is not None)
    wait_for(lambda: is_complete(same_window))
    return found


def texts(panel: LabelPanel, column: int) -> list[str]:
    model = panel.model
    return [model.index(row, column).data() for row in range(model.rowCount())]


def layer(window: MainWindow) -> LabelLayer:
    found = window.store.scene.layers[1]
    assert isinstance(found, LabelLayer)
    return found


def middle(window: MainWindow, wait_for: Wait) -> np.ndarray:
    """Colour in the middle of the left and of the right half of the picture."""
    wait_for(lambda: is_complete(window))
    image = window.controller.handle.read_image()
    row = image[image.shape[0] // 2]
    seen = np.flatnonzero(row[:, 3] > 0.5)
    left, right = np.quantile(seen, (0.25, 0.75)).astype(int)
    return row[[left, right], :3].argmax(axis=1)


def test_labels_are_listed_found_and_sorted(same_window: MainWindow, panel: LabelPanel) -> None:
    assert same_window.docks["labels"].is_in_front
    assert texts(panel, NAME) == ["Left", "Right", "without a name"]
    assert texts(panel, VOXELS) == ["6 912", "6 912", "1"]
    assert panel.model.headerData(3, Qt.Orientation.Horizontal, 0) == "Volume (mm³)"
    panel.table.sortByColumn(VOXELS, Qt.SortOrder.AscendingOrder)
    assert texts(panel, LABEL)[0] == "40"
    panel.table.sortByColumn(NAME, Qt.SortOrder.AscendingOrder)
    for words, found in (("RIGHT", ["8"]), ("4", ["40"]), ("x", []), ("", ["3", "8", "40"])):
        panel.search.setText(words)
        assert texts(panel, LABEL) == found
    panel.table.sortByColumn(LABEL, Qt.SortOrder.AscendingOrder)


def test_labels_are_hidden_shown_alone_coloured_and_faded(
    same_window: MainWindow, panel: LabelPanel, wait_for: Wait
) -> None:
    window, model = same_window, panel.model
    window.view_commands.show_axis_view("A")
    assert middle(window, wait_for).tolist() == [0, 2]
    model.setData(model.index(1, NAME), Qt.CheckState.Unchecked.value, Qt.ItemDataRole.CheckStateRole)
    assert layer(window).hidden == (8,)
    assert model.index(1, NAME).data(Qt.ItemDataRole.CheckStateRole) == Qt.CheckState.Unchecked
    assert "1 of them hidden" in panel.words.text()
    panel.choose(8)
    assert panel.chosen == [8]
    QTest.mouseClick(panel.alone_button, Qt.MouseButton.LeftButton)
    assert layer(window).hidden == (3, 40)
    QTest.mouseClick(panel.all_button, Qt.MouseButton.LeftButton)
    assert layer(window).hidden == ()
    panel.set_color([3, 8], (0.0, 1.0, 0.0))
    assert middle(window, wait_for).tolist() == [1, 1]
    panel.opacity.setValue(30)
    assert layer(window).opacities == ((8, 0.3),)
    assert panel.chosen == [8]
    panel.choose(3)
    assert panel.opacity.value() == 100
    for _ in range(5):
        window.documents.undo()
    assert layer(window) == layer(window).__class__(
        layer(window).volume, {3: "red", 8: "blue"}, {3: "Left", 8: "Right"}, name=layer(window).name
    )


def test_values_of_an_image_are_told_and_written(
    same_window: MainWindow, panel: LabelPanel, tmp_path: Path, wait_for: Wait
) -> None:
    assert panel.model.columnCount() == 4
    panel.show_statistics(0)
    wait_for(lambda: panel.model.columnCount() == 8)
    image, labels = (
        np.load(same_window.store.scene.layers[0].volume.source),
        np.load(tmp_path / "halves.npy"),
    )
    assert texts(panel, MEAN) == [f"{image[labels == label].mean():.5g}" for label in (3, 8, 40)]
    panel.save_csv(tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["name"] for row in rows] == ["Left", "Right", ""]
    assert float(rows[1]["maximum"]) == image[labels == 8].max()


def test_chosen_labels_become_meshes(panel: LabelPanel, tmp_path: Path, wait_for: Wait) -> None:
    panel.choose(8)
    panel.save_meshes(tmp_path / "meshes")
    wait_for(lambda: panel.words.text().startswith("1 mesh in"))
    assert [path.name for path in (tmp_path / "meshes").iterdir()] == ["8 Right.stl"]


def test_names_are_edited_read_from_a_file_and_saved_with_the_session(
    same_window: MainWindow, panel: LabelPanel, tmp_path: Path, wait_for: Wait
) -> None:
    model = panel.model
    model.setData(model.index(2, NAME), "Corner", Qt.ItemDataRole.EditRole)
    assert texts(panel, NAME) == ["Left", "Right", "Corner"]
    (tmp_path / "names.txt").write_text("3 Lobe 255 255 0 0\n8 Lung 0 255 255 0\n")
    panel.read_names(tmp_path / "names.txt")
    assert texts(panel, NAME) == ["Lobe", "Lung", "Corner"]
    panel.set_hidden([40], hidden=True)
    before = same_window.store.scene.layers
    same_window.session_commands.save_path(tmp_path / "named.volviz.json")
    same_window.documents.undo()
    same_window.open(str(tmp_path / "named.volviz.json"))
    wait_for(lambda: same_window.store.scene.layers == before)
    wait_for(lambda: is_complete(same_window))


def test_labels_are_named_chosen_and_flown_to_in_the_picture(
    same_window: MainWindow, panel: LabelPanel, wait_for: Wait
) -> None:
    window = same_window
    window.view_commands.show_axis_view("A")
    wait_for(lambda: is_complete(window))
    viewport = window.viewport
    place = QPoint(viewport.width() // 2 + 20, viewport.height() // 2)
    QTest.mouseMove(viewport, place)
    wait_for(lambda: "Right" in window.messages.status_line.pointer.text())
    QTest.mouseClick(viewport, Qt.MouseButton.LeftButton, pos=place)
    assert panel.chosen == [8]
    before = viewport.view_camera
    QTest.mouseDClick(viewport, Qt.MouseButton.LeftButton, pos=place)
    after = viewport.view_camera
    np.testing.assert_allclose(after.focal_point, (21.5, 15.5, 15.5))
    np.testing.assert_allclose(after.direction, before.direction, atol=1e-9)
    panel.set_hidden([8], hidden=True)
    wait_for(lambda: is_complete(window))
    picked = window.controller.handle.pick(*window.viewport.pixel_size)
    assert picked is None
    panel.fly_to(40)
    np.testing.assert_allclose(viewport.view_camera.focal_point, (0.0, 0.0, 0.0), atol=1e-9)


def test_ten_thousand_labels_are_changed_in_a_moment(same_window: MainWindow, panel: LabelPanel) -> None:
    """The model and the layer of 27 000 labels; the picture gets another palette."""
    from dataclasses import replace

    from volviz.measure.label_table import label_statistics
    from volviz.model.label_edits import alone
    from volviz_ui.labels.model import LabelModel, Rows

    cells = np.arange(27_000, dtype=np.uint16).reshape(30, 30, 30)
    table = label_statistics(Volume(cells))
    names = {n: f"cell {n}" for n in range(1, 27_000)}
    big = replace(layer(same_window), names=names, colors=dict.fromkeys(names, (1.0, 0.0, 0.0)))
    model = LabelModel()
    model.show_rows(Rows.of(big, table))
    begin = time.process_time()
    changed = replace(big, **alone([5], table.labels.tolist()))
    model.show_rows(Rows.of(changed, table))
    assert time.process_time() - begin < 0.5
    assert (np.count_nonzero(model.rows.palette[:, 3]), model.rowCount()) == (1, 26_999)
    model.set_filter("cell 2699")
    assert model.rowCount() == 11
