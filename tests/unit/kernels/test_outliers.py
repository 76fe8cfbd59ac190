"""Numbers that stand for "no data", and hot voxels: what is found, and what a first function makes of it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

import volviz
from volviz.kernels.outliers import no_data_of


def ball(n: int = 24) -> npt.NDArray[np.float64]:
    z, y, x = np.mgrid[-1 : 1 : n * 1j, -1 : 1 : n * 1j, -1 : 1 : n * 1j]
    return np.asarray(np.clip(1 - np.sqrt(x * x + y * y + z * z), 0, 1))


def with_corner(array: npt.NDArray[np.float64], value: float, dtype: str) -> volviz.Volume:
    filled = array.astype(dtype)
    filled[:4] = value
    return volviz.Volume(filled)


@pytest.mark.parametrize(
    ("value", "scale", "dtype"),
    [
        (-9999.0, 100.0, "float32"), (1e20, 1.0, "float32"), (-1e30, 1.0, "float64"), (65535, 4000.0, "uint16"),
        (-32768, 3000.0, "int16"), (2**31 - 1, 1e4, "int32"), (9.96921e36, 1.0, "float32"),
    ],
)  # fmt: skip
def test_usual_numbers_for_no_data_are_found(value: float, scale: float, dtype: str) -> None:
    volume = with_corner(ball() * scale, value, dtype)
    assert volume.no_data == (float(np.dtype(dtype).type(value)),)
    assert volume.data_range == pytest.approx((0.0, float((ball() * scale).astype(dtype).max())))
    assert no_data_of(volume.array).share == pytest.approx(4 / 24)


@pytest.mark.parametrize(
    "array",
    [
        np.where(ball() > 0.4, 65535, 0).astype(np.uint16),  # a mask
        np.clip(ball() * 1e5, 0, 65535).astype(np.uint16),  # saturated, but not apart
        np.where(ball() > 0.4, 1.0, ball() * 1e-4),  # one material, and noise
        (ball() * 255).astype(np.uint8),
        (ball() * 2e9).astype(np.float32),
    ],
)
def test_other_extremes_are_data(array: npt.NDArray[np.float64]) -> None:
    assert volviz.Volume(array).no_data == ()


def test_two_numbers_for_no_data_are_both_found() -> None:
    array = ball().astype(np.float32)
    array[:3], array[-3:] = -9999.0, 1e20
    assert volviz.Volume(array).no_data == (-9999.0, float(np.float32(1e20)))


@pytest.mark.parametrize("value", [-9999.0, 1e20])
def test_no_data_is_left_out_of_the_first_function(value: float) -> None:
    volume = with_corner(ball() * 100, value, "float32")
    function = volviz.TransferFunction.auto(volume)
    assert function.evaluate([value])[0, 3] == 0
    # the data are seen as they are without those voxels
    plain = volviz.TransferFunction.auto(volviz.Volume(np.where(volume.array == value, 0, volume.array)))
    values = np.linspace(0, float(volume.data_range[1]), 50)
    assert np.allclose(function.evaluate(values), plain.evaluate(values), atol=0.02)


def test_a_source_says_what_stands_for_no_data(tmp_path: object) -> None:
    array = ball().astype(np.float32)
    array[:3] = -9999.0
    path = f"{tmp_path}/filled.npy"
    np.save(path, array)
    (note,) = volviz.load(path).metadata["notes"]
    assert (
        note
        == '-9999 stands for "no data", it seems (about 12% of the voxels); the first look leaves it out.'
    )


@pytest.mark.parametrize("hot", [1e6, -1e6, 1e30])
def test_a_hot_voxel_leaves_the_range_of_the_bulk(hot: float) -> None:
    array = ball().astype(np.float32)
    array[1, 1, 1] = hot
    low, high = volviz.Volume(array).bulk_range
    assert low == 0.0
    assert 0.5 < high <= 1.0
    assert volviz.Volume(ball()).bulk_range == volviz.Volume(ball()).range
