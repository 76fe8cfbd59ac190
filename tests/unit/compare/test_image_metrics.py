"""Figures of pairs of images: equal to scikit-image's, zero for an image against itself."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

from volviz.compare.image_metrics import (
    CHANNELS,
    KINDS,
    as_float,
    color_table,
    compare_images,
    difference_image,
    image_shift,
    luminance,
    psnr,
    similarity_image,
    ssim,
    ssim_map,
)
from volviz.errors import InputError


def images(shape: tuple[int, ...] = (40, 53, 3), noise: int = 20) -> tuple[Any, Any]:
    random = np.random.default_rng(11)
    y, x = np.mgrid[0 : shape[0], 0 : shape[1]]
    smooth = 120 + 80 * np.sin(x / 7.0) * np.cos(y / 5.0)
    first = np.broadcast_to(smooth[..., None] if len(shape) == 3 else smooth, shape)
    second = first + random.normal(0, noise, shape)
    return tuple(np.clip(np.rint(p), 0, 255).astype(np.uint8) for p in (first, second))


@pytest.mark.parametrize("shape", [(40, 53, 3), (31, 29)])
def test_psnr_is_that_of_scikit_image(shape: tuple[int, ...]) -> None:
    a, b = images(shape)
    assert psnr(a, b) == pytest.approx(peak_signal_noise_ratio(a, b, data_range=255), abs=1e-9)


@pytest.mark.parametrize("shape", [(40, 53, 3), (31, 29), (7, 7, 3)])
def test_ssim_is_that_of_scikit_image_with_its_defaults(shape: tuple[int, ...]) -> None:
    a, b = images(shape)
    axis = -1 if len(shape) == 3 else None
    mean, full = structural_similarity(a, b, data_range=255, channel_axis=axis, full=True)
    assert ssim(a, b) == pytest.approx(mean, abs=1e-9)
    np.testing.assert_allclose(ssim_map(a, b), full.mean(axis=-1) if axis else full, atol=1e-9)


def test_gaussian_ssim_is_that_of_scikit_image_as_wang_defines_it() -> None:
    a, b = images()
    mean, full = structural_similarity(
        a, b, data_range=255, channel_axis=-1, full=True, gaussian_weights=True, use_sample_covariance=False
    )
    assert ssim(a, b, gaussian=True) == pytest.approx(mean, abs=1e-9)
    np.testing.assert_allclose(ssim_map(a, b, gaussian=True), full.mean(axis=-1), atol=1e-9)


def test_all_figures_come_from_the_same_differences() -> None:
    a, b = images()
    found = compare_images(a, b)
    difference = np.abs(a.astype(float) - b)
    column, row = found.max_position
    assert found.psnr == pytest.approx(psnr(a, b))
    assert found.ssim == pytest.approx(ssim(a, b))
    assert found.mean_difference == pytest.approx(difference.mean())
    assert found.max_difference == pytest.approx(difference.max())
    assert difference[row, column].max() == difference.max()
    assert found.rms_difference == pytest.approx(math.sqrt((difference**2).mean()))
    assert found.visible_share == pytest.approx((difference.max(axis=2) > 2).mean())


def test_a_picture_against_itself_differs_by_nothing() -> None:
    a, _ = images()
    found = compare_images(a, a)
    assert (found.psnr, found.ssim) == (math.inf, pytest.approx(1.0))
    assert (found.mean_difference, found.max_difference, found.visible_share) == (0.0, 0.0, 0.0)
    assert not difference_image(a, a).values.any()
    assert not difference_image(a, a, channel="rgb").image.any()


def test_bytes_floats_and_alpha_give_the_same_figures() -> None:
    a, b = images()
    alpha = np.random.default_rng(2).integers(0, 256, (*a.shape[:2], 1), np.uint8)
    with_alpha = compare_images(np.concatenate([a, alpha], axis=2), np.concatenate([b, 255 - alpha], axis=2))
    floats = compare_images(a / 255.0, b / 255.0)
    assert with_alpha == compare_images(a, b)
    assert floats.psnr == pytest.approx(with_alpha.psnr)
    assert floats.ssim == pytest.approx(with_alpha.ssim)


def test_a_signed_difference_is_second_minus_first_and_pale_at_zero() -> None:
    a = np.full((8, 9, 3), 100, np.uint8)
    b = a.copy()
    b[2, 3], b[5, 6] = 140, 60
    shown = difference_image(a, b, kind="signed", limit=40)
    table = color_table("signed")
    assert shown.values[2, 3] == pytest.approx(40)
    assert shown.values[5, 6] == pytest.approx(-40)
    assert (shown.image[2, 3] == table[-1]).all()
    assert (shown.image[5, 6] == table[0]).all()
    assert shown.image[0, 0].min() > 200


def test_channels_of_a_difference_are_kept_apart() -> None:
    a = np.zeros((8, 8, 3), np.uint8)
    b = a.copy()
    b[..., 1] = 51
    assert difference_image(a, b, channel="green").values.max() == pytest.approx(51)
    assert not difference_image(a, b, channel="red").values.any()
    assert difference_image(a, b).values.max() == pytest.approx(0.7152 * 51)
    as_colors = difference_image(a, b, channel="rgb")
    assert as_colors.limit == pytest.approx(51)
    assert (as_colors.image == (0, 255, 0)).all()


def test_the_scale_of_a_difference_is_at_least_a_level() -> None:
    a = np.zeros((8, 8, 3))
    assert difference_image(a, a + 1e-4).limit == 1.0
    assert difference_image(a, a + 0.5).limit == pytest.approx(127.5)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("channel", CHANNELS)
def test_every_difference_of_grey_pictures_can_be_drawn(kind: Any, channel: Any) -> None:
    a, b = images((12, 10))
    shown = difference_image(a, b, kind=kind, channel=channel)
    assert shown.image.shape == (12, 10, 3)
    assert shown.image.dtype == np.uint8


def test_similarity_is_drawn_white_where_pictures_agree() -> None:
    drawn = similarity_image(np.array([[1.0, 0.0], [-0.5, 0.5]]))
    assert drawn[..., 0].tolist() == [[255, 0], [0, 128]]


@pytest.mark.parametrize("shift", [(0.3, -0.2), (-0.5, 0.0), (0.0, 0.0)])
def test_a_shift_below_a_pixel_is_found(shift: tuple[float, float]) -> None:
    y, x = np.mgrid[0:60, 0:80].astype(float)

    def image(right: float, down: float) -> npt.NDArray[Any]:
        blobs = [(30, 25, 9.0), (55, 35, 7.0), (20, 45, 6.0)]
        grey = sum(np.exp(-((x - right - i) ** 2 + (y - down - j) ** 2) / s**2) for i, j, s in blobs)
        return np.repeat(np.asarray(grey)[..., None] / 2, 3, axis=-1)

    first, second = image(0.0, 0.0), image(*shift)
    assert image_shift(first, second) == pytest.approx(shift, abs=0.01)
    assert image_shift(second, first) == pytest.approx([-s for s in shift], abs=0.01)
    assert compare_images(first, second).shift == image_shift(first, second)


def test_plain_pictures_have_no_shift() -> None:
    grey = np.full((9, 9, 3), 0.5)
    assert image_shift(grey, grey + 0.1) == (0.0, 0.0)
    stripes = np.repeat(np.linspace(0, 1, 9)[None, :, None], 9, axis=0)
    assert image_shift(stripes, stripes) == (0.0, 0.0)


def test_luminance_of_white_is_one() -> None:
    assert luminance(np.full((2, 2, 3), 255, np.uint8)) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (np.zeros((8, 8, 3)), np.zeros((8, 9, 3))),
        (np.zeros((8, 8)), np.zeros((8, 8, 3))),
        (np.zeros((8, 8, 2)), np.zeros((8, 8, 2))),
        (np.zeros((0, 8, 3)), np.zeros((0, 8, 3))),
        (np.zeros((8, 8, 3), np.int32), np.zeros((8, 8, 3), np.int32)),
        (np.zeros((6, 8, 3)), np.zeros((6, 8, 3))),
    ],
)
def test_pictures_that_cannot_be_compared_are_refused_in_a_sentence(
    first: npt.NDArray[Any], second: npt.NDArray[Any]
) -> None:
    with pytest.raises(InputError, match=r"^[^\n]+\.$"):
        compare_images(first, second)


@pytest.mark.parametrize(
    "arguments", [{"kind": "relative"}, {"channel": "alpha"}, {"limit": 0.0}, {"limit": math.nan}]
)
def test_odd_wishes_for_a_difference_are_refused(arguments: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        difference_image(np.zeros((8, 8, 3)), np.zeros((8, 8, 3)), **arguments)


def test_as_float_leaves_the_picture_alone() -> None:
    image = np.full((4, 4, 4), 128, np.uint8)
    as_float(image)[:] = 0
    assert (image == 128).all()
