"""``volviz render`` with several channels and files in one picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile

import volviz
from tests.render.scenes import blobs
from volviz import ImageLayer
from volviz.cli import main
from volviz.model.layer_looks import CHANNEL_COLORS, channel_function, named_look


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a stack of two channels and another volume."""
    channels = np.stack([blobs((9, 20, 22), seed=n) for n in range(2)], axis=1)
    tifffile.imwrite(tmp_path / "cells.tif", channels, imagej=True, metadata={"axes": "ZCYX"})
    np.save(tmp_path / "other.npy", blobs((12, 14, 13), seed=5))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def drawn(*arguments: str) -> Any:
    """The picture that the command writes."""
    assert main(["render", *arguments, "--size", "48x40", "-o", "out.npy"]) == 0
    return np.load("out.npy")


def expected(*layers: Any) -> Any:
    return volviz.render(layers, size=(48, 40), background="black", dtype="float32")


def test_a_vector_file_keeps_title_and_numbers(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    common = ["other.npy", "--size", "120x90", "--show", "bar, scale", "--title", "Blobs", "--methods"]
    assert main(["render", *common, "-o", "out.svg"]) == 0
    assert "Blobs" in (files / "out.svg").read_text(encoding="utf-8")
    assert "Rendered with VolViz" in capsys.readouterr().out
    assert main(["render", *common, "-o", "out.png", "--dpi", "300"]) == 0
    assert main(["render", "other.npy", "--show", "frame", "-o", "out.png"]) == 2
    assert "cannot show 'frame'" in capsys.readouterr().err


def layer(channel: int, look: str = "") -> ImageLayer:
    source = volviz.open("cells.tif")
    volume = source.read(channel=channel)
    function = named_look(look, volume) if look else channel_function(volume, CHANNEL_COLORS[channel])
    return ImageLayer(source, function, channel=channel)


def test_channels_and_files_become_layers(files: Path) -> None:
    both = drawn("cells.tif", "--channel", "0:green", "--channel", "1:magenta")
    np.testing.assert_array_equal(both, expected(layer(0, "green"), layer(1, "magenta")))
    usual = drawn("cells.tif", "--channel", "0", "--channel", "1")
    np.testing.assert_array_equal(usual, expected(layer(0), layer(1)))
    other = volviz.load("other.npy")
    more = drawn("cells.tif", "--channel", "1:viridis", "--layer", "other.npy:hot", "--layer", "./other.npy")
    np.testing.assert_array_equal(
        more, expected(layer(1, "viridis"), ImageLayer(other, named_look("hot", other)), ImageLayer(other))
    )
    assert not np.array_equal(both, usual)


def test_files_of_labels_become_surfaces(files: Path) -> None:
    np.save("seg.npy", (blobs((12, 14, 13), seed=5) > 100).astype(np.uint8) * 4)
    seen = drawn("other.npy", "--layer", "seg.npy:labels")
    other, labels = volviz.load("other.npy"), volviz.load("seg.npy")
    np.testing.assert_array_equal(seen, expected(ImageLayer(other), volviz.LabelLayer(labels)))


def test_layers_that_move_are_drawn_at_one_time_point(files: Path) -> None:
    moving = np.stack([blobs((9, 10, 11), seed=n) for n in range(3)])
    np.save("moving.npy", moving)
    np.save("also.npy", moving[::-1])
    seen = drawn("moving.npy", "--time", "2", "--layer", "also.npy", "--layer", "other.npy:hot")
    other = volviz.load("other.npy")
    layers = [ImageLayer(volviz.load(name, time=2)) for name in ("moving.npy", "also.npy")]
    np.testing.assert_array_equal(seen, expected(*layers, ImageLayer(other, named_look("hot", other))))
    assert main(["render", "moving.npy", "--time", "3", "--layer", "other.npy", "-o", "out.npy"]) == 2


def test_one_channel_without_a_look_is_the_volume_that_is_read(files: Path) -> None:
    one = drawn("cells.tif", "--channel", "1")
    of = volviz.load("cells.tif", channel=1)
    np.testing.assert_array_equal(one, volviz.render(of, size=(48, 40), background="black", dtype="float32"))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--channel", "x:red"], "no channel is called 'x'"),
        (["--channel", ":red"], "--channel takes a number from 0"),
        (["--channel", "0:nocolour"], "no preset, colour or colour map called 'nocolour'"),
        (["--channel", "0", "--channel", "7"], "channel"),
        (["--layer", "missing.nii"], "missing.nii"),
        (["--layer", "other.npy", "-t", "splatting"], "Splatting draws one layer and 2 are visible"),
        (["--layer", "other.npy", "--plane", "axial"], "go with neither"),
    ],
)
def test_what_cannot_be_drawn_is_said(
    files: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    assert main(["render", "cells.tif", *arguments, "-o", "out.npy"]) == 2
    assert words in capsys.readouterr().err
