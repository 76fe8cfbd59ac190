"""The trilinear interpolant: decisions in single cells, and the topology of whole meshes."""

from __future__ import annotations

import numpy as np
import pytest

from volviz.kernels.marching import marching_cubes
from volviz.kernels.marching.cube import FACES, ambiguous_faces
from volviz.kernels.marching.trilinear import inside_connection, joined_faces
from volviz.kernels.mesh_metrics import edge_uses, mesh_metrics


def euler_of_inside(values):
    """Euler characteristic of {trilinear >= 0} in each closed cell, by stratified Morse theory.

    Parameters
    ----------
    values : ndarray of shape (N, 8)
        Corner values, corner bit 0 is x.

    Notes
    -----
    While the level falls from infinity to 0, the characteristic changes at critical points only: at corners
    that are maxima by 1; at saddles inside faces by -1 when the function falls into the cell; at saddles
    inside the cell by -1 or 1, the sign of minus the determinant of the second derivatives (Etiene et al.
    2012 count the same points).
    """
    chi = np.zeros(len(values), int)
    for corner in range(8):
        own = values[:, corner]
        neighbours = np.stack([values[:, corner ^ bit] for bit in (1, 2, 4)])
        chi += (own >= 0) & (neighbours < own).all(axis=0)
    for axis in range(3):
        for side in range(2):
            chi -= _face_saddle(values, axis, side)
    return chi + _body_saddles(values)


def _face_saddle(values, axis, side):
    """1 where a face has a saddle at 0 or more from which the function falls into the cell."""
    u, v, w = 1 << (axis + 1) % 3, 1 << (axis + 2) % 3, 1 << axis
    base = w * side
    f00, f10, f01, f11 = (values[:, base | a | b] for a, b in ((0, 0), (u, 0), (0, v), (u, v)))
    denominator = f00 + f11 - f10 - f01
    s, t = (f00 - f01) / denominator, (f00 - f10) / denominator
    level = (f00 * f11 - f10 * f01) / denominator
    other = base ^ w
    g00, g10, g01, g11 = (values[:, other | a | b] for a, b in ((0, 0), (u, 0), (0, v), (u, v)))
    across = (1 - s) * (1 - t) * g00 + s * (1 - t) * g10 + (1 - s) * t * g01 + s * t * g11
    return ((s > 0) & (s < 1) & (t > 0) & (t < 1) & (level >= 0) & (across < level)).astype(int)


def _body_saddles(values):
    """Signed number of critical points at 0 or more inside each cell."""
    f = values
    a = f[:, 0]
    b, c, d = f[:, 1] - a, f[:, 2] - a, f[:, 4] - a
    e = f[:, 3] - f[:, 1] - f[:, 2] + a
    g = f[:, 5] - f[:, 1] - f[:, 4] + a
    k = f[:, 6] - f[:, 2] - f[:, 4] + a
    h = f[:, 7] - f[:, 3] - f[:, 5] - f[:, 6] + f[:, 1] + f[:, 2] + f[:, 4] - a
    # F = a + b x + c y + d z + e xy + g xz + k yz + h xyz; moved to x' = x + k/h, y' = y + g/h, z' = z + e/h
    # it is h x'y'z' + alpha x' + beta y' + gamma z' + constant.
    alpha, beta, gamma = b - e * g / h, c - e * k / h, d - g * k / h
    with np.errstate(invalid="ignore"):
        root = np.sqrt(-beta * gamma / (h * alpha))
    total = np.zeros(len(values), int)
    for sign in (1, -1):
        x1 = sign * root
        y1, z1 = -gamma / (h * x1), -beta / (h * x1)
        x, y, z = x1 - k / h, y1 - g / h, z1 - e / h
        level = a + b * x + c * y + d * z + e * x * y + g * x * z + k * y * z + h * x * y * z
        is_inside = (x > 0) & (x < 1) & (y > 0) & (y < 1) & (z > 0) & (z < 1) & (level >= 0)
        # The second derivatives are h z', h y', h x' off the diagonal, so the determinant is 2 h^3 x'y'z'.
        determinant = 2 * h**3 * x1 * y1 * z1
        total -= np.where(is_inside, np.sign(determinant), 0).astype(int)
    return total


