"""The surfaces that settings ask for, in the order in which the shader wants them. No OpenGL."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from volviz.volume_data.scalars import FARTHEST

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.custom_gl.techniques.isosurface.settings import IsosurfaceSettings
    from volviz.model.transfer.function import TransferFunction

#: By so much of the data range isovalues are lowered on the GPU: samples that *are* the isovalue count as
#: inside despite the rounding of float32, so that plateaus at it are not torn. It is a ten-thousandth of a
#: grey level of 256.
PLATEAU_MARGIN = 2.0**-21

#: Larger than any texel: no surface.
_NEVER = 4.0 * FARTHEST


@dataclass(frozen=True)
class Surfaces:
    """One to four surfaces, isovalues ascending.

    Attributes
    ----------
    isovalues : tuple of floats
        In data units.
    colors : tuple of colours
        Straight RGB.
    opacities : tuple of floats
        0..1.
    """

    isovalues: tuple[float, ...]
    colors: tuple[tuple[float, float, float], ...]
    opacities: tuple[float, ...]

    def fractions(self, bulk_range: tuple[float, float]) -> tuple[float, ...]:
        """The isovalues as fractions of the bulk's range, filled up to four."""
        low, high = bulk_range
        span = high - low if high > low else 1.0
        # far beyond the range every isovalue means the same: nothing, or everything, is inside
        found = [
            float(np.clip((v - low) / span, -2 * FARTHEST, 2 * FARTHEST)) - PLATEAU_MARGIN
            for v in self.isovalues
        ]
        return tuple(found + [_NEVER] * (4 - len(found)))

    def looks(self) -> npt.NDArray[np.float32]:
        """Straight RGBA, filled up to shape (4, 4), float32; flat, for a uniform array."""
        rows = np.zeros((4, 4), np.float32)
        for row, (color, opacity) in enumerate(zip(self.colors, self.opacities, strict=True)):
            rows[row] = (*color, opacity)
        return rows.ravel()


def layer_surfaces(
    isovalues: tuple[float, ...], settings: IsosurfaceSettings, function: TransferFunction, *, leads: bool
) -> Surfaces:
    """The surfaces of one of several layers: in the colours of settings where those say the isovalues, else its own."""
    if leads and settings.isovalues is not None:
        found = shown_surfaces(isovalues, settings)
        return replace(found, opacities=tuple(a * function.opacity for a in found.opacities))
    values = np.array(isovalues)
    if not np.isfinite(values).all():
        return Surfaces(isovalues, ((0.0, 0.0, 0.0),), (0.0,))
    red, green, blue = (float(c) for c in function.evaluate(values)[0, :3])
    return Surfaces(isovalues, ((red, green, blue),), (function.opacity,))


def shown_surfaces(isovalues: tuple[float, ...], settings: IsosurfaceSettings) -> Surfaces:
    """The surfaces of these values, sorted, each with its own colour and opacity."""
    colors = [settings.colors[i % len(settings.colors)] for i in range(len(isovalues))]
    opacities = [settings.opacities[min(i, len(settings.opacities) - 1)] for i in range(len(isovalues))]
    order = sorted(range(len(isovalues)), key=lambda i: isovalues[i])
    return Surfaces(
        tuple(isovalues[i] for i in order),
        tuple(colors[i] for i in order),
        tuple(opacities[i] for i in order),
    )
