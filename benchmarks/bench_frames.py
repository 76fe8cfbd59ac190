"""Frame times of our ray casters and slicing against VTK's, in one process, frame by frame in turn.

    python benchmarks/bench_frames.py [--size 600x600] [--frames 7]

The same volume, camera, transfer function, step and window on both sides; medians of the wall time of a frame, and the
ratio VTK / ours (above 1: ours is faster). Name the machine when quoting figures.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from typing import Any

import pyvista

import volviz
from volviz.custom_gl.framing import default_camera
from volviz.custom_gl.offscreen import apply_camera
from volviz.model.transfer.presets import preset_for

SCENES = (("mri-head", "mri"), ("ct-chest", "ct-bone"), ("engine", "engine"))
TECHNIQUES = ("raycast", "two_pass_raycast", "slicing")


def vtk_side(
    volume: volviz.Volume, function: volviz.TransferFunction, size: tuple[int, int], step: float, kind: str
) -> Any:
    """A render window in which VTK's mapper shows the volume."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    image = vtk.vtkImageData()
    image.SetDimensions(*volume.dimensions)
    image.SetSpacing(*volume.spacing)
    image.SetOrigin(*volume.origin)
    image.SetDirectionMatrix(*volume.direction.ravel())
    image.GetPointData().SetScalars(numpy_to_vtk(volume.array.ravel(), deep=True))
    mapper = (
        vtk.vtkOpenGLGPUVolumeRayCastMapper() if kind == "GPU" else vtk.vtkFixedPointVolumeRayCastMapper()
    )
    mapper.SetInputData(image)
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetSampleDistance(step)
    if kind == "GPU":
        mapper.SetUseJittering(0)
    else:
        mapper.SetInteractiveSampleDistance(step)
        mapper.SetImageSampleDistance(1.0)
        mapper.SetMinimumImageSampleDistance(1.0)
    color, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for point in function.resolved(volume.range).points:
        color.AddRGBPoint(point.value, *point.color)
        opacity.AddPoint(point.value, point.opacity)
    look = vtk.vtkVolumeProperty()
    look.SetColor(color)
    look.SetScalarOpacity(opacity)
    look.SetInterpolationTypeToLinear()
    look.SetScalarOpacityUnitDistance(volume.mean_spacing)
    prop = vtk.vtkVolume()
    prop.SetMapper(mapper)
    prop.SetProperty(look)
    plotter = pyvista.Plotter(off_screen=True, window_size=list(size))
    plotter.render_window.SetMultiSamples(0)
    plotter.add_actor(prop)
    return plotter


def shown(plotter: Any, camera: volviz.Camera) -> Any:
    """The plotter with that camera, drawn once."""
    plotter.set_background("black")
    apply_camera(plotter.camera, camera)
    plotter.reset_camera_clipping_range()
    plotter.show(auto_close=False, interactive=False)
    return plotter


def frame(plotter: Any) -> float:
    """Wall time of one frame after a small turn."""
    plotter.camera.Azimuth(4)
    begin = time.perf_counter()
    plotter.render()
    plotter.render_window.WaitForCompletion()
    return time.perf_counter() - begin


def compare(sides: dict[str, Any], frames: int) -> dict[str, float]:
    """Median frame time of every side, all in turn."""
    times: dict[str, list[float]] = {name: [] for name in sides}
    for _ in range(frames):
        for name, plotter in sides.items():
            times[name].append(frame(plotter))
    return {name: statistics.median(values) for name, values in times.items()}


def main(show: Callable[[str], None] = print) -> None:
    """Print one table row a scene."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="600x600")
    parser.add_argument("--frames", type=int, default=7)
    parser.add_argument("--step", type=float, default=1.0, help="in voxels of the smallest spacing")
    options = parser.parse_args()
    width, height = (int(n) for n in options.size.split("x"))
    names = [*TECHNIQUES, "VTK GPU", "VTK CPU"]
    show(
        f"| {width} x {height}, step {options.step:g} | "
        + " | ".join(names)
        + " | GPU / raycast | CPU / raycast |"
    )
    show("|---" * (len(names) + 3) + "|")
    for sample, preset in SCENES:
        volume = volviz.load(f"sample:{sample}")
        function = preset_for(preset, volume)
        camera = default_camera(volume, (width, height), transfer_function=function)
        sides: dict[str, Any] = {}
        handles = []
        for technique in TECHNIQUES:
            plotter = pyvista.Plotter(off_screen=True, window_size=[width, height])
            handles.append(
                volviz.add_volume(plotter, volume, technique, transfer_function=function, step=options.step)
            )
            sides[technique] = shown(plotter, camera)
        for kind in ("GPU", "CPU"):
            side = vtk_side(volume, function, (width, height), options.step * min(volume.spacing), kind)
            sides[f"VTK {kind}"] = shown(side, camera)
        medians = compare(sides, options.frames)
        cells = [f"{1000 * medians[name]:.0f} ms" for name in names]
        ratios = [f"{medians[f'VTK {kind}'] / medians['raycast']:.2f}" for kind in ("GPU", "CPU")]
        show(f"| {sample} ({preset}) | " + " | ".join([*cells, *ratios]) + " |")
        for handle in handles:
            handle.remove()
        for plotter in sides.values():
            plotter.close()


if __name__ == "__main__":
    main()
