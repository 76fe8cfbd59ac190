"""The integral with a shadow ray from every sample: what half-angle slicing approximates, computed in float64."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.oracles import OracleScene


def shadowed_rays(scene: OracleScene, settings: Any) -> npt.NDArray[np.float64]:
    """Volumetric shadows: premultiplied RGBA of shape (H, W, 4), row 0 at the top."""
    from volviz.reference.shadows import reference_shadows

    light = scene.light
    eye = np.linalg.inv(scene.view)[:3, 3]
    return reference_shadows(
        **scene.where(), table=scene.table(), value_range=scene.value_range,
        light_position=tuple(eye) if light.headlight or light.position is None else light.position,
        light_color=light.color, kappa=settings.attenuation_color, ambient=settings.ambient,
        unit_distance=scene.unit_distance(settings), density_threshold=settings.density_threshold,
    )  # fmt: skip


def is_exact(scene: OracleScene, settings: Any) -> bool:
    """Whether the oracle draws just what the slices converge to: it knows plain shadows only."""
    return (
        not settings.shading
        and settings.scattering == 0.0
        and settings.material_tint == 0.0
        and settings.light_blend == "attenuate"
        and settings.interpolation == "linear"
        and settings.display == "image"
        and settings.slices_shown is None
        and scene.function.by_gradient is None
        and bool(np.isfinite(scene.array).all())
    )
