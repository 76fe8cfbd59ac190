"""The solid geometry of the generated engine block, by signed distances.

A solid is a field that is negative inside and grows with the distance outside (for the unions, cuts and
rounded boxes used here it is exact or a close bound). All lengths are fractions of the width of the volume,
whose middle is the origin: x along the crankshaft, y across, z up. Two-dimensional parts are computed once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    Grid = npt.NDArray[np.float32]

#: Middles of the bores along x, and their radius.
BORES = (-0.27, -0.09, 0.09, 0.27)
BORE_RADIUS = 0.068
LINER = 0.010
SHAFT_HEIGHT = -0.20
DECK = 0.30

#: Values of the three materials, standard deviation of the noise, and strength and reach of the halo.
AIR, ALUMINIUM, STEEL = 5.0, 120.0, 215.0
NOISE = 3.0
HALO, HALO_REACH = 14.0, 0.035


class Distances(NamedTuple):
    """Signed distances of a slab, shape (slices, size, size), float32, in fractions of the width."""

    aluminium: Grid
    steel: Grid


class Engine:
    """The geometry on a lattice of ``size``^3 voxels."""

    def __init__(self, size: int) -> None:
        axis = ((np.arange(size, dtype=np.float32) + np.float32(0.5)) / np.float32(size)) - np.float32(0.5)
        self._z = axis
        self._x = axis[None, None, :]
        self._y = axis[None, :, None]
        bore = np.full((1, size, size), np.inf, np.float32)
        bolts = bore.copy()
        for middle in BORES:
            bore = np.minimum(bore, np.hypot(self._x - middle, self._y))
        for x in (-0.375, -0.18, 0.0, 0.18, 0.375):
            for y in (-0.165, 0.165):
                bolts = np.minimum(bolts, np.hypot(self._x - x, self._y - y))
        self._bore, self._bolts = bore, bolts

    def distances(self, first: int, last: int) -> Distances:
        """The slices ``first`` to ``last`` (exclusive) of both metals."""
        z = self._z[first:last, None, None]
        return Distances(self._aluminium(z), self._steel(z))

    def _aluminium(self, z: Grid) -> Grid:
        x, y = self._x, self._y
        block = _box(x, y, z - 0.07, 0.41, 0.20, DECK - 0.07, 0.02)
        skirt = _box(x, y, z + 0.20, 0.41, 0.17, 0.10, 0.03)
        solid = _join(block, skirt, 0.03)
        # ribs and a flange stiffen the sides
        for middle in (-0.33, -0.18, 0.0, 0.18, 0.33) if _near(z, -0.18, 0.22) else ():
            solid = np.minimum(solid, _box(x - middle, y, z - 0.02, 0.012, 0.225, 0.20, 0.006))
        solid = np.minimum(solid, _box(x, y, z + 0.29, 0.43, 0.20, 0.012, 0.006))
        # intake flange and its three ports on one side
        solid = np.minimum(solid, _box(x, y - 0.22, z - 0.18, 0.30, 0.03, 0.05, 0.01))
        # bores, water jacket, crankcase, oil gallery, bolt holes
        solid = np.maximum(solid, BORE_RADIUS - self._bore)
        jacket = np.maximum(np.abs(self._bore - 0.106) - 0.010, np.abs(z - 0.13) - 0.11)
        solid = np.maximum(solid, -jacket)
        solid = np.maximum(solid, -_box(x, y, z + 0.22, 0.385, 0.135, 0.13, 0.04))
        solid = np.maximum(solid, -_capsule_x(x, y + 0.165, z + 0.02, 0.40, 0.014))
        solid = np.maximum(solid, -np.maximum(self._bolts - 0.013, (DECK - 0.16) - z))
        for middle in (-0.18, 0.0, 0.18) if _near(z, 0.13, 0.23) else ():
            # on through the wall, until the water jacket
            port = np.hypot(x - middle, z - 0.18) - 0.030
            solid = np.maximum(solid, -np.maximum(port, 0.150 - y))
        # bearing walls of the crankshaft, between the bores
        for middle in (-0.36, -0.18, 0.0, 0.18, 0.36) if _near(z, -0.30, -0.10) else ():
            wall = _box(x - middle, y, z + 0.20, 0.014, 0.15, 0.10, 0.004)
            wall = np.maximum(wall, 0.042 - np.hypot(y, z - SHAFT_HEIGHT))
            solid = np.minimum(solid, wall)
        # the sump: a thin shell below
        shell = np.abs(_box(x, y, z + 0.34, 0.39, 0.16, 0.085, 0.05) + 0.006) - 0.006
        return np.asarray(np.minimum(solid, np.maximum(shell, z + 0.29)), np.float32)

    def _steel(self, z: Grid) -> Grid:
        x, y = self._x, self._y
        # liners stand a little above the deck
        liners = np.maximum(
            np.abs(self._bore - (BORE_RADIUS - LINER / 2)) - LINER / 2, np.abs(z - 0.115) - 0.193
        )
        steel = liners
        shaft = np.maximum(np.hypot(y, z - SHAFT_HEIGHT) - 0.032, np.abs(x) - 0.46)
        steel = np.minimum(steel, shaft)
        for number, middle in enumerate(BORES):
            up = 1.0 if number in (0, 3) else -1.0
            crown = 0.20 if up > 0 else 0.07
            if _near(z, crown - 0.045, crown + 0.045):
                # piston: a cup, open below
                cup = np.hypot(x - middle, y)
                piston = np.maximum(cup - (BORE_RADIUS - LINER - 0.004), np.abs(z - crown) - 0.045)
                hollow = np.maximum(cup - (BORE_RADIUS - LINER - 0.016), z - crown - 0.030)
                steel = np.minimum(steel, np.maximum(piston, -hollow))
            if not _near(z, SHAFT_HEIGHT - 0.1, SHAFT_HEIGHT + 0.1):
                continue
            # webs with their counterweights, on both sides of each crank pin
            for side in (-0.042, 0.042):
                web = np.hypot(y, z - SHAFT_HEIGHT + up * 0.022) - 0.072
                steel = np.minimum(steel, np.maximum(web, np.abs(x - middle - side) - 0.011))
            pin = np.hypot(y, z - SHAFT_HEIGHT - up * 0.055) - 0.024
            steel = np.minimum(steel, np.maximum(pin, np.abs(x - middle) - 0.045))
        # flywheel flange with a ring of holes
        if not _near(z, SHAFT_HEIGHT - 0.115, SHAFT_HEIGHT + 0.115):
            return np.asarray(steel, np.float32)
        wheel = np.maximum(np.hypot(y, z - SHAFT_HEIGHT) - 0.115, np.abs(x - 0.465) - 0.012)
        for angle in np.radians(np.arange(0, 360, 60)):
            hole = np.hypot(y - 0.08 * np.cos(angle), z - SHAFT_HEIGHT - 0.08 * np.sin(angle)) - 0.014
            wheel = np.maximum(wheel, -hole)
        return np.asarray(np.minimum(steel, wheel), np.float32)


def material_values(distances: Distances, noise: Grid, size: int) -> npt.NDArray[np.uint8]:
    """Values a scanner would measure: materials, softened edges, halo and noise.

    Parameters
    ----------
    distances : Distances
    noise : ndarray, same shape
        Normal random numbers of standard deviation 1.
    size : int
        Voxels along an axis; edges are 1.6 voxels wide, as a scanner's are.

    Returns
    -------
    ndarray of the same shape, uint8
    """
    sharpness = np.float32(size / 1.6)
    steel = np.clip(0.5 - distances.steel * sharpness, 0, 1)
    aluminium = np.clip(0.5 - distances.aluminium * sharpness, 0, 1)
    outside = np.maximum(np.minimum(distances.steel, distances.aluminium), 0)
    halo = np.exp(outside * np.float32(-1 / HALO_REACH))
    value = AIR + HALO * halo
    value += (ALUMINIUM - value) * aluminium
    value += (STEEL - value) * steel
    # noise is stronger near the part, as the rays that cross it are weaker
    value += noise * (NOISE * (np.float32(0.35) + np.float32(0.65) * halo))
    return np.clip(np.rint(value), 0, 255).astype(np.uint8)


def _near(z: Grid, low: float, high: float) -> bool:
    """Whether a part between these heights can be seen in the slices `z`; farther away even its halo has ended."""
    reach = 5 * HALO_REACH
    return bool(z.min() < high + reach and z.max() > low - reach)


def _box(x: Grid, y: Grid, z: Grid, a: float, b: float, c: float, rounding: float) -> Grid:
    """A box of half widths a, b, c with rounded edges."""
    dx, dy, dz = np.abs(x) - (a - rounding), np.abs(y) - (b - rounding), np.abs(z) - (c - rounding)
    outside = np.sqrt(np.maximum(dx, 0) ** 2 + np.maximum(dy, 0) ** 2 + np.maximum(dz, 0) ** 2)
    return np.asarray(outside + np.minimum(np.maximum(np.maximum(dx, dy), dz), 0) - np.float32(rounding))


def _capsule_x(x: Grid, y: Grid, z: Grid, half: float, radius: float) -> Grid:
    """A rod along x with round ends."""
    return np.asarray(np.sqrt(np.maximum(np.abs(x) - half, 0) ** 2 + y * y + z * z) - np.float32(radius))


def _join(a: Grid, b: Grid, width: float) -> Grid:
    """Union of two solids with a fillet of about `width` between them (polynomial smooth minimum)."""
    mix = np.clip(0.5 + 0.5 * (b - a) / width, 0, 1)
    return np.asarray(b + (a - b) * mix - width * mix * (1 - mix))
