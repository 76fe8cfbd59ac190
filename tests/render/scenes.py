"""Small volumes, cameras and the oracle's image of them, for the tests that look at pixels."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

import volviz
from volviz.custom_gl.offscreen import apply_camera
from volviz.custom_gl.registry import technique
from volviz.custom_gl.vtk.vtk_imports import pyvista
from volviz.model.transfer.function import table_size
from volviz.reference.image import Shading, reference_render

SIZE = (64, 64)

#: A continuous function with empty, thin and dense parts.
POINTS = [
    (0.0, (0.0, 0.0, 0.4, 0.0)),
    (0.25, (0.1, 0.3, 1.0, 0.0)),
    (0.4, (0.2, 1.0, 0.4, 0.06)),
    (0.7, (1.0, 0.8, 0.1, 0.15)),
    (1.0, (1.0, 0.2, 0.1, 0.5)),
]

OBLIQUE = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
LEFT_HANDED = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def blobs(
    shape: tuple[int, int, int] = (27, 32, 35), dtype: Any = np.uint8, seed: int = 3
) -> npt.NDArray[Any]:
    """A smooth random field (Z, Y, X) over the whole range of small integers, or 0..1."""
    random = np.random.default_rng(seed)
    z, y, x = np.meshgrid(*[np.linspace(-1, 1, n) for n in shape], indexing="ij")
    field = np.zeros(shape)
    for _ in range(6):
        c = random.uniform(-0.5, 0.5, 3)
        r = random.uniform(0.2, 0.5)
        field += random.uniform(0.4, 1) * np.exp(
            -((z - c[0]) ** 2 + (y - c[1]) ** 2 + (x - c[2]) ** 2) / r**2
        )
    field /= field.max()
    if np.issubdtype(dtype, np.integer):
        info = np.iinfo(dtype)
        low, high = max(info.min, -2000), min(info.max, 3000)
        return np.rint(low + field * (high - low)).astype(dtype)
    return field.astype(dtype)


class Requests:
    """A frame scheduler that only counts how often it is asked to go on, and woken by work in the background."""

    def __init__(self) -> None:
        self.count = self.wakes = 0

    def request(self, _handle: object) -> None:
        self.count += 1

    def wake(self, _handle: object) -> None:
        self.wakes += 1


def volume(dtype: Any = np.uint8, **geometry: Any) -> volviz.Volume:
    """`blobs` with a geometry."""
    return volviz.Volume(blobs(dtype=dtype), **geometry)


def function(of: volviz.Volume, points: Any = None) -> volviz.TransferFunction:
    """`POINTS` over the range of a volume, in data units."""
    relative = volviz.TransferFunction.from_points(points or POINTS, domain="relative")
    return relative.resolved(of.range)


def camera(
    of: volviz.Volume, azimuth: float = 25.0, elevation: float = 20.0, **changes: Any
) -> volviz.Camera:
    """A camera that sees all of a volume from an angle that is no symmetry of it."""
    return replace(volviz.Camera.fit(of.corners).turned(azimuth, elevation), **changes)


def inside(of: volviz.Volume) -> volviz.Camera:
    """A camera in the middle of a volume."""
    x, y, z = of.center
    return volviz.Camera((x, y, z), (x + 3.0, y + 7.0, z + 2.0), (0.0, 0.0, 1.0), view_angle=60.0)


@contextmanager
def shown(
    of: volviz.Volume, technique_id: str, size: tuple[int, int], **values: Any
) -> Iterator[tuple[Any, Any]]:
    """An off-screen window that shows a volume, and its handle; both are taken down at the end."""
    window = pyvista.Plotter(off_screen=True, window_size=size)
    window.render_window.SetMultiSamples(0)
    handle = None
    try:
        handle = volviz.add_volume(window, of, technique_id, **values)
        apply_camera(window.camera, camera(of))
        window.reset_camera_clipping_range()
        window.show(auto_close=False, interactive=False)
        yield window, handle
    finally:
        if handle is not None:
            handle.remove()
        window.close()


def matrices(of: volviz.Volume, view: volviz.Camera, size: tuple[int, int]) -> tuple[Any, Any]:
    """View and projection matrices that VTK uses for a camera, (4, 4) each."""
    from vtkmodules.vtkRenderingCore import vtkRenderer

    renderer = vtkRenderer()
    target = renderer.GetActiveCamera()
    apply_camera(target, view)
    # what VTK chooses for windows with more than 16 bits of depth; it moves the near plane of a camera inside
    renderer.SetNearClippingPlaneTolerance(0.001)
    renderer.ResetCameraClippingRange(*of.bounds)
    matrix = target.GetModelViewTransformMatrix()
    projection = target.GetProjectionTransformMatrix(size[0] / size[1], -1, 1)
    return (
        np.array([matrix.GetElement(i, j) for i in range(4) for j in range(4)]).reshape(4, 4),
        np.array([projection.GetElement(i, j) for i in range(4) for j in range(4)]).reshape(4, 4),
    )


def oracle(
    of: volviz.Volume,
    transfer: volviz.TransferFunction,
    view: volviz.Camera,
    *,
    size: tuple[int, int] = SIZE,
    technique_id: str = "raycast",
    **values: Any,
) -> npt.NDArray[np.float64]:
    """The oracle's image for the same values that `image` takes: premultiplied, (H, W, 4)."""
    info = technique(technique_id)
    settings = {p.name: p.default for p in info.parameters} | values
    entries = table_size(of.range, of.array.dtype.kind in "iu")
    view_matrix, projection = matrices(of, view, size)
    shading = None
    if settings["shading"]:
        headlight = settings.get("headlight", "light_position" not in values)
        shading = Shading(
            settings["ambient"], settings["diffuse"], settings["specular"], settings["shininess"],
            None if headlight else values["light_position"], (1.0, 1.0, 1.0), settings["gradient_delta"],
        )  # fmt: skip
    return reference_render(
        of.array, of.spacing, of.origin, of.direction,
        table=transfer.bake(of.range, entries), value_range=of.range, view=view_matrix, projection=projection,
        size=size, step_world=settings["step"] * min(of.spacing), first_sample=settings["first_sample"],
        unit_distance=settings["opacity_unit_distance"], mode=settings["mode"],
        attenuation=settings["attenuation"], early_termination=settings["early_termination"], shading=shading,
        gradient_opacity=settings["gradient_opacity"], crop=values.get("crop"),
        clip_planes=values.get("clip_planes", ()), interpolation=settings["interpolation"],
        preintegrated=settings.get("preintegrated", False), density_threshold=settings["density_threshold"],
        gradient_delta=settings["gradient_delta"], **gradient_table(of, transfer),
    )  # fmt: skip


