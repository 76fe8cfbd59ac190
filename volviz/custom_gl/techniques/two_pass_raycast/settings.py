"""Settings of two-pass ray casting."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.settings import PreintegrationSettings, SamplingSettings, ShadingSettings
from volviz.model.parameters import Cost, parameter

DEBUG_VIEWS = (("image", "Image"), ("entry", "Entry points"), ("exit", "Exit points"))


@dataclass(frozen=True)
class TwoPassSettings(PreintegrationSettings, ShadingSettings, SamplingSettings):
    """How rays are cast, and what the first pass keeps of the box."""

    reverse: bool = parameter(
        False,
        "Entry points first",
        "The first pass draws the front faces and the second marches from the back faces, instead of the "
        "other way round. With the eye inside the box this order is always taken: no front face is in view "
        "there.",
        group="Passes",
        cost=Cost.PROGRAM,
    )
    half_float: bool = parameter(
        False,
        "Half-float positions",
        "Keeps the points of the first pass in 16-bit instead of 32-bit floats, as older programs did: good "
        "to about 1/2000 of the box, which shows as fine bands.",
        group="Passes",
        cost=Cost.TEXTURE,
    )
    display: str = parameter(
        "image",
        "Show",
        "The picture, or the points where rays enter or leave the box as colours: red, green and blue are "
        "the texture coordinates x, y and z.",
        choices=DEBUG_VIEWS,
        group="Machinery",
        cost=Cost.PROGRAM,
    )
