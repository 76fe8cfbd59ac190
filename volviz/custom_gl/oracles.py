"""What a technique shows, drawn by the float64 oracles in `volviz.kernels` (`TechniqueInfo.oracle`).

Those are imported when something is drawn: techniques are listed without them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.settings import common_settings
from volviz.model.clipping import Clipping
from volviz.model.light import Light
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.volume import Volume

Float64Array = npt.NDArray[np.float64]

#: Colour of surfaces.
SURFACE = (0.87, 0.79, 0.65)


@dataclass(frozen=True)
class OracleScene:
    """What an oracle draws, and from where.

    Attributes
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars in data units, perhaps every n-th voxel of the volume only.
    spacing : tuple of 3 floats
        Of the array along (x, y, z), in world units.
    function : TransferFunction
        Without regions over value and gradient.
    value_range : tuple of 2 floats
        Lowest and highest finite value of the whole volume.
    mean_spacing : float
        Mean spacing of the whole volume, in world units: what automatic distances stand for.
    step : float
        Distance between samples, in world units.
    view, projection : ndarray of shape (4, 4)
        World to eye and eye to clip space, OpenGL conventions.
    size : tuple of 2 ints
        Width and height in pixels.
    origin, direction
        As in `Volume`.
    isovalues : tuple of floats
        Of surfaces, in data units.
    light : Light
        A placed light has a position.
    clipping : Clipping
    """

    array: npt.NDArray[Any]
    spacing: tuple[float, float, float]
    function: TransferFunction
    value_range: tuple[float, float]
    mean_spacing: float
    step: float
    view: Float64Array
    projection: Float64Array
    size: tuple[int, int]
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    direction: npt.NDArray[Any] | None = None
    isovalues: Sequence[float] = ()
    light: Light = field(default_factory=Light)
    clipping: Clipping = field(default_factory=Clipping)

    def where(self) -> dict[str, Any]:
        """Arguments that all oracles share."""
        return {
            "array": self.array, "spacing": self.spacing, "origin": self.origin, "direction": self.direction,
            "view": self.view, "projection": self.projection, "size": self.size, "step_world": self.step,
            "crop": self.clipping.crop, "clip_planes": self.clipping.planes,
        }  # fmt: skip

    def volume(self) -> Volume:
        """The array on its lattice."""
        return Volume(self.array, self.spacing, self.origin, self.direction)

    def table(self) -> npt.NDArray[np.float32]:
        """Colours and opacities over the value range, shape (N, 4)."""
        return self.function.bake(
            self.value_range,
            self.function.table_size(self.value_range, integer=self.array.dtype.kind in "iu"),
        )

    def unit_distance(self, settings: Any) -> float:
        """Length of ray to which opacities refer, in world units."""
        return float(settings.opacity_unit_distance or self.mean_spacing)


def sampled_rays(scene: OracleScene, settings: Any) -> Float64Array:
    """Any of the ray casters' modes, lit from the eye: premultiplied RGBA of shape (H, W, 4), row 0 at the top."""
    from volviz.reference.image import Shading, reference_render

    low, high = scene.value_range
    lit = Shading(settings.ambient, settings.diffuse, settings.specular, settings.shininess)
    return reference_render(
        **scene.where(), table=scene.table(), value_range=scene.value_range,
        unit_distance=scene.unit_distance(settings), mode=settings.mode,
        attenuation=settings.attenuation, shading=lit if settings.shading else None,
        gradient_opacity=settings.gradient_opacity, gradient_reference=0.25 * (high - low) / scene.mean_spacing,
        interpolation=settings.interpolation, density_threshold=settings.density_threshold,
        preintegrated=settings.mode == "composite" and common_settings(settings).preintegrated,
    )  # fmt: skip


def isosurfaces(scene: OracleScene, _settings: Any) -> Float64Array:
    """The isosurfaces in one colour, lit from the eye: premultiplied RGBA of shape (H, W, 4), row 0 at the top."""
    from volviz.reference.image import Shading
    from volviz.reference.isosurface import reference_isosurface

    return reference_isosurface(
        **scene.where(), isovalues=scene.isovalues, colors=SURFACE, shading=Shading()
    ).color
