"""What is drawn, and from where: the two values that decide an image."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.layers import ImageLayer, LabelLayer
from volviz.model.light import Light
from volviz.model.surface_values import DistanceColoring, SurfaceColors

#: Id of the technique that draws where none is named.
DEFAULT_TECHNIQUE = "raycast"

Color = tuple[float, float, float]


@dataclass(frozen=True)
class RenderSpec:
    """What is drawn. `volviz.custom_gl.resolve` says what it means for a renderer.

    Attributes
    ----------
    layers : tuple of ImageLayer or LabelLayer
        The volumes and how they are classified.
    technique : str
        Id of the technique that draws.
    settings : object or None
        Instance of the technique's settings class; None means its defaults.
    light : Light
    clipping : Clipping
    surface_colors : SurfaceColors, DistanceColoring or None
        Values that the surface is coloured by instead of its own colours, where the technique draws triangles.
    """

    layers: tuple[ImageLayer | LabelLayer, ...]
    technique: str = DEFAULT_TECHNIQUE
    settings: Any = None
    light: Light = Light()
    clipping: Clipping = Clipping()
    surface_colors: SurfaceColors | DistanceColoring | None = None

    def drawn_by(self, technique: str, settings: Any = None) -> RenderSpec:
        """The same layers, light and clipping, drawn by another technique."""
        return replace(self, technique=technique, settings=settings, surface_colors=None)


@dataclass(frozen=True)
class View:
    """From where it is seen, and how large the image is.

    Attributes
    ----------
    camera : Camera or None
        None frames what is visible of the volume.
    size : tuple of 2 ints
        Width and height in pixels.
    background : tuple of 3 floats or None
        Red, green, blue (0..1) behind an opaque image; None keeps the image's own alpha.
    clipping_range : tuple of 2 floats or None
        World distances from the eye, along the view, of the near and the far plane; None puts them around the volume.
    """

    camera: Camera | None = None
    size: tuple[int, int] = (800, 600)
    background: Color | None = None
    clipping_range: tuple[float, float] | None = None
