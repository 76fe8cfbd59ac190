"""What the mouse does in the plot, with real events."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QApplication

from tests.ui.transfer_editor.conftest import send

CTRL, SHIFT, ALT = (
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.AltModifier,
)


def function(store):
    return store.scene.layer.transfer_function


def values(store) -> list[float]:
    return [p.value for p in function(store).points]


def wheel(plot, at: QPointF, notches: float, modifiers=Qt.KeyboardModifier.NoModifier) -> None:
    event = QWheelEvent(
        at, plot.mapToGlobal(at), QPoint(), QPoint(0, round(120 * notches)), Qt.MouseButton.NoButton,
        modifiers, Qt.ScrollPhase.NoScrollPhase, False,
    )  # fmt: skip
    QApplication.sendEvent(plot, event)


def test_a_point_follows_the_pointer_and_the_drag_is_one_step(editor, store, drag, place) -> None:
    start = place(2)
    drag(editor.plot, start + QPointF(3, -2), start + QPointF(53, 18))
    point = function(store).points[2]
    expected = start + QPointF(50, 20)
    assert editor.plot.places.point(point.value, point.opacity).x() == pytest.approx(expected.x(), abs=0.01)
    assert editor.plot.places.point(point.value, point.opacity).y() == pytest.approx(expected.y(), abs=0.01)
    assert store.undo_label == "Move points"
    store.undo()
    assert store.undo_label is None
    assert values(store) == [-500, 0, 400, 1000]


def test_a_drag_tells_when_it_starts_and_ends(editor, store, drag, place) -> None:
    told: list[bool] = []
    store.interaction_changed.connect(told.append)
    drag(editor.plot, place(1), place(1) + QPointF(30, 0))
    assert told == [True, False]


def test_a_drag_ends_with_a_plot_that_is_hidden(editor, store, drag, place) -> None:
    before = function(store)
    drag(editor.plot, place(1), place(1) + QPointF(40, -30), release=False)
    assert store.is_interacting
    editor.hide()
    assert not store.is_interacting
    assert function(store) != before
    store.undo()
    assert function(store) == before


def test_shift_restricts_the_drag_to_the_longer_axis(editor, store, drag, place) -> None:
    before = function(store).points[2]
    drag(editor.plot, place(2), place(2) + QPointF(60, -20), modifiers=SHIFT)
    assert function(store).points[2].opacity == before.opacity
    assert function(store).points[2].value > before.value
    before = function(store).points[2]
    drag(editor.plot, place(2), place(2) + QPointF(10, -30), modifiers=SHIFT)
    assert function(store).points[2].value == pytest.approx(before.value)
    assert function(store).points[2].opacity > before.opacity


def test_a_point_cannot_pass_its_neighbours(editor, store, drag, place) -> None:
    drag(editor.plot, place(1), place(3) + QPointF(50, 0))
    assert values(store) == [-500, 400, 400, 1000]


def test_escape_takes_a_running_drag_back(editor, store, drag, place, qtbot) -> None:
    before = function(store)
    drag(editor.plot, place(1), place(1) + QPointF(40, -30), release=False)
    assert function(store) != before
    qtbot.keyClick(editor.plot, Qt.Key.Key_Escape)
    assert function(store) == before
    assert store.undo_label is None
    send(editor.plot, QEvent.Type.MouseMove, place(3), Qt.MouseButton.NoButton, Qt.MouseButton.LeftButton)
    send(
        editor.plot,
        QEvent.Type.MouseButtonRelease,
        place(3),
        Qt.MouseButton.LeftButton,
        Qt.MouseButton.NoButton,
    )
    assert function(store) == before


def test_double_click_adds_a_point_at_the_pointer(editor, store, qtbot) -> None:
    at = editor.plot.places.point(700, 0.2).toPoint()
    qtbot.mouseDClick(editor.plot, Qt.MouseButton.LeftButton, pos=at)
    added = function(store).points[3]
    assert added.value == pytest.approx(700, abs=5)
    assert added.opacity == pytest.approx(0.2, abs=0.02)
    assert editor.model.selection == {3}


def test_double_click_near_the_curve_keeps_its_shape(editor, store, qtbot) -> None:
    before = function(store)
    at = editor.plot.places.point(700, before.evaluate([700])[0, 3]).toPoint()
    qtbot.mouseDClick(editor.plot, Qt.MouseButton.LeftButton, pos=at)
    probe = np.linspace(-900, 1400, 50)
    np.testing.assert_allclose(function(store).evaluate(probe), before.evaluate(probe), atol=1e-9)
    assert len(function(store).points) == 5


def test_a_rubber_band_chooses_several_points_which_move_together(editor, store, drag, place) -> None:
    drag(editor.plot, place(1) + QPointF(-25, -60), place(2) + QPointF(25, 30))
    assert editor.model.selection == {1, 2}
    drag(editor.plot, place(1), place(1) + QPointF(20, -10))
    moved = np.subtract(values(store), [-500, 0, 400, 1000])
    assert moved[0] == moved[3] == 0
    assert moved[1] == pytest.approx(moved[2])
    assert moved[1] > 10


def test_control_adds_to_the_choice_and_a_click_on_nothing_clears_it(editor, store, qtbot, place) -> None:
    for i in (0, 2):
        qtbot.mouseClick(editor.plot, Qt.MouseButton.LeftButton, CTRL, place(i).toPoint())
    assert editor.model.selection == {0, 2}
    qtbot.mouseClick(editor.plot, Qt.MouseButton.LeftButton, CTRL, place(0).toPoint())
    assert editor.model.selection == {2}
    qtbot.mouseClick(editor.plot, Qt.MouseButton.LeftButton, pos=editor.plot.places.point(700, 0.9).toPoint())
    assert editor.model.selection == frozenset()


def test_the_wheel_zooms_about_the_pointer_and_shift_pans(editor) -> None:
    plot = editor.plot
    at = plot.places.point(400, 0.5)
    before = plot.axis
    wheel(plot, at, 3)
    assert plot.axis.high - plot.axis.low < 0.6 * (before.high - before.low)
    assert plot.places.value(at.x()) == pytest.approx(400, abs=1e-6)
    zoomed = plot.axis
    wheel(plot, at, 1, SHIFT)
    assert plot.axis.high - plot.axis.low == pytest.approx(zoomed.high - zoomed.low)
    assert plot.axis.low < zoomed.low
    wheel(plot, at, -100)
    assert plot.axis.high - plot.axis.low <= 3.1 * (before.data_high - before.data_low)


def test_middle_drag_pans(editor, drag) -> None:
    plot = editor.plot
    plot.zoom(4)
    value = plot.places.value(500)
    drag(plot, QPointF(500, 60), QPointF(420, 60), button=Qt.MouseButton.MiddleButton)
    assert plot.places.value(420) == pytest.approx(value)


def test_points_outside_the_window_are_marked_and_a_click_brings_them_back(editor, qtbot) -> None:
    plot = editor.plot
    plot.set_axis(plot.axis.showing(-100, 500))
    assert plot.places.outside(editor.model.function) == ([0], [3])
    qtbot.mouseClick(plot, Qt.MouseButton.LeftButton, pos=plot.places.edge_marker(True).center().toPoint())
    assert plot.places.outside(editor.model.function) == ([0], [])
    qtbot.mouseClick(plot, Qt.MouseButton.LeftButton, pos=plot.places.edge_marker(False).center().toPoint())
    assert plot.places.outside(editor.model.function) == ([], [])


def test_dragging_the_colour_strip_shifts_and_stretches_everything(editor, store, drag) -> None:
    plot = editor.plot
    ramp = plot.places.ramp.center()
    width = plot.places.value(ramp.x() + 60) - plot.places.value(ramp.x())
    drag(plot, ramp, ramp + QPointF(60, 0))
    np.testing.assert_allclose(np.subtract(values(store), [-500, 0, 400, 1000]), width)
    store.undo()
    drag(plot, ramp, ramp + QPointF(0, -120))
    assert values(store)[3] - values(store)[0] == pytest.approx(3000)
    assert store.undo_label == "Shift and stretch"


def test_alt_drag_in_the_plot_shifts_too(editor, store, drag) -> None:
    plot = editor.plot
    at = plot.places.point(700, 0.9)
    drag(plot, at, at + QPointF(40, 0), modifiers=ALT)
    assert values(store)[0] > -500


def test_a_colour_stop_moves_and_the_opacities_stay(editor, store, drag) -> None:
    plot = editor.plot
    before = function(store)
    at = QPointF(plot.places.x(0), plot.places.color_points.center().y())
    drag(plot, at, at + QPointF(80, 0))
    after = function(store)
    probe = np.linspace(-900, 1400, 200)
    np.testing.assert_allclose(after.evaluate(probe)[:, 3], before.evaluate(probe)[:, 3], atol=1e-9)
    assert not np.allclose(after.evaluate(probe)[:, :3], before.evaluate(probe)[:, :3], atol=0.01)
    store.undo()
    assert function(store) == before


def test_double_click_on_the_strip_adds_a_colour_that_del_removes(editor, store, qtbot) -> None:
    plot = editor.plot
    before = function(store)
    at = QPointF(plot.places.x(700), plot.places.ramp.center().y()).toPoint()
    qtbot.mouseDClick(plot, Qt.MouseButton.LeftButton, pos=at)
    assert editor.model.color_point == 3
    assert len(editor.model.channels[0]) == 5
    qtbot.keyClick(plot, Qt.Key.Key_Right, SHIFT)
    assert editor.model.channels[0][3].value > 705
    qtbot.keyClick(plot, Qt.Key.Key_Delete)
    probe = np.linspace(-900, 1400, 200)
    np.testing.assert_allclose(function(store).evaluate(probe), before.evaluate(probe), atol=1e-9)


def test_isovalues_are_dragged_and_told(editor, store, drag, qtbot) -> None:
    plot = editor.plot
    editor.set_isovalues((200.0,), ((1.0, 0.0, 0.0),))
    told: list[tuple[int, float]] = []
    editor.isovalue_moved.connect(lambda i, v: told.append((i, v)))
    at = QPointF(plot.places.x(200), plot.places.plot.top() + 4)
    drag(plot, at, at + QPointF(50, 0), release=False)
    assert store.is_interacting
    assert told[-1][0] == 0
    assert told[-1][1] == pytest.approx(plot.places.value(at.x() + 50), abs=1)
    qtbot.keyClick(plot, Qt.Key.Key_Escape)
    assert not store.is_interacting
    assert plot.markers == (200.0,)


def test_the_curve_is_drawn_where_the_points_are(editor) -> None:
    """The pixel of a control point has its colour, on both opacity axes and on both value axes."""
    plot = editor.plot
    for fine in (False, True):
        for logarithmic in (False, True):
            plot.set_fine_opacity(fine)
            plot.set_log_values(logarithmic)
            image = plot.grab().toImage()
            ratio = image.devicePixelRatio()
            for p in editor.model.function.points:
                at = plot.places.point(p.value, p.opacity) * ratio
                color = image.pixelColor(round(at.x()), round(at.y()))
                np.testing.assert_allclose(color.getRgbF()[:3], p.color, atol=0.02)


def test_the_histogram_stands_where_the_voxels_are(editor) -> None:
    counts = editor.counter.counts
    array = editor.model.volume.array
    limits = np.array([-1024.5, -999.5, 0.5, 500.5, 1500.5])
    expected = [((array > a) & (array < b)).sum() for a, b in pairwise(limits)]
    np.testing.assert_allclose(counts.in_intervals(limits), expected, atol=1e-6)


def test_values_that_never_occur_make_no_comb(editor) -> None:
    from volviz_ui.transfer_editor.histogram_worker import Counts

    edges = np.arange(-0.5, 400.5)
    used = np.where(np.arange(400) % 4 == 0, 1000.0, 0.0)
    counts = Counts(edges, np.concatenate([[0.0], np.cumsum(used)]))
    assert counts.grain == 4.0
    density = counts.density(np.linspace(10, 390, 500), np.full(500, 0.76))
    np.testing.assert_allclose(density, 250.0)
