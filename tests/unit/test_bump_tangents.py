"""Tangent spaces: of planes, of meshes with and without texture coordinates; the pieces of surface."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from volviz.custom_gl.techniques.bump_mapping.receivers import polygons, vertex_data
from volviz.errors import InputError
from volviz.kernels.tangents import box_projection, plane_basis, vertex_tangents
from volviz.model.cut_plane import default_cut_plane

BITS = np.array([[c & 1, c >> 1 & 1, c >> 2 & 1] for c in range(8)], float)


def directions(count: int) -> np.ndarray:
    v = np.random.default_rng(3).normal(size=(count, 3))
    return np.concatenate([v / np.linalg.norm(v, axis=1, keepdims=True), np.eye(3), -np.eye(3)])


def sphere(rings: int = 24, sectors: int = 48) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions on the unit sphere without its caps, triangles, and uv = (longitude, latitude)."""
    latitude = np.linspace(-1.3, 1.3, rings)
    longitude = np.linspace(0.0, 2 * np.pi, sectors)
    la, lo = (part.ravel() for part in np.meshgrid(latitude, longitude, indexing="ij"))
    points = np.stack([np.cos(la) * np.cos(lo), np.cos(la) * np.sin(lo), np.sin(la)], axis=1)
    i, j = (p.ravel() for p in np.meshgrid(np.arange(rings - 1), np.arange(sectors - 1), indexing="ij"))
    a = i * sectors + j
    quads = np.stack([a, a + 1, a + sectors + 1, a + sectors], axis=1)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return points, faces, np.stack([lo, la], axis=1)


# -------------------------------------------------------------------------------------------------- planes


def test_the_basis_of_a_plane_is_orthonormal_right_handed_and_upright() -> None:
    ups = [np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])]
    for normal in directions(50):
        t, b, n = plane_basis(3.0 * normal, ups)
        frame = np.stack([t, b, n])
        assert np.allclose(frame @ frame.T, np.eye(3), atol=1e-12)
        assert np.allclose(np.cross(t, b), n)
        assert np.allclose(b, np.cross(n, t)), "b = n x t; the other order flips green"
        assert b @ (ups[1] if abs(normal[2]) == 1 else ups[0]) > 0


def test_turning_normal_and_up_turns_the_basis() -> None:
    ups = [np.array([0.1, 0.2, 1.0]), np.array([0.0, 1.0, 0.0])]
    for seed, normal in enumerate(directions(20)):
        turn = Rotation.random(random_state=seed).as_matrix()
        turned = plane_basis(turn @ normal, [turn @ up for up in ups])
        assert np.allclose(np.stack(turned), np.stack(plane_basis(normal, ups)) @ turn.T, atol=1e-9)


def test_a_plane_without_a_normal_or_an_upper_side_is_refused() -> None:
    with pytest.raises(InputError, match="not zero"):
        plane_basis((0, 0, 0), [(0, 0, 1)])
    with pytest.raises(InputError, match="upper side"):
        plane_basis((0, 0, 1), [(0, 0, -2)])


# -------------------------------------------------------------------------------------------------- meshes


def test_tangents_of_a_sphere_point_east_and_binormals_north() -> None:
    points, faces, uv = sphere()
    tangents = vertex_tangents(points, points, faces, uv)
    east = np.stack([-np.sin(uv[:, 0]), np.cos(uv[:, 0]), np.zeros(len(uv))], axis=1)
    north = np.cross(points, east)
    inner = np.abs(uv[:, 1]) < 1.2
    assert np.allclose(np.linalg.norm(tangents[:, :3], axis=1), 1)
    assert np.abs(np.einsum("vi,vi->v", tangents[:, :3], points)).max() < 1e-12
    # at the seam a vertex has triangles on one side only
    assert np.einsum("vi,vi->v", tangents[:, :3], east)[inner].min() > np.cos(np.radians(4))
    binormals = tangents[:, 3:] * np.cross(points, tangents[:, :3])
    assert np.einsum("vi,vi->v", binormals, north)[inner].min() > np.cos(np.radians(4))


def test_a_mirrored_parametrisation_is_told_by_w() -> None:
    points, faces, uv = sphere()
    plain = vertex_tangents(points, points, faces, uv)
    mirrored = vertex_tangents(points, points, faces, uv * (1, -1))
    assert np.all(plain[:, 3] == 1)
    assert np.all(mirrored[:, 3] == -1)
    assert np.allclose(plain[:, :3], mirrored[:, :3])


