"""What every technique owes the program, asked of all that are registered."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import volviz
import volviz.custom_gl.techniques as package
from tests.leaks import Watch
from tests.render.scenes import camera, function, volume
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.registry import techniques
from volviz.custom_gl.settings import SharedSettings
from volviz.custom_gl.vtk.vtk_imports import pyvista
from volviz.model.parameters import Cost, Parameter, make_settings, parameters_of

#: High enough for two tiles, which are 64 pixels high.
SIZE = (72, 88)
#: Enough where it counts what is compiled and uploaded: nobody looks at the image.
TINY = (24, 24)
FOLDER = Path(package.__path__[0])
#: Those that read our textures of the volume; VTK's own mappers upload theirs past us.
TEXTURED = [key for key, info in techniques().items() if info.uses_textures]

#: A step in the image that counts as a change: half a grey level, somewhere.
CHANGE = 0.5 / 255


class Stage:
    """A volume in an off-screen window, drawn again and again with other settings."""

    def __init__(self, window: Any, technique: str, dtype: Any = np.float32) -> None:
        self.volume = volume(dtype, spacing=(1.0, 1.1, 0.9))
        self.window = window
        self.handle = volviz.add_volume(
            window, self.volume, technique, transfer_function=function(self.volume)
        )
        self.look()
        window.show(auto_close=False, interactive=False)

    def look(self) -> None:
        """Look from where every test begins, at the whole volume."""
        self.window.camera.SetParallelProjection(False)
        apply_camera(self.window.camera, camera(self.volume))
        self.window.reset_camera_clipping_range()
        self.handle.update(crop=None, clip_planes=())

    def image(self, **values: Any) -> Any:
        """The image with these values and defaults otherwise."""
        info = self.handle.technique
        self.handle.update(settings=make_settings(info.settings, values, owner=info.id))
        self.window.render()
        self.handle.raise_error()
        return self.handle.read_image()


@contextmanager
def stage(technique: str, dtype: Any = np.float32, size: tuple[int, int] = SIZE) -> Iterator[Stage]:
    """A stage that is taken down at the end."""
    window = pyvista.Plotter(off_screen=True, window_size=size)
    window.render_window.SetMultiSamples(0)
    made = None
    try:
        made = Stage(window, technique, dtype)
        yield made
    finally:
        if made is not None:
            made.handle.remove()
        window.close()


@pytest.fixture(scope="module", params=list(techniques()))
def shared(request: pytest.FixtureRequest) -> Iterator[Stage]:
    """One stage for all tests that look at images of a technique; what it leaves behind is looked for at its end."""
    watch = Watch(objects=True)
    with stage(request.param) as made:
        yield made
    # pytest still holds the stage; what hangs on it must not look leaked
    vars(made).clear()
    if leaks := watch.leaks():
        pytest.fail("The stage left behind:\n  " + "\n  ".join(leaks), pytrace=False)


@pytest.fixture
def on(shared: Stage) -> Stage:
    """The shared stage, seen as at first. What a technique keeps from image to image is no leak."""
    shared.look()
    return shared


def other_values(p: Parameter) -> list[Any]:
    """Values of a setting that differ from its default, those that should be seen first."""
    if p.kind == "bool":
        return [not p.default]
    if p.kind == "choice":
        return [key for key, _ in p.choices if key != p.default]
    if p.kind in ("float", "int"):
        kind = float if p.kind == "float" else int
        low = p.soft_minimum if p.soft_minimum is not None else p.minimum
        high = p.soft_maximum if p.soft_maximum is not None else p.maximum
        if low is None or high is None:
            # in data units: the range of the stage's volume
            return [0.35, 0.6, 0.9]
        middle = (low * high) ** 0.5 if p.logarithmic else (low + high) / 2
        # the ends of the slider, then the utmost that can be typed
        tried = (middle, low, high) if p.minimum is None else (middle, low, high, p.minimum)
        return [kind(v) for v in tried if kind(v) != p.default]
    return {
        "color": [(1.0, 0.1, 0.1), (0.1, 0.1, 1.0)],
        "vector": [(0.3, 1.0, 0.2), (12.0, 14.0, 10.0)],
        "floats": [(0.35,), (0.6,), (0.9,)],
        "colors": [((1.0, 0.0, 0.0),) * 4, ((0.0, 0.0, 1.0),) * 4],
    }.get(p.kind, [])


@pytest.mark.parametrize("technique", list(techniques()))
def test_a_technique_is_a_folder_with_a_readme_and_described_settings(technique: str) -> None:
    info = techniques()[technique]
    if (FOLDER / technique).is_dir():
        assert (FOLDER / technique / "README.md").stat().st_size > 300
    assert info.label
    assert info.summary.endswith(".")
    assert dataclasses.is_dataclass(info.settings)
    assert info.settings.__dataclass_params__.frozen
    names = {p.name for p in info.parameters}
    assert names == {field.name for field in dataclasses.fields(info.settings)}, (
        "a setting has no description"
    )
    assert not names & {p.name for p in parameters_of(SharedSettings)}, (
        "light and clipping belong to the scene"
    )
    assert set(info.inert) <= names
    for p in info.parameters:
        assert p.label, p.name
        assert len(p.tooltip) > 15, p.name
        assert p.default is None or p.checked(p.default) == p.default, p.name


@pytest.mark.parametrize("technique", list(techniques()))
def test_settings_survive_json_and_the_command_line(technique: str) -> None:
    info = techniques()[technique]
    settings = make_settings(info.settings, info.classic, owner=technique)
    plain = json.loads(json.dumps(dataclasses.asdict(settings)))
    assert make_settings(info.settings, plain, owner=technique) == settings
    for p in info.parameters:
        if p.kind in ("float", "int", "bool", "choice"):
            for value in other_values(p):
                assert p.parse(str(value)) == value


@pytest.mark.parametrize("technique", list(techniques()))
def test_the_classic_values_draw_a_picture(technique: str) -> None:
    info = techniques()[technique]
    # they were made for bytes
    with stage(technique, np.uint8) as on:
        image = on.image(**info.classic)
        assert np.isfinite(image).all()
        assert (image[..., 3] > 0.02).mean() > 0.005


@pytest.mark.parametrize("technique", TEXTURED)
def test_a_cheap_setting_compiles_and_uploads_nothing(technique: str) -> None:
    info = techniques()[technique]
    with stage(technique, size=TINY) as on:
        on.image()
        gpu = on.handle.gpu
        for p in info.parameters:
            if p.cost is not Cost.VALUE or p.kind == "path":
                continue
            for value in other_values(p)[:2]:
                compiled, uploads = gpu.programs.compiled, gpu.uploads
                on.image(**{p.name: value})
                assert gpu.programs.compiled == compiled, f"{p.name} compiles a program"
                assert gpu.uploads == uploads, f"{p.name} uploads a texture"


@pytest.mark.parametrize("technique", list(techniques()))
def test_vtk_draws_as_before_after_the_technique_was_there(technique: str) -> None:
    with stage(technique) as on:
        on.handle.remove()
        on.window.add_mesh(pyvista.Sphere(radius=4.0, center=on.volume.center), color="orange")
        before = on.window.screenshot(return_img=True)
        handle = volviz.add_volume(on.window, on.volume, technique, transfer_function=function(on.volume))
        on.window.render()
        handle.raise_error()
        during = on.window.screenshot(return_img=True)
        handle.remove()
        # a screenshot alone would show the frame that is there
        on.window.render()
        after = on.window.screenshot(return_img=True)
        assert not np.array_equal(before, during)
        assert np.array_equal(before, after)


# ---------------------------------------------------- tests that share a stage come last: no search in between


@pytest.mark.leaks_allowed("the shared stage is searched at its end")
def test_the_default_picture_is_neither_empty_nor_solid(on: Stage) -> None:
    image = on.image()
    alpha = image[..., 3]
    assert np.isfinite(image).all()
    assert 0.01 < (alpha > 0.05).mean() < 0.9
    assert image[..., :3].std() > 0.01
    assert alpha.max() <= 1.0 + 1e-4


@pytest.mark.leaks_allowed("the shared stage is searched at its end")
def test_each_setting_changes_the_picture_or_says_why_not(on: Stage) -> None:
    info = on.handle.technique
    # coarse samples, since the default ones are so fine that where they lie cannot be seen
    coarse = {"step": 2.0} if any(p.name == "step" for p in info.parameters) else {}
    default = on.image(**coarse)
    dead = [
        p.name
        for p in info.parameters
        if p.name not in info.inert
        and not any(
            np.abs(on.image(**(coarse | {p.name: v})) - default).max() > CHANGE for v in other_values(p)
        )
    ]
    assert not dead, f"these settings change nothing: {', '.join(dead)}"


@pytest.mark.leaks_allowed("the shared stage is searched at its end")
def test_a_setting_that_acts_only_with_another_one_acts_with_it(on: Stage) -> None:
    info = on.handle.technique
    dead = []
    for p in info.parameters:
        if p.enabled_by is None or p.kind == "path":
            continue
        name, values = p.enabled_by
        enabled = {name: values[0]}
        base = on.image(**enabled)
        if not any(np.abs(on.image(**enabled, **{p.name: v}) - base).max() > CHANGE for v in other_values(p)):
            dead.append(p.name)
    assert not dead, f"these settings change nothing even when they are enabled: {', '.join(dead)}"


@pytest.mark.leaks_allowed("the shared stage is searched at its end")
def test_chunks_make_the_same_picture_as_one_piece(on: Stage) -> None:
    whole = on.image()
    on.handle.invalidate()
    turns = 0
    while not on.handle.refine(budget=0.0):
        turns += 1
        assert turns < 5000
    assert turns > 0
    assert np.abs(on.handle.read_image() - whole).max() <= 1 / 255


@pytest.mark.leaks_allowed("the shared stage is searched at its end")
def test_an_interrupted_picture_does_not_show_in_the_next_one(on: Stage) -> None:
    whole = on.image()
    on.window.camera.Azimuth(40)
    on.handle.invalidate()
    assert not on.handle.refine(budget=0.0)
    on.window.camera.Azimuth(-40)
    again = on.image()
    assert np.abs(again - whole).max() <= 1 / 255


@pytest.mark.leaks_allowed("the shared stage is searched at its end")
def test_crop_box_and_clip_planes_take_something_away(on: Stage) -> None:
    full = on.image()[..., 3]
    x, y, z = on.volume.dimensions
    on.handle.update(crop=(0, (x - 1) / 2, 0, y - 1, 0, z - 1))
    on.window.render()
    on.handle.raise_error()
    cropped = on.handle.read_image()[..., 3]
    on.handle.update(crop=None, clip_planes=((on.volume.center, (1.0, 0.0, 0.0)),))
    on.window.render()
    on.handle.raise_error()
    clipped = on.handle.read_image()[..., 3]
    covered = (full > 0.05).sum()
    for cut in (cropped, clipped):
        assert 0 < (cut > 0.05).sum() < covered


@pytest.mark.leaks_allowed("the shared stage is searched at its end")
def test_parallel_projection_and_a_camera_inside_draw_without_error(on: Stage) -> None:
    on.window.camera.SetParallelProjection(True)
    parallel = on.image()
    assert np.isfinite(parallel).all()
    assert (parallel[..., 3] > 0.05).mean() > 0.01
    on.window.camera.SetParallelProjection(False)
    x, y, z = on.volume.center
    on.window.camera.SetPosition(x, y, z)
    on.window.camera.SetFocalPoint(x + 3.0, y + 7.0, z + 2.0)
    on.window.reset_camera_clipping_range()
    assert np.isfinite(on.image()).all()
