"""Images of README and documentation, drawn by the program itself: python scripts/make_images.py [NAME ...].

Without names all of them are drawn into docs/images/. The window's image needs a display (xvfb-run does).
"""

from __future__ import annotations

import argparse
import os
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageDraw

import volviz
from volviz.custom_gl.arguments import spec_of
from volviz.custom_gl.framing import default_camera, layers_camera
from volviz.custom_gl.resolve import resolve
from volviz.kernels.histogram import joint_histogram
from volviz.model.layer_looks import named_look
from volviz.model.transfer.function_2d import Region, TransferFunction2D
from volviz.model.transfer.presets import preset as preset_of
from volviz.model.transfer.presets import preset_for

FOLDER = Path(__file__).parent.parent / "docs" / "images"
SIZE = (420, 320)
BACKGROUND = (0.08, 0.09, 0.11)

#: Sample, preset and settings that show a technique well.
SCENES: dict[str, tuple[str, str | None, dict[str, object]]] = {
    "raycast": ("ct-chest", "ct-bone", {}),
    "slicing": ("engine", "engine", {}),
    "two_pass_raycast": ("mri-brain", "mri-cortex", {}),
    "isosurface": ("mri-head", None, {"isovalues": (30.0,), "gradient_delta": 1.5}),
    "splatting": ("mri-head", "mri-skin", {}),
    "half_angle": ("mri-brain", "mri", {}),
    "bump_mapping": ("mri-head", None, {}),
    "marching_cubes": ("ct-chest", None, {"isovalue": 180.0}),
    "marching_tetrahedra": ("engine", "engine", {"isovalue": 170.0}),
}


def image(
    sample: str, technique: str, preset: str | None, size: tuple[int, int] = SIZE, **values: object
) -> Image.Image:
    """An image of a sample, under the light that a preset is made for."""
    volume = volviz.load(f"sample:{sample}")
    function = preset_for(preset, volume) if preset else volviz.TransferFunction.auto(volume)
    camera = default_camera(volume, size, transfer_function=function)
    info = volviz.techniques()[technique]
    made_for = (preset_of(preset).settings or {}) if preset and "light" not in info.manipulators else {}
    known = {parameter.name for parameter in info.parameters}
    lit = {name: value for name, value in made_for.items() if name in known}
    pixels = volviz.render(
        volume,
        technique,
        transfer_function=function,
        size=size,
        camera=camera,
        background=BACKGROUND,
        headlight=False,
        **(lit | values),
    )
    return Image.fromarray(pixels).convert("RGB")