def test_without_usable_texture_coordinates_any_perpendicular_vector_is_taken() -> None:
    points, faces, uv = sphere()
    tangents = vertex_tangents(points, points, faces, np.zeros_like(uv))
    assert np.allclose(np.linalg.norm(tangents[:, :3], axis=1), 1)
    assert np.abs(np.einsum("vi,vi->v", tangents[:, :3], points)).max() < 1e-12


def test_projected_triangles_keep_their_shape_and_are_never_mirrored() -> None:
    points, faces, _ = sphere()
    made = box_projection(points, points, faces, np.eye(3))
    assert np.all(made.tangents[:, 3] == 1)
    assert np.array_equal(made.vertices[made.faces], faces)
    a, b, c = (made.uv[made.faces[:, i]] for i in range(3))
    signed = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    p, q, r = (points[faces[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(q - p, r - p), axis=1)
    assert np.all(signed > 0), "a triangle is mirrored"
    # a triangle of the sphere is turned by at most 55 degrees from its side of the box, and a little at borders
    assert (signed / area).min() > np.cos(np.radians(62))
    assert np.abs(np.einsum("vi,vi->v", made.tangents[:, :3], points[made.vertices])).max() < 1e-12


def test_projection_agrees_with_tangents_from_its_own_texture_coordinates() -> None:
    points, faces, _ = sphere(60, 120)
    made = box_projection(points, points, faces, np.eye(3))
    normals = points[made.vertices]
    derived = vertex_tangents(normals, normals, made.faces, made.uv)
    assert np.all(derived[:, 3] == 1)
    assert np.median(np.einsum("vi,vi->v", derived[:, :3], made.tangents[:, :3])) > 0.98


# -------------------------------------------------------------------------------------------------- pieces


def pieces_of(**changes: object) -> list:  # type: ignore[type-arg]
    corners = BITS * (3.0, 4.0, 5.0)
    arguments = {
        "surface": "both", "plane": (None, None), "up": None, "eye": np.array([30.0, -40.0, 20.0]),
    } | changes  # fmt: skip
    return polygons(corners, np.eye(3), **arguments)  # type: ignore[arg-type]


def test_the_default_plane_goes_through_the_middle_and_faces_the_first_view() -> None:
    corners = BITS * (3.0, 4.0, 5.0)
    origin, normal = default_cut_plane(corners)
    assert origin == (1.5, 2.0, 2.5)
    assert np.linalg.norm(normal) == pytest.approx(1)
    # from the front, a little to the side and above
    assert normal[1] < -0.8
    assert normal[2] == pytest.approx(np.sin(np.radians(15)))


def test_far_faces_come_first_then_the_plane_then_near_faces() -> None:
    layers = [piece.layer for piece in pieces_of()]
    assert layers == [0, 0, 0, 1, 2, 2, 2]


def test_every_piece_faces_the_eye_from_either_side() -> None:
    for eye in ([30.0, -40.0, 20.0], [-30.0, 40.0, -20.0], [1.0, 1.0, 1.0]):
        for piece in pieces_of(eye=np.array(eye)):
            assert piece.normal @ (np.array(eye) - piece.corners[0]) >= -1e-9
            assert piece.tangent @ piece.normal == pytest.approx(0, abs=1e-12)


def test_a_plane_beside_the_box_draws_nothing() -> None:
    assert pieces_of(surface="plane", plane=((50.0, 0.0, 0.0), (1.0, 0.0, 0.0))) == []


def test_subdivision_keeps_the_area_and_the_orientation() -> None:
    pieces = pieces_of()
    middle = np.zeros(3)
    areas = []
    for n in (1, 7):
        data, ranges = vertex_data(pieces, middle, n)
        assert sum(count for _, _, count in ranges) == len(data)
        assert [layer for layer, _, _ in ranges] == [0, 1, 2]
        corners = data[:, :3].astype(float).reshape(-1, 3, 3)
        sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        areas.append(np.linalg.norm(sides, axis=1).sum())
    assert areas[0] == pytest.approx(areas[1], rel=1e-5)


def test_texture_coordinates_are_lengths_along_tangent_and_binormal() -> None:
    pieces = pieces_of(surface="plane", plane=((1.5, 2.0, 2.5), (0.3, -1.0, 0.2)))
    data, _ = vertex_data(pieces, np.zeros(3), 1)
    t, n = data[:, 6:9].astype(float), data[:, 3:6].astype(float)
    rebuilt = np.array([1.5, 2.0, 2.5]) + data[:, 10:11] * t + data[:, 11:12] * np.cross(n, t)
    assert np.abs(rebuilt - data[:, :3]).max() < 1e-5
