"""The cross-check: it finds our meshes right, and it would find wrong ones."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from volviz import Volume
from volviz.cli import main
from volviz.compare import crosscheck as module
from volviz.compare.crosscheck import crosscheck
from volviz.errors import Cancelled, InputError
from volviz.kernels.marching import marching_cubes

from .meshes import noise


@pytest.fixture(scope="module")
def report():
    return crosscheck(
        Volume(noise((12, 13, 14), np.uint8), (0.5, 1.0, 2.0), (9.0, -4.0, 1.0)), 99.5, repeats=1
    )


def test_vertices_agree_and_every_difference_is_another_diagonal(report):
    assert report.vertices_agree
    assert report.is_explained
    for comparison in report.comparisons:
        assert comparison.vertices.only_ours == comparison.vertices.only_theirs == 0
        assert {d.reason for d in comparison.differences} == {"diagonals"}
        differing = sum(d.our_triangles for d in comparison.differences)
        assert comparison.common_triangles + differing == report.cleaned.faces
        assert comparison.distance.hausdorff < 2.0


def test_the_area_differs_only_where_the_triangles_do(report):
    for comparison in report.comparisons:
        explained = sum(d.area_difference for d in comparison.differences)
        assert report.cleaned.area - comparison.cleaned.area == pytest.approx(explained, abs=1e-3)


def test_the_text_names_counts_times_and_reasons(report):
    text = report.format()
    for word in ("vtkMarchingCubes", "vtkFlyingEdges3D, threaded", "other diagonals", "Hausdorff", "Euler"):
        assert word in text
    assert f"all {report.cleaned.vertices} vertices agree" in text
    assert str(report.raw.faces) in text


def test_all_sides_are_timed(report):
    assert set(report.seconds) == {
        "ours", "vtkMarchingCubes", "vtkFlyingEdges3D", "vtkFlyingEdges3D, threaded",
    }  # fmt: skip
    assert min(report.seconds.values()) > 0


def test_isovalues_on_samples_are_given_as_the_reason():
    found = crosscheck(
        Volume(np.random.default_rng(0).integers(0, 4, (8, 9, 10)).astype(np.uint8)), 2.0, repeats=1
    )
    assert found.vertices_agree
    assert found.raw.non_manifold_edges == 0
    assert {d.reason for c in found.comparisons for d in c.differences} <= {"diagonals", "sample"}


def test_another_connection_of_the_topological_method_is_named():
    found = crosscheck(Volume(noise((8, 9, 10), np.float32)), 3.5, "topological", repeats=1)
    reasons = {d.reason for d in found.comparisons[0].differences}
    assert "connection" in reasons
    assert found.comparisons[0].vertices.only_theirs == 0


def test_a_moved_vertex_would_be_found(monkeypatch):
    def wrong(*arguments, **keywords):
        vertices, faces, normals = marching_cubes(*arguments, **keywords)
        vertices[5] += 0.01
        return vertices, faces, normals

    monkeypatch.setattr(module, "marching_cubes", wrong)
    found = crosscheck(Volume(noise((6, 6, 6), np.uint8)), 99.5, repeats=1)
    assert not found.vertices_agree
    assert not found.is_explained
    assert "NOT identical" in found.format()


def test_a_missing_triangle_would_be_found(monkeypatch):
    def wrong(*arguments, **keywords):
        vertices, faces, normals = marching_cubes(*arguments, **keywords)
        return vertices, faces[1:], normals

    monkeypatch.setattr(module, "marching_cubes", wrong)
    found = crosscheck(Volume(noise((6, 6, 6), np.uint8)), 99.5, repeats=1)
    assert "connection" in {d.reason for d in found.comparisons[0].differences}


def test_an_empty_surface_gives_a_report_as_well():
    found = crosscheck(Volume(noise((4, 4, 4), np.uint8)), 999.0, repeats=1)
    assert found.vertices_agree
    assert "empty" in found.format()
    assert found.comparisons[0].distance is None


def test_progress_ends_at_one_and_repeats_are_checked():
    seen = []
    crosscheck(Volume(noise((4, 4, 4), np.uint8)), 99.5, repeats=1, progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    with pytest.raises(InputError, match="repeats"):
        crosscheck(Volume(noise((4, 4, 4), np.uint8)), 99.5, repeats=0)


def test_a_report_cannot_be_changed(report):
    with pytest.raises(dataclasses.FrozenInstanceError):
        report.isovalue = 3.0


def test_the_report_as_plain_values_survives_json(report):
    found = json.loads(json.dumps(report.to_dict()))
    assert found["cleaned"]["faces"] == report.cleaned.faces
    assert found["threaded"]["area"] == pytest.approx(report.comparisons[1].cleaned.area)
    assert found["comparisons"][0]["differences"][0]["reason"] == "diagonals"
    assert found["vertices_agree"] is True
    assert found["verdict"] in report.format()


def test_a_cross_check_can_be_cancelled_at_every_step():
    volume = Volume(noise((5, 5, 5), np.uint8))
    steps = []
    crosscheck(volume, 99.5, repeats=1, progress=steps.append)
    for last in range(len(steps)):
        asked = []
        with pytest.raises(Cancelled):
            crosscheck(volume, 99.5, repeats=1, cancel=lambda: asked.append(1) or len(asked) > last)  # noqa: B023
        assert len(asked) == last + 1


def test_the_command_line_writes_the_report_as_json(tmp_path, capsys):
    source, target = tmp_path / "noise.npy", tmp_path / "report.json"
    np.save(source, noise((5, 6, 7), np.uint8))
    assert main(["crosscheck", str(source), "--isovalue", "99.5", "--json", str(target)]) == 0
    assert "Vertices are identical" in capsys.readouterr().out
    assert json.loads(target.read_text())["isovalue"] == 99.5
