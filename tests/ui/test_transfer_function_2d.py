"""Regions over value and gradient in the window: the image follows what is done to them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from tests.ui.conftest import drag, image, is_complete
from volviz.custom_gl.scene_techniques import choose_technique
from volviz.model.layers import ImageLayer
from volviz.model.scene import Scene
from volviz.model.transfer.function import TransferFunction
from volviz.model.transfer.function_2d import Region, TransferFunction2D
from volviz.volume_data.references import VolumeRef
from volviz_ui.app.main_window import MainWindow
from volviz_ui.session.script import script_of

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    """These tests are about what happens in a window that is there."""
    return same_window


@pytest.fixture
def planar(window: MainWindow, wait_for: Wait) -> MainWindow:
    """The window with the automatic regions drawn and the joint histogram counted."""
    QTest.mouseClick(window.transfer_editor.dimensions.two_button, Qt.MouseButton.LeftButton)
    joint = window.transfer_editor.joint
    wait_for(lambda: joint.histogram is not None and joint.histogram.done == 1.0)
    wait_for(lambda: is_complete(window))
    return window


def regions_of(window: MainWindow) -> TransferFunction2D:
    return window.store.scene.layer.transfer_function.by_gradient


def test_the_switch_draws_the_regions_and_undo_brings_the_curve_back(
    window: MainWindow, wait_for: Wait
) -> None:
    curve = image(window)
    QTest.mouseClick(window.transfer_editor.dimensions.two_button, Qt.MouseButton.LeftButton)
    wait_for(lambda: is_complete(window))
    assert regions_of(window).enabled
    assert np.abs(image(window) - curve).max() > 20
    window.store.undo()
    wait_for(lambda: is_complete(window))
    assert np.abs(image(window) - curve).max() <= 1
    window.transfer_editor.joint.close()


def test_the_picture_follows_a_region_that_is_dragged_and_undo_takes_it_back(
    planar: MainWindow, wait_for: Wait
) -> None:
    plot = planar.transfer_editor.gradient_plot
    at = QPoint(round(plot.plot.left() + 0.4 * plot.plot.width()), round(plot.plot.center().y()))
    plot.apply(TransferFunction2D(), "nothing")
    wait_for(lambda: is_complete(planar))
    nothing = image(planar)
    QTest.mouseDClick(plot, Qt.MouseButton.LeftButton, pos=at)
    QTest.mouseRelease(plot, Qt.MouseButton.LeftButton, pos=at)
    assert [region.kind for region in regions_of(planar).regions] == ["rectangle"]
    wait_for(lambda: is_complete(planar))
    added = image(planar)
    assert np.abs(added - nothing).max() > 20, "the border of the ball has such values and gradients"
    compiled = planar.controller.handle.gpu.programs.compiled
    before = regions_of(planar)
    # beyond all gradients there is nothing to be seen
    drag(plot, at, QPoint(at.x(), round(plot.plot.top()) - 200))
    wait_for(lambda: is_complete(planar))
    assert np.abs(image(planar) - nothing).max() <= 1
    planar.store.undo()
    assert regions_of(planar) == before
    wait_for(lambda: is_complete(planar))
    assert np.abs(image(planar) - added).max() <= 1
    # of the image while something moves and the one at rest there is one program each
    assert planar.controller.handle.gpu.programs.compiled - compiled <= 1


def test_a_technique_without_regions_shows_curve_and_reason(planar: MainWindow, wait_for: Wait) -> None:
    editor = planar.transfer_editor
    choose_technique(planar.store, "isosurface")
    assert editor.plots.currentWidget() is editor.plot
    assert editor.dimensions.note.isVisible()
    assert "Isosurface" in editor.dimensions.note.text()
    choose_technique(planar.store, "slicing")
    assert editor.plots.currentWidget() is editor.gradient_plot
    assert not editor.dimensions.note.isVisible()
    wait_for(lambda: is_complete(planar))


def test_each_kind_of_region_is_drawn(planar: MainWindow, wait_for: Wait) -> None:
    plot = planar.transfer_editor.gradient_plot
    top = plot.top
    seen = []
    for kind in ("rectangle", "ellipse", "triangle"):
        region = Region(kind, 100.0, 160.0, 0.1 * top, 0.9 * top, (1.0, 0.3, 0.2), 0.5, 0.5)
        plot.apply(TransferFunction2D((region,)), kind)
        wait_for(lambda: is_complete(planar))
        seen.append(image(planar))
    for i, j in ((0, 1), (0, 2), (1, 2)):
        assert np.abs(seen[i] - seen[j]).max() > 4


def test_the_copied_script_draws_the_regions(ball_file: str) -> None:
    regions = TransferFunction2D(
        (
            Region("ellipse", 120.5, 80.25, 3.125, 40.0, (1.0, 0.5, 0.25), 0.35, 0.75),
            Region("triangle", 60.0, 50.0, 0.0, 12.0, (0.0, 0.25, 1.0), 1.0, 0.0),
        )
    )
    curve = TransferFunction.from_points([(0.0, (0, 0, 0, 0)), (200.0, (1, 1, 1, 1))])
    for by_gradient in (regions, TransferFunction2D()):
        function = replace(curve, by_gradient=by_gradient)
        script = script_of(Scene(layers=(ImageLayer(VolumeRef(ball_file), function),)), (64, 48))
        scope: dict[str, Any] = {}
        exec(script.partition("picture = ")[0], scope)
        assert scope["transfer_function"] == function
    off = replace(curve, by_gradient=replace(regions, enabled=False))
    assert "Region" not in script_of(Scene(layers=(ImageLayer(VolumeRef(ball_file), off),)), (64, 48))