def side_by_side(images: list[Image.Image], columns: int) -> Image.Image:
    """Images of one size in rows, two pixels apart."""
    width, height = images[0].size
    rows = -(-len(images) // columns)
    sheet = Image.new("RGB", (columns * (width + 2) - 2, rows * (height + 2) - 2), "white")
    for i, one in enumerate(images):
        sheet.paste(one, ((i % columns) * (width + 2), (i // columns) * (height + 2)))
    return sheet


def save(image: Image.Image, name: str) -> None:
    """Write an image with few bytes: 256 colours are enough for a small one."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{name}.png"
    small = image.width * image.height < 600_000
    (image.quantize(256, dither=Image.Dither.FLOYDSTEINBERG) if small else image).save(path, optimize=True)
    print(f"{path.name}: {image.width} x {image.height}, {path.stat().st_size // 1024} KB")


def draw_techniques() -> None:
    """One image a technique, and all of them on one sheet."""
    images = []
    for technique, (sample, preset, values) in SCENES.items():
        if technique in volviz.techniques():
            images.append(image(sample, technique, preset, **values))
            save(images[-1], technique)
    save(side_by_side([one.resize((280, 213)) for one in images], 3), "techniques")


def draw_looks() -> None:
    """The looks of four samples."""
    size, images = (236, 200), []
    with volviz.Renderer(size) as renderer:
        for sample in ("ct-chest", "mri-head", "engine", "torus"):
            volume = volviz.load(f"sample:{sample}")
            for look in list(volviz.looks(volume).values())[:5]:
                drawn = Image.fromarray(renderer.render(volume, look=look, background=BACKGROUND)).convert(
                    "RGB"
                )
                ImageDraw.Draw(drawn).text((8, 6), look.label, fill=(225, 228, 232), font_size=14)
                images.append(drawn)
    save(side_by_side(images, 5), "looks")


def draw_slices() -> None:
    """8 to 256 slices: polygons above, images below."""
    counts, size = (8, 16, 32, 64, 128, 256), (200, 170)
    rows = [
        [image("engine", "slicing", "engine", size, slices=n, controller=controller) for n in counts]
        for controller in ("wireframe", "image")
    ]
    save(side_by_side([*rows[0], *rows[1]], len(counts)), "slicing-counts")


def draw_modes() -> None:
    """The modes of ray casting."""
    modes = ("composite", "maximum", "minimum", "average", "additive", "attenuated_maximum")
    ramp = volviz.TransferFunction.from_points([(0.0, (0, 0, 0, 0)), (1.0, (1, 1, 1, 1))], domain="relative")
    volume = volviz.load("sample:mri-head")
    camera = default_camera(volume, (200, 170))
    images = [
        Image.fromarray(
            volviz.render(
                volume, transfer_function=ramp, size=(200, 170), camera=camera, background=BACKGROUND, mode=mode,
                opacity_unit_distance=30.0 if mode in ("composite", "additive") else None,
            )
        ).convert("RGB")
        for mode in modes
    ]  # fmt: skip
    save(side_by_side(images, 3), "modes")


def draw_layers() -> None:
    """Channels of a cell, and an atlas inside a head by three techniques, of the test data where those are there."""
    folder = Path(os.environ.get("VOLVIZ_TEST_DATA", FOLDER.parents[2] / "shared" / "data"))
    cells, atlas = folder / "xyzct-mitosis.tif", folder / "layers" / "aal.nii.gz"
    if not (cells.exists() and atlas.exists()):
        print(
            f"layers: {folder} does not hold {cells.name} and layers/{atlas.name}; the picture stays as it is."
        )
        return
    source = volviz.open(cells)
    channels = [
        volviz.ImageLayer(source, named_look(color, source.read(channel=n)), channel=n)
        for n, color in enumerate(("green", "magenta"))
    ]
    head = volviz.load("sample:mri-head")
    layers = [volviz.ImageLayer(head, preset_for("mri", head)), volviz.LabelLayer(volviz.open(atlas))]
    veiled = [replace(layers[0], opacity=0.25), layers[1]]
    pictures = []
    for shown, technique in (
        (channels, "raycast"),
        (layers, "raycast"),
        (layers, "half_angle"),
        (veiled, "isosurface"),
    ):
        seen = resolve(spec_of(shown)).seen
        camera = layers_camera(seen, SIZE, elevation=25.0 if shown is channels else 0.0)
        pixels = volviz.render(shown, technique, size=SIZE, camera=camera, background=BACKGROUND)
        pictures.append(Image.fromarray(pixels).convert("RGB"))
    save(side_by_side(pictures, 2), "layers")


def draw_regions() -> None:
    """Regions over the joint histogram of value and gradient, the curve's image and theirs."""
    volume = volviz.load("sample:ct-chest")
    regions = (
        Region("ellipse", -450.0, 700.0, 80.0, 380.0, (0.45, 0.7, 1.0), 0.08, 0.8),
        Region("ellipse", 450.0, 650.0, 50.0, 380.0, (1.0, 0.9, 0.7), 0.6, 0.6),
        Region("rectangle", 60.0, 160.0, 0.0, 14.0, (0.85, 0.3, 0.25), 0.03, 0.5),
    )
    curve = volviz.TransferFunction.auto(volume)
    function = replace(curve, by_gradient=TransferFunction2D(regions))
    size = (300, 260)
    images = [_plane(volume, regions, size)]
    camera = default_camera(volume, size, transfer_function=curve)
    for shown in (curve, function):
        pixels = volviz.render(
            volume, transfer_function=shown, size=size, camera=camera, background=BACKGROUND, shading=True
        )
        images.append(Image.fromarray(pixels).convert("RGB"))
    save(side_by_side(images, 3), "regions")


def _plane(volume: volviz.Volume, regions: tuple[Region, ...], size: tuple[int, int]) -> Image.Image:
    """The joint histogram of value (right) and gradient magnitude (up) with outlines of regions."""
    values, gradients = volume.range, (0.0, 420.0)
    counts = joint_histogram(
        volume.array, volume.spacing, bins=size, value_range=values, gradient_range=gradients
    ).counts
    level = np.minimum(np.log1p(counts) / np.quantile(np.log1p(counts), 0.995), 1.0)[::-1, :, None]
    plane = np.asarray(BACKGROUND) + 0.7 * level * (1.0 - np.asarray(BACKGROUND))
    image = Image.fromarray(np.rint(255 * plane).astype(np.uint8))
    pen = ImageDraw.Draw(image)
    for region in regions:
        x = [
            (region.value + side * region.width / 2 - values[0]) / (values[1] - values[0]) * size[0]
            for side in (-1, 1)
        ]
        y = [size[1] * (1.0 - g / gradients[1]) for g in (region.gradient_high, region.gradient_low)]
        color = tuple(round(255 * c) for c in region.color)
        draw = pen.ellipse if region.kind == "ellipse" else pen.rectangle
        draw((x[0], y[0], x[1], y[1]), outline=color, width=2)
    return image


def draw_in_window(name: str, theme: str, sample: str, act: Callable[[Any], None] | None = None) -> None:
    """The desktop program with a sample, after something was done in it."""
    from volviz.environment import prepare

    prepare()
    from PySide6.QtCore import QEvent, QSettings
    from PySide6.QtWidgets import QApplication

    from volviz_ui.app.application import make_application

    application = QApplication.instance() or make_application()
    from volviz_ui.app.main_window import MainWindow
    from volviz_ui.session.preferences import Preferences
    from volviz_ui.style.theme import Theme

    kept = tempfile.TemporaryDirectory()
    settings = QSettings(str(Path(kept.name) / "settings.ini"), QSettings.Format.IniFormat)
    window = MainWindow(Theme(application, theme), Preferences(settings))
    window.resize(1360, 860)
    window.show()
    window.open(f"sample:{sample}")
    for doing in (None, act):
        if doing is not None:
            doing(window)
        while not (window.views.is_complete and window.ray_inspector.is_settled) or window.workers.is_busy:
            application.processEvents()
        # outside of the application's own loop nothing else delivers them: docks leave tab bars behind
        application.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        for _ in range(200):
            application.processEvents()
    grabbed = window.screen().grabWindow(window.winId()).toImage()
    grabbed = grabbed.convertToFormat(grabbed.Format.Format_RGB888)
    pixels = np.frombuffer(grabbed.constBits(), np.uint8).reshape(grabbed.height(), grabbed.bytesPerLine())
    image = pixels[:, : 3 * grabbed.width()].reshape(grabbed.height(), grabbed.width(), 3)
    save(Image.fromarray(image.copy()), name)
    window.close()
    window.deleteLater()
    del settings
    kept.cleanup()


def draw_window() -> None:
    """The desktop program with the first picture of a chest and its other looks, and of an engine block."""
    from volviz_ui.views import look_strip

    # as long as somebody points at it
    look_strip.STAYS_MS = 10_000_000

    def act(window: Any) -> None:
        from PySide6.QtWidgets import QApplication

        for command in ("view.next_look", "view.previous_look"):
            before = window.store.scene
            window.commands[command].trigger()
            while window.store.scene is before or window.look_commands.is_drawing:
                QApplication.processEvents()

    draw_in_window("window-dark", "dark", "ct-chest", act)
    draw_in_window("window-light", "light", "engine")


def draw_ray_inspector() -> None:
    """A ray through the engine block, one of its samples chosen."""
    from PySide6.QtWidgets import QApplication

    def act(window: Any) -> None:
        window.docks["ray"].show()
        window.ray_inspector.inspect((0.52, 0.49))
        while window.ray_panel.plot.found is None:
            QApplication.processEvents()
        window.ray_panel.plot.choose(int(np.argmax(window.ray_panel.plot.found.profile.values)))

    draw_in_window("ray-inspector", "dark", "engine", act)


def draw_slices_in_window() -> None:
    """Three slices beside the volume."""

    def act(window: Any) -> None:
        window.commands["view.slices.grid"].trigger()
        center = window.documents.volume.center
        window.store.update(
            lambda scene: replace(scene, cursor=(center[0] + 9, center[1] - 4, center[2] + 6))
        )

    draw_in_window("window-slices", "dark", "mri-head", act)


def draw_crosscheck() -> None:
    """Marching cubes in the window, with the cross-check beneath."""
    from volviz.environment import prepare

    prepare()
    from PySide6.QtCore import QSettings

    from volviz_ui.app.application import make_application

    application = make_application()
    from volviz.custom_gl.scene_techniques import change_setting, choose_technique
    from volviz_ui.app.main_window import MainWindow
    from volviz_ui.session.preferences import Preferences
    from volviz_ui.style.theme import Theme

    kept = tempfile.TemporaryDirectory()
    settings = QSettings(str(Path(kept.name) / "settings.ini"), QSettings.Format.IniFormat)
    window = MainWindow(Theme(application, "dark"), Preferences(settings))
    window.resize(1360, 900)
    window.show()
    window.open("sample:ct-chest")
    while window.documents.volume is None:
        application.processEvents()
    choose_technique(window.store, "marching_cubes")
    isovalue = next(p for p in volviz.techniques()["marching_cubes"].parameters if p.name == "isovalue")
    change_setting(window.store, isovalue, 200.0)
    window.docks["crosscheck"].toggleViewAction().trigger()
    while not window.controller.is_complete or window.surface.summary is None:
        application.processEvents()
    window.crosscheck_panel.start()
    while window.crosscheck_panel.is_running:
        application.processEvents()
    for _ in range(200):
        application.processEvents()
    panel = window.technique_panel
    panel.ensureWidgetVisible(panel.surface, 0, 12)
    grabbed = window.grab().toImage()
    grabbed = grabbed.convertToFormat(grabbed.Format.Format_RGB888)
    pixels = np.frombuffer(grabbed.constBits(), np.uint8).reshape(grabbed.height(), grabbed.bytesPerLine())
    image = pixels[:, : 3 * grabbed.width()].reshape(grabbed.height(), grabbed.width(), 3)
    save(Image.fromarray(image.copy()), "crosscheck")
    window.close()
    window.deleteLater()
    del settings
    kept.cleanup()


def draw_comparison() -> None:
    """Our ray caster, VTK's and the difference of both; errors over the step with fitted slopes."""
    from volviz.compare.convergence import ConvergenceRun
    from volviz.compare.image_metrics import difference_image
    from volviz.compare.plots import convergence_plot
    from volviz.compare.run import Side, compare
    from volviz.model.render_spec import RenderSpec, View

    volume, size = volviz.load("sample:mri-head"), (300, 240)
    function = preset_for("mri", volume)
    camera = default_camera(volume, size, transfer_function=function)
    spec = RenderSpec((volviz.ImageLayer(volume, function),))
    view = View(camera, size, BACKGROUND)
    found = compare(spec, view, [Side("raycast"), Side("vtk_gpu")], frames=0)
    images = [side.image for side in found.sides]
    images.append(difference_image(*images).image)
    save(side_by_side([Image.fromarray(one) for one in images], 3), "comparison")
    results = []
    for technique in ("raycast", "slicing", "vtk_gpu", "half_angle", "vtk_shadows"):
        run = ConvergenceRun(spec, view, technique, technique)
        for _ in run.steps():
            pass
        assert run.result is not None
        results.append(run.result)
    # a page around it cannot lend its colours to an image: ink on paper
    plot = convergence_plot(results).replace("currentColor", "#1d1f21")
    head, rest = plot.split(">", 1)
    (FOLDER / "convergence.svg").write_text(f'{head}>\n<rect width="860" height="400" fill="#fff"/>{rest}\n')
    print("convergence.svg")


def draw_comparison_in_window() -> None:
    """Our ray caster beside VTK's, with the Compare panel."""
    from PySide6.QtWidgets import QApplication

    def act(window: Any) -> None:
        # the panel needs the height
        window.docks["transfer"].hide()
        window.commands["compare.with_vtk"].trigger()
        window.commands["view.reset_camera"].trigger()
        while window.measurements.metrics is None:
            QApplication.processEvents()
        window.compare_panel.time_button.click()
        # taking times draws the images anew, and their figures are measured anew
        while window.measurements.timing.is_running or window.measurements.metrics is None:
            QApplication.processEvents()

    draw_in_window("window-compare", "dark", "engine", act)


DRAWINGS: dict[str, Callable[[], None]] = {
    "crosscheck": draw_crosscheck,
    "techniques": draw_techniques,
    "looks": draw_looks,
    "slices": draw_slices,
    "modes": draw_modes,
    "layers": draw_layers,
    "comparison": draw_comparison,
    "regions": draw_regions,
    "window": draw_window,
    "ray-inspector": draw_ray_inspector,
    "window-compare": draw_comparison_in_window,
    "window-slices": draw_slices_in_window,
}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(DRAWINGS))
    names = parser.parse_args().names
    if unknown := [name for name in names if name not in DRAWINGS]:
        parser.error(f"there is no picture called {', '.join(unknown)}; there are {', '.join(DRAWINGS)}")
    for chosen in names or DRAWINGS:
        DRAWINGS[chosen]()
