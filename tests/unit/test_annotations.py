"""What stands around a volume in a picture: shapes in the right pixels, round numbers, what is behind and before."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from volviz.annotations.figure import surround, write_picture
from volviz.annotations.margins import direction_words
from volviz.annotations.picture import shapes_around
from volviz.annotations.projection import Projection
from volviz.annotations.shapes import Area, Line, Ramp, Shape, Text, moved
from volviz.annotations.subject import BarColors, Subject
from volviz.errors import InputError
from volviz.model.camera import Camera
from volviz.model.picture import SWITCHES, PictureContents

SIZE = (400, 300)
CORNERS = np.array([[x, y, z] for z in (-20.0, 20.0) for y in (-20.0, 20.0) for x in (-20.0, 20.0)])
CAMERA = Camera((90.0, -160.0, 70.0), (0.0, 0.0, 0.0))
SUBJECT = Subject(
    CORNERS, "mm", is_anatomical=True, bar=BarColors(-1000.0, 2000.0, ((0, 0, 0), (1, 1, 1)), "HU"),
    legend=(("Liver", (1.0, 0.0, 0.0)), ("Spleen", (0.0, 0.0, 1.0))),
)  # fmt: skip


def around(
    *names: str, camera: Camera = CAMERA, title: str = "", subject: Subject = SUBJECT
) -> tuple[Shape, ...]:
    return shapes_around(PictureContents.of(names, title), subject, camera, SIZE, scale=1.0)


def words(shapes: tuple[Shape, ...]) -> list[str]:
    return [shape.words for shape in shapes if isinstance(shape, Text)]


def test_pixels_of_world_points_are_those_of_the_matrices_of_opengl() -> None:
    points = np.random.default_rng(1).uniform(-20, 20, (50, 3))
    for camera in (CAMERA, Camera((90.0, -160.0, 70.0), (0.0, 0.0, 0.0), parallel=True, parallel_scale=30.0)):
        view, projection = camera.matrices(SIZE[0] / SIZE[1], (1.0, 500.0))
        clip = np.column_stack([points, np.ones(50)]) @ (projection @ view).T
        x, y = (clip[:, :2] / clip[:, 3:]).T
        expected = np.stack([(x + 1) / 2 * SIZE[0], (1 - y) / 2 * SIZE[1]], axis=1)
        assert Projection(camera, SIZE).pixels(points) == pytest.approx(expected)


def test_three_edges_of_a_box_lie_behind_what_is_in_it_and_all_seen_from_inside() -> None:
    lines = [shape for shape in around("box") if isinstance(shape, Line)]
    assert len(lines) == 12
    assert sum(line.behind for line in lines) == 3
    # from inside all edges lie behind what is between them and the eye, and those beside the eye are cut off
    inside = around("box", camera=Camera((0, 0, 0), (0, 1, 0)))
    assert 0 < len(inside) <= 12
    assert all(shape.behind for shape in inside)


def test_axes_have_round_numbers_and_units_outside_of_the_box() -> None:
    shapes = around("axes")
    found = words(shapes)
    assert {"x (mm)", "y (mm)", "z (mm)"} <= set(found)
    assert all(int(word) % 10 == 0 for word in found if not word.endswith(")"))
    middle = np.array(SIZE) / 2
    corners = Projection(CAMERA, SIZE).pixels(CORNERS)
    nearest = np.linalg.norm(corners - middle, axis=1).min()
    for text in shapes:
        if isinstance(text, Text) and text.words.endswith(")"):
            assert np.linalg.norm(np.array(text.place) - middle) > nearest


def test_a_colour_bar_counts_in_ones_twos_and_fives() -> None:
    shapes = around("bar")
    (ramp,) = [shape for shape in shapes if isinstance(shape, Ramp)]
    assert words(shapes) == ["-1000", "0", "1000", "2000", "HU"]
    top = next(shape for shape in shapes if isinstance(shape, Text) and shape.words == "2000")
    assert top.place[1] == pytest.approx(ramp.top)
    assert ramp.left + ramp.width < SIZE[0]


def test_a_scale_bar_is_as_long_as_it_says() -> None:
    camera = Camera((0, -100, 0), (0, 0, 0), parallel=True, parallel_scale=30.0)
    shapes = around("scale", camera=camera)
    (text,) = words(shapes)
    length = max(abs(line.points[1][0] - line.points[0][0]) for line in shapes if isinstance(line, Line))
    assert text == "10 mm"
    assert length == pytest.approx(10.0 / (60.0 / SIZE[1]))
    assert words(around("scale"))[0].endswith("mm in the middle")


def test_letters_and_marker_name_directions_of_a_patient() -> None:
    assert set(words(around("marker"))) == {"L", "P", "S"}
    plane = Subject(CORNERS, "mm", is_anatomical=True, facing=((0.0, 0.0, -1.0), (0.0, -1.0, 0.0)))
    camera = Camera((0, 0, -100), (0, 0, 0), view_up=(0, -1, 0), parallel=True, parallel_scale=30.0)
    assert words(around("marker", "letters", camera=camera, subject=plane)) == ["L", "R", "A", "P"]
    assert direction_words(np.array([0.8, -0.6, 0.0]), is_anatomical=True) == "LA"
    assert direction_words(np.array([0.0, 0.0, -1.0]), is_anatomical=False) == "−z"


def test_a_legend_names_what_there_is_and_counts_what_has_no_room() -> None:
    assert words(around("legend")) == ["Liver", "Spleen"]
    many = Subject(CORNERS, legend=tuple((f"Label {n}", (1.0, 1.0, 1.0)) for n in range(40)))
    assert words(around("legend", subject=many))[-1] == "and 25 more"


def test_what_cannot_be_shown_is_refused_in_words() -> None:
    assert PictureContents.of("box, bar").names == ("box", "bar")
    assert PictureContents.of(SWITCHES, "Title").title == "Title"
    with pytest.raises(InputError, match="cannot show 'boxes'; choose among box"):
        PictureContents.of(("boxes",))


def test_shapes_lie_behind_and_before_the_volume_and_tiles_make_the_whole() -> None:
    red, green = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    shapes = (
        Area(((2, 2), (20, 2), (20, 20), (2, 20)), red, behind=True),
        Area(((30, 2), (40, 2), (40, 20), (30, 20)), green),
        Text("ab", (5.0, 30.0), 10.0, red, green),
        Ramp(30.0, 25.0, 8.0, 10.0, (red, green)),
    )
    half = np.zeros((40, 50, 4), np.float32)
    half[:, :, 2:] = 0.5
    whole = surround(half, shapes)
    assert whole[10, 10] == pytest.approx([0.5, 0.0, 0.5, 1.0], abs=0.01)
    assert whole[10, 35] == pytest.approx([0.0, 1.0, 0.0, 1.0], abs=0.01)
    assert whole[27, 34, 1] == pytest.approx(1.0, abs=0.01)
    assert whole[33, 34, 0] == pytest.approx(1.0, abs=0.01)
    part = surround(half[5:35, 8:45], shapes, (8, 5))
    assert np.abs(part - whole[5:35, 8:45]).max() < 0.01
    assert moved(shapes[0], 3, 4).points[0] == (5, 6)


@pytest.mark.parametrize("suffix", [".svg", ".pdf", ".png"])
def test_words_stay_words_in_vector_files_and_the_same_picture_gives_the_same_file(
    suffix: str, tmp_path: Path
) -> None:
    picture = np.full((60, 80, 4), 200, np.uint8)
    shapes = around("bar", title="A head") if suffix != ".png" else ()
    for name in ("a", "b"):
        write_picture(tmp_path / f"{name}{suffix}", picture, shapes, (0.0, 0.0, 0.0), dpi=300.0)
    written = (tmp_path / f"a{suffix}").read_bytes()
    assert written == (tmp_path / f"b{suffix}").read_bytes()
    if suffix == ".svg":
        assert b"A head" in written
        assert b'width="19.2pt" height="14.4pt"' in written
    elif suffix == ".png":
        with Image.open(tmp_path / "a.png") as image:
            assert image.info["dpi"] == pytest.approx((300, 300), abs=0.1)
