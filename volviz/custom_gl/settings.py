"""Settings that several techniques have in common, declared once."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from volviz.model.parameters import Cost, parameter, setting_values

MODES = (
    ("composite", "Compositing"),
    ("maximum", "Maximum intensity"),
    ("minimum", "Minimum intensity"),
    ("average", "Average intensity"),
    ("additive", "Additive (emission only)"),
    ("attenuated_maximum", "Attenuated maximum"),
)
#: Modes that classify every sample; the others classify one value per ray.
CLASSIFYING_MODES = ("composite", "additive")

INTERPOLATIONS = (("linear", "Trilinear"), ("nearest", "Nearest voxel"))


@dataclass(frozen=True)
class SharedSettings:
    """Values of the scene that every technique obeys; in the window they have panels of their own."""

    headlight: bool = parameter(
        True,
        "Headlight",
        "The light sits at the eye. Off: it stays where it was put in the scene.",
        group="Light",
    )
    light_position: tuple[float, float, float] | None = parameter(
        None,
        "Light position",
        "World position of the light; automatic places it at the upper left in front of the volume.",
        kind="vector",
        optional=True,
        group="Light",
        enabled_by=("headlight", (False,)),
    )
    light_beside_eye: bool = parameter(
        False,
        "Light beside the eye",
        "The light stays at the upper left of the eye, however the camera turns.",
        group="Light",
        enabled_by=("headlight", (False,)),
    )
    light_color: tuple[float, float, float] = parameter(
        (1.0, 1.0, 1.0), "Light colour", "Colour of the light.", kind="color", group="Light"
    )
    crop: tuple[float, float, float, float, float, float] | None = parameter(
        None,
        "Crop box",
        "Shows only this box, in voxel indices along the volume's own axes.",
        kind="crop",
        optional=True,
        none_label="whole volume",
        group="Clipping",
    )
    clip_planes: tuple[tuple[tuple[float, float, float], tuple[float, float, float]], ...] = parameter(
        (), "Clip planes", "Up to six planes in world space; the side the normal points to is kept.",
        kind="planes", group="Clipping",
    )  # fmt: skip


@dataclass(frozen=True)
class ShadingSettings:
    """Blinn-Phong lighting with the gradient as normal."""

    shading: bool = parameter(
        False,
        "Shading",
        "Lights every sample by the gradient of the data (Blinn-Phong); off, the colours of the transfer "
        "function are shown as they are.",
        group="Lighting",
        cost=Cost.PROGRAM,
    )
    ambient: float = parameter(
        0.25, "Ambient", "Light that reaches every place.", group="Lighting", minimum=0.0, maximum=1.0,
        enabled_by=("shading", (True,)),
    )  # fmt: skip
    diffuse: float = parameter(
        0.75, "Diffuse", "Light scattered evenly from a lit surface.", group="Lighting", minimum=0.0, maximum=1.0,
        enabled_by=("shading", (True,)),
    )  # fmt: skip
    specular: float = parameter(
        0.25, "Specular", "Strength of highlights.", group="Lighting", minimum=0.0, maximum=1.0,
        enabled_by=("shading", (True,)),
    )  # fmt: skip
    shininess: float = parameter(
        30.0, "Shininess", "Exponent of highlights: higher is smaller and sharper.", group="Lighting",
        minimum=1.0, maximum=1000.0, logarithmic=True, enabled_by=("shading", (True,)),
    )  # fmt: skip
    gradient_delta: float = parameter(
        1.0, "Gradient delta", "Distance of the central differences to either side of a sample.", unit="voxels",
        group="Lighting", minimum=0.05, maximum=8.0, soft_minimum=0.25, soft_maximum=4.0,
    )  # fmt: skip
    gradient_opacity: float = parameter(
        0.0,
        "Gradient opacity",
        "Fades out regions where the data hardly changes, so that boundaries stand out: 0 leaves opacity as it "
        "is, 1 multiplies it by the gradient's share of its largest value.",
        group="Classification",
        minimum=0.0,
        maximum=1.0,
        cost=Cost.PROGRAM,
    )


@dataclass(frozen=True)
class SamplingSettings:
    """How the volume is sampled along the view and classified."""

    mode: str = parameter(
        "composite",
        "Mode",
        "What is made of the samples along a ray. Compositing and additive classify each sample; maximum, minimum "
        "and average act on the scalar and classify the result.",
        choices=MODES,
        group="Sampling",
        cost=Cost.PROGRAM,
    )
    attenuation: float = parameter(
        1.0,
        "Attenuation",
        "Attenuated maximum: how quickly structures behind bright ones fade, per opacity unit distance.",
        group="Sampling",
        minimum=0.0,
        maximum=50.0,
        soft_maximum=10.0,
        enabled_by=("mode", ("attenuated_maximum",)),
    )
    step: float = parameter(
        0.5,
        "Step",
        "Distance between samples, in voxels of the smallest spacing. The density of the picture does not depend "
        "on it, its accuracy and cost do.",
        unit="voxels",
        group="Sampling",
        minimum=0.02,
        maximum=20.0,
        soft_minimum=0.1,
        soft_maximum=4.0,
        logarithmic=True,
        cost=Cost.TEXTURE,
    )
    first_sample: float = parameter(
        0.5,
        "First sample",
        "Where in its segment a sample lies: 0.5 is the midpoint (second order), 1.0 the far end, as in VTK.",
        unit="steps",
        group="Sampling",
        minimum=0.0,
        maximum=1.0,
    )
    opacity_unit_distance: float | None = parameter(
        None,
        "Opacity unit distance",
        "Length of ray to which the opacities of the transfer function refer, in world units; larger is more "
        "transparent.",
        kind="float",
        group="Classification",
        minimum=1e-9,
        soft_minimum=0.05,
        soft_maximum=50.0,
        logarithmic=True,
        optional=True,
        none_label="mean voxel spacing",
        cost=Cost.TEXTURE,
    )
    density_threshold: float = parameter(
        0.0,
        "Density threshold",
        "Values below this fraction of the data range are left out, such as the noise around a scanned object.",
        group="Classification",
        minimum=0.0,
        maximum=1.0,
        cost=Cost.TEXTURE,
    )
    interpolation: str = parameter(
        "linear", "Interpolation", "Between voxel centres, or the nearest voxel as a block.",
        choices=INTERPOLATIONS, group="Sampling", cost=Cost.PROGRAM,
    )  # fmt: skip
    mipmaps: bool = parameter(
        False,
        "Mipmaps",
        "Takes a smoothed, coarser level of the data where pixels are larger than voxels, so that a large volume "
        "seen from afar does not sparkle.",
        group="Sampling",
        cost=Cost.TEXTURE,
    )
    jitter: bool = parameter(
        False,
        "Jitter",
        "Shifts the samples of each ray by a fixed pseudo-random fraction of a step: wood-grain patterns become "
        "fine noise.",
        group="Sampling",
    )
    early_termination: float = parameter(
        1.0 - 1.0 / 255.0,
        "Early termination",
        "Rays end once this much opacity has gathered; 1 never ends one early.",
        group="Sampling",
        minimum=0.5,
        maximum=1.0,
    )


@dataclass(frozen=True)
class PreintegrationSettings:
    """Classification of pieces of ray instead of samples, for ray casters."""

    preintegrated: bool = parameter(
        False,
        "Pre-integrated",
        "Colour and opacity of a piece of ray come from a table over the scalars at both its ends, so that thin "
        "features of the transfer function are not missed between samples.",
        group="Classification",
        cost=Cost.PROGRAM,
        enabled_by=("mode", ("composite",)),
    )


@dataclass(frozen=True)
class CommonSettings:
    """What the parts that all techniques share read of a technique's settings.

    A setting of one of these names means the same in every technique; a technique without it has the value that
    stands here. The fields are described in `SamplingSettings`, `ShadingSettings` and `PreintegrationSettings`;
    `display` says whether the image or what stands behind it is shown ("image", "both", ...).
    """

    mode: str = "composite"
    attenuation: float = 1.0
    step: float = 0.5
    first_sample: float = 0.5
    opacity_unit_distance: float | None = None
    density_threshold: float = 0.0
    interpolation: str = "linear"
    mipmaps: bool = False
    jitter: bool = False
    early_termination: float = 1.0 - 1.0 / 255.0
    preintegrated: bool = False
    shading: bool = False
    ambient: float = 0.25
    diffuse: float = 0.75
    specular: float = 0.25
    shininess: float = 30.0
    gradient_delta: float = 1.0
    gradient_opacity: float = 0.0
    display: str = "image"


def common_settings(settings: Any) -> CommonSettings:
    """The settings of a technique as the shared parts read them."""
    names = {field.name for field in dataclasses.fields(CommonSettings)}
    return CommonSettings(**{n: value for n, value in setting_values(settings).items() if n in names})


def taken_from(settings: type[Any], name: str, **changes: Any) -> Any:
    """The field of another settings class once more, for techniques that share some settings but not all.

    Parameters
    ----------
    settings : type
        `SamplingSettings`, `ShadingSettings` or another dataclass of `parameter` fields.
    name : str
        Field in it.
    **changes
        Parts of the description that differ here, such as ``default`` or ``enabled_by``.
    """
    field = next(field for field in dataclasses.fields(settings) if field.name == name)
    description = field.metadata["parameter"] | changes
    return dataclasses.field(default=description["default"], metadata={"parameter": description})
