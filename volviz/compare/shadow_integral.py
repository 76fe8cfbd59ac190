"""The integral with a shadow ray from every sample: what half-angle slicing approximates, computed in float64."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.compare.stage import View
from volviz.kernels.reference_shadows import reference_shadows
from volviz.model.camera import Camera
from volviz.model.light import default_position
from volviz.model.transfer_function import table_size
from volviz.offscreen import apply_camera

#: Step of rays and shadow rays, in voxels of the smallest spacing.
STEP = 0.5


def has_shadow_integral(view: View, settings: Any) -> bool:
    """Whether the oracle draws what half-angle slicing shows with these settings: it knows plain shadows only."""
    return (
        not settings.shading
        and settings.scattering == 0.0
        and settings.material_tint == 0.0
        and settings.light_blend == "attenuate"
        and settings.interpolation == "linear"
        and settings.display == "image"
        and settings.slices_shown is None
        and view.transfer_function.by_gradient is None
        and bool(np.isfinite(view.volume.array).all())
    )


def shadow_integral(view: View, settings: Any) -> npt.NDArray[np.float64]:
    """The picture of the integral over the view's background, shape (H, W, 3), 0..1, row 0 at the top.

    Parameters
    ----------
    view : View
        A headlight stands at the eye.
    settings : HalfAngleSettings
        For which `has_shadow_integral` holds.
    """
    volume, camera, light = view.volume, view.camera, view.light
    place = light.position or default_position(volume.bounds)
    modelview, projection = camera_matrices(camera, view.size, volume.bounds)
    entries = table_size(volume.range, volume.array.dtype.kind in "iu")
    step = STEP * min(volume.spacing)
    rgba = reference_shadows(
        volume.array, volume.spacing, volume.origin, volume.direction,
        table=view.transfer_function.bake(volume.range, entries), value_range=volume.range,
        view=modelview, projection=projection, size=view.size, step_world=step,
        light_position=camera.position if light.headlight else place, light_color=light.color,
        kappa=settings.attenuation_color, ambient=settings.ambient,
        unit_distance=settings.opacity_unit_distance, crop=view.clipping.crop, clip_planes=view.clipping.planes,
        density_threshold=settings.density_threshold,
    )  # fmt: skip
    return np.asarray(rgba[..., :3] + (1.0 - rgba[..., 3:]) * np.asarray(view.background))


def camera_matrices(
    camera: Camera, size: tuple[int, int], bounds: tuple[float, ...]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """View and projection matrix (4, 4) of a camera, as VTK computes them for things within these bounds."""
    from vtkmodules.vtkRenderingCore import vtkRenderer

    renderer = vtkRenderer()
    target = renderer.GetActiveCamera()
    apply_camera(target, camera)
    renderer.ResetCameraClippingRange(*bounds)
    matrices = (
        target.GetModelViewTransformMatrix(),
        target.GetProjectionTransformMatrix(size[0] / size[1], -1, 1),
    )
    view, projection = (
        np.array([m.GetElement(i, j) for i in range(4) for j in range(4)]).reshape(4, 4) for m in matrices
    )
    return view, projection
