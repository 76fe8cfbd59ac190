"""`volviz compare`: reports of every kind, what stands in them, and what is refused."""

from __future__ import annotations

import csv
import json
import math
import shlex
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import trimesh
from PIL import Image

import volviz
from tests.render.scenes import POINTS, blobs
from volviz.cli import main
from volviz.commands.progress import ProgressLine
from volviz.compare.matching import match_sides, side_names
from volviz.compare.report import csv_report, html_report, json_report, save_report
from volviz.compare.results import Comparison, image_pairs
from volviz.compare.run import ComparisonRun, Side, compare
from volviz.compare.samples import ray_samples
from volviz.compare.suite import suite_groups
from volviz.compare.vtk_contours import vtk_contour
from volviz.custom_gl.arguments import spec_of
from volviz.custom_gl.framing import default_camera
from volviz.custom_gl.registry import technique
from volviz.errors import InputError
from volviz.model.render_spec import RenderSpec, View

VOID = {"meta", "img", "br", "link", "input"}


def make_view(name: str = "blobs", size: tuple[int, int] = (64, 48)) -> tuple[RenderSpec, View]:
    """What is drawn, and from where."""
    volume = volviz.Volume(blobs((17, 18, 19), dtype=np.float32), name=name, spacing=(1.0, 1.1, 1.3))
    function = volviz.TransferFunction.from_points(POINTS)
    spec = RenderSpec((volviz.ImageLayer(volume, function),))
    return spec, View(default_camera(volume, size, transfer_function=function), size)


@pytest.fixture(scope="module")
def comparison() -> Comparison:
    sides = [
        Side("raycast"), Side("slicing", {"step": 1.0}), Side("marching_cubes", {"isovalue": 0.5}),
        Side("marching_tetrahedra", {"isovalue": 0.5}),
    ]  # fmt: skip
    return compare(
        *make_view("<b>&'name\""),
        sides,
        frames=2,
        convergence=True,
        command="volviz compare a&b.nrrd -o r.html",
    )


