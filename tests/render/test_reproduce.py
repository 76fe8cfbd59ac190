"""Pictures that carry their session: drawn again they are equal to the bit."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import volviz
from tests.render.scenes import volume
from volviz.cli import main
from volviz.custom_gl.registry import techniques
from volviz.embedded_session import session_in
from volviz.scene_volumes import holds_scene, load_scene

OURS = [ident for ident, info in techniques().items() if not info.counterpart_of]


@pytest.fixture
def field(tmp_path: Path) -> Path:
    volviz.save(volume(), tmp_path / "field.nrrd")
    return tmp_path / "field.nrrd"


def render(field: Path, output: Path, *options: str) -> None:
    assert main(["render", str(field), "-o", str(output), "--size", "60x44", *options]) == 0


@pytest.mark.parametrize("technique", OURS)
def test_every_technique_is_drawn_again_to_the_bit(
    field: Path, tmp_path: Path, technique: str, capsys: pytest.CaptureFixture[str]
) -> None:
    picture, again = tmp_path / "a.png", tmp_path / "b.png"
    render(
        field,
        picture,
        "-t",
        technique,
        "--azimuth",
        "25",
        "--show",
        "box,bar,scale,marker",
        "--title",
        "A field",
    )
    assert main(["reproduce", str(picture), "-o", str(again)]) == 0
    assert "equal to a.png to the bit" in capsys.readouterr().out
    with Image.open(picture) as one, Image.open(again) as other:
        np.testing.assert_array_equal(np.asarray(one), np.asarray(other))


@pytest.mark.parametrize(
    "options",
    [
        ("--plane", "coronal", "--at", "1", "--show", "letters,bar,scale"),
        ("--background", "none", "--preset", "fire"),
        (
            "--set",
            "crop=2,9,2,9,2,9",
            "--set",
            "clip_planes=0,0,0,1,0,0",
            "--parallel",
            "--background",
            "white",
        ),
        (
            "--channel",
            "0:green",
        ),
    ],
)
def test_slices_cuts_transparency_and_layers_are_kept(
    field: Path, tmp_path: Path, options: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    render(field, tmp_path / "a.tif", *options)
    assert main(["reproduce", str(tmp_path / "a.tif"), "-o", str(tmp_path / "b.png")]) == 0
    assert "to the bit" in capsys.readouterr().out


def test_a_level_and_a_box_of_a_file_are_drawn_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    array = np.arange(6 * 300 * 300, dtype=np.uint32).reshape(6, 300, 300) % 251
    store = tmp_path / "levels.ome.zarr"
    volviz.save(volviz.Volume(array.astype(np.uint8)), store)
    assert len(volviz.open(store).levels) > 1
    for number, part in enumerate((("--level", "1"), ("--box", "10,140,8,150,0,5"))):
        render(store, tmp_path / f"{number}.png", *part)
        assert (
            main(["reproduce", str(tmp_path / f"{number}.png"), "-o", str(tmp_path / f"again{number}.png")])
            == 0
        )
        assert "to the bit" in capsys.readouterr().out


def test_the_session_of_a_picture_of_many_pixels_is_read(
    field: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("a.png", "a.tif"):
        render(field, tmp_path / name)
        monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 10)
        assert session_in(tmp_path / name) is not None
        monkeypatch.undo()
    (tmp_path / "b.png").write_bytes(b"no picture")
    (tmp_path / "b.tif").write_bytes(b"II*\0 no picture either")
    assert session_in(tmp_path / "b.png") is None
    assert session_in(tmp_path / "b.tif") is None


def test_a_volume_that_has_moved_is_named_and_one_that_has_changed_is_told(
    field: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    render(field, tmp_path / "a.png")
    moved = tmp_path / "elsewhere" / "moved.nrrd"
    moved.parent.mkdir()
    field.rename(moved)
    assert main(["reproduce", str(tmp_path / "a.png"), "-o", str(tmp_path / "b.png")]) == 2
    assert "field.nrrd" in capsys.readouterr().err
    assert (
        main(["reproduce", str(tmp_path / "a.png"), "-o", str(tmp_path / "b.png"), "--volume", str(moved)])
        == 0
    )
    assert "to the bit" in capsys.readouterr().out
    other = volume()
    volviz.save(volviz.Volume(other.array[::-1].copy(), spacing=other.spacing, origin=other.origin), field)
    assert main(["reproduce", str(tmp_path / "a.png"), "-o", str(tmp_path / "c.png")]) == 0
    said = capsys.readouterr().out
    assert "differs from a.png" in said
    assert "has changed since" in said


def test_a_picture_says_nothing_where_that_is_switched_off(
    field: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    render(field, tmp_path / "a.png", "--no-session")
    assert session_in(tmp_path / "a.png") is None
    assert not holds_scene(tmp_path / "a.png")
    assert main(["reproduce", str(tmp_path / "a.png"), "-o", str(tmp_path / "b.png")]) == 2
    assert "does not say how it was made" in capsys.readouterr().err
    assert main(["reproduce", str(tmp_path / "none.png"), "-o", str(tmp_path / "b.png")]) == 2
    assert "no such file" in capsys.readouterr().err


def test_nothing_of_headers_is_in_a_picture(tmp_path: Path) -> None:
    of = volume()
    secret = volviz.Volume(of.array, spacing=of.spacing, name="scan", metadata={"patient_name": "Roe^Jane"})
    volviz.save(secret, tmp_path / "field.nrrd")
    render(tmp_path / "field.nrrd", tmp_path / "a.png")
    text = json.dumps(session_in(tmp_path / "a.png"))
    assert "Roe" not in text
    assert load_scene(tmp_path / "a.png").layers[0].key.ref.source == str(tmp_path / "field.nrrd")