def gradient_table(of: volviz.Volume, transfer: volviz.TransferFunction) -> dict[str, Any]:
    """Arguments of the oracle for the regions of a function; fine enough that the table does not count."""
    if transfer.by_gradient is None:
        return {}
    top = max(region.gradient_high for region in transfer.by_gradient.regions) * 1.01
    table = transfer.by_gradient.bake(of.range, (0.0, top), (1536, 1024))
    table[..., 3] *= transfer.opacity
    return {"gradient_table": table, "gradient_range": (0.0, top)}


def image(
    of: volviz.Volume,
    transfer: volviz.TransferFunction,
    view: volviz.Camera,
    *,
    size: tuple[int, int] = SIZE,
    technique_id: str = "raycast",
    **values: Any,
) -> npt.NDArray[np.float64]:
    """Our image, premultiplied float64, (H, W, 4)."""
    straight = volviz.render(
        of, technique_id, transfer_function=transfer, size=size, camera=view, dtype="float32", **values
    ).astype(np.float64)
    straight[..., :3] *= straight[..., 3:]
    return straight


def psnr(a: npt.ArrayLike, b: npt.ArrayLike, peak: float = 1.0) -> float:
    """Peak signal to noise ratio in dB; 99 for equal images."""
    error = float(np.mean((np.asarray(a, float) - np.asarray(b, float)) ** 2))
    return 99.0 if error == 0 else float(10 * np.log10(peak**2 / error))
