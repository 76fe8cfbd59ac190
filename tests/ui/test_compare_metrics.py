"""Figures of two views: equal to those of exported images, measured when somebody looks, told in the panel."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

from tests.ui.conftest import drag, is_complete
from tests.ui.test_compare import viewports
from tests.ui.test_compare_modes import exported
from volviz.compare.timing import FrameTimes
from volviz.custom_gl.gpu.context import Limits
from volviz.custom_gl.scene_techniques import (
    change_setting,
    choose_technique,
    current_settings,
    current_technique,
)
from volviz.kernels.marching.surface import clean_mesh
from volviz.kernels.mesh_metrics import mesh_metrics
from volviz.meshes.polydata import extract_isosurface, triangle_arrays
from volviz.model.camera import Camera
from volviz_ui.app.main_window import MainWindow
from volviz_ui.views.fitting import fitted, reach

Wait = Callable[..., None]
pytestmark = [
    pytest.mark.usefixtures("first_full_images"),
    pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends"),
]


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    """These tests are about what happens in a window that is there."""
    return same_window


@pytest.fixture
def split(window: MainWindow, wait_for: Wait) -> MainWindow:
    """Two views of the ball with the Compare panel in front, measured."""
    window.commands["compare.split"].trigger()
    wait_for(lambda: window.measurements.metrics is not None)
    return window


def metric(window: MainWindow, key: str) -> float:
    return float(window.compare_panel.images.text(key).split()[0].replace("\N{NARROW NO-BREAK SPACE}dB", ""))


def test_a_picture_against_itself_shows_no_difference(split: MainWindow) -> None:
    table = split.compare_panel.images
    assert table.text("psnr").startswith("\N{INFINITY}")
    assert table.text("ssim") == "1.00000"
    assert table.text("max") == "0"
    assert split.docks["compare"].isVisible()


def test_the_figures_are_those_of_the_exported_pictures(split: MainWindow, wait_for: Wait) -> None:
    choose_technique(split.store, "slicing", view=1)
    wait_for(lambda: is_complete(split) and split.measurements.metrics is not None)
    first, second = exported(split)
    wait_for(lambda: is_complete(split) and split.measurements.metrics is not None)
    assert metric(split, "psnr") == pytest.approx(peak_signal_noise_ratio(first, second), abs=0.05)
    expected = structural_similarity(first, second, channel_axis=2)
    assert metric(split, "ssim") == pytest.approx(expected, abs=5e-4)
    difference = np.abs(first.astype(float) - second)
    assert metric(split, "mean") == pytest.approx(difference.mean(), abs=0.01)
    assert metric(split, "max") == pytest.approx(difference.max(), abs=1)


def test_after_a_drag_the_figures_are_measured_anew_and_times_broken_off(
    split: MainWindow, wait_for: Wait
) -> None:
    choose_technique(split.store, "isosurface", view=1)
    wait_for(lambda: is_complete(split) and split.measurements.metrics is not None)
    before = split.measurements.metrics
    viewport = viewports(split)[0]
    drag(viewport, viewport.rect().center(), viewport.rect().center() / 2)
    wait_for(lambda: split.measurements.metrics not in (None, before))
    assert split.measurements.metrics.images != before.images

    # and a drag breaks a measurement of times off
    split.compare_panel.time_button.click()
    drag(viewport, viewport.rect().center(), viewport.rect().center() / 2)
    wait_for(lambda: not split.measurements.timing.is_running)
    assert split.compare_panel.sides.text("time", 0) == "\N{EN DASH}"
    wait_for(lambda: is_complete(split))
    assert split.compare_panel.time_button.text() == split.compare_panel.tr("Measure frame times")


def test_nothing_is_measured_while_the_panel_is_hidden(window: MainWindow, wait_for: Wait) -> None:
    window.commands["compare.four_views"].trigger()
    wait_for(lambda: is_complete(window))
    QTest.qWait(400)
    assert window.measurements.metrics is None
    window.docks["compare"].toggleViewAction().trigger()
    wait_for(lambda: window.measurements.metrics is not None)


def test_frame_times_agree_with_a_clock_beside_them(split: MainWindow, wait_for: Wait) -> None:
    panel, timing = split.compare_panel, split.measurements.timing
    found: list[object] = []
    timing.finished.connect(found.append)
    statuses = [view_widget.controller.status for view_widget in split.views.view_widgets]
    begin = time.perf_counter()
    QTest.mouseClick(panel.time_button, Qt.MouseButton.LeftButton)
    assert timing.is_running
    wait_for(lambda: found)
    taken = time.perf_counter() - begin
    (times,) = found
    assert all(len(side.seconds) == 5 and min(side.seconds) > 0 for side in times)
    # what lies between the pieces is not counted, and nothing is counted twice
    assert sum(sum(side.seconds) for side in times) < taken
    # VTK's own frame is among it: no frame takes less than the pieces of its image
    assert all(
        max(side.seconds) > view_widget.controller.status.seconds
        for side, view_widget in zip(times, split.views.view_widgets, strict=True)
    )
    assert panel.sides.text("time", 0).endswith("ms")
    assert "times as long" in panel.time_ratio.text()
    assert all(
        view_widget.controller.status is not old
        for view_widget, old in zip(split.views.view_widgets, statuses, strict=True)
    )
    wait_for(lambda: is_complete(split))


def test_the_gpu_clock_is_read_where_there_is_one_and_its_absence_is_explained(
    split: MainWindow, wait_for: Wait, monkeypatch: pytest.MonkeyPatch
) -> None:
    panel, timing = split.compare_panel, split.measurements.timing
    handles = [view_widget.controller.handle for view_widget in split.views.view_widgets]
    if not handles[0].gpu.limits.software:
        pytest.skip("OpenGL runs on hardware here: its absence cannot be shown")
    assert panel.gpu_words.isVisible()
    assert "llvmpipe" in panel.gpu_words.text() or "software" in panel.gpu_words.text().lower()
    # the images are there: nothing else asks any more whether OpenGL is software
    monkeypatch.setattr(Limits, "software", property(lambda _limits: False))
    found: list[tuple[FrameTimes, FrameTimes]] = []
    timing.finished.connect(found.append)
    panel.time_button.click()
    wait_for(lambda: found)
    for side in found[0]:
        assert len(side.gpu_seconds) == len(side.seconds) == 5
        assert all(0 < gpu <= wall for gpu, wall in zip(side.gpu_seconds, side.seconds, strict=True))
    assert panel.sides.text("gpu", 0).endswith("ms")
    wait_for(panel.gpu_words.isHidden)
    assert not any(handle.on_gpu_clock for handle in handles)


def test_meshes_are_counted_like_the_mesh_of_the_library(split: MainWindow, wait_for: Wait) -> None:
    choose_technique(split.store, "marching_cubes", view=0)
    choose_technique(split.store, "marching_tetrahedra", view=1)
    wait_for(lambda: split.measurements.metrics is not None and all(split.measurements.metrics.meshes))
    metrics = split.measurements.metrics
    volume = split.documents.volume
    from volviz.model.auto_isovalue import auto_isovalue

    mesh = extract_isosurface(volume, auto_isovalue(volume), "tetrahedra", normals=None)
    vertices, faces, _ = clean_mesh(*triangle_arrays(mesh), None)
    assert metrics.meshes[1] == mesh_metrics(vertices, faces)
    assert metrics.meshes[0].faces < metrics.meshes[1].faces
    assert metrics.distance.hausdorff < max(volume.spacing)
    table = split.compare_panel.meshes
    assert table.text("euler", 0) == table.text("euler", 1) == "2"
    assert table.text("open", 0) == "0"
    assert not split.compare_panel.mesh_section.isHidden()


def test_matching_gives_the_second_view_the_settings_of_the_first(split: MainWindow) -> None:
    choose_technique(split.store, "slicing", view=1)
    step = next(p for p in current_technique(split.store.scene, 0).parameters if p.name == "step")
    split.views.activate(0)
    change_setting(split.store, step, 0.8)
    words = split.compare_panel.words.text()
    assert step.label in words
    assert "0.8" in words
    split.compare_panel.match_button.click()
    assert current_settings(split.store.scene, 1).step == 0.8
    assert step.label not in split.compare_panel.words.text()
    split.commands["edit.undo"].trigger()
    assert current_settings(split.store.scene, 1).step == 0.5


def test_vtks_counterpart_comes_beside_with_the_same_settings(window: MainWindow, wait_for: Wait) -> None:
    step = next(p for p in current_technique(window.store.scene).parameters if p.name == "step")
    change_setting(window.store, step, 0.4)
    window.commands["compare.with_vtk"].trigger()
    wait_for(lambda: window.measurements.metrics is not None)
    scene = window.store.scene
    assert [view.technique for view in scene.views] == ["raycast", "vtk_gpu"]
    assert current_settings(scene, 1).step == 0.4
    # one's own view stays as it was until one wants it to follow: VTK's first sample lies at the end of the first step
    assert current_settings(scene, 0).first_sample == 0.5
    window.compare_panel.match_button.click()
    assert current_settings(window.store.scene, 0).first_sample == 1.0
    wait_for(lambda: is_complete(window) and window.measurements.metrics is not None)
    assert window.measurements.metrics.images.psnr > 45
    samples = window.measurements.metrics.samples
    assert samples[0] == samples[1]


def test_a_narrower_view_steps_back_only_from_what_was_seen_whole() -> None:
    camera = Camera((0.0, -100.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    points = np.array([[x, y, z] for x in (-30, 30) for y in (-5, 5) for z in (-20, 20)], float)
    assert fitted(camera, points, 2.0, 1.5) == camera
    farther = fitted(camera, points, 2.0, 0.8)
    assert farther.distance > camera.distance
    assert 0.9 < reach(farther, points, 0.8)[0] <= 1
    near = replace(camera, position=(0.0, -40.0, 0.0))
    assert fitted(near, points, 2.0, 0.8) == near
    parallel = replace(camera, parallel=True, parallel_scale=25.0)
    assert reach(fitted(parallel, points, 2.0, 0.8), points, 0.8)[0] <= 1