class Reader(HTMLParser):
    """Checks that elements are closed in order; collects text and what is referred to."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.words: list[str] = []
        self.references: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.references += [str(v) for k, v in attrs if k in ("src", "href")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)


def read(html: str) -> Reader:
    reader = Reader()
    reader.feed(html)
    reader.close()
    assert not reader.open
    return reader


def test_the_page_holds_everything_and_needs_nothing_else(comparison: Comparison) -> None:
    reader = read(html_report([comparison]))
    words = " ".join(reader.words)
    # four images, difference and lost similarity of six pairs and both surfaces of one, each with its colour bar
    assert reader.tags.count("img") == 4 + 6 * 4 + 4
    # times, convergence of images and of meshes
    assert reader.tags.count("svg") == 3
    assert all(reference.startswith("data:") for reference in reader.references)
    for heading in ("Differences", "Frame times", "Samples per ray", "Meshes", "Convergence", "Settings",
                    "Machine and versions", "How this was made"):  # fmt: skip
        assert heading in words
    assert "volviz compare a&b.nrrd -o r.html" in words
    assert "<b>&'name\"" in words
    assert "step is 0.5 in raycast, 1 in slicing." in words
    assert str(Path.home()) not in html_report([comparison])


@pytest.mark.parametrize("several", [False, True])
def test_every_cell_of_a_table_stands_under_a_head(comparison: Comparison, several: bool) -> None:
    html = html_report([comparison] * (2 if several else 1))
    tables = [part.split("</table>")[0] for part in html.split("<table>")[1:]]
    assert len(tables) > 8
    for table in tables:
        heads = table.count("<th>") + table.count("<th ")
        widths = {row.count("<td") for row in table.split("<tr")[1:]} - {0}
        assert len(widths) == 1
        assert heads in (0, *widths)


def test_a_page_of_several_begins_with_an_overview_that_leads_to_each(comparison: Comparison) -> None:
    html = html_report([comparison, comparison], ["engine: nothing could be drawn."])
    start = html[: html.index('id="c0"')]
    assert "engine: nothing could be drawn." in start
    assert {part.split('"')[0] for part in start.split('href="#')[1:]} == {"c1"}
    assert f"{comparison.pairs[0].metrics.psnr:.1f}" in start
    assert all(f'id="{name}"' in html for name in ("c0", "c1"))


def test_one_pixel_that_is_far_off_does_not_dim_the_map_of_differences() -> None:
    view = make_view(size=(64, 48))
    found = compare(*view, [Side("raycast"), Side("raycast", {"step": 2.0})], frames=0)
    shown = found.pairs[0].difference
    assert 1.0 <= shown.limit < shown.values.max()
    assert (shown.values > shown.limit).mean() < 0.0015
    assert "≥" in html_report([found])


def test_plots_are_sound_xml(comparison: Comparison) -> None:
    html = html_report([comparison])
    plots = ["<svg" + part.split("</svg>")[0] + "</svg>" for part in html.split("<svg")[1:]]
    roots = [ET.fromstring(plot) for plot in plots]
    assert [root.tag.endswith("svg") for root in roots] == [True, True, True]
    legend = "".join(roots[1].itertext())
    assert "raycast: slope" in legend
    assert "slicing: slope" in legend


def test_json_says_the_same_as_the_results(comparison: Comparison) -> None:
    data = json.loads(json_report([comparison]))
    assert data["schema"] == 1
    assert set(data) == {
        "schema", "title", "volume", "view", "sides", "pairs", "convergence", "transfer_function", "machine",
        "versions", "remarks", "command", "without_curve", "notes",
    }  # fmt: skip
    assert [side["name"] for side in data["sides"]] == [side.name for side in comparison.sides]
    for entry, pair in zip(data["pairs"], comparison.pairs, strict=True):
        assert entry["psnr"] == pytest.approx(pair.metrics.psnr)
        assert entry["time_ratio"]["median"] > 0
    times = data["sides"][0]["times"]
    assert times["median"] == pytest.approx(np.median(times["frames"]))
    assert len(times["frames"]) == 2
    assert data["sides"][1]["settings"]["step"] == 1.0
    assert volviz.TransferFunction.from_dict(data["transfer_function"]) is not None
    assert {"volviz", "python", "numpy", "vtk"} <= set(data["versions"])
    assert data["machine"]["processor"]


def test_csv_has_one_figure_a_row(comparison: Comparison) -> None:
    rows = list(csv.DictReader(csv_report([comparison]).splitlines()))
    (value,) = [
        r["value"] for r in rows
        if (r["kind"], r["side"], r["other"], r["figure"]) == ("pair", "raycast", "slicing", "psnr")
    ]  # fmt: skip
    assert float(value) == pytest.approx(comparison.pairs[0].metrics.psnr)
    assert {row["volume"] for row in rows} == {"<b>&'name\""}
    assert {
        "times",
        "samples_per_ray",
        "mesh",
        "settings",
        "convergence",
        "machine",
        "versions",
        "command",
    } <= {row["kind"] for row in rows}


def test_figures_of_meshes_are_those_of_trimesh(comparison: Comparison) -> None:
    side = comparison.side("marching_cubes")
    volume = make_view()[0].layers[0].volume
    mesh = volviz.extract_isosurface(volume, 0.5, clean=True)
    theirs = trimesh.Trimesh(mesh.points, mesh.regular_faces, process=False)
    assert side.mesh is not None
    assert side.mesh.faces == len(theirs.faces)
    assert side.mesh.area == pytest.approx(theirs.area)
    assert side.mesh.euler_characteristic == theirs.euler_number
    (distance,) = [p.distance for p in comparison.pairs if p.distance is not None]
    # tetrahedra cut cells more finely: their surface stays within a cell of the cubes'
    assert 0 < distance.hausdorff < 1.3


def test_both_sides_converge_at_second_order(comparison: Comparison) -> None:
    assert [c.name for c in comparison.convergence[:2]] == ["raycast", "slicing"]
    for found in comparison.convergence[:2]:
        assert found.slope == pytest.approx(2.0, abs=0.3)
        assert list(found.errors) == sorted(found.errors, reverse=True)


def test_a_technique_against_itself_is_equal(tmp_path: Path) -> None:
    found = compare(*make_view(), [Side("raycast"), Side("raycast")], frames=0)
    assert [side.name for side in found.sides] == ["raycast", "raycast 2"]
    assert math.isinf(found.pairs[0].metrics.psnr)
    assert found.pairs[0].metrics.max_difference == 0
    assert json.loads(json_report([found]))["pairs"][0]["psnr"] is None
    save_report(found, tmp_path / "equal.html")
    page = read((tmp_path / "equal.html").read_text(encoding="utf-8"))
    assert "equal" in page.words
    assert "Frame times" not in page.words


def test_a_run_that_is_left_early_gives_its_windows_back() -> None:
    run = ComparisonRun(*make_view(), [Side("raycast"), Side("slicing")])
    steps = run.steps()
    for _ in range(4):
        next(steps)
    steps.close()
    assert run.result is None


def test_samples_of_a_ray_through_a_cube_are_its_length_over_the_step() -> None:
    volume = volviz.Volume(np.zeros((21, 21, 21), np.float32) + np.arange(21, dtype=np.float32))
    camera = volviz.Camera((10.0, -100.0, 10.0), (10.0, 10.0, 10.0), parallel=True, parallel_scale=5.0)
    view = View(camera, (40, 40))
    for ident in ("raycast", "slicing"):
        found = ray_samples(spec_of(volume, ident, step=0.4), view)
        assert found is not None
        assert (found.mean, found.maximum, found.hit_share) == (pytest.approx(50), pytest.approx(50), 1.0)
        assert found.distance == pytest.approx(0.4)
    sliced = ray_samples(spec_of(volume, "slicing", slices=16), view)
    assert sliced is not None
    assert sliced.mean == pytest.approx(16)
    assert ray_samples(spec_of(volume, "splatting"), view) is None


def test_every_technique_of_a_suite_stands_beside_its_like() -> None:
    groups = [[info.id for info in group] for group in suite_groups()]
    assert all(len(group) > 1 for group in groups)
    assert next(g for g in groups if "raycast" in g)[:3] == ["raycast", "slicing", "two_pass_raycast"]
    idents = [ident for group in groups for ident in group]
    assert len(idents) == len(set(idents))


def test_names_and_pairs() -> None:
    assert side_names(["a", "b", "a", "a"]) == ["a", "b", "a 2", "a 3"]
    assert len(image_pairs("abcd")) == 6
    assert image_pairs("abcde") == [("a", "b"), ("a", "c"), ("a", "d"), ("a", "e")]
    more = image_pairs(["a", "b", "c", "d", "reference"], ["reference"])
    assert [pair for pair in more if "a" not in pair] == [
        ("b", "reference"),
        ("c", "reference"),
        ("d", "reference"),
    ]


@pytest.fixture
def volume_file(tmp_path: Path) -> Path:
    path = tmp_path / "small.npy"
    np.save(path, blobs((17, 18, 19)))
    return path


def test_the_command_writes_a_report_and_the_command_that_makes_it_again(
    volume_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "report.json"
    arguments = [
        "compare", str(volume_file), "-t", "raycast", "-t", "slicing:step=1", "--set", "shading=true",
        "--set", "light_color=1,0.9,0.8", "--size", "48x40", "--azimuth", "30", "--preset", "grey-classic",
        "--frames", "0", "-o", str(output),
    ]  # fmt: skip
    assert main(arguments) == 0
    assert "raycast against slicing: PSNR" in capsys.readouterr().out
    data = json.loads(output.read_text(encoding="utf-8"))
    assert data["view"]["size"] == [48, 40]
    assert data["view"]["light_color"] == [1.0, 0.9, 0.8]
    assert [side["settings"]["step"] for side in data["sides"]] == [0.5, 1.0]
    assert all(side["settings"]["shading"] for side in data["sides"])
    again = shlex.split(data["command"])
    assert again[:3] == ["volviz", "compare", "small.npy"]
    assert str(tmp_path) not in output.read_text(encoding="utf-8")
    again = [str(volume_file), *again[3:-1], str(tmp_path / "again.json")]
    assert main(["compare", *again]) == 0
    second = json.loads((tmp_path / "again.json").read_text(encoding="utf-8"))
    for key in ("volume", "view", "sides", "pairs", "transfer_function"):
        assert second[key] == data[key]


def test_an_isovalue_is_that_of_all_surfaces(volume_file: Path, tmp_path: Path) -> None:
    output = tmp_path / "r.json"
    words = [
        "-t",
        "isosurface",
        "-t",
        "marching_cubes",
        "--isovalue",
        "120",
        "--size",
        "40x40",
        "--frames",
        "0",
    ]
    assert main(["compare", str(volume_file), *words, "-o", str(output)]) == 0
    first, second = json.loads(output.read_text(encoding="utf-8"))["sides"]
    assert first["settings"]["isovalues"] == [120.0]
    assert second["settings"]["isovalue"] == 120.0
    assert second["mesh"]["faces"] > 100


def test_a_camera_can_be_given_in_numbers(volume_file: Path, tmp_path: Path) -> None:
    output = tmp_path / "r.json"
    words = [
        "-t",
        "raycast",
        "-t",
        "slicing",
        "--camera=9,-60,9,9,9,9,0,0,1",
        "--view-angle",
        "25",
        "--parallel",
    ]
    words += ["--size", "40x40", "--frames", "0", "-o", str(output)]
    assert main(["compare", str(volume_file), *words]) == 0
    view = json.loads(output.read_text(encoding="utf-8"))["view"]
    assert view["position"] == [9, -60, 9]
    assert (view["view_angle"], view["parallel"]) == (25, True)


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["-t", "raycast", "-o", "r.html"], "two techniques"),
        (["-t", "raycast", "-t", "nothing", "-o", "r.html"], "nothing"),
        (["-t", "raycast", "-t", "slicing", "-o", "r.pdf"], ".html"),
        (["-t", "raycast", "-t", "slicing", "-o", "no/folder/r.html"], "folder"),
        (["-t", "raycast:steps=1", "-t", "slicing", "-o", "r.html"], "steps"),
        (["-t", "raycast:step=none", "-t", "slicing", "-o", "r.html"], "step"),
        (["-t", "raycast", "-t", "slicing", "--set", "splat_size=2", "-o", "r.html"], "splat_size"),
        (["-t", "raycast", "-t", "slicing", "--set", "step", "-o", "r.html"], "NAME=VALUE"),
        (["-t", "raycast:headlight=false", "-t", "slicing", "-o", "r.html"], "--set"),
        (["-t", "raycast", "-t", "slicing", "--size", "0x3", "-o", "r.html"], "0 x 3"),
        (["-t", "raycast", "-t", "slicing", "--size", "3x3", "-o", "r.html"], "7 x 7"),
        (["-t", "raycast", "-t", "slicing", "--camera", "1,2", "-o", "r.html"], "--camera"),
        (["-t", "raycast", "-t", "slicing", "--frames", "-1", "-o", "r.html"], "--frames"),
        (["-t", "raycast", "-t", "slicing", "--background", "nocolour", "-o", "r.html"], "nocolour"),
        (["-t", "raycast", "--suite", "-o", "r.html"], "--suite"),
        (["-t", "raycast", "-t", "slicing", "--patience", "0", "-o", "r.html"], "--patience"),
    ],
)
def test_what_cannot_be_compared_is_refused_in_one_sentence(
    words: list[str], part: str, volume_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", str(volume_file), *words]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert told.startswith("volviz: ")
    assert told[-2:] in (".\n", "?\n")
    assert part in told


def test_one_side_alone_is_no_comparison() -> None:
    with pytest.raises(InputError):
        ComparisonRun(*make_view(), [Side("raycast")])


def names_of(data: Any) -> list[str]:
    return [entry["volume"]["name"] for entry in data]


def test_a_suite_on_one_file_compares_group_by_group(
    volume_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    groups = [group for group in suite_groups() if group[0].id in ("isosurface", "marching_cubes")]
    monkeypatch.setattr("volviz.compare.suite.suite_groups", lambda: groups)
    output = tmp_path / "suite.json"
    assert (
        main(["compare", str(volume_file), "--suite", "--size", "24x20", "--frames", "0", "-o", str(output)])
        == 0
    )
    data = json.loads(output.read_text(encoding="utf-8"))
    assert [[side["name"] for side in entry["sides"]] for entry in data] == [
        [i.id for i in g] for g in groups
    ]
    assert set(names_of(data)) == {"small"}
    assert "2 comparisons" in capsys.readouterr().out


def test_sides_are_matched_unless_they_shall_not_be() -> None:
    sides = [("raycast", {"step": 1.0}), ("vtk_gpu", {}), ("slicing", {"first_sample": 0.5})]
    matched = [side.settings for side in match_sides(sides)]
    assert (matched[0].step, matched[0].first_sample) == (1.0, 1.0)
    assert matched[1].step == 1.0
    # what is given for a side stays
    assert matched[2].first_sample == 0.5
    left = [side.settings for side in match_sides(sides, matched=False)]
    assert (left[0].first_sample, left[1].step) == (0.5, 0.5)


def test_ours_and_vtks_agree_to_45_decibels_and_ours_is_as_near_to_the_reference() -> None:
    sides = [Side("raycast"), Side("vtk_gpu"), Side("reference")]
    found = compare(*make_view(size=(96, 72)), sides, frames=1)
    psnr = {(pair.first, pair.second): pair.metrics.psnr for pair in found.pairs}
    assert psnr["raycast", "vtk_gpu"] > 45
    assert psnr["raycast", "reference"] >= psnr["vtk_gpu", "reference"]
    assert all(abs(offset) < 0.02 for pair in found.pairs for offset in pair.metrics.shift)
    # the oracle has all the time in the world
    assert found.side("reference").times is None
    assert found.side("raycast").times is not None


def test_what_vtk_does_differently_is_told_in_words() -> None:
    sides = [Side("marching_tetrahedra"), Side("vtk_flying_edges")]
    found = compare(*make_view(), sides, frames=0)
    assert any("ambiguous" in sentence for sentence in found.pairs[0].differences)
    assert "ambiguous" in html_report([found])


def test_figures_of_vtks_mesh_are_those_of_what_it_draws() -> None:
    volume = make_view()[0].layers[0].volume
    sides = [Side("marching_cubes"), Side("vtk_flying_edges"), Side("vtk_flying_edges", {"stride": 2})]
    found = compare(*make_view(), [Side(s.technique, {"isovalue": 0.5, **s.values}) for s in sides], frames=0)
    ours, theirs, coarse = (side.mesh for side in found.sides)
    assert ours is not None
    assert theirs is not None
    assert coarse is not None
    assert theirs.vertices == ours.vertices
    assert theirs.area == pytest.approx(ours.area, rel=0.01)
    assert 0.2 < coarse.faces / theirs.faces < 0.3
    # every second voxel of 19 x 18 x 17 spans the same box but for the last one of the even axis
    expected = vtk_contour(volviz.Volume(volume.array[::2, ::2, ::2].copy(), spacing=(2.0, 2.2, 2.6)), 0.5)
    assert coarse.faces == len(expected[1])


def test_meshes_of_volumes_with_gaps_have_finite_figures() -> None:
    array = blobs((17, 18, 19), dtype=np.float32)
    array[8, 9, 9] = np.nan
    function = volviz.TransferFunction.from_points(POINTS)
    volume = volviz.Volume(array)
    view = (
        RenderSpec((volviz.ImageLayer(volume, function),)),
        View(default_camera(volume, (40, 30)), (40, 30)),
    )
    sides = [Side(name, {"isovalue": 0.5}) for name in ("marching_cubes", "vtk_marching_cubes")]
    found = compare(*view, sides, frames=0)
    assert all(side.mesh is not None and np.isfinite(side.mesh.area) for side in found.sides)
    distance = found.pairs[0].distance
    assert distance is not None
    # the gap is one voxel wide
    assert distance.hausdorff < 2.0


def test_a_group_that_fails_does_not_end_a_suite(
    volume_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    good = [technique("raycast"), technique("slicing")]
    monkeypatch.setattr("volviz.compare.suite.suite_groups", lambda: [[technique("raycast")], good])
    output = tmp_path / "suite.json"
    words = ["compare", str(volume_file), "--suite", "--size", "24x20", "--frames", "0", "-o", str(output)]
    assert main(words) == 0
    told = capsys.readouterr()
    assert told.err == "volviz: small, raycast: a comparison needs at least two techniques, got 1.\n"
    assert told.out.endswith("1 comparison\n")
    monkeypatch.setattr("volviz.compare.suite.suite_groups", lambda: [[technique("raycast")]])
    assert main(words) == 2


def test_a_suite_that_is_stopped_writes_what_is_finished(
    volume_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    group = [technique("raycast"), technique("slicing")]
    monkeypatch.setattr("volviz.compare.suite.suite_groups", lambda: [group, group, group])
    shown: list[float] = []

    def press_in_the_second(line: ProgressLine, fraction: float, _words: str = "") -> None:
        shown.append(fraction)
        if fraction > 0.5:
            line._stopping = True

    monkeypatch.setattr(ProgressLine, "show", press_in_the_second)
    output = tmp_path / "suite.json"
    words = ["compare", str(volume_file), "--suite", "--size", "24x20", "--frames", "0", "-o", str(output)]
    assert main(words) == 130
    assert capsys.readouterr().out.endswith("1 comparison of 3, stopped before the end\n")
    assert json.loads(output.read_text(encoding="utf-8"))["sides"][0]["name"] == "raycast"
    assert shown == sorted(shown)
    assert shown[-1] < 0.7


def test_a_side_that_is_slow_gets_fewer_frames_and_the_report_says_so() -> None:
    view = make_view(size=(48, 40))
    found = compare(*view, [Side("raycast"), Side("slicing")], frames=3, patience=1e-9)
    assert [len(side.times.seconds) for side in found.sides if side.times is not None] == [1, 1]
    assert len(found.notes) == 2
    assert "1 of 3 frames was measured" in found.notes[0]
    assert "1 of 3 frames was measured" in html_report([found])
    assert any("Up to 3 frames" in words for words in found.remarks)
    assert compare(*view, [Side("raycast"), Side("slicing")], frames=1).notes == ()


def test_a_mesh_that_is_empty_has_figures_and_no_distance() -> None:
    sides = [Side(name, {"isovalue": 99.0}) for name in ("marching_cubes", "vtk_flying_edges")]
    found = compare(*make_view(), sides, frames=0)
    assert [side.mesh.faces for side in found.sides if side.mesh is not None] == [0, 0]
    assert found.pairs[0].distance is None
    assert math.isinf(found.pairs[0].metrics.psnr)
    assert read(html_report([found]))


def test_files_of_settings_appear_by_their_names(volume_file: Path, tmp_path: Path) -> None:
    image = tmp_path / "normals.png"
    Image.fromarray(np.full((8, 8, 3), (128, 128, 255), np.uint8)).save(image)
    output = tmp_path / "r.html"
    words = ["-t", f"bump_mapping:normal_source=image:normal_image={image}", "-t", "bump_mapping"]
    words += ["--set", f"normal_image={image}", "--size", "40x40", "--frames", "0", "-o", str(output)]
    assert main(["compare", str(volume_file), *words]) == 0
    told = output.read_text(encoding="utf-8")
    assert "normal_image=normals.png" in told
    assert str(tmp_path) not in told