def random_cells(count, seed):
    """Corner values with all cases about equally frequent, a third of them with very unequal sizes."""
    rng = np.random.default_rng(seed)
    values = rng.uniform(-1, 1, (count, 8))
    values[: count // 3] = np.sign(values[: count // 3]) * np.abs(values[: count // 3]) ** 3
    return values


def test_the_interior_test_agrees_with_critical_points_in_200000_cells():
    cells = random_cells(200_000, 1)
    # The rare checkerboard in half of them.
    even = np.array([c.bit_count() % 2 == 0 for c in range(8)])
    cells[::2] = np.where(even, np.abs(cells[::2]), -np.abs(cells[::2]))
    predicted = euler_of_inside(cells)
    for values, chi in zip(cells, predicted, strict=True):
        components, holes = inside_connection(values)
        assert components - holes == chi


def test_the_interior_test_does_not_depend_on_how_the_cell_is_turned():
    cells = random_cells(3000, 2)
    corner = np.arange(8)
    swapped = (corner >> 1 & 1) | (corner & 1) << 1 | corner & 4
    cycled = (corner >> 1 & 3) | (corner & 1) << 2
    for values in cells:
        wanted = inside_connection(values)
        for order in (swapped, cycled, corner ^ 1, corner ^ 4):
            assert inside_connection(values[order].copy()) == wanted


def test_inside_of_a_two_corner_cell_joins_when_the_middle_is_high():
    values = np.full(8, -1.0)
    values[0] = values[7] = 1.0
    assert inside_connection(values) == (2, 0)
    values[0] = values[7] = 6.0
    assert inside_connection(values) == (1, 0)
    assert inside_connection(-values)[1] == 1


@pytest.mark.parametrize("face", range(6))
def test_faces_are_joined_where_the_saddle_is_inside(face):
    a, b, c, d = FACES[face]
    values = np.full(8, -1.0)
    values[[a, c]] = 2.0
    assert joined_faces(values) >> face & 1 == 1
    values[[b, d]] = -3.0
    assert joined_faces(values) >> face & 1 == 0
    assert face in ambiguous_faces(1 << a | 1 << c)


def many_grids(per_axis, interior, seed):
    """Random grids next to each other, each in a shell of negative values; shape (n, n, n) and the period."""
    rng = np.random.default_rng(seed)
    period = interior + 2
    n = per_axis * period
    values = -rng.uniform(0.05, 1.0, (n, n, n))
    place = np.arange(n) % period
    inner = (place > 0) & (place < period - 1)
    cube = inner[:, None, None] & inner[None, :, None] & inner[None, None, :]
    values[cube] = rng.uniform(-1.0, 1.0, np.count_nonzero(cube))
    return values, period


def predicted_characteristic(grid, period):
    """Euler characteristic of the boundary of the inside, one number a grid: twice that of the inside.

    The inside of each grid is summed up from its open corners, edges, faces and cells.
    """
    per_axis = len(grid) // period
    blocks = grid.reshape(per_axis, period, per_axis, period, per_axis, period).transpose(0, 2, 4, 1, 3, 5)
    blocks = blocks.reshape(-1, period, period, period)
    inside = blocks >= 0
    chi = inside.sum(axis=(1, 2, 3)).astype(int)
    both = {}
    for axis in (1, 2, 3):
        both[axis] = _low(inside, axis) & _high(inside, axis)
        # An open edge that is wholly inside has characteristic -1, a half-open one 0.
        chi -= both[axis].sum(axis=(1, 2, 3))
    for u, v in ((1, 2), (1, 3), (2, 3)):
        a, b = _low(_low(blocks, u), v), _high(_low(blocks, u), v)
        c, d = _high(_high(blocks, u), v), _low(_high(blocks, u), v)
        signs = [x >= 0 for x in (a, b, c, d)]
        corners = sum(s.astype(int) for s in signs)
        ring = sum((signs[i] & signs[(i + 1) % 4]).astype(int) for i in range(4))
        parts = (corners > 0).astype(int)
        apart = ((signs[0] & signs[2] & ~signs[1] & ~signs[3]) & (a * c < b * d)) | (
            (signs[1] & signs[3] & ~signs[0] & ~signs[2]) & (b * d < a * c)
        )
        chi += (parts + apart - (corners - ring)).sum(axis=(1, 2, 3))
        # What is said here of a closed face minus its rim is that of the open face.
    cells = np.stack(
        [
            _part(_part(_part(blocks, 3, k & 1), 2, k >> 1 & 1), 1, k >> 2 & 1).reshape(len(blocks), -1)
            for k in range(8)
        ],
        axis=-1,
    )
    whole = euler_of_inside(cells.reshape(-1, 8)).reshape(len(blocks), -1)
    rims = _rim_characteristic(cells.reshape(-1, 8)).reshape(len(blocks), -1)
    return 2 * (chi + (whole - rims).sum(axis=1))


def _low(array, axis):
    return _part(array, axis, 0)


def _high(array, axis):
    return _part(array, axis, 1)


def _part(array, axis, side):
    n = array.shape[axis]
    return np.take(array, range(side, n - 1 + side), axis)


def _rim_characteristic(cells):
    """Euler characteristic of the inside on the surface of each cell."""
    inside = cells >= 0
    chi = inside.sum(axis=1).astype(int)
    for corner in range(8):
        for bit in (1, 2, 4):
            if not corner & bit:
                chi -= inside[:, corner] & inside[:, corner | bit]
    for a, b, c, d in FACES:
        signs = [inside[:, i] for i in (a, b, c, d)]
        corners = sum(s.astype(int) for s in signs)
        ring = sum((signs[i] & signs[(i + 1) % 4]).astype(int) for i in range(4))
        ac, bd = cells[:, a] * cells[:, c], cells[:, b] * cells[:, d]
        apart = (signs[0] & signs[2] & ~signs[1] & ~signs[3] & (ac < bd)) | (
            signs[1] & signs[3] & ~signs[0] & ~signs[2] & (bd < ac)
        )
        chi += (corners > 0).astype(int) + apart - (corners - ring)
    return chi


@pytest.mark.parametrize("interior", [2, 3, 4])
def test_10000_random_grids_have_the_topology_of_the_trilinear_interpolant(interior):
    per_axis = 22 if interior == 3 else 16
    grids, period = many_grids(per_axis, interior, seed=interior)
    vertices, faces, _ = marching_cubes(grids, 0.0, method="topological")
    metrics = mesh_metrics(vertices, faces)
    assert metrics.is_closed
    assert metrics.is_oriented
    assert metrics.vertices == len(vertices)

    block = (vertices // period).astype(int)
    owner = (block[:, 2] * per_axis + block[:, 1]) * per_axis + block[:, 0]
    count = per_axis**3
    edges, _, _ = edge_uses(faces)
    found = (
        np.bincount(owner, minlength=count)
        - np.bincount(owner[edges[:, 0]], minlength=count)
        + np.bincount(owner[faces[:, 0]], minlength=count)
    )
    assert np.array_equal(found, predicted_characteristic(grids, period))


def test_the_three_sizes_make_more_than_10000_grids():
    assert 22**3 + 2 * 16**3 > 10_000


def test_lorensen_differs_from_the_interpolant_where_it_must():
    grids, period = many_grids(8, 3, seed=9)
    vertices, faces, _ = marching_cubes(grids, 0.0, method="lorensen")
    block = (vertices // period).astype(int)
    owner = (block[:, 2] * 8 + block[:, 1]) * 8 + block[:, 0]
    edges, _, _ = edge_uses(faces)
    found = (
        np.bincount(owner, minlength=512)
        - np.bincount(owner[edges[:, 0]], minlength=512)
        + np.bincount(owner[faces[:, 0]], minlength=512)
    )
    assert np.count_nonzero(found != predicted_characteristic(grids, period)) > 100
