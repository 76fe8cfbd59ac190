"""The plane of value and gradient: regions by mouse and keyboard."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtWidgets import QColorDialog

from volviz.model.transfer.function_2d import Region, TransferFunction2D

Key = Qt.Key


@pytest.fixture
def plane(editor, store, qtbot):
    editor.set_two_dimensional_available(True)
    editor.dimensions.two_button.click()
    qtbot.waitUntil(
        lambda: editor.joint.histogram is not None and editor.joint.histogram.done == 1.0, timeout=120000
    )
    plot = editor.gradient_plot
    top = plot.top
    region = Region("rectangle", 200.0, 400.0, 0.2 * top, 0.6 * top, (1.0, 0.5, 0.25), 0.3, 0.5)
    plot.apply(TransferFunction2D((region,)), "start")
    store.clear_history()
    plot.setFocus()
    return plot


def region_of(store) -> Region:
    return store.scene.layer.transfer_function.by_gradient.regions[0]


def test_the_switch_is_hidden_until_a_technique_can_use_it(editor) -> None:
    assert not editor.dimensions.two_button.isVisible()
    editor.set_two_dimensional_available(True)
    assert editor.dimensions.two_button.isVisible()


def test_a_technique_that_draws_no_regions_says_so(editor, store) -> None:
    editor.set_two_dimensional_available(True)
    editor.dimensions.two_button.click()
    editor.set_two_dimensional_available(False, "Isosurface draws the curve.")
    # the curve is what is drawn, so it is what is shown; the regions stay in the function
    assert editor.plots.currentWidget() is editor.plot
    assert store.scene.layer.transfer_function.by_gradient.enabled
    assert not editor.dimensions.two_button.isEnabled()
    assert editor.dimensions.note.isVisible()
    assert editor.dimensions.note.text() == "Isosurface draws the curve."
    editor.set_two_dimensional_available(True)
    assert editor.plots.currentWidget() is editor.gradient_plot
    assert not editor.dimensions.note.isVisible()
    editor.joint.close()


def test_switching_is_an_edit_that_undo_takes_back(editor, store, qtbot) -> None:
    editor.set_two_dimensional_available(True)
    editor.dimensions.two_button.click()
    assert store.scene.layer.transfer_function.by_gradient.enabled
    assert editor.plots.currentWidget() is editor.gradient_plot
    editor.dimensions.one_button.click()
    assert not store.scene.layer.transfer_function.by_gradient.enabled
    assert editor.plots.currentWidget() is editor.plot
    store.undo()
    store.undo()
    assert store.scene.layer.transfer_function.by_gradient is None
    assert editor.dimensions.one_button.isChecked()
    qtbot.waitUntil(
        lambda: editor.joint.histogram is not None and editor.joint.histogram.done == 1.0, timeout=120000
    )


def test_a_region_is_moved_as_one_step(plane, store, drag) -> None:
    before = region_of(store)
    center = plane.box(before).center()
    drag(plane, center, center + QPointF(60, -20))
    after = region_of(store)
    assert plane.x(after.value) - plane.x(before.value) == pytest.approx(60)
    assert plane.y(after.gradient_low) - plane.y(before.gradient_low) == pytest.approx(-20)
    store.undo()
    assert region_of(store) == before
    assert store.undo_label is None


def test_its_edges_resize_it_and_the_opposite_edge_stays(plane, store, drag) -> None:
    plane.select(0)
    before = region_of(store)
    box = plane.box(before)
    drag(plane, QPointF(box.right(), box.center().y()), QPointF(box.right() + 50, box.center().y()))
    after = region_of(store)
    assert plane.box(after).right() == pytest.approx(box.right() + 50)
    assert plane.box(after).left() == pytest.approx(box.left())
    drag(plane, QPointF(plane.box(after).center().x(), box.top()), QPointF(box.center().x(), box.top() - 15))
    assert plane.box(region_of(store)).top() == pytest.approx(box.top() - 15)
    assert region_of(store).gradient_low == before.gradient_low


def test_escape_takes_a_running_drag_back(plane, store, drag, qtbot) -> None:
    before = region_of(store)
    center = plane.box(before).center()
    drag(plane, center, center + QPointF(60, -20), release=False)
    assert region_of(store) != before
    qtbot.keyClick(plane, Key.Key_Escape)
    assert region_of(store) == before


def test_double_click_adds_and_del_removes(plane, store, qtbot) -> None:
    at = QPointF(plane.plot.left() + 60, plane.plot.top() + 20)
    qtbot.mouseDClick(plane, Qt.MouseButton.LeftButton, pos=at.toPoint())
    assert len(plane.function.regions) == 2
    assert plane.selected == 1
    assert plane.box(plane.region).center().x() == pytest.approx(at.x(), abs=1)
    qtbot.keyClick(plane, Key.Key_Delete)
    assert len(plane.function.regions) == 1


def test_the_plane_by_keyboard(plane, store, qtbot) -> None:
    qtbot.keyClick(plane, Key.Key_Insert)
    qtbot.keyClick(plane, Key.Key_PageDown)
    assert plane.selected == 0
    before = region_of(store)
    qtbot.keyClick(plane, Key.Key_Right, Qt.KeyboardModifier.ShiftModifier)
    qtbot.keyClick(plane, Key.Key_Up)
    after = region_of(store)
    assert after.value > before.value
    assert after.gradient_low > before.gradient_low
    qtbot.keyClick(plane, Key.Key_Escape)
    assert plane.selected is None


def test_the_fields_change_the_chosen_region(plane, editor, store, qtbot) -> None:
    plane.select(0)
    fields = editor.region_fields
    fields.opacity.setValue(0.75)
    fields.softness.setValue(0.25)
    fields.kind.setCurrentIndex(2)
    fields.kind.activated.emit(2)
    region = region_of(store)
    assert (region.opacity, region.softness, region.kind) == (0.75, 0.25, "triangle")
    qtbot.keyClick(plane, Key.Key_C)
    dialog = editor.findChild(QColorDialog)
    dialog.setCurrentColor(Qt.GlobalColor.green)
    dialog.reject()
    assert region_of(store).color == (1.0, 0.5, 0.25)


def test_a_pixel_of_the_picture_shows_the_count_of_its_place(plane, editor) -> None:
    plane.selected = None
    histogram = editor.joint.histogram
    j, i = divmod(int(histogram.counts.argmax()), histogram.counts.shape[1])
    value = (histogram.value_edges[i] + histogram.value_edges[i + 1]) / 2
    gradient = (histogram.gradient_edges[j] + histogram.gradient_edges[j + 1]) / 2
    image = plane._histogram_image()
    x, y = plane.x(value) - plane.plot.left(), plane.y(gradient) - plane.plot.top()
    assert image.pixelColor(round(x - 0.5), round(y - 0.5)).alpha() > 150
