"""Images of a turntable from one `volviz.Renderer` against frames of the same in one open plotter, in turn.

    python benchmarks/bench_turntable.py [--size 320x240] [--images 100] [--sample mri-brain]

Both draw the same volume with the same function from the same cameras; an image is read back and turned into bytes, a
frame is only drawn. Prints both medians, the ratio of the sums and the quartiles of the ratios image by image: a
machine that is slow for a while is so for both.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pyvista

import volviz
from volviz.custom_gl.framing import default_camera
from volviz.custom_gl.offscreen import apply_camera


def seconds_of(draw: Callable[[Any], object], camera: Any) -> float:
    """Wall time of one image or frame."""
    begin = time.perf_counter()
    draw(camera)
    return time.perf_counter() - begin


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--images", type=int, default=100)
    parser.add_argument("--sample", default="mri-brain")
    parser.add_argument("--technique", default="raycast")
    options = parser.parse_args()
    width, height = (int(n) for n in options.size.split("x"))
    volume = volviz.load(f"sample:{options.sample}")
    function = volviz.TransferFunction.auto(volume)
    camera = default_camera(volume, (width, height), transfer_function=function)

    plotter = pyvista.Plotter(off_screen=True, window_size=[width, height])
    plotter.render_window.SetMultiSamples(0)
    handle = volviz.add_volume(plotter, volume, options.technique, transfer_function=function)
    plotter.show(auto_close=False)

    def frame(view: Any) -> None:
        apply_camera(plotter.camera, view)
        plotter.reset_camera_clipping_range()
        plotter.render()
        plotter.render_window.WaitForCompletion()
        handle.raise_error()

    with volviz.Renderer((width, height)) as renderer:

        def image(view: Any) -> None:
            renderer.render(volume, options.technique, transfer_function=function, camera=view)

        for warm_up in (1.0, 2.0):
            frame(camera.turned(warm_up))
            image(camera.turned(warm_up))
        frames, images = [], []
        for number in range(options.images):
            view = camera.turned(360.0 * number / options.images)
            sides = [(frames, frame), (images, image)]
            for times, draw in sides if number % 2 == 0 else sides[::-1]:
                times.append(seconds_of(draw, view))
        opengl = renderer.opengl
    plotter.close()
    low, middle, high = np.quantile(np.array(images) / np.array(frames), (0.25, 0.5, 0.75))
    print(f"{opengl}: {options.sample}, {options.technique}, {width} x {height}, {options.images} pictures")
    print(
        f"frame in an open plotter {1000 * np.median(frames):.2f} ms, picture {1000 * np.median(images):.2f} ms"
    )
    print(
        f"pictures / frames: {sum(images) / sum(frames):.3f} in all, "
        f"median {middle:.3f} ({low:.3f} to {high:.3f})"
    )


if __name__ == "__main__":
    main()
