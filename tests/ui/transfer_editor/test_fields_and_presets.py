"""Number fields, colour dialog, presets, files, the histogram's worker."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtGui import QColor, QFocusEvent, QImage
from PySide6.QtWidgets import QApplication, QColorDialog

from tests.ui.transfer_editor.conftest import ct_like, documents_of, show, start_function
from volviz.custom_gl.registry import techniques
from volviz.errors import VolvizError
from volviz.model.layers import ImageLayer
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.model.transfer.function import TransferFunction
from volviz.model.transfer.presets import preset, preset_for, presets
from volviz.volume_data.references import VolumeRef
from volviz.volume_data.volume import Volume
from volviz_ui.transfer_editor import TransferEditor
from volviz_ui.transfer_editor.arrange import add_shape, arrange, arrangements, shapes


def function(store) -> TransferFunction:
    return store.scene.layer.transfer_function


def type_number(qtbot, field, text: str) -> None:
    field.selectAll()
    qtbot.keyClicks(field, text)
    qtbot.keyClick(field, Qt.Key.Key_Return)


def test_the_fields_show_the_chosen_point_with_its_unit(editor) -> None:
    fields = editor.fields
    assert not fields.value.isEnabled()
    editor.model.select({2})
    assert fields.value.text() == "400 HU"
    assert fields.opacity.value() == 0.3
    assert fields.swatch.color == QColor.fromRgbF(0.9, 0.8, 0.5)
    assert fields.caption.text() == "Point 3 of 4"
    editor.model.select({1, 2})
    assert fields.swatch.color is None


def test_typed_numbers_change_the_point_and_neighbours_hold_it_back(editor, store, qtbot) -> None:
    editor.model.select({1})
    type_number(qtbot, editor.fields.value, "-123.5")
    type_number(qtbot, editor.fields.opacity, "0,75")
    assert (function(store).points[1].value, function(store).points[1].opacity) == (-123.5, 0.75)
    type_number(qtbot, editor.fields.value, "5000")
    assert function(store).points[1].value == 400
    assert editor.fields.value.value() == 400


def test_one_opacity_for_several_points(editor, store, qtbot) -> None:
    editor.model.select({0, 3})
    type_number(qtbot, editor.fields.opacity, "0.5")
    assert [p.opacity for p in function(store).points] == [0.5, 0.1, 0.3, 0.5]


def test_the_colour_dialog_is_followed_live_and_one_step(editor, store, qtbot) -> None:
    editor.model.select({1, 2})
    qtbot.mouseClick(editor.fields.swatch, Qt.MouseButton.LeftButton)
    dialog = editor.findChild(QColorDialog)
    dialog.setCurrentColor(QColor(0, 255, 0))
    dialog.setCurrentColor(QColor(0, 0, 255))
    assert [p.color for p in function(store).points[1:3]] == [(0, 0, 1), (0, 0, 1)]
    dialog.accept()
    store.undo()
    assert function(store) == start_function()


def test_a_rejected_colour_dialog_leaves_everything_as_it_was(editor, store, qtbot) -> None:
    editor.model.select({1})
    qtbot.keyClick(editor.plot, Qt.Key.Key_C)
    dialog = editor.findChild(QColorDialog)
    # the plot loses the focus to the dialog
    QApplication.sendEvent(editor.plot, QFocusEvent(QEvent.Type.FocusOut))
    dialog.setCurrentColor(QColor(0, 255, 0))
    dialog.reject()
    assert function(store) == start_function()
    assert store.undo_label is None
    assert editor.model.selection == {1}


def test_the_overall_opacity_is_one_step_a_drag(editor, store, qtbot) -> None:
    slider = editor.fields.overall
    slider.setSliderDown(True)
    for position in (800, 500, 250):
        slider.setValue(position)
    slider.setSliderDown(False)
    assert function(store).opacity == 0.25
    assert editor.fields.percent.text() == "25 %"
    store.undo()
    assert function(store).opacity == 1.0
    assert slider.value() == 1000


def test_escape_takes_a_drag_of_the_overall_opacity_back(editor, store, qtbot) -> None:
    slider = editor.fields.overall
    middle = slider.rect().center()
    grip = QPoint(slider.width() - 4, middle.y())
    qtbot.mousePress(slider, Qt.MouseButton.LeftButton, pos=grip)
    qtbot.mouseMove(slider, middle)
    assert function(store).opacity < 0.9
    qtbot.keyClick(slider, Qt.Key.Key_Escape)
    assert function(store) == start_function()
    qtbot.mouseMove(slider, middle / 2)
    qtbot.mouseRelease(slider, Qt.MouseButton.LeftButton, pos=middle / 2)
    assert function(store) == start_function()
    assert slider.value() == 1000
    assert store.undo_label is None
    qtbot.keyClick(slider, Qt.Key.Key_PageDown)
    assert function(store).opacity == 0.9


def test_undo_brings_the_old_points_back_into_the_fields(editor, store, qtbot) -> None:
    editor.model.select({1})
    type_number(qtbot, editor.fields.value, "50")
    store.undo()
    assert editor.fields.value.value() == 0
    store.redo()
    assert editor.fields.value.value() == 50


def test_auto_puts_a_function_from_the_histogram(editor, store, qtbot) -> None:
    qtbot.mouseClick(editor.auto_button, Qt.MouseButton.LeftButton)
    assert function(store) == TransferFunction.auto(editor.model.volume)
    assert editor.preset_button.text().startswith("Automatic")
    assert store.undo_label == "Automatic function"


def test_presets_are_shown_with_pictures_and_taken_by_keyboard(editor, store, qtbot) -> None:
    editor.show_presets()
    qtbot.waitUntil(editor.popup.isVisible)
    assert editor.popup.list.count() == len(presets())
    assert not editor.popup.list.item(0).icon().isNull()
    qtbot.keyClick(editor.popup.list, Qt.Key.Key_Right)
    qtbot.keyClick(editor.popup.list, Qt.Key.Key_Return)
    assert not editor.popup.isVisible()
    assert function(store) == preset_for("ct-muscle", editor.model.volume)
    assert editor.preset_button.text().startswith("CT muscle")


def test_thumbnails_come_from_the_provider_when_there_is_one(editor, qtbot) -> None:
    asked: list[TransferFunction] = []

    def provider(_preset, wanted, deliver) -> None:
        asked.append(wanted)
        image = QImage(104, 72, QImage.Format.Format_RGB32)
        image.fill(QColor(255, 0, 0))
        deliver(image)

    editor.thumbnail_provider = provider
    editor.show_presets()
    qtbot.waitUntil(lambda: len(asked) == len(presets()), timeout=5000)
    qtbot.wait(20)
    icon = editor.popup.list.item(3).icon().pixmap(104, 72).toImage()
    assert icon.pixelColor(50, 30).red() > 200
    editor.popup.close()
    editor.show_presets()
    qtbot.wait(50)
    assert len(asked) == len(presets())
    editor.popup.close()


def test_own_presets_are_saved_and_stand_first(editor, store) -> None:
    editor.commands.save_as("Mine")
    editor.popup.fill()
    assert [editor.popup.own_list.item(i).text() for i in range(editor.popup.own_list.count())] == ["Mine"]
    store.update(lambda s: s.with_layer(transfer_function=preset("mri").transfer_function))
    editor.popup.chosen.emit(editor.own_presets.all()["Mine"])
    assert function(store).points == start_function().points


def test_the_button_says_which_preset_it_is_and_that_it_was_changed(editor, store, qtbot) -> None:
    editor.commands.save_as("Mine")
    assert editor.preset_button.text() == "Mine ▾"
    taken = function(store)
    editor.model.apply(taken.shifted(5.0), "shift", ())
    assert editor.preset_button.text() == "Mine * ▾"
    assert "changed since" in editor.preset_button.toolTip()
    editor.show_presets()
    assert editor.popup.own_list.currentItem().text() == "Mine"
    editor.popup.close()
    editor.commands.save_as("Mine")
    assert editor.preset_button.text() == "Mine ▾"


def test_a_preset_can_bring_its_technique_and_settings_in_one_step(editor, store) -> None:
    one = replace(preset("ct-bone"), technique="raycast", settings={"step": 0.25})
    editor.commands.take(one)
    view = store.scene.view
    assert view.technique == "raycast"
    assert view.settings_for("raycast", lambda: None).step == 0.25
    store.undo()
    assert function(store) == start_function()
    assert store.scene.view.settings == ()


def test_a_preset_made_for_light_lights_what_can_be_lit_and_keeps_the_technique(editor, store) -> None:
    raycast = techniques()["raycast"].settings
    store.update(lambda s: s.with_view(settings=s.view.with_settings("raycast", raycast(step=0.3)).settings))
    editor.commands.take(preset("ct-bone"))
    settings = store.scene.view.settings_for("raycast", raycast)
    assert (settings.shading, settings.step) == (True, 0.3)
    assert not store.scene.light.headlight
    store.undo()
    assert store.scene.view.settings_for("raycast", raycast) == raycast(step=0.3)
    assert store.scene.light.headlight
    for technique in ("isosurface", "half_angle"):
        store.update(lambda s, t=technique: s.with_view(technique=t))
        before = store.scene.view
        editor.commands.take(preset("ct-bone"))
        assert store.scene.view == before
        assert function(store) == preset_for("ct-bone", editor.model.volume)


def test_a_preset_of_an_unknown_technique_brings_at_least_its_function(editor, store, qtbot) -> None:
    with qtbot.waitSignal(editor.failed) as failed:
        editor.commands.take(replace(preset("ct-bone"), technique="nowhere"))
    assert isinstance(failed.args[0], VolvizError)
    assert function(store) == preset_for("ct-bone", editor.model.volume)


@pytest.mark.parametrize("name", ["own.json", "slicer.vp"])
def test_what_is_exported_comes_back_by_import(editor, store, name, tmp_path) -> None:
    editor.commands.write(tmp_path / name)
    store.update(lambda s: s.with_layer(transfer_function=preset("mri").transfer_function))
    editor.commands.read(tmp_path / name)
    probe = np.linspace(-900, 1400, 100)
    np.testing.assert_allclose(function(store).evaluate(probe), start_function().evaluate(probe), atol=1e-6)


def test_a_raw_table_and_a_paraview_map_are_written(editor, tmp_path) -> None:
    editor.commands.write(tmp_path / "table.dat")
    assert (tmp_path / "table.dat").stat().st_size == 1024
    editor.commands.write(tmp_path / "map.json", paraview=True)
    assert json.loads((tmp_path / "map.json").read_text())[0]["RGBPoints"][0] == -500


def test_a_damaged_file_is_told_and_changes_nothing(editor, store, tmp_path, qtbot) -> None:
    (tmp_path / "bad.vp").write_text("hello")
    with qtbot.waitSignal(editor.failed) as failed:
        editor.commands.read(tmp_path / "bad.vp")
    assert "bad.vp" in str(failed.args[0])
    assert function(store) == start_function()


def test_a_colour_map_changes_the_colours_only(editor, store) -> None:
    editor.commands.apply_colormap("viridis")
    probe = np.linspace(-900, 1400, 100)
    np.testing.assert_allclose(
        function(store).evaluate(probe)[:, 3], start_function().evaluate(probe)[:, 3], atol=1e-9
    )
    assert function(store).evaluate([1500])[0, :3] == pytest.approx((0.993, 0.906, 0.144), abs=0.005)


def test_the_colour_menu_offers_maps_by_name_with_a_picture(editor) -> None:
    menu = editor.color_button.menu()
    menu.aboutToShow.emit()
    names = [action.text() for action in menu.actions()]
    assert {"viridis", "magma", "gray"} <= set(names)
    assert not menu.actions()[0].icon().isNull()


def test_every_shape_is_put_on_the_curve_and_chosen(editor, store) -> None:
    for shape, _, _ in shapes(editor.plot):
        before = function(store)
        add_shape(editor.plot, shape, 700.0, 0.9)
        assert function(store).evaluate([700.0])[0, 3] >= before.evaluate([700.0])[0, 3]
        assert editor.model.selection
        store.undo()
        assert function(store) == before


def test_every_arrangement_is_one_step(editor, store) -> None:
    for one in arrangements(editor.plot):
        if one is None:
            continue
        label, _, edit = one
        editor.model.select({1, 2, 3})
        arrange(editor.plot, label, edit)
        values = [p.value for p in function(store).points]
        assert values == sorted(values)
        if store.undo_label is not None:
            assert store.undo_label == label
            store.undo()
        assert function(store) == start_function()


def test_the_context_menu_offers_what_can_be_done(editor, qtbot) -> None:
    from volviz_ui.transfer_editor.arrange import context_menu

    menu = context_menu(editor.plot, editor.plot.places.point(700, 0.5))
    texts = [action.text() for action in menu.actions()]
    assert "Add point here" in texts
    assert not next(a for a in menu.actions() if a.text() == "Delete").isEnabled()
    next(a for a in menu.actions() if a.text() == "Add point here").trigger()
    assert len(editor.model.function.points) == 5
    menu.deleteLater()


def test_a_drag_in_the_viewport_shifts_and_stretches_as_one_step(editor, store) -> None:
    editor.begin_shift_stretch()
    editor.shift_stretch(0.05, 0.0)
    editor.shift_stretch(0.1, 0.25)
    editor.end_shift_stretch()
    first, last = function(store).points[0].value, function(store).points[-1].value
    assert last - first == pytest.approx(3000)
    assert (first + last) / 2 == pytest.approx(250 + 0.1 * 2524)
    store.undo()
    assert function(store) == start_function()
    editor.begin_shift_stretch()
    editor.shift_stretch(0.3, 0.0)
    editor.end_shift_stretch(cancel=True)
    assert function(store) == start_function()


def test_a_relative_function_is_shown_in_data_units_and_stored_so_when_edited(qtbot, tmp_path) -> None:
    relative = TransferFunction.from_points([(0, (0, 0, 0, 0)), (1, (1, 1, 1, 1))], domain="relative")
    store = Store(Scene(layers=(ImageLayer(VolumeRef("array:1"), relative),)))
    documents = documents_of(store, ct_like())
    editor = TransferEditor(store, documents)
    qtbot.addWidget(editor)
    assert [p.value for p in editor.model.function.points] == [-1024, 1500]
    assert function(store) is relative
    editor.model.select({1})
    editor.model.nudge(-10.0, 0.0)
    assert function(store).domain == "data"
    assert [p.value for p in function(store).points] == [-1024, 1490]


def test_the_histogram_is_counted_only_when_the_editor_is_seen(qtbot, store, documents) -> None:
    editor = TransferEditor(store, documents)
    qtbot.addWidget(editor)
    qtbot.wait(30)
    assert editor.counter.counts is None
    editor.show()
    qtbot.waitUntil(lambda: editor.counter.is_done, timeout=20000)
    assert editor.counter.counts.below[-1] == ct_like().array.size


def test_another_volume_replaces_histogram_range_and_unit(editor, store, documents, qtbot) -> None:
    values = np.random.default_rng(2).random((20, 20, 20)).astype(np.float32)
    values[3, 3, 3] = 1e7
    show(documents, store, Volume(values))
    qtbot.waitUntil(lambda: editor.counter.is_done, timeout=20000)
    counts = editor.counter.counts
    assert counts.below[-1] == values.size
    np.testing.assert_allclose(
        counts.in_intervals(np.array([0.2, 0.4])), [((values > 0.2) & (values < 0.4)).sum()], rtol=0.02
    )
    editor.plot.fit_percentiles()
    assert editor.plot.axis.high < 2
    assert editor.fields.value.suffix() == ""


def test_closing_while_counting_leaves_no_thread_behind(qtbot, store, documents) -> None:
    editor = TransferEditor(store, documents)
    editor.show()
    show(documents, store, Volume(np.random.default_rng(3).random((160, 160, 160)).astype(np.float32)))
    qtbot.waitUntil(lambda: editor.counter.counts is not None, timeout=20000)
    editor.close()
    editor.deleteLater()
    qtbot.wait(10)


def test_the_store_outlives_the_editor(qtbot, store, documents) -> None:
    editor = TransferEditor(store, documents)
    editor.deleteLater()
    qtbot.wait(10)
    store.update(lambda s: s.with_layer(transfer_function=preset("mri").transfer_function))
