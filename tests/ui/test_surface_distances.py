"""Two surfaces coloured by their distance: measured in the background, shown on both, never out of date."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.ui.conftest import drag, is_complete
from volviz.custom_gl.scene_techniques import choose_technique, current_technique
from volviz.errors import Cancelled
from volviz.model.comparison import Comparison
from volviz.model.session import scene_from_dict, scene_to_dict
from volviz_ui.app.main_window import MainWindow
from volviz_ui.compare import surface_distances
from volviz_ui.session.script import script_of
from volviz_ui.views.picture_parts import PictureRequest

Wait = Callable[..., None]
pytestmark = [
    pytest.mark.usefixtures("first_full_images"),
    pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends"),
]


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    """These tests are about what happens in a window that is there."""
    return same_window


def handles(window: MainWindow) -> list[Any]:
    return [view_widget.controller.handle for view_widget in window.views.view_widgets]


def colored(window: MainWindow) -> list[bool]:
    return [handle.surface_colors is not None for handle in handles(window)]


def isovalue_of(window: MainWindow, view: int, value: float) -> None:
    """Another isovalue in one view."""
    info = current_technique(window.store.scene, view)

    def changed(scene: Any) -> Any:
        settings = replace(scene.views[view].settings_for(info.id, info.settings), isovalue=value)
        return scene.with_view(view, settings=scene.views[view].with_settings(info.id, settings).settings)

    window.store.update(changed, label="Isovalue")


@pytest.fixture
def surfaces(window: MainWindow, wait_for: Wait) -> MainWindow:
    """Marching cubes beside marching tetrahedra of the ball."""
    window.commands["compare.split"].trigger()
    choose_technique(window.store, "marching_cubes", view=0)
    choose_technique(window.store, "marching_tetrahedra", view=1)
    wait_for(lambda: is_complete(window))
    return window


def choose(window: MainWindow, distances: str, wait_for: Wait) -> None:
    box = window.compare_panel.distances.choice
    box.setCurrentIndex(box.findData(distances))
    box.activated.emit(box.currentIndex())
    wait_for(lambda: all(colored(window)[:2]) == (distances != "off") and is_complete(window))


def test_copy_as_python_draws_the_colours_of_the_distance(
    surfaces: MainWindow, wait_for: Wait, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for distances in ("off", "signed", "absolute"):
        if distances != "off":
            choose(surfaces, distances, wait_for)
        for view, handle in enumerate(handles(surfaces)):
            surfaces.store.update(lambda scene, view=view: replace(scene, active=view), label="View")
            wait_for(lambda: is_complete(surfaces))
            shown = handle.read_image()
            height, width = shown.shape[:2]
            script = script_of(surfaces.store.scene, (width, height))
            assert ("DistanceColoring" in script) == (distances != "off")
            lines = script.split("\n")
            load = next(i for i, line in enumerate(lines) if line.startswith("volume = "))
            lines[load] = "volume = given"
            names: dict[str, object] = {"given": handle.volume}
            exec("\n".join(lines), names)
            drawn = np.asarray(names["picture"], np.float64) / 255.0
            apart = np.abs(drawn[..., :3] * drawn[..., 3:] - shown[..., :3])
            # seven digits of the camera move edges by next to nothing
            assert np.quantile(apart, 0.99) < 2 / 255


def test_both_surfaces_are_coloured_and_turning_keeps_the_colours(
    surfaces: MainWindow, wait_for: Wait
) -> None:
    plain = [handle.read_image() for handle in handles(surfaces)]
    choose(surfaces, "signed", wait_for)
    found = surfaces.surface_distances.colors
    assert found.is_signed
    assert 0 < found.largest < 1
    for handle, before, colors in zip(handles(surfaces), plain, (found.first, found.second), strict=True):
        assert handle.surface_colors is colors
        assert np.abs(handle.read_image() - before).max() > 0.1
    section = surfaces.compare_panel.distances
    assert not section.isHidden()
    assert f"{found.largest:.3g}" in section.state.text()
    assert "units" in section.state.text()
    assert section.cancel_button.isHidden()
    assert surfaces.commands["compare.distances"].isChecked()
    viewport = surfaces.views.first.viewport
    drag(viewport, viewport.rect().center(), viewport.rect().center() / 2)
    wait_for(lambda: is_complete(surfaces))
    assert surfaces.surface_distances.colors is found
    assert colored(surfaces) == [True, True]

    choose(surfaces, "absolute", wait_for)
    assert surfaces.surface_distances.colors.first.low == 0.0
    choose(surfaces, "off", wait_for)
    assert surfaces.surface_distances.colors is None
    assert not surfaces.commands["compare.distances"].isChecked()


def test_colours_of_another_surface_are_never_seen(surfaces: MainWindow, wait_for: Wait) -> None:
    choose(surfaces, "signed", wait_for)
    before = surfaces.surface_distances.colors
    isovalue_of(surfaces, 0, 60.0)
    # at once, and on the other side too
    assert colored(surfaces) == [False, False]
    assert surfaces.surface_distances.colors is None
    wait_for(lambda: all(colored(surfaces)))
    after = surfaces.surface_distances.colors
    assert after.largest > before.largest
    surfaces.store.undo()
    # what was measured is still there
    assert colored(surfaces) == [True, True]
    assert surfaces.surface_distances.colors.largest == before.largest
    choose_technique(surfaces.store, "raycast", view=1)
    assert not any(handle.surface_colors for handle in handles(surfaces))
    assert surfaces.compare_panel.distances.isHidden()
    wait_for(lambda: is_complete(surfaces))
    choose_technique(surfaces.store, "marching_tetrahedra", view=1)
    wait_for(lambda: all(colored(surfaces)) and is_complete(surfaces))
    assert not surfaces.compare_panel.distances.isHidden()


def test_a_look_that_is_no_other_surface_keeps_the_colours(surfaces: MainWindow, wait_for: Wait) -> None:
    choose(surfaces, "signed", wait_for)
    before = surfaces.surface_distances.colors
    surfaces.store.update(
        lambda scene: replace(scene, clipping=replace(scene.clipping, crop=(4, 20, 0, 31, 0, 31))),
        label="Crop",
    )
    wait_for(lambda: is_complete(surfaces))
    assert surfaces.surface_distances.colors is before
    assert colored(surfaces) == [True, True]


def test_equal_surfaces_are_said_to_be_the_same(surfaces: MainWindow, wait_for: Wait) -> None:
    choose_technique(surfaces.store, "vtk_marching_cubes", view=0)
    choose_technique(surfaces.store, "vtk_flying_edges", view=1)
    surfaces.commands["compare.distances"].trigger()
    wait_for(lambda: all(colored(surfaces)) and is_complete(surfaces))
    assert surfaces.surface_distances.colors.are_same
    words = surfaces.tr("No distance: the surfaces are the same.")
    assert surfaces.compare_panel.distances.state.text() == words
    assert surfaces.store.scene.comparison.distances == "signed"


def test_a_scale_of_ones_own_changes_the_colours_and_measures_nothing(
    surfaces: MainWindow, wait_for: Wait, monkeypatch: pytest.MonkeyPatch
) -> None:
    choose(surfaces, "signed", wait_for)
    monkeypatch.setattr(surface_distances, "distance_maps", None)
    section = surfaces.compare_panel.distances
    largest = surfaces.surface_distances.colors.largest
    section.automatic.click()
    # it begins with what was seen
    assert surfaces.store.scene.comparison.distance_limit == pytest.approx(largest)
    section.limit.setValue(0.25)
    assert handles(surfaces)[1].surface_colors.high == 0.25
    assert surfaces.surface_distances.colors.largest == largest
    section.automatic.click()
    assert handles(surfaces)[0].surface_colors.high == pytest.approx(largest)
    wait_for(lambda: is_complete(surfaces))


def test_the_distance_can_be_given_up_while_it_is_measured(
    surfaces: MainWindow, wait_for: Wait, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended: list[bool] = []

    def endless(_first: Any, _second: Any, *, progress: Any, cancel: Any) -> Any:
        progress(0.5)
        while not cancel():
            time.sleep(0.002)
        ended.append(True)
        raise Cancelled("given up")

    monkeypatch.setattr(surface_distances, "distance_maps", endless)
    section = surfaces.compare_panel.distances
    # a pair that no other test has measured
    isovalue_of(surfaces, 1, 77.0)
    section.bar.setValue(0)
    surfaces.commands["compare.distances"].trigger()
    wait_for(lambda: section.bar.value() >= 500)
    assert not section.cancel_button.isHidden()
    section.cancel_button.click()
    wait_for(lambda: ended)
    assert surfaces.store.scene.comparison.distances == "off"
    assert section.cancel_button.isHidden()
    assert colored(surfaces) == [False, False]


def test_of_four_views_only_the_compared_two_are_coloured(surfaces: MainWindow, wait_for: Wait) -> None:
    surfaces.commands["compare.four_views"].trigger()
    choose_technique(surfaces.store, "marching_cubes", view=2)
    surfaces.commands["compare.distances"].trigger()
    wait_for(lambda: colored(surfaces) == [True, True, False, False])
    surfaces.compare_commands.change(pair=(0, 2))
    wait_for(lambda: colored(surfaces) == [True, False, True, False])
    assert surfaces.surface_distances.colors.are_same
    surfaces.commands["compare.one_view"].trigger()
    assert colored(surfaces) == [False]


def test_an_exported_picture_has_the_colours_of_the_window(
    surfaces: MainWindow, wait_for: Wait, tmp_path: Path
) -> None:
    choose(surfaces, "signed", wait_for)
    shown = surfaces.views.pair_images()[0]
    path = tmp_path / "colored.png"
    surfaces.picture_commands.save_image(str(path), PictureRequest(surfaces.viewport.pixel_size, view=0))
    wait_for(path.exists)
    saved = np.asarray(Image.open(path))
    assert saved.shape == shown.shape
    assert np.abs(saved.astype(int) - shown).max() <= 2
    wait_for(lambda: is_complete(surfaces))


def test_a_volume_without_the_surface_says_so(surfaces: MainWindow, wait_for: Wait) -> None:
    isovalue_of(surfaces, 0, 250.0)
    surfaces.commands["compare.distances"].trigger()
    state = surfaces.compare_panel.distances.state
    wait_for(lambda: "without triangles" in state.text())
    assert colored(surfaces) == [False, False]


def test_sessions_keep_how_distances_are_shown(window: MainWindow) -> None:
    comparison = Comparison(distances="absolute", distance_limit=0.5)
    scene = replace(window.store.scene, comparison=comparison)
    again = scene_from_dict(scene_to_dict(scene), lambda _technique: None)
    assert again.comparison == comparison
