"""Settings of half-angle slicing."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.settings import SamplingSettings, ShadingSettings, taken_from
from volviz.model.parameters import Cost, parameter

MIN_SLICES, MAX_SLICES = 8, 2048

DEBUG_VIEWS = (("image", "Image"), ("light_buffer", "Light buffer"))


@dataclass(frozen=True)
class HalfAngleSettings(ShadingSettings):
    """How light is carried through the volume, slice by slice."""

    ambient: float = taken_from(
        ShadingSettings, "ambient", default=0.25, enabled_by=None,
        tooltip="Share of light that reaches every place, however dark its shadow.",
    )  # fmt: skip
    slices: int | None = parameter(
        None,
        "Slices",
        "Number of slices through the volume, half-way between view and light; automatic follows the step. "
        "The keys + and - change it.",
        kind="int",
        optional=True,
        none_label="from the step",
        minimum=MIN_SLICES,
        maximum=MAX_SLICES,
        logarithmic=True,
        group="Sampling",
    )
    step: float = taken_from(SamplingSettings, "step")
    first_sample: float = taken_from(SamplingSettings, "first_sample")
    opacity_unit_distance: float | None = taken_from(SamplingSettings, "opacity_unit_distance")
    density_threshold: float = taken_from(SamplingSettings, "density_threshold")
    interpolation: str = taken_from(SamplingSettings, "interpolation")
    jitter: bool = taken_from(SamplingSettings, "jitter")
    attenuation_color: tuple[float, float, float] = parameter(
        (0.7, 0.85, 1.0),
        "Attenuation",
        "How strongly red, green and blue light are weakened on their way from the light: 0 passes "
        "unhindered, 1 is weakened like the view itself. Unequal values colour the shadows.",
        kind="color",
        group="Light",
    )
    material_tint: float = parameter(
        0.0,
        "Material tint",
        "How far the colour of a material tints the light that passes through it: at 1 red matter lets red "
        "light pass and holds back the rest, at 0 only opacity counts.",
        group="Light",
        minimum=0.0,
        maximum=1.0,
    )
    scattering: float = parameter(
        0.0,
        "Forward scattering",
        "Share of light that comes from all around the straight way from the light: shadows get soft edges "
        "and light bleeds into them.",
        group="Light",
        minimum=0.0,
        maximum=1.0,
        cost=Cost.PROGRAM,
    )
    light_buffer_size: int = parameter(
        512,
        "Light buffer",
        "Edge of the picture that is taken from the light; finer shadows cost more.",
        unit="pixels",
        group="Light",
        minimum=32,
        maximum=4096,
        soft_minimum=128,
        soft_maximum=2048,
        logarithmic=True,
        cost=Cost.TEXTURE,
    )
    light_blend: str = parameter(
        "attenuate",
        "Light blending",
        "Attenuate: each slice takes its share of the light away. Classic: each slice is laid over the light "
        "with the attenuation as its colour, as the well-known teaching program does; that can add light.",
        choices=(("attenuate", "Attenuate"), ("over", "Classic: lay over")),
        group="Machinery",
        cost=Cost.PROGRAM,
    )
    light_buffer_precision: str = parameter(
        "float32",
        "Light buffer numbers",
        "Half floats are the classic choice; over hundreds of thin slices their rounding darkens the light.",
        choices=(("float32", "32-bit floats"), ("float16", "Classic: 16-bit floats")),
        group="Machinery",
        cost=Cost.TEXTURE,
    )
    slices_shown: int | None = parameter(
        None,
        "Slices shown",
        "Draws only so many slices, counted from the light, to watch picture and light buffer grow.",
        kind="int",
        optional=True,
        none_label="all",
        minimum=1,
        maximum=MAX_SLICES,
        group="Machinery",
    )
    display: str = parameter(
        "image",
        "Show",
        "The picture, or what is left of the light behind the last slice.",
        choices=DEBUG_VIEWS,
        group="Machinery",
        cost=Cost.PROGRAM,
    )
