"""A look: a name, a technique with its settings, and a transfer function, made for one volume."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from volviz.model.transfer.function import Color, TransferFunction

#: Ids of the techniques that looks are drawn by.
RAYS, SURFACES = "raycast", "isosurface"
#: Soft light on a matt surface: enough ambient light that shadows keep their colour.
MATT: Mapping[str, Any] = {"ambient": 0.3, "diffuse": 0.85, "specular": 0.15, "shininess": 20.0}
#: The same for matter that one looks through: most of it is lit from aside, and must not become dark.
TRANSLUCENT: Mapping[str, Any] = {**MATT, "ambient": 0.45, "diffuse": 0.8}


@dataclass(frozen=True)
class Look:
    """One way of showing a volume.

    Attributes
    ----------
    id : str
        Key in `volviz.looks`, such as "bone".
    label, description : str
        For people: one or two words, and what is seen.
    transfer_function : TransferFunction
        In the units of the volume. Where the technique shows isosurfaces, it begins where they lie.
    technique : str
        Id of the technique that draws it.
    settings : mapping
        Its settings by name; the others have their defaults.
    """

    id: str
    label: str
    description: str
    transfer_function: TransferFunction
    technique: str = RAYS
    settings: Mapping[str, Any] = field(default_factory=dict)


def lit(
    ident: str, label: str, description: str, points: Sequence[tuple[float, Color, float]], **settings: Any
) -> Look:
    """A look at matter under a light.

    Parameters
    ----------
    points : sequence of (value, colour, opacity)
        The transfer function.
    **settings
        Settings of ray casting beside those of the light.
    """
    return Look(
        ident, label, description, function(label, points), RAYS, {"shading": True, **MATT, **settings}
    )


def shells(
    ident: str,
    label: str,
    description: str,
    surfaces: Sequence[tuple[float, Color, float]],
    width: float,
    **settings: Any,
) -> Look:
    """A look at isosurfaces.

    Parameters
    ----------
    surfaces : sequence of (isovalue, colour, opacity)
        One to four, ascending.
    width : float
        How far below an isovalue the transfer function begins to rise, for techniques that draw it instead.
    **settings
        Settings of isosurfaces beside their values, colours and opacities.
    """
    values, colors, opacities = zip(*surfaces, strict=True)
    points: list[tuple[float, Color, float]] = []
    for value, color, opacity in surfaces:
        before = points[-1][2] if points else 0.0
        points += [(value - width, color, before), (value, color, max(opacity, before))]
    chosen = {"isovalues": values, "colors": colors, "opacities": opacities}
    return Look(ident, label, description, function(label, points), SURFACES, {**chosen, **MATT, **settings})


def function(name: str, points: Sequence[tuple[float, Color, float]]) -> TransferFunction:
    """A transfer function of values, colours and opacities."""
    return TransferFunction.from_points(
        [(value, (*color, opacity)) for value, color, opacity in points], name=name
    )
