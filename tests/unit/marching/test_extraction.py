"""What `marching_cubes` promises for every method, type, argument and odd value."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from volviz.errors import Cancelled, InputError
from volviz.kernels import threads
from volviz.kernels.marching import face_components, keep_components, marching_cubes, passes
from volviz.kernels.mesh_metrics import edge_uses, mesh_metrics

from .meshes import DTYPES, METHODS, closed, lattice, metrics_of, noise, sphere


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", DTYPES)
def test_white_noise_is_closed_manifold_and_faces_outward(method, dtype):
    array = closed(noise((13, 9, 70), dtype))
    metrics = metrics_of(array, float(np.median(array)) + 0.3, method=method)
    assert metrics.is_closed
    assert metrics.is_oriented
    assert metrics.volume > 0


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.float32])
def test_an_isovalue_equal_to_samples_leaves_no_hole(method, dtype):
    array = closed(np.random.default_rng(1).integers(0, 5, (12, 14, 11)).astype(dtype))
    for isovalue in (1.0, 2.0, 4.0):
        vertices, faces, normals = marching_cubes(array, isovalue, method=method)
        metrics = mesh_metrics(vertices, faces)
        assert metrics.is_closed
        assert metrics.is_oriented
        assert np.isfinite(vertices).all()
        assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)


@settings(max_examples=60, deadline=None)
@given(
    hnp.arrays(
        np.int8, hnp.array_shapes(min_dims=3, max_dims=3, min_side=2, max_side=6), elements=st.integers(0, 3)
    ),
    st.integers(1, 3),
    st.sampled_from(METHODS),
)
def test_any_small_integer_volume_is_closed_and_manifold(array, isovalue, method):
    padded = np.pad(array, 1, constant_values=-1)
    vertices, faces, _ = marching_cubes(padded, isovalue, method=method)
    assert mesh_metrics(vertices, faces).is_closed
    assert mesh_metrics(vertices, faces).is_oriented
    assert len(np.unique(faces)) == len(vertices)


@pytest.mark.parametrize("method", METHODS)
def test_no_triangle_repeats_a_vertex_and_every_vertex_is_used(method):
    vertices, faces, _ = marching_cubes(noise((9, 10, 11), np.uint8), 77.0, method=method)
    a, b, c = faces.T
    assert not ((a == b) | (b == c) | (c == a)).any()
    assert np.array_equal(np.unique(faces), np.arange(len(vertices)))


@pytest.mark.parametrize("method", METHODS)
def test_border_edges_lie_on_the_border_of_the_volume(method):
    array = noise((8, 9, 10), np.float32)
    vertices, faces, _ = marching_cubes(array, 0.0, method=method)
    edges, uses, _ = edge_uses(faces)
    assert uses.max() == 2
    open_ends = vertices[edges[uses == 1]]
    last = np.array(array.shape[::-1]) - 1
    on_low = (open_ends == 0).all(axis=1)
    on_high = (open_ends == last).all(axis=1)
    assert (on_low | on_high).any(axis=1).all()


def test_the_position_on_an_edge_is_linear_in_the_values():
    array = np.zeros((2, 2, 2), np.float32)
    array[:, :, 1] = 10.0
    vertices, faces, normals = marching_cubes(array, 2.5)
    assert np.allclose(vertices[:, 0], 0.25)
    assert len(faces) == 2
    assert np.allclose(normals, (-1, 0, 0))
    a, b, c = vertices[faces[0]]
    assert np.cross(b - a, c - a)[0] < 0


@pytest.mark.parametrize("pieces", [1, 3, 7])
@pytest.mark.parametrize("method", METHODS)
def test_the_result_does_not_depend_on_how_the_work_is_split(monkeypatch, method, pieces):
    array = noise((17, 20, 66), np.int16)
    wanted = marching_cubes(array, 3.5, method=method)
    monkeypatch.setattr(passes.Extraction, "_piece_count", lambda _: pieces)
    found = marching_cubes(array, 3.5, method=method)
    for one, other in zip(wanted, found, strict=True):
        assert np.array_equal(one, other)


def test_the_result_does_not_depend_on_the_number_of_threads(monkeypatch):
    from concurrent.futures import ThreadPoolExecutor

    array = noise((64, 64, 64), np.uint8)
    wanted = marching_cubes(array, 100.5)
    for workers in (1, 5):
        with ThreadPoolExecutor(workers) as pool:
            monkeypatch.setattr(passes, "executor", lambda pool=pool: pool)
            found = marching_cubes(array, 100.5)
        for one, other in zip(wanted, found, strict=True):
            assert np.array_equal(one, other)
    assert threads.worker_count() >= 1


@pytest.mark.parametrize("method", METHODS)
def test_nan_and_infinities_give_finite_closed_meshes(method):
    rng = np.random.default_rng(5)
    array = rng.random((10, 11, 12)).astype(np.float32)
    for value in (np.nan, np.inf, -np.inf):
        array[rng.random(array.shape) < 0.1] = value
    array = np.pad(array, 1, constant_values=-1)
    vertices, faces, normals = marching_cubes(array, 0.5, method=method)
    assert np.isfinite(vertices).all()
    assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)
    assert mesh_metrics(vertices, faces).is_closed


def test_the_surface_at_nan_passes_through_the_finite_neighbour():
    array = np.zeros((2, 2, 3), np.float32)
    array[:, :, 1] = 1.0
    array[:, :, 2] = np.nan
    vertices, _, normals = marching_cubes(array, 0.5)
    assert sorted(set(vertices[:, 0].tolist())) == [0.5, 1.0]
    assert np.allclose(np.abs(normals[:, 0]), 1)


@pytest.mark.parametrize("scale", [1e-30, 1e30])
def test_normals_of_very_small_and_very_large_values_are_unit_vectors(scale):
    field = sphere(20, dtype=np.float64)
    _, _, wanted = marching_cubes(field.astype(np.float32), 0.0)
    _, _, found = marching_cubes((field * scale).astype(np.float32), 0.0)
    assert np.allclose(found, wanted, atol=1e-5)


def test_where_the_gradient_vanishes_the_normal_points_from_inside_to_outside():
    plate = np.zeros((5, 5, 5), np.uint8)
    plate[2] = 10
    vertices, _, normals = marching_cubes(plate, 5.0)
    below = vertices[:, 2] < 2
    assert np.allclose(normals[below], (0, 0, -1))
    assert np.allclose(normals[~below], (0, 0, 1))


@pytest.mark.parametrize("isovalue", [-1.0, 0.0, 250.0, 300.0, 1e300, -1e300])
def test_an_isovalue_out_of_range_gives_an_empty_mesh(isovalue):
    array = noise((4, 5, 6), np.uint8)
    array[0, 0, 0] = 0
    vertices, faces, normals = marching_cubes(array, isovalue)
    assert vertices.shape == faces.shape == normals.shape == (0, 3)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", [np.uint8, np.float32, np.float64])
def test_flat_volumes_have_no_surface_at_any_isovalue(dtype, method):
    array = np.full((4, 4, 4), 7, dtype)
    for isovalue in (6.5, 7.0, 7.5):
        assert len(marching_cubes(array, isovalue, method=method)[1]) == 0


@pytest.mark.parametrize("method", METHODS)
def test_every_case_of_a_single_cell_has_its_crossed_edges_as_vertices(method):
    for case in range(256):
        array = np.array([case >> c & 1 for c in range(8)], np.uint8).reshape(2, 2, 2)
        vertices, faces, _ = marching_cubes(array, 0.5, method=method)
        assert np.isfinite(vertices).all()
        assert mesh_metrics(vertices, faces).non_manifold_edges == 0
        crossed = sum(np.count_nonzero(np.diff(array.astype(int), axis=axis)) for axis in range(3))
        assert len(vertices) >= crossed
        if method == "lorensen":
            assert len(vertices) == crossed


def test_spacing_origin_and_direction_place_the_mesh_in_the_world():
    field = sphere(20)
    index, faces, _ = marching_cubes(field, 0.0)
    angle = np.deg2rad(30)
    direction = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    world, same, normals = marching_cubes(
        field, 0.0, spacing=(0.5, 2.0, 3.0), origin=(-100.0, 20.0, 7.0), direction=direction
    )
    wanted = (index * (0.5, 2.0, 3.0)) @ direction.T + (-100.0, 20.0, 7.0)
    assert np.allclose(world, wanted, atol=2e-5)
    assert np.array_equal(faces, same)
    outward = mesh_metrics(world, same)
    assert outward.volume > 0
    corners = world[same].astype(float)
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middle = normals[same].mean(axis=1)
    assert (np.einsum("ij,ij->i", flat, middle) > 0).mean() > 0.99


@pytest.mark.parametrize("method", METHODS)
def test_a_left_handed_direction_keeps_triangles_and_normals_outward(method):
    field = sphere(16)
    vertices, faces, normals = marching_cubes(field, 0.0, method=method, direction=np.diag([-1.0, 1.0, 1.0]))
    metrics = mesh_metrics(vertices, faces)
    assert metrics.volume > 0
    assert metrics.is_oriented
    centre = vertices.mean(axis=0)
    assert (np.einsum("ij,ij->i", vertices - centre, normals) > 0).all()


def test_flat_normals_belong_to_triangles():
    vertices, faces, normals = marching_cubes(sphere(12), 0.0, normals="flat")
    corners = vertices[faces].astype(float)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert normals.shape == faces.shape
    assert np.allclose(normals, cross / np.linalg.norm(cross, axis=1, keepdims=True), atol=1e-5)


def test_no_normals_on_request():
    assert marching_cubes(sphere(8), 0.0, normals=None)[2] is None


@pytest.mark.parametrize("stride", [2, 3, 5])
def test_a_stride_takes_every_nth_sample_and_keeps_the_last_partial_cell(stride):
    x, y, z = lattice(18)
    # A plane: its position does not depend on the sampling, nor does its normal.
    field = (0.3 - x - 0.2 * y + 0.1 * z).astype(np.float32)
    vertices, _, normals = marching_cubes(field, 0.0, stride=stride)
    step = 2.0 / 17.0
    place = vertices * step - 1.0
    assert np.allclose(place @ (1.0, 0.2, -0.1), 0.3, atol=1e-5)
    assert np.allclose(normals, np.array([1.0, 0.2, -0.1]) / np.linalg.norm([1.0, 0.2, -0.1]), atol=1e-4)
    assert vertices[:, 1].max() == 17.0
    grid = [*range(0, 17, stride), 17]
    on_lattice = np.isin(vertices, grid)
    assert (on_lattice.sum(axis=1) >= 2).all()


def test_bounds_give_the_part_of_the_mesh_inside_them():
    array = noise((12, 13, 14), np.uint8)
    whole, _, _ = marching_cubes(array, 99.5)
    part, faces, _ = marching_cubes(array, 99.5, bounds=(2, 9, 1, 8, 3, 11))
    inside = ((whole >= (2, 1, 3)) & (whole <= (9, 8, 11))).all(axis=1)
    assert {tuple(v) for v in part.tolist()} == {tuple(v) for v in whole[inside].tolist()}
    assert mesh_metrics(part, faces).non_manifold_edges == 0


@pytest.mark.parametrize("method", METHODS)
def test_a_mask_draws_only_cells_whose_corners_are_all_set(method):
    array = noise((9, 10, 11), np.uint8)
    mask = np.random.default_rng(3).random(array.shape) < 0.9
    whole_vertices, whole_faces, _ = marching_cubes(array, 99.5, method=method)
    vertices, faces, normals = marching_cubes(array, 99.5, method=method, mask=mask)
    cell = np.floor(whole_vertices[whole_faces].astype(float).mean(axis=1)).astype(int)
    drawn = np.ones(len(cell), bool)
    for corner in range(8):
        i, j, k = (cell + np.array([corner & 1, corner >> 1 & 1, corner >> 2 & 1])).T
        drawn &= mask[k, j, i]
    assert np.array_equal(whole_vertices[whole_faces[drawn]], vertices[faces])
    assert np.array_equal(np.unique(faces), np.arange(len(vertices)))
    assert len(normals) == len(vertices)


def test_a_mask_that_is_true_everywhere_changes_nothing():
    array = noise((9, 10, 11), np.float32)
    for method in METHODS:
        plain = marching_cubes(array, 0.0, method=method)
        masked = marching_cubes(array, 0.0, method=method, mask=np.ones(array.shape, bool), stride=1)
        assert all(np.array_equal(a, b) for a, b in zip(plain, masked, strict=True))


def test_cleaning_merges_coincident_vertices_and_drops_triangles_without_area():
    array = closed(np.random.default_rng(1).integers(0, 4, (10, 10, 10)).astype(np.uint8))
    vertices, faces, normals = marching_cubes(array, 2.0)
    area = mesh_metrics(vertices, faces).area
    cleaned, fewer, kept = marching_cubes(array, 2.0, clean=True)
    assert len(np.unique(cleaned, axis=0)) == len(cleaned) < len(vertices)
    assert {tuple(v) for v in cleaned.tolist()} <= {tuple(v) for v in vertices.tolist()}
    assert len(fewer) < len(faces)
    assert len(kept) == len(cleaned)
    corners = cleaned[fewer].astype(float)
    doubled = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    assert doubled.min() > 1e-9
    assert mesh_metrics(cleaned, fewer).area == pytest.approx(area, rel=1e-9)
    assert len(normals) == len(vertices)


@pytest.mark.parametrize(
    "make",
    [
        np.asfortranarray,
        lambda a: a.astype(a.dtype.newbyteorder(">")),
        lambda a: np.repeat(a, 2, axis=2)[:, :, ::2],
        lambda a: a[::-1][::-1],
    ],
    ids=["fortran", "big-endian", "strided", "flipped"],
)
def test_the_layout_of_the_array_does_not_matter(make):
    array = noise((11, 12, 13), np.int16)
    wanted = marching_cubes(array, 5.5)
    found = marching_cubes(make(array), 5.5)
    assert all(np.array_equal(a, b) for a, b in zip(wanted, found, strict=True))


def test_bool_and_half_precision_and_long_double_are_taken():
    field = sphere(14)
    inside = field >= 0
    assert len(marching_cubes(inside, 0.5)[1]) == len(marching_cubes(inside.astype(np.uint8), 0.5)[1]) > 0
    for dtype in (np.float16, np.longdouble):
        taken = field.astype(dtype)
        wanted = marching_cubes(taken.astype(np.float64), 0.01)[1]
        assert np.array_equal(marching_cubes(taken, 0.01)[1], wanted)


def test_a_memory_mapped_volume_is_read_in_place(tmp_path):
    array = noise((20, 21, 22), np.uint16)
    np.save(tmp_path / "volume.npy", array)
    mapped = np.load(tmp_path / "volume.npy", mmap_mode="r")
    wanted = marching_cubes(array, 99.5)
    found = marching_cubes(mapped, 99.5)
    assert all(np.array_equal(a, b) for a, b in zip(wanted, found, strict=True))


@pytest.mark.parametrize("dtype", [np.int64, np.uint64])
def test_integers_beyond_float64_are_told_apart(dtype):
    array = np.full((3, 3, 3), 2**53, dtype)
    array[1, 1, 1] = 2**53 + 1
    assert len(marching_cubes(array, float(2**53))[1]) == 0
    for method in METHODS:
        vertices, faces, _ = marching_cubes(array, float(2**53) + 2.0, method=method)
        assert len(faces) == len(vertices) == 0
    array[1, 1, 1] = 2**53 + 2
    for method in METHODS:
        metrics = metrics_of(array, float(2**53) + 2.0, method=method)
        assert metrics.is_closed
        assert metrics.components == 1


@pytest.mark.parametrize("width", [2, 3, 63, 64, 65, 66, 127, 128, 129, 200])
def test_rows_of_any_width_are_cut_into_words_correctly(width):
    array = noise((4, 5, width), np.uint8, seed=width)
    vertices, _, _ = marching_cubes(array, 99.5)
    inside = array >= 99.5
    crossed = sum(np.count_nonzero(np.diff(inside, axis=axis)) for axis in range(3))
    assert len(vertices) == crossed


def test_progress_rises_to_one_and_runs_in_the_calling_thread():
    import threading

    seen = []
    marching_cubes(
        noise((64, 64, 64), np.uint8), 99.5, progress=lambda f: seen.append((f, threading.get_ident()))
    )
    fractions = [f for f, _ in seen]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    assert len(fractions) > 4
    assert {ident for _, ident in seen} == {threading.get_ident()}


@pytest.mark.parametrize("after", [0, 1, 5])
def test_a_cancelled_extraction_ends_with_cancelled(after):
    answers = iter([False] * after + [True] * 100)
    with pytest.raises(Cancelled):
        marching_cubes(noise((64, 64, 64), np.uint8), 99.5, cancel=lambda: next(answers))
    assert len(marching_cubes(noise((64, 64, 64), np.uint8), 99.5)[1]) > 0


@pytest.mark.parametrize(
    ("keywords", "word"),
    [
        ({"method": "mc33"}, "method"),
        ({"method": ["lorensen"]}, "method"),
        ({"normals": "smooth"}, "normals"),
        ({"spacing": (1, 1)}, "spacing"),
        ({"spacing": (1, 0, 1)}, "spacing"),
        ({"spacing": (1, np.nan, 1)}, "spacing"),
        ({"origin": "here"}, "origin"),
        ({"direction": np.zeros((3, 3))}, "direction"),
        ({"direction": np.eye(2)}, "direction"),
        ({"stride": 0}, "stride"),
        ({"stride": 1.5}, "stride"),
        ({"stride": "two"}, "stride"),
        ({"bounds": (0, 1, 2)}, "bounds"),
        ({"bounds": (0, 9, 0, 3, 0, 3)}, "bounds"),
        ({"bounds": (2, 2, 0, 3, 0, 3)}, "bounds"),
        ({"bounds": (0, 1.5, 0, 3, 0, 3)}, "bounds"),
        ({"mask": np.ones((4, 4, 4))}, "mask"),
        ({"mask": np.ones((4, 4, 3), bool)}, "mask"),
        ({"isovalue": np.nan}, "isovalue"),
        ({"isovalue": np.inf}, "isovalue"),
        ({"isovalue": "high"}, "isovalue"),
        ({"isovalue": [1, 2]}, "isovalue"),
        ({"scalars": np.zeros((4, 4))}, "scalars"),
        ({"scalars": np.zeros((4, 1, 4))}, "scalars"),
        ({"scalars": np.zeros((4, 4, 4), complex)}, "scalars"),
        ({"scalars": np.full((4, 4, 4), "a")}, "scalars"),
    ],
)
def test_a_wrong_argument_is_named_in_one_sentence(keywords, word):
    arguments = {"scalars": noise((4, 4, 4), np.uint8), "isovalue": 99.5} | keywords
    with pytest.raises(InputError, match=word) as caught:
        marching_cubes(**arguments)
    message = str(caught.value)
    assert message.endswith(".")
    assert "\n" not in message


def test_other_names_of_the_methods_are_understood():
    array = noise((6, 6, 6), np.uint8)
    for name, method in (("marching_cubes", "lorensen"), ("marching_tetrahedra", "tetrahedra")):
        assert np.array_equal(
            marching_cubes(array, 99.5, method=name)[1], marching_cubes(array, 99.5, method=method)[1]
        )


def test_parts_are_numbered_and_the_largest_can_be_kept():
    field = np.maximum(sphere(40, 0.3), np.roll(sphere(40, 0.15), 15, axis=0))
    vertices, faces, normals = marching_cubes(field, 0.0)
    labels, count = face_components(faces, len(vertices))
    assert count == 2
    sizes = np.bincount(labels)
    kept = keep_components(vertices, faces, normals, largest_only=True)
    assert len(kept[1]) == sizes.max()
    assert mesh_metrics(kept[0], kept[1]).components == 1
    assert len(kept[2]) == len(kept[0])
    assert len(keep_components(vertices, faces, normals, min_triangles=sizes.max() + 1)[1]) == 0
    with pytest.raises(InputError, match="min_triangles"):
        keep_components(vertices, faces, normals, min_triangles=-1)


def test_flat_normals_follow_the_kept_triangles():
    field = np.maximum(sphere(30, 0.3), np.roll(sphere(30, 0.15), 11, axis=0))
    vertices, faces, normals = marching_cubes(field, 0.0, normals="flat")
    _, fewer, kept = keep_components(vertices, faces, normals, largest_only=True)
    assert len(kept) == len(fewer) < len(faces)


def test_warming_up_leaves_nothing_to_compile_for_the_first_extraction():
    from volviz.kernels.marching import warm_up
    from volviz.kernels.marching.vertices import place_vertices

    warm_up(np.uint8)
    compiled = len(place_vertices.signatures)
    marching_cubes(noise((9, 9, 9), np.uint8), 99.5)
    assert len(place_vertices.signatures) == compiled
