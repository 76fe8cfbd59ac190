"""Guesses at what a raw file holds, and the slices by which they are judged."""

import gzip

import numpy as np
import pytest

from tests.unit.io.writers import scalars
from volviz.io.raw_guesses import RawGuess, guesses, middle_slices, raw_bytes, sizes_from_name


def smooth(shape, dtype, noise=4.0):
    """Blobs with noise."""
    rng = np.random.default_rng(2)
    z, y, x = np.meshgrid(*(np.linspace(-1, 1, n) for n in shape), indexing="ij", sparse=True)
    field = np.zeros(shape)
    for middle, width in zip(rng.uniform(-0.8, 0.8, (12, 3)), rng.uniform(0.15, 0.4, 12), strict=True):
        distance = (x - middle[0]) ** 2 + (y - middle[1]) ** 2 + (z - middle[2]) ** 2
        field += np.exp(-distance / width**2)
    field = field / field.max() * 200 + rng.normal(0, noise, shape) + 20
    if np.dtype(dtype).kind == "i":
        field = 20 * field - 1500
    return np.clip(field, *((0, 255) if np.dtype(dtype) == np.uint8 else (-2000, 4000))).astype(dtype)


def best(name, array, header=0):
    data = np.frombuffer(bytes(header) + array.tobytes(), np.uint8)
    return guesses(name, data)[0]


@pytest.mark.parametrize(
    ("shape", "stored", "header"),
    [
        ((40, 48, 56), "u1", 0),
        ((30, 64, 64), "<i2", 352),
        ((61, 57, 45), ">i2", 0),
        ((40, 48, 56), "<u2", 0),
        ((61, 57, 45), "<f4", 512),
        ((30, 64, 64), ">f4", 0),
    ],
)
def test_shape_type_order_and_header_are_found_without_a_word(shape, stored, header):
    found = best("scan.raw", smooth(shape, stored), header)
    assert (found.dims, found.stored, found.header) == (shape[::-1], np.dtype(stored), header)


def test_a_name_that_says_it_comes_first_and_a_rest_is_taken_for_a_header():
    array = scalars((6, 7, 8), "uint16")
    found = best("a_8_7_6_uint16.bin", array)
    assert (found.dims, found.dtype, found.header) == ((8, 7, 6), "uint16", 0)
    found = best("a_56x48x40.raw", smooth((40, 48, 56), "uint8"), 77)
    assert (found.dims, found.dtype, found.header) == ((56, 48, 40), "uint8", 77)
    assert sizes_from_name("2021_head.raw") is None


def test_nothing_is_guessed_of_noise_and_of_what_is_too_short():
    noise = np.random.default_rng(3).integers(0, 256, 40_000, dtype=np.uint8)
    assert guesses("a.raw", noise) == []
    assert guesses("a.raw", noise[:5]) == []
    assert guesses("a.raw", np.zeros(4096, np.uint8)) == []


def test_packed_files_are_unpacked_and_damaged_ones_said(tmp_path):
    array = smooth((20, 24, 28), "uint8")
    path = tmp_path / "v.raw.gz"
    path.write_bytes(gzip.compress(array.tobytes()))
    np.testing.assert_array_equal(raw_bytes(path), array.ravel())
    path.write_bytes(path.read_bytes()[:-30])
    with pytest.raises(OSError, match="ended"):
        raw_bytes(path)


def test_slices_are_those_through_the_middle():
    array = smooth((9, 11, 13), "<i2", noise=0)
    data = np.frombuffer(b"abc" + array.tobytes(), np.uint8)
    pictures = middle_slices(data, RawGuess((13, 11, 9), "int16", header=3))
    expected = array[4], array[:, 5], array[:, :, 6]
    for picture, plane in zip(pictures, expected, strict=True):
        assert picture.shape == plane.shape
        assert np.corrcoef(picture.ravel(), plane.ravel())[0, 1] > 0.99
    assert [p.shape for p in middle_slices(data, RawGuess((13, 11, 9), "int16"), side=5)] == [
        (4, 5),
        (5, 5),
        (5, 4),
    ]
    assert middle_slices(data, RawGuess((13, 11, 10), "int16")) is None
