"""Colours of the distance between two surfaces: what both sides of a comparison are shown in."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt

from volviz.compare.distance_map import DistanceMap, distance_maps
from volviz.compare.mesh_differences import position_tolerance
from volviz.compare.meshes import drawn_mesh
from volviz.custom_gl.resolve import Volumes, resolve
from volviz.errors import InputError
from volviz.model.parameters import setting_values
from volviz.model.render_spec import RenderSpec
from volviz.model.surface_values import DistanceColoring, SurfaceColors

Bytes = npt.NDArray[np.uint8]

#: Entries of a table of colours; an odd number, so that one of them is no distance.
COLORS = 1025


@dataclass(frozen=True, eq=False)
class DistanceColors:
    """Two surfaces in the colours of their distance to each other.

    Attributes
    ----------
    first, second : SurfaceColors
        Both with the same limits and colours.
    limit : float
        Distance of the strongest colour, in world units.
    largest : float
        Largest distance of a place of one surface to the other, in world units.
    is_signed : bool
        Whether the first colour stands for `-limit`, inside of the other surface, and not for 0.
    are_same : bool
        There is no distance but that of rounding.
    are_vertices_same : bool
        None at the vertices: triangles may still be cut from the same polygons along other diagonals.
    """

    first: SurfaceColors
    second: SurfaceColors
    limit: float
    largest: float
    is_signed: bool
    are_same: bool
    are_vertices_same: bool


def distance_colors(
    maps: tuple[DistanceMap, DistanceMap], spacing: tuple[float, float, float], limit: float | None = None
) -> DistanceColors:
    """Colour two surfaces by their distances.

    Parameters
    ----------
    maps : tuple of 2 DistanceMap
        See `volviz.compare.distance_map.distance_maps`.
    spacing : tuple of 3 floats
        Of the volume: what is rounding is told by it.
    limit : float, optional
        Distance of the strongest colour, above 0; the default is the largest distance.

    Raises
    ------
    InputError
        `limit` is not above 0.
    """
    if limit is not None and not limit > 0:
        raise InputError(f"the strongest colour stands for a distance above 0, got {limit!r}.")
    largest = max(each.maximum for each in maps)
    rounding = position_tolerance(max(each.rounding for each in maps), spacing)
    are_same = largest <= rounding
    is_signed = maps[0].is_signed
    # between equal surfaces, rounding is not worth a colour
    top = limit if limit is not None else max(largest, min(spacing) if are_same else rounding)
    table = distance_table(signed=is_signed)
    first, second = (SurfaceColors(each.values, -top if is_signed else 0.0, top, table) for each in maps)
    at_vertices = max(each.maximum_at_vertices for each in maps)
    return DistanceColors(first, second, top, largest, is_signed, are_same, at_vertices <= rounding)


def colors_of(spec: RenderSpec, volumes: Volumes | None = None) -> SurfaceColors:
    """The colours that a spec wishes for its surface: by its distance to the one that another technique draws.

    Parameters
    ----------
    spec : RenderSpec
        With a `DistanceColoring`.
    volumes : mapping of VolumeKey to Volume, optional
        What has been read of the references in its layers.

    Raises
    ------
    InputError
        One of the two draws no triangles.
    """
    request = spec.surface_colors
    assert isinstance(request, DistanceColoring)
    meshes = []
    for side in (
        spec.drawn_by(spec.technique, spec.settings),
        spec.drawn_by(request.technique, request.settings),
    ):
        shown = resolve(side, volumes)
        mesh = drawn_mesh(shown.volume, shown.info.id, setting_values(shown.settings))
        if mesh is None:
            raise InputError(f"{shown.info.id} draws no mesh, so there is no distance to colour by.")
        meshes.append(mesh)
    maps = distance_maps(meshes[0], meshes[1], signed=request.signed)
    return distance_colors(maps, shown.volume.spacing, request.limit).first


@cache
def distance_table(*, signed: bool) -> Bytes:
    """Colours of distances, evenly spaced, shape (1025, 3): from -limit to limit, or from 0 to limit.

    The cool to warm map (Moreland 2009, "Diverging Color Maps for Scientific Visualization"), made for lit surfaces: no
    distance is pale grey, as a surface without colours would be, outside is red and inside blue. Colours go with the
    root of the distance: a few large ones must not make all others pale.
    """
    import cmap

    shares = np.linspace(-1.0 if signed else 0.0, 1.0, COLORS)
    places = 0.5 + 0.5 * np.sign(shares) * np.sqrt(np.abs(shares))
    colors = np.asarray(cmap.Colormap("matplotlib:coolwarm")(places))[:, :3]
    table = np.rint(255.0 * colors).astype(np.uint8)
    table.flags.writeable = False
    return table
