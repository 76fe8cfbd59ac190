"""Reports on two surfaces: distances each way, and both surfaces in their colours."""

from __future__ import annotations

import csv
import io
import json
import re
from pathlib import Path

import numpy as np
import pytest

import volviz
from tests.render.scenes import blobs, camera
from volviz.cli import main
from volviz.compare.distance_map import distance_maps
from volviz.compare.meshes import side_mesh
from volviz.compare.report import csv_report, html_report, json_report
from volviz.compare.results import Comparison
from volviz.compare.run import Side, compare
from volviz.compare.surface_distance import surface_distance
from volviz.model.render_spec import RenderSpec, View

ISOVALUE = 0.53


@pytest.fixture(scope="module")
def of() -> volviz.Volume:
    return volviz.Volume(
        blobs((16, 17, 18), np.float32), spacing=(1.0, 1.3, 0.8), metadata={"length_unit": "mm"}
    )


def compared(of: volviz.Volume, *techniques: str, **options: object) -> Comparison:
    spec = RenderSpec((volviz.ImageLayer(of),))
    return compare(
        spec,
        View(camera(of), (96, 72)),
        [Side(t, {"isovalue": ISOVALUE}) for t in techniques],
        frames=0,
        **options,
    )


@pytest.fixture(scope="module")
def found(of: volviz.Volume) -> Comparison:
    return compared(of, "marching_cubes", "marching_tetrahedra")


def test_the_figures_are_those_of_the_meshes(found: Comparison, of: volviz.Volume) -> None:
    meshes = [
        side_mesh(of, t, {"isovalue": ISOVALUE, "stride": 1})
        for t in ("marching_cubes", "marching_tetrahedra")
    ]
    expected = surface_distance(*meshes)
    maps = distance_maps(*meshes)
    data = json.loads(json_report([found]))["pairs"][0]["distance"]
    for metric, value in (
        ("hausdorff", expected.hausdorff),
        ("mean", expected.mean),
        ("forward", maps[0].maximum),
        ("forward_mean", maps[0].mean),
        ("backward_rms", maps[1].rms),
    ):
        assert data[metric] == pytest.approx(value, rel=1e-5)
    rows = list(csv.reader(io.StringIO(csv_report([found]))))
    told = {row[4]: float(row[5]) for row in rows if row[1] == "pair" and row[4].startswith("distance.")}
    assert told == {f"distance.{name}": pytest.approx(value) for name, value in data.items()}


def test_both_surfaces_are_drawn_in_the_colours_of_their_distance(found: Comparison) -> None:
    pair = found.pairs[0]
    shown = pair.distance_images
    assert shown is not None
    assert shown.limit == shown.largest == pytest.approx(pair.distance.hausdorff)
    assert (shown.is_signed, shown.low) == (True, -shown.limit)
    for image, side in zip((shown.first, shown.second), found.sides, strict=True):
        assert image.shape == side.image.shape
        # the same pixels, in other colours: red, blue and pale ones
        assert np.array_equal(image.any(axis=2), side.image.any(axis=2))
        seen = image[image.any(axis=2)].astype(int)
        assert (seen[:, 0] - seen[:, 2]).max() > 20
        assert (seen[:, 2] - seen[:, 0]).max() > 20


def test_the_page_has_pictures_bar_unit_and_words(found: Comparison) -> None:
    text = html_report([found])
    assert "Distance of marching_cubes and marching_tetrahedra" in text
    assert "marching_tetrahedra in the colours of its distance to marching_cubes" in text
    limit = f"{found.pairs[0].distance_images.limit:.3g}"
    assert f"colours from \N{MINUS SIGN}{limit} to {limit} mm" in text
    assert "Red lies outside of the other surface" in text
    assert "root of the mean square (mm)" in text


def test_a_limit_of_ones_own_says_that_there_is_more(of: volviz.Volume) -> None:
    found = compared(of, "marching_cubes", "marching_tetrahedra", distance_limit=0.01)
    assert found.pairs[0].distance_images.limit == 0.01
    assert re.search("≤ \N{MINUS SIGN}0.01<img.*≥ 0.01 mm", html_report([found]))


def test_equal_surfaces_are_said_to_be_the_same(of: volviz.Volume) -> None:
    found = compared(of, "vtk_marching_cubes", "vtk_flying_edges")
    assert found.pairs[0].distance_images.are_same
    text = html_report([found])
    assert "No distance: the surfaces are the same." in text
    assert "in the colours of its distance" in text
    assert ' mm" src=' not in text


def test_figures_alone_need_no_pictures(of: volviz.Volume) -> None:
    found = compared(of, "marching_cubes", "marching_tetrahedra", surface_images=False)
    assert found.pairs[0].distance.hausdorff > 0
    assert found.pairs[0].distance_images is None


def test_the_command_takes_a_limit_and_repeats_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], of: volviz.Volume
) -> None:
    np.save(tmp_path / "blobs.npy", of.array)
    words = ["compare", str(tmp_path / "blobs.npy"), "-t", "marching_cubes", "-t", "marching_tetrahedra"]
    words += ["--isovalue", str(ISOVALUE), "--frames", "0", "--size", "64x48", "-o", str(tmp_path / "r.html")]
    assert main([*words, "--distance-limit", "0.05"]) == 0
    text = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert "0.05 world units" in text
    assert "--distance-limit=0.05" in text
    assert main([*words, "--distance-limit", "0"]) != 0
    assert "above 0" in capsys.readouterr().err
    assert main(["compare", "--suite", "--distance-limit", "1", "-o", str(tmp_path / "s.html")]) != 0
    assert "leave --distance-limit out" in capsys.readouterr().err
