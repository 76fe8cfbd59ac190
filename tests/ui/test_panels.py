"""The panels: settings, light, crop box, clip planes; widget to store, store to widget, one step a drag."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSlider,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QWidget,
)

from tests.ui.conftest import drag, foreground, image, is_complete
from volviz.custom_gl.registry import techniques
from volviz.custom_gl.scene_techniques import (
    change_setting,
    choose_technique,
    current_settings,
    current_technique,
    drawing_techniques,
)
from volviz.volume_data.references import VolumeKey, VolumeRef
from volviz.volume_data.volume import Volume
from volviz_ui.app.main_window import MainWindow
from volviz_ui.editors.number import STEPS, NumberEditor
from volviz_ui.panels import form_cache
from volviz_ui.panels.settings_form import SettingsForm

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    """These tests are about what happens in a window that is there."""
    return same_window


def slider_drag(slider: QAbstractSlider, pixels: int) -> None:
    """Drag the handle of a slider."""
    part = slider.minimum() + (slider.value() - slider.minimum()) / (slider.maximum() - slider.minimum())
    x = 6 + part * (slider.width() - 12)
    start = QPoint(round(x), slider.height() // 2)
    drag(slider, start, start + QPoint(pixels, 0))


def editor(window: MainWindow, name: str) -> NumberEditor:
    form = window.technique_panel.form
    assert form is not None
    found = form.editors[name]
    assert isinstance(found, NumberEditor)
    return found


def test_a_drag_of_a_slider_is_one_step_and_reaches_the_picture(window: MainWindow, wait_for: Wait) -> None:
    before = image(window)
    slider = editor(window, "density_threshold").control.slider
    slider_drag(slider, 30)
    value = current_settings(window.store.scene).density_threshold
    assert value > 0.2
    assert window.store.undo_label == "Density threshold"
    assert window.controller.handle.settings.density_threshold == value
    window.commands["edit.undo"].trigger()
    assert current_settings(window.store.scene).density_threshold == 0.0
    assert window.store.undo_label is None
    assert slider.value() == 0
    wait_for(lambda: is_complete(window))
    assert np.abs(image(window) - before).max() <= 2


def test_no_picture_is_completed_while_a_slider_is_held(window: MainWindow, wait_for: Wait) -> None:
    slider = editor(window, "density_threshold").control.slider
    QTest.mousePress(slider, Qt.MouseButton.LeftButton, pos=QPoint(6, slider.height() // 2))
    assert window.store.is_interacting
    QTest.mouseRelease(slider, Qt.MouseButton.LeftButton, pos=QPoint(6, slider.height() // 2))
    assert not window.store.is_interacting
    wait_for(lambda: is_complete(window))


def test_a_typed_number_beyond_the_slider_is_taken(window: MainWindow) -> None:
    field = editor(window, "step").control.field
    field.setFocus()
    field.selectAll()
    QTest.keyClicks(field, "7.5")
    QTest.keyClick(field, Qt.Key.Key_Return)
    assert current_settings(window.store.scene).step == 7.5
    assert editor(window, "step").control.slider.value() == STEPS


def test_passing_through_a_field_does_not_round_its_value(window: MainWindow) -> None:
    field = editor(window, "early_termination").control.field
    before = current_settings(window.store.scene).early_termination
    field.setFocus()
    QTest.keyClick(field, Qt.Key.Key_Return)
    QTest.keyClick(field, Qt.Key.Key_Tab)
    assert current_settings(window.store.scene).early_termination == before
    assert window.store.undo_label is None


def test_a_setting_that_does_not_act_is_greyed(window: MainWindow) -> None:
    form = window.technique_panel.form
    assert form is not None
    assert not form.editors["ambient"].isEnabled()
    form.editors["shading"].control.click()
    assert current_settings(window.store.scene).shading
    assert form.editors["ambient"].isEnabled()


def test_the_small_button_brings_the_default_back(window: MainWindow) -> None:
    form = window.technique_panel.form
    assert form is not None
    editor(window, "step").control.field.setValue(2.0)
    assert current_settings(window.store.scene).step == 2.0
    _words, reset = form._rows["step"]
    assert reset.isVisible()
    reset.click()
    assert current_settings(window.store.scene).step == 0.5
    assert not reset.isVisible()


def test_two_clicks_on_a_check_box_are_two_steps(window: MainWindow) -> None:
    form = window.technique_panel.form
    assert form is not None
    form.editors["shading"].control.click()
    form.editors["shading"].control.click()
    window.commands["edit.undo"].trigger()
    assert current_settings(window.store.scene).shading
    window.commands["edit.undo"].trigger()
    assert not current_settings(window.store.scene).shading


@pytest.mark.parametrize("info", drawing_techniques(), ids=lambda info: info.id)
def test_the_panel_of_every_technique_builds_and_shows_its_settings(window: MainWindow, info: object) -> None:
    number = [i.id for i in drawing_techniques()].index(info.id) + 1
    if number <= 9:
        QTest.keyClick(window, str(number))
    else:
        choose_technique(window.store, info.id)
    assert window.store.scene.view.technique == info.id
    form = window.technique_panel.form
    assert form is not None
    assert form.info is info
    assert set(form.editors) == {p.name for p in info.parameters}
    assert window.tools.technique.currentData() == info.id
    QTest.qWait(30)
    assert window.controller.handle.error is None


def test_the_crop_box_cuts_the_picture_and_whole_volume_brings_it_back(
    window: MainWindow, wait_for: Wait
) -> None:
    window.view_commands.show_axis_view("A")
    wait_for(lambda: is_complete(window))
    whole = foreground(window)
    window.data_panel.crop.fields[0][1].setValue(15)
    assert window.store.scene.clipping.crop == (0, 15, 0, 31, 0, 31)
    wait_for(lambda: is_complete(window))
    cut = foreground(window)
    half = whole.shape[1] // 2
    # seen from the front, larger x (the patient's left) lies on the right of the image
    assert cut[:, half + 6 :].sum() < 0.05 * whole[:, half + 6 :].sum()
    assert cut[:, : half - 6].sum() == pytest.approx(whole[:, : half - 6].sum(), rel=0.05)
    window.data_panel.crop.whole.click()
    assert window.store.scene.clipping.crop is None


def test_a_clip_plane_can_be_added_moved_turned_and_removed(window: MainWindow, wait_for: Wait) -> None:
    panel = window.data_panel.planes
    panel.add_plane((1.0, 0.0, 0.0))
    assert len(panel.rows) == 1
    ((origin, _normal),) = window.store.scene.clipping.planes
    assert origin == pytest.approx((15.5, 15.5, 15.5))
    panel.rows[0].position.field.setValue(5.0)
    assert window.store.scene.clipping.planes[0][0] == pytest.approx((20.5, 15.5, 15.5))
    row = panel.rows[0]
    row.turned.emit()
    assert window.store.scene.clipping.planes[0][1] == (-1.0, -0.0, -0.0)
    panel.rows[0].removed.emit()
    assert window.store.scene.clipping.planes == ()
    assert panel.rows == []
    for _ in range(4):
        window.commands["edit.undo"].trigger()
    assert window.store.scene.clipping.planes == ()
    assert window.store.undo_label is None


def test_at_most_six_planes(window: MainWindow) -> None:
    for _ in range(6):
        window.data_panel.planes.add_plane((0.0, 1.0, 0.0))
    assert not window.data_panel.planes.add.isEnabled()
    assert len(window.store.scene.clipping.planes) == 6


def test_the_light_can_be_placed_by_numbers(window: MainWindow) -> None:
    section = window.technique_panel.light
    section.editors["headlight"].control.click()
    assert not window.store.scene.light.headlight
    place = section.editors["position"]
    place.check.click()
    place.inner.fields[2].setValue(123.0)
    assert window.store.scene.light.position[2] == 123.0
    assert window.controller.handle.light_position[2] == 123.0


def test_groups_fold_and_stay_folded_when_the_technique_changes(window: MainWindow) -> None:
    form = window.technique_panel.form
    assert form is not None
    section = form.sections["Sampling"]
    section.header.click()
    assert not section.content.isVisible()
    choose_technique(window.store, "slicing")
    assert window.technique_panel.form is not form
    assert not window.technique_panel.form.sections["Sampling"].header.isChecked()


def test_the_histogram_counts_every_voxel(window: MainWindow, wait_for: Wait) -> None:
    wait_for(lambda: window.data_panel.histogram.counts is not None)
    counts = window.data_panel.histogram.counts
    assert counts.sum() == 32**3
    assert counts[1:-1].sum() == 0


def test_every_control_has_a_tooltip_and_a_name(window: MainWindow) -> None:
    without = []
    for kind in (QAbstractButton, QAbstractSlider, QAbstractSpinBox, QComboBox):
        for widget in [*window.data_panel.findChildren(kind), *window.technique_panel.findChildren(kind)]:
            if widget.objectName().startswith("qt_") or isinstance(widget.parent(), QComboBox):
                continue
            if type(widget).__name__ == "QScrollBar":
                continue
            if not (widget.toolTip() or _parent_tooltip(widget)):
                without.append(f"{type(widget).__name__} {widget.accessibleName()}")
    assert not without


def _parent_tooltip(widget: QWidget) -> str:
    parent = widget.parentWidget()
    return parent.toolTip() if parent is not None else ""


def test_a_technique_about_light_starts_with_a_placed_light(window: MainWindow) -> None:
    from volviz.custom_gl.scene_techniques import choose_technique
    from volviz.model.light import Light

    choose_technique(window.store, "half_angle")
    assert window.store.scene.light == Light(headlight=False)
    window.store.undo()
    assert window.store.scene.light == Light()
    touched = Light(color=(1.0, 0.5, 0.5))
    window.store.update(lambda scene: replace(scene, light=touched))
    choose_technique(window.store, "half_angle")
    assert window.store.scene.light == touched


def test_a_technique_chosen_again_finds_its_form_with_present_values_and_folds(
    window: MainWindow, wait_for: Wait, other_file: str
) -> None:
    panel = window.technique_panel
    first = panel.form
    first.sections["Sampling"].set_open(False)
    choose_technique(window.store, "isosurface")
    second = panel.form
    assert second is not first
    assert first.isHidden()
    choose_technique(window.store, "raycast")
    assert panel.form is first
    assert first.isVisible()
    first.sections["Sampling"].set_open(True)
    # changed elsewhere meanwhile
    step = next(p for p in current_technique(window.store.scene).parameters if p.name == "step")
    choose_technique(window.store, "isosurface")
    choose_technique(window.store, "raycast")
    change_setting(window.store, step, 1.25)
    assert editor(window, "step").control.value == 1.25
    # another volume: only forms that name its range are made anew
    window.open(other_file)
    wait_for(lambda: window.documents.volume.dimensions[0] == 24)
    wait_for(lambda: is_complete(window))
    assert panel.form is first
    choose_technique(window.store, "isosurface")
    assert panel.form is not second
    assert panel.form.sections["Sampling"].header.isChecked()


def test_forms_are_made_in_advance_in_quiet_times_and_not_while_hidden(
    window: MainWindow, wait_for: Wait, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(form_cache, "REST_MS", 0)
    monkeypatch.setattr(form_cache, "APART_MS", 0)
    monkeypatch.setattr(form_cache.FormCache, "builds_ahead", True)
    panel = window.technique_panel
    choose_technique(window.store, "slicing")
    wait_for(
        lambda: [form.is_whole for form in panel.findChildren(SettingsForm)] == [True] * len(techniques())
    )
    assert [form for form in panel.findChildren(SettingsForm) if form.isVisible()] == [panel.form]
    assert panel.form.info.id == "slicing"
    # another theme would dress them all: those that nobody sees go, and come back in the next quiet time
    monkeypatch.setattr(form_cache, "REST_MS", 100_000)
    window.edit_commands.set_theme("light")
    assert panel.findChildren(SettingsForm) == [panel.form]
    window.edit_commands.set_theme("dark")
    choose_technique(window.store, "raycast")
    assert panel.form.isVisible()
    panel.forms.stop()


def test_a_form_that_is_still_in_the_making_is_whole_when_it_is_chosen(
    window: MainWindow, wait_for: Wait, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(form_cache, "REST_MS", 0)
    monkeypatch.setattr(form_cache, "APART_MS", 10)
    monkeypatch.setattr(form_cache, "PIECE_SECONDS", 0.0)
    monkeypatch.setattr(form_cache.FormCache, "builds_ahead", True)
    panel = window.technique_panel
    choose_technique(window.store, "slicing")
    begun = []

    def one_is_begun() -> bool:
        begun[:] = [form for form in panel.findChildren(SettingsForm) if not form.is_whole and form.editors]
        return bool(begun)

    wait_for(one_is_begun)
    panel.forms.stop()
    choose_technique(window.store, begun[0].info.id)
    assert panel.form is begun[0]
    assert panel.form.is_whole
    assert list(panel.form.editors) == [parameter.name for parameter in panel.form.info.parameters]


def test_long_names_and_units_are_shortened_and_make_nothing_wider(window: MainWindow) -> None:
    panel, unit = window.data_panel, "photons / (s mm² sr) at 540 nm"
    volume = window.documents.volume
    before = panel.body.minimumSizeHint().width()
    name = "a_very_long_name_of_a_measurement_that_goes_on_and_on.nii"
    long = Volume(volume.array, spacing=(0.123456, 0.234567, 0.345678), unit=unit, name=name)
    ref = VolumeRef("array:1")
    window.documents.cache.put(VolumeKey(ref), long)
    window.store.update(lambda scene: scene.with_layer(volume=ref), label="Long names")
    assert window.documents.volume is long
    QTest.qWait(20)
    assert panel.body.minimumSizeHint().width() == before
    shown = panel._properties["name"]
    assert shown.whole == name
    assert shown.text().endswith("…")
    assert name in shown.toolTip()
    choose_technique(window.store, "isosurface")
    field = window.transfer_editor.fields.value
    assert field.suffix() == ""
    assert field.sizeHint().width() < 200
    window.store.undo()
    window.store.undo()
    assert panel._properties["name"].text() == volume.name


def test_one_of_a_unit_is_said_in_the_singular(window: MainWindow) -> None:
    choose_technique(window.store, "marching_cubes")
    field = editor(window, "stride").control.field
    assert field.text() == "1 voxel"
    field.setValue(2)
    assert field.text() == "2 voxels"


def test_a_narrow_editor_shows_icons_without_words_and_none_cut_off(window: MainWindow) -> None:
    transfer = window.transfer_editor
    window.docks["transfer"].setFloating(True)
    for width, words in ((620, False), (1100, True), (640, False)):
        window.docks["transfer"].resize(width, 260)
        QTest.qWait(30)
        for button in (transfer.color_button, transfer.shape_button, transfer.arrange_button):
            assert (button.toolButtonStyle() == Qt.ToolButtonStyle.ToolButtonTextBesideIcon) is words
            assert button.width() >= button.sizeHint().width()


@pytest.mark.parametrize("technique", ["raycast", "isosurface"])
def test_the_tab_key_goes_through_the_technique_panel_from_above(window: MainWindow, technique: str) -> None:
    choose_technique(window.store, technique)
    panel = window.technique_panel
    panel.box.setFocus()
    rows = []
    for _ in range(60):
        QTest.keyClick(QApplication.focusWidget() or panel, Qt.Key.Key_Tab)
        focused = QApplication.focusWidget()
        if focused is None or not panel.body.isAncestorOf(focused):
            break
        rows.append(focused.mapTo(panel.body, QPoint(0, focused.height() // 2)).y())
    assert len(rows) > 8
    # labels and fields of one row differ by a few pixels in height
    assert all(below - above > -12 for above, below in itertools.pairwise(rows))
