"""Folders of images: their order, gaps, colours, and what does not fit together."""

from __future__ import annotations

import numpy as np
import pytest
import tifffile
from PIL import Image

import volviz
from tests.unit.io.writers import scalars
from volviz.errors import LoadError
from volviz.io import load

STACK = scalars((12, 6, 7), "uint8")


def images(folder, array=STACK, name="s_{}.png", numbers=None):
    folder.mkdir(exist_ok=True)
    for n, slice_ in zip(numbers or range(len(array)), array, strict=True):
        path = folder / name.format(n)
        if path.suffix == ".tif":
            tifffile.imwrite(path, slice_)
        else:
            Image.fromarray(slice_).save(path)
    return folder


def notes(volume):
    return " ".join(volume.metadata["notes"])


@pytest.mark.parametrize("name", ["s_{}.png", "s_{:04}.bmp", "slice{}.tif"])
def test_pictures_are_stacked_in_the_order_of_their_numbers(tmp_path, name):
    volume = load(images(tmp_path / "d", name=name))
    np.testing.assert_array_equal(volume.array, STACK)
    assert "do not say how far they lie apart" in notes(volume)
    assert load(tmp_path / "d", spacing=(1, 1, 3)).spacing == (1, 1, 3)


def test_sixteen_bits_are_kept(tmp_path):
    deep = scalars((5, 6, 7), "uint16")
    np.testing.assert_array_equal(load(images(tmp_path / "d", deep)).array, deep)


def test_one_picture_opens_those_beside_it(tmp_path):
    folder = images(tmp_path / "d")
    images(folder, STACK[:3], "other{}.png")
    volume = load(folder / "s_3.png")
    np.testing.assert_array_equal(volume.array, STACK)
    assert "one of 12 in its folder" in notes(volume)
    assert "3 pictures with names of another kind were left out" in notes(load(folder))


def test_missing_numbers_are_told(tmp_path):
    volume = load(images(tmp_path / "d", STACK[:5], numbers=[10, 20, 30, 50, 60]))
    assert "1 numbers between 10 and 60 have no picture" in notes(volume)


def test_colours_are_brightness_or_one_component(tmp_path):
    colours = scalars((4, 6, 7, 3), "uint8")
    folder = images(tmp_path / "d", colours)
    np.testing.assert_allclose(load(folder).array, colours @ np.array([0.2126, 0.7152, 0.0722]), atol=0.51)
    np.testing.assert_array_equal(load(folder, channel=1).array, colours[..., 1])


def test_a_box_reads_its_pictures_alone(tmp_path):
    folder = images(tmp_path / "d")
    source = volviz.open(folder)
    (folder / "s_11.png").write_bytes(b"\x89PNG\r\n\x1a\n")
    np.testing.assert_array_equal(source.read(box=(1, 5, 2, 6, 3, 8)).array, STACK[3:8, 2:6, 1:5])
    with pytest.raises(LoadError, match=r"^s_11\.png: this picture is damaged"):
        source.read()


def test_pictures_of_several_sizes_are_refused_in_words(tmp_path):
    folder = images(tmp_path / "d")
    Image.fromarray(np.zeros((9, 9), np.uint8)).save(folder / "s_7.png")
    with pytest.raises(LoadError, match=r"^s_7\.png: it is 9 x 9 pixels large where s_0\.png is 7 x 6"):
        load(folder)


def test_a_single_picture_is_no_volume(tmp_path):
    with pytest.raises(LoadError, match="a single picture, no volume"):
        load(images(tmp_path / "d", STACK[:1]) / "s_0.png")


def test_files_of_many_pages_are_no_slices(tmp_path):
    folder = tmp_path / "d"
    folder.mkdir()
    for n in range(3):
        tifffile.imwrite(folder / f"t{n}.tif", STACK)
    with pytest.raises(LoadError, match=r"t0\.tif: it holds several pictures"):
        load(folder)
