"""The trilinear interpolant of a cell: which corners are joined on its faces, and whether there is a tunnel.

Along z the interpolant is linear. So the inside (value >= 0) of the closed cell shrinks, along z, onto the
set of (x, y) where the bottom face or the top face is inside, without a change of topology. Both are regions
of bilinear functions, and what they have in common shrinks in the same way along y onto intervals of x. The
numbers of regions and intervals therefore tell how the inside hangs together, without critical points or case
distinctions.

The ambiguity inside a cell was found by Chernyaev (1995) and Natarajan (1994); the asymptotic decider of
faces is by Nielson and Hamann (1991).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.kernels.compiled import compiled
from volviz.kernels.marching.cube import FACES

Array = npt.NDArray[Any]

#: How the surface inside a cell connects its boundary loops: by discs only, or two of them by a tube that
#: joins two inside corners, or two outside ones, through the middle of the cell.
NO_TUNNEL, INSIDE_TUNNEL, OUTSIDE_TUNNEL = 0, 1, 2

_FACES = np.array(FACES, np.int64)


@compiled
def joined_faces(values: Array) -> int:
    """Ambiguous faces on which the inside corners are connected (asymptotic decider).

    Parameters
    ----------
    values : ndarray of shape (8,), float64
        Corner values minus isovalue; inside is 0 and more.

    Returns
    -------
    int
        Bit f is set for face f of `volviz.kernels.marching.cube.FACES`. Both cells at a face come to the same
        result, since products do not depend on the order of their factors.
    """
    joined = 0
    for f in range(6):
        a, b = values[_FACES[f, 0]], values[_FACES[f, 1]]
        c, d = values[_FACES[f, 2]], values[_FACES[f, 3]]
        if a >= 0 and c >= 0 and not b >= 0 and not d >= 0:
            if a * c >= b * d:
                joined |= 1 << f
        elif b >= 0 and d >= 0 and not a >= 0 and not c >= 0 and b * d >= a * c:
            joined |= 1 << f
    return joined


@compiled
def inside_connection(values: Array) -> tuple[int, int]:
    """How the inside of the trilinear interpolant hangs together in the closed cell.

    Parameters
    ----------
    values : ndarray of shape (8,), float64
        Corner values minus isovalue; inside is 0 and more.

    Returns
    -------
    components : int
        Connected parts of the inside.
    holes : int
        Tubes of the outside that run through the inside.
    """
    # Parts of the inside of the bottom and of the top face: none, one, or two at opposite corners.
    parts = np.zeros(2, np.int64)
    middle = np.zeros(2)
    for side in range(2):
        v00, v10, v01, v11 = (
            values[4 * side],
            values[4 * side + 1],
            values[4 * side + 2],
            values[4 * side + 3],
        )
        if v00 >= 0 or v10 >= 0 or v01 >= 0 or v11 >= 0:
            parts[side] = 1
        apart_up = v00 >= 0 and v11 >= 0 and not v10 >= 0 and not v01 >= 0 and not v00 * v11 >= v10 * v01
        apart_down = v10 >= 0 and v01 >= 0 and not v00 >= 0 and not v11 >= 0 and not v10 * v01 >= v00 * v11
        if apart_up or apart_down:
            parts[side] = 2
            # Between the two parts, where the value does not depend on y.
            middle[side] = (v00 - v01) / ((v00 - v01) - (v10 - v11))

    nodes = parts[0] + parts[1]
    links = 0
    # Union of parts by links: label of each of the up to four parts.
    label = np.arange(4)
    at = _break_points(values)
    was_open = False
    for i in range(at.size - 1):
        x = 0.5 * (at[i] + at[i + 1])
        is_open = _faces_overlap(values, x)
        if is_open and not was_open:
            links += 1
            first = 1 if parts[0] == 2 and x > middle[0] else 0
            second = 2 + (1 if parts[1] == 2 and x > middle[1] else 0)
            old, new = label[second], label[first]
            for j in range(4):
                if label[j] == old:
                    label[j] = new
        was_open = is_open
    components = 0
    for side in range(2):
        for part in range(parts[side]):
            own = 2 * side + part
            is_first = True
            for j in range(own):
                exists = j % 2 < parts[j // 2]
                if exists and label[j] == label[own]:
                    is_first = False
            components += is_first
    return components, links - nodes + components


@compiled
def _break_points(values: Array) -> Array:
    """Ascending x in 0..1, ends included, between which bottom and top overlap everywhere or nowhere."""
    roots = np.empty(8)
    roots[0], roots[1] = 0.0, 1.0
    n = 2
    for row in range(4):
        a, b = values[2 * row], values[2 * row + 1]
        if (a >= 0) != (b >= 0):
            roots[n] = a / (a - b)
            n += 1
    # Where the two zero lines cross: A0 (C1 - A1) = A1 (C0 - A0), a quadratic in x.
    a0, a1, c0, c1 = values[0], values[4], values[2], values[6]
    da0, da1 = values[1] - a0, values[5] - a1
    dc0, dc1 = values[3] - c0, values[7] - c1
    p, q, r = da0 * dc1 - da1 * dc0, a0 * dc1 + da0 * c1 - a1 * dc0 - da1 * c0, a0 * c1 - a1 * c0
    discriminant = q * q - 4 * p * r
    if discriminant >= 0:
        # Without cancellation: the larger root in absolute value first.
        s = -0.5 * (q + np.copysign(np.sqrt(discriminant), q))
        if p != 0 and 0 < s / p < 1:
            roots[n] = s / p
            n += 1
        if s != 0 and 0 < r / s < 1:
            roots[n] = r / s
            n += 1
    return np.sort(roots[:n])


@compiled
def _faces_overlap(values: Array, x: float) -> bool:
    """Tell whether some y in 0..1 is inside on the bottom and on the top face, at one x."""
    low, high = 0.0, 1.0
    for side in range(2):
        a = values[4 * side] + x * (values[4 * side + 1] - values[4 * side])
        c = values[4 * side + 2] + x * (values[4 * side + 3] - values[4 * side + 2])
        if not a >= 0 and not c >= 0:
            return False
        if a >= 0 and not c >= 0:
            high = min(high, a / (a - c))
        elif c >= 0 and not a >= 0:
            low = max(low, a / (a - c))
    return low <= high
