"""Reports of the window: the command tells all that is shown, and its answer comes back."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtTest import QTest

from tests.ui.conftest import is_complete
from volviz.commands.compare import add_commands, sides_of, spec_and_view, technique_and_values
from volviz.commands.inputs import hints_of
from volviz.custom_gl.scene_techniques import choose_technique, current_settings, current_technique
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.layers import ImageLayer
from volviz.model.light import Light
from volviz.model.scene import Scene, SceneView
from volviz.model.transfer.formats import write_transfer_function
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.references import VolumeRef
from volviz.volume_data.volume import Volume
from volviz_ui.app.main_window import MainWindow
from volviz_ui.compare.command_line import compare_arguments, function_name
from volviz_ui.compare.convergence_plot import Curve, decades
from volviz_ui.compare.reports import curves_of

Wait = Callable[..., None]
pytestmark = pytest.mark.usefixtures("first_full_images")


def scene_of(views: tuple[SceneView, ...], camera: Camera) -> Scene:
    function = TransferFunction.from_points([(10.0, (1, 0, 0, 0)), (200.0, (1, 1, 0, 0.7))])
    ref = VolumeRef("brain.raw", (("dims", (16, 16, 16)), ("dtype", "uint8")))
    return Scene(
        (ImageLayer(ref, function, channel=0, time=2),),
        Light(headlight=False, position=(1.5, -80.25, 7.0), color=(1.0, 0.5, 0.25)),
        Clipping((1.0, 12.0, 0.0, 15.0, 2.0, 14.0), (((1.0, 2.0, 3.0), (0.0, 0.6, 0.8)),)),
        (0.0, 0.2, 1.0),
        tuple(replace(view, camera=camera) for view in views),
    )


@pytest.mark.parametrize("parallel", [False, True])
def test_the_command_of_a_report_means_what_the_views_show(tmp_path: Path, parallel: bool) -> None:
    camera = Camera(
        (3.1, -41.7, 9.25), (7.5, 7.5, 7.0), (0.0, 0.1, 1.0), 24.0, parallel, 11.5 if parallel else None
    )
    views = (
        SceneView("raycast").with_settings("raycast", _changed("raycast", step=0.37, shading=True)),
        SceneView("isosurface").with_settings("isosurface", _changed("isosurface", isovalues=(40.0, 120.5))),
        SceneView("slicing"),
    )
    scene = scene_of(views, camera)
    file = tmp_path / function_name(Path("out.html"))
    write_transfer_function(scene.layer.transfer_function, file)
    words = compare_arguments(scene, (320, 200), str(file), str(tmp_path / "out.html"), ("--convergence",))
    parser = argparse.ArgumentParser()
    add_commands(parser.add_subparsers())
    options = parser.parse_args(words)
    assert (options.file, options.convergence, options.unmatched) == ("brain.raw", True, True)
    assert hints_of(options) == {"dims": (16, 16, 16), "dtype": "uint8", "channel": 0, "time": 2}
    sides = sides_of([technique_and_values(text) for text in options.techniques], options)
    for number, side in enumerate(sides):
        info, settings = current_technique(scene, number), current_settings(scene, number)
        assert side.technique == info.id
        given = {p.name: getattr(settings, p.name) for p in info.parameters}
        assert info.settings(**dict(side.values)) == info.settings(**given)
    volume = Volume(np.zeros((16, 16, 16), np.uint8))
    spec, view = spec_and_view(volume, sides, options)
    assert view.size == (320, 200)
    assert spec.light == scene.light
    assert spec.clipping == scene.clipping
    assert view.background == pytest.approx(scene.background, abs=1 / 255)
    assert spec.layers[0].transfer_function.points == scene.layer.transfer_function.points
    assert view.camera.direction == pytest.approx(camera.direction)
    assert view.camera.scale == pytest.approx(camera.scale)
    if not parallel:
        assert view.camera == camera


def _changed(technique: str, **values: object) -> object:
    scene = Scene(views=(SceneView(technique),))
    return replace(current_settings(scene), **values)


def test_convergence_comes_back_with_slopes_and_can_be_cancelled(
    window: MainWindow, tmp_path: Path, wait_for: Wait
) -> None:
    window.commands["compare.split"].trigger()
    choose_technique(window.store, "slicing", view=1)
    wait_for(lambda: is_complete(window))
    panel = window.compare_panel
    panel.convergence_button.click()
    assert window.reports.is_running
    assert not panel.report_button.isEnabled()
    seen: list[int] = []
    window.reports.process.progressed.connect(lambda *_: seen.append(panel.bar.value()))
    wait_for(lambda: not window.reports.is_running, 300)
    assert [curve.name for curve in panel.plot.curves] == ["raycast", "slicing"]
    assert all(0.7 < curve.slope < 3 for curve in panel.plot.curves)
    assert seen == sorted(seen)
    assert len(set(seen)) > 5
    assert not panel.plot.isHidden()

    path = tmp_path / "report.html"
    assert window.reports.save(path)
    wait_for(lambda: len(seen) > 0)
    QTest.qWait(50)
    panel.cancel_button.click()
    assert not window.reports.is_running
    assert list(tmp_path.glob("report*")) == []
    assert panel.report_button.isEnabled()

    choose_technique(window.store, "two_pass_raycast", view=1)
    assert panel.plot.isHidden()


def test_a_report_that_cannot_be_made_is_told_in_one_sentence(
    window: MainWindow, tmp_path: Path, wait_for: Wait
) -> None:
    window.commands["compare.split"].trigger()
    said: list[str] = []
    window.reports.process.failed.connect(said.append)
    arguments = ["compare", str(tmp_path / "none.nrrd"), "-t", "raycast", "-t", "slicing", "-o", "r.html"]
    window.reports.process.start(arguments, tmp_path)
    wait_for(lambda: said)
    assert "none.nrrd" in said[0]
    assert "\n" not in said[0]
    assert not said[0].startswith("volviz")


def test_curves_leave_out_what_logarithms_cannot_show() -> None:
    report = json.loads(
        '{"convergence": [{"name": "a", "distances": [1, 0.5], "errors": [0.0, 0.25], "slope": null, '
        '"fitted": [null, null], "finest": 0.0, "unit": "levels of 255"}]}'
    )
    (curve,) = curves_of(report)
    assert curve.points == [(0.5, 0.25)]
    assert math.isnan(curve.slope)
    assert Curve("b", (1.0,), (2.0,), 2.0, 1.0).points == [(1.0, 2.0)]
    assert decades(0.02, 30.0) == [0.1, 1.0, 10.0]
    assert decades(0.3, 2.5) == [0.5, 1.0, 2.0]
