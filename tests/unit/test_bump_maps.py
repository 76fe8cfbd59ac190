"""Normal maps: encoding, patterns, images, and the cube map that normalises."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.spatial import cKDTree

from volviz.custom_gl.techniques.bump_mapping.maps import image_normals
from volviz.errors import InputError, LoadError
from volviz.kernels.normal_maps import (
    BUMPS,
    brick_heights,
    bump_heights,
    cube_map_directions,
    decoded,
    encoded,
    normals_from_heights,
)

RANDOM = np.random.default_rng(7)


def unit_vectors(count: int) -> np.ndarray:
    v = RANDOM.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def test_a_flat_normal_is_the_well_known_blue() -> None:
    assert encoded([0.0, 0.0, 1.0]).tolist() == [128, 128, 255]
    assert encoded([0.0, 0.0, 1.0], "classic").tolist() == [128, 128, 255]
    assert encoded([-1.0, 1.0, -1.0]).tolist() == [0, 255, 0]
    assert encoded([-1.0, 1.0, -1.0], "classic").tolist() == [1, 255, 1]


def test_the_classic_encoding_is_exact_at_zero_and_at_both_ends_when_decoded_its_own_way() -> None:
    v = np.array([-1.0, 0.0, 1.0])
    assert decoded(encoded(v, "classic"), "classic").tolist() == v.tolist()


@pytest.mark.parametrize("encoding", ["centred", "classic"])
def test_bytes_hold_a_vector_to_half_a_step(encoding: str) -> None:
    v = unit_vectors(2000)
    step = 1 / 127 if encoding == "classic" else 2 / 255
    error = np.abs(decoded(encoded(v, encoding), encoding) - v)  # type: ignore[arg-type]
    assert error.max() <= 0.5 * step + 1e-12


def test_vectors_beyond_the_range_are_clamped() -> None:
    assert encoded([2.0, -3.0, 0.0]).tolist() == [255, 0, 128]


def test_normals_of_a_wave_are_those_of_its_derivative() -> None:
    n = 512
    u = (np.arange(n) + 0.5) / n
    heights = np.tile(0.02 * np.sin(2 * np.pi * u), (8, 1))
    slope = 0.02 * 2 * np.pi * np.cos(2 * np.pi * u)
    expected = np.stack([-slope, np.zeros(n), np.ones(n)], axis=1) / np.hypot(slope, 1)[:, None]
    assert np.abs(normals_from_heights(heights)[3] - expected).max() < 1e-4


def test_heights_that_grow_with_the_row_lean_the_normal_back_along_the_binormal() -> None:
    heights = np.zeros((16, 16))
    heights[6:10] = np.linspace(0.0, 0.1, 4)[:, None]
    assert normals_from_heights(heights)[7, 3, 1] < -0.1
    assert normals_from_heights(heights)[7, 3, 0] == 0


@pytest.mark.parametrize("make", [brick_heights, bump_heights])
def test_a_pattern_has_no_edge_where_it_repeats(make: object) -> None:
    heights = make(128)  # type: ignore[operator]
    steps = np.abs(np.diff(np.tile(heights, (2, 2)), axis=1))
    assert steps[:, 127].max() <= steps[:, :126].max()
    assert heights.min() == 0.0
    assert heights.max() > 0.0


def test_every_other_row_of_bricks_is_shifted_by_half_a_brick() -> None:
    heights = brick_heights(256)
    assert np.array_equal(heights[32], np.roll(heights[96], 64))
    assert not np.array_equal(heights[32], heights[96])


def test_bumps_lie_on_a_square_lattice() -> None:
    heights = bump_heights(128)
    assert np.allclose(heights, np.roll(heights, 128 // BUMPS, axis=0), rtol=0, atol=1e-15)
    assert np.allclose(heights, heights.T, rtol=0, atol=1e-15)


# -------------------------------------------------------------------------------------------------- the cube map


@pytest.mark.parametrize("size", [1, 3, 33])
def test_the_middle_of_each_face_is_its_axis(size: int) -> None:
    faces = cube_map_directions(size)
    middle = faces[:, size // 2, size // 2]
    assert np.allclose(middle, [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])


def test_directions_have_length_one_and_cover_the_sphere_evenly() -> None:
    faces = cube_map_directions(16)
    assert np.allclose(np.linalg.norm(faces, axis=-1), 1)
    assert np.allclose(faces.reshape(-1, 3).sum(axis=0), 0, atol=1e-10)


def test_neighbouring_faces_meet_without_a_jump() -> None:
    size = 32
    vectors = cube_map_directions(size).reshape(-1, 3)
    # itself and its neighbours, over edges as well; a corner of the cube has three of them
    distances, _ = cKDTree(vectors).query(vectors, k=4)
    widest = 2 / size
    assert distances[:, 3].max() <= widest
    assert distances[:, 1].min() > 0.3 * widest


def test_a_cube_map_without_texels_is_refused() -> None:
    with pytest.raises(InputError, match="at least one texel"):
        cube_map_directions(0)


# -------------------------------------------------------------------------------------------------- image files


def test_a_colour_image_is_a_normal_map_with_its_lowest_row_first(tmp_path: Path) -> None:
    vectors = unit_vectors(6 * 5).reshape(6, 5, 3)
    vectors[..., 2] = np.abs(vectors[..., 2])
    Image.fromarray(encoded(vectors)[::-1]).save(tmp_path / "normals.png")
    read = image_normals(tmp_path / "normals.png")
    assert np.abs(read - vectors).max() < 0.01
    assert np.allclose(np.linalg.norm(read, axis=-1), 1)


def test_a_black_pixel_is_no_vector_of_length_zero(tmp_path: Path) -> None:
    pixels = np.full((4, 4, 3), 127, np.uint8)
    Image.fromarray(pixels).save(tmp_path / "grey.png")
    assert np.isfinite(image_normals(tmp_path / "grey.png")).all()


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_a_grey_image_is_taken_as_heights(tmp_path: Path, kind: type) -> None:
    heights = np.zeros((16, 16))
    heights[4:12, 4:12] = 1.0
    top = np.iinfo(kind).max
    Image.fromarray((heights * top).astype(kind)[::-1]).save(tmp_path / "heights.png")
    normals = image_normals(tmp_path / "heights.png")
    assert np.allclose(normals, normals_from_heights(heights * 0.05))


@pytest.mark.parametrize("content", [b"", b"not an image", b"\x89PNG\r\n\x1a\n" + b"\0" * 40])
def test_a_file_that_is_no_image_is_refused_in_words(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "broken.png").write_bytes(content)
    with pytest.raises(LoadError, match=r"broken\.png cannot be read as an image"):
        image_normals(tmp_path / "broken.png")
