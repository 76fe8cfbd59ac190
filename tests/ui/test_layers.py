"""Layers in the window: added, listed, hidden, recoloured, edited one at a time, saved and taken away again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import tifffile
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from tests.ui.conftest import is_complete
from volviz.model.layer_edits import contrast_of
from volviz.model.layers import ImageLayer, LabelLayer
from volviz.model.placement import Placement
from volviz_ui.app.main_window import MainWindow
from volviz_ui.session.script import script_of

Wait = Callable[..., None]


@pytest.fixture
def label_file(tmp_path: Path) -> str:
    """Two labels in a file that says that they are some."""
    array = np.zeros((16, 16, 16), np.uint8)
    array[3:8, 3:13, 3:13], array[9:13, 3:13, 3:13] = 1, 2
    header = (
        "NRRD0005\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 16 16 16\n"
        "space directions: (2,0,0) (0,2,0) (0,0,2)\nspace origin: (0,0,0)\nencoding: raw\n"
        "Segment0_ID:=one\nSegment0_Name:=Liver\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n"
        "Segment0_Color:=1 0 0\nSegment0_Extent:=0 15 0 15 0 15\n\n"
    )
    path = tmp_path / "organs.seg.nrrd"
    path.write_bytes(header.encode() + array.tobytes())
    return str(path)


def picture(window: MainWindow, wait_for: Wait) -> np.ndarray:
    wait_for(lambda: is_complete(window))
    return window.controller.handle.read_image()


def test_layers_are_added_listed_hidden_and_removed(
    window: MainWindow, other_file: str, label_file: str, wait_for: Wait
) -> None:
    rows = window.data_panel.layers.rows
    alone = picture(window, wait_for)
    first = window.store.scene.layers[0]
    assert len(rows) == 1
    assert not rows[0].remove.isEnabled()
    window.documents.add(other_file)
    wait_for(lambda: len(window.store.scene.layers) == 2)
    assert window.store.scene.active_layer == 1
    assert window.documents.volume.dimensions == (24, 24, 24)
    window.documents.add(label_file)
    wait_for(lambda: len(window.store.scene.layers) == 3)
    labels = window.store.scene.layers[2]
    assert isinstance(labels, LabelLayer)
    assert labels.colors == ((1, (1.0, 0.0, 0.0)),)
    assert labels.names == ((1, "Liver"),)
    together = picture(window, wait_for)
    assert len(window.controller.handle.spec.layers) == 3
    assert np.abs(together - alone).max() > 0.1
    assert [row.name.isChecked() for row in rows] == [True, False, False]

    QTest.mouseClick(rows[1].name, Qt.MouseButton.LeftButton)
    assert window.documents.volume.dimensions == (24, 24, 24)
    assert window.transfer_editor.model.volume is window.documents.volume
    rows[1].set_color((0.0, 1.0, 0.0))
    assert {p.color for p in window.store.scene.layers[1].transfer_function.points} == {(0.0, 1.0, 0.0)}
    assert window.store.scene.layers[0] == first
    rows[1].opacity.setValue(40)
    assert window.store.scene.layers[1].opacity == 0.4
    QTest.mouseClick(rows[0].eye, Qt.MouseButton.LeftButton)
    assert not window.store.scene.layers[0].visible
    without = picture(window, wait_for)
    assert np.abs(without - together).max() > 0.1
    QTest.mouseClick(rows[0].eye, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.AltModifier)
    assert [layer.visible for layer in window.store.scene.layers] == [True, False, False]
    for number in (2, 1):
        QTest.mouseClick(rows[number].remove, Qt.MouseButton.LeftButton)
    assert window.store.scene.layers == (first,)
    np.testing.assert_allclose(picture(window, wait_for), alone, atol=1e-5)
    window.documents.undo()
    assert len(window.store.scene.layers) == 2
    wait_for(lambda: is_complete(window))


def test_a_technique_for_one_layer_draws_the_active_one_and_says_so(
    window: MainWindow, other_file: str, wait_for: Wait
) -> None:
    window.documents.add(other_file)
    wait_for(lambda: len(window.store.scene.layers) == 2)
    window.store.update(lambda scene: scene.with_view(technique="splatting"), label="Splatting")
    wait_for(lambda: is_complete(window))
    assert window.data_panel.layers.words.text() == "Splatting draws the active layer; 1 other layer waits."
    assert window.controller.handle.error is None
    assert window.controller.handle.volume is window.documents.volume
    assert "not in the picture" in script_of(window.store.scene, (32, 24))
    window.store.update(lambda scene: scene.with_view(technique="raycast"), label="Ray casting")
    wait_for(lambda: is_complete(window))
    assert "order changes nothing" in window.data_panel.layers.words.text()


def test_all_channels_of_a_file_become_layers(window: MainWindow, tmp_path: Path, wait_for: Wait) -> None:
    stack = np.zeros((6, 2, 16, 18), np.uint8)
    stack[2:4, 0, 4:9, 4:9], stack[1:5, 1, 8:13, 8:13] = 200, 150
    path = str(tmp_path / "cells.tif")
    tifffile.imwrite(path, stack, imagej=True, metadata={"axes": "ZCYX"})
    window.open(path)
    wait_for(lambda: window.documents.volume.dimensions == (18, 16, 6))
    assert window.data_panel.layers.channels_button.isVisibleTo(window.data_panel)
    window.data_panel.layers.channels_button.click()
    wait_for(lambda: len(window.store.scene.layers) == 2)
    assert all(isinstance(layer, ImageLayer) for layer in window.store.scene.layers)
    assert [layer.channel for layer in window.store.scene.layers] == [0, 1]
    colors = [layer.transfer_function.points[-1].color for layer in window.store.scene.layers]
    assert colors == [(1.0, 0.0, 1.0), (0.0, 1.0, 0.0)]
    assert picture(window, wait_for)[..., 3].max() > 0.1
    saved = tmp_path / "cells.volviz.json"
    window.session_commands.save_path(saved)
    before = window.store.scene.layers
    window.open("sample:mri-brain")
    wait_for(lambda: len(window.store.scene.layers) == 1)
    window.open(str(saved))
    wait_for(lambda: window.store.scene.layers == before)
    wait_for(lambda: is_complete(window))


def test_with_everything_hidden_the_picture_is_empty(window: MainWindow, wait_for: Wait) -> None:
    QTest.mouseClick(window.data_panel.layers.rows[0].eye, Qt.MouseButton.LeftButton)
    assert picture(window, wait_for).max() == 0.0
    assert window.controller.handle.error is None


def test_layers_are_ordered_copied_linked_placed_and_contrasted(
    window: MainWindow, other_file: str, wait_for: Wait
) -> None:
    store, rows = window.store, window.data_panel.layers.rows
    assert not rows[0].contrast.isVisibleTo(window.data_panel)
    window.documents.add(other_file)
    wait_for(lambda: len(store.scene.layers) == 2)
    before = picture(window, wait_for)

    def choose(row: int, words: str) -> None:
        rows[row].menu.aboutToShow.emit()
        (action,) = [each for each in rows[row].menu.actions() if each.text() == words]
        assert action.isEnabled()
        action.trigger()

    names = [layer.name for layer in store.scene.layers]
    choose(0, "Move down")
    assert [layer.name for layer in store.scene.layers] == names[::-1]
    # the active layer stays the active one, and the picture what it was
    assert store.scene.active_layer == 0
    np.testing.assert_array_equal(picture(window, wait_for), before)

    contrast = rows[1].contrast
    assert contrast.isVisibleTo(window.data_panel)
    low, high = contrast_of(store.scene.layers[1])
    contrast.slider.setValue((100, 500))
    low, high = contrast_of(store.scene.layers[1])
    assert (low, high) == pytest.approx((20.0, 100.0), abs=0.2)
    contrast.auto.click()
    assert contrast_of(store.scene.layers[1]) != (low, high)
    contrast.reset.click()
    assert contrast_of(store.scene.layers[1]) == pytest.approx((0.0, 200.0))

    for row in (0, 1):
        choose(row, "Link function")
    contrast.slider.setValue((200, 600))
    first, second = (layer.transfer_function for layer in store.scene.layers)
    assert first == second
    choose(0, "Duplicate")
    assert len(store.scene.layers) == 3
    assert store.scene.active_layer == 1

    dialog = rows[0].show_place()
    dialog.fields[0].setValue(5.0)
    dialog.fields[5].setValue(90.0)
    dialog.close()
    placed = Placement.of(store.scene.layers[0].transform, window.documents.volume.center)
    np.testing.assert_allclose((placed.move, placed.turn), ((5.0, 0.0, 0.0), (0.0, 0.0, 90.0)), atol=1e-9)
    assert np.abs(picture(window, wait_for) - before).max() > 0.05
    dialog = rows[0].show_place()
    assert dialog.fields[5].value() == pytest.approx(90.0)
    dialog.reset.click()
    dialog.close()
    assert store.scene.layers[0].transform is None
    choose(2, "Show as labels")
    assert isinstance(store.scene.layers[2], LabelLayer)
    assert picture(window, wait_for).max() > 0.0
