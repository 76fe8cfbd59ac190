"""Coarser levels of the scalars: mipmaps, volumes that do not fit, and what is read while something moves."""

from __future__ import annotations

import numpy as np
import pytest

import volviz
from tests.render.scenes import blobs, camera, function, image, psnr, volume
from volviz.custom_gl.vtk.vtk_imports import pyvista
from volviz.volume_data.scalars import TextureData, coarser, levels_of, reduction


def test_a_coarser_level_holds_means_of_blocks() -> None:
    random = np.random.default_rng(1)
    data = random.random((6, 5, 7), dtype=np.float32)
    level = coarser(TextureData(data, 1.0, 0.0))
    assert level.data.shape == (3, 3, 4)
    assert level.factor == (2, 2, 2)
    assert level.data[0, 0, 0] == pytest.approx(data[:2, :2, :2].mean(), rel=1e-5)
    # at an odd end the last texel counts twice, as if the edge were repeated
    assert level.data[2, 2, 3] == pytest.approx(data[4:6, 4, 6].mean(), rel=1e-5)


def test_levels_lie_where_the_voxels_lie() -> None:
    of = volume()
    for texels in levels_of(of, "f4", 2048, 2**30):
        scale, offset = texels.index_to_texture
        count = np.array(texels.data.shape[::-1])
        # the first block covers the voxels -0.5 .. factor - 0.5, its middle is the first texel's centre
        middle = (np.array(texels.factor) - 1) / 2
        assert np.allclose(middle * scale + offset, 0.5 / count)


def test_a_volume_that_does_not_fit_is_reduced_along_its_longest_axes() -> None:
    assert reduction((64, 64, 64), "f4", 2048, 2**30) == (1, 1, 1)
    assert reduction((64, 64, 4096), "f4", 2048, 2**30) == (2, 1, 1)
    fx, fy, fz = reduction((512, 512, 512), "u2", 2048, 2**24)
    assert 2 * (512 / fx) * (512 / fy) * (512 / fz) <= 2**24


def test_a_reduced_volume_is_drawn_in_the_same_place(monkeypatch: pytest.MonkeyPatch) -> None:
    of = volviz.Volume(blobs((120, 128, 140), np.float32))
    view, transfer = camera(of), function(of)
    size = (100, 100)
    full = image(of, transfer, view, size=size)
    # 120 x 128 x 140 floats are 8.2 MB
    monkeypatch.setenv("VOLVIZ_TEXTURE_MB", "2")
    again = volviz.Volume(of.array)
    reduced = image(again, transfer, view, size=size)
    shifted = [
        psnr(full[8:-8, 8:-8], np.roll(reduced, move, axis=(0, 1))[8:-8, 8:-8])
        for move in ((0, 0), (0, 1), (0, -1), (1, 0), (-1, 0))
    ]
    assert shifted[0] > 40
    assert shifted[0] == max(shifted)


def test_mipmaps_calm_a_volume_seen_from_afar() -> None:
    random = np.random.default_rng(5)
    of = volviz.Volume(random.random((96, 96, 96), dtype=np.float32))
    transfer = volviz.TransferFunction.from_points([(0.0, (0, 0, 0, 0.2)), (1.0, (1, 1, 1, 0.2))])
    view = camera(of)
    size = (24, 24)
    sharp = image(of, transfer, view, size=(192, 192)).reshape(24, 8, 24, 8, 4).mean(axis=(1, 3))
    inner = sharp[..., 3] > 0.97
    assert inner.sum() > 40
    without, with_mipmaps = (
        np.abs(image(of, transfer, view, size=size, mipmaps=on) - sharp)[inner].mean() for on in (False, True)
    )
    assert with_mipmaps < 0.6 * without


def test_a_reduced_volume_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VOLVIZ_TEXTURE_MB", "1")
    of = volviz.Volume(blobs((120, 120, 120), np.float32))
    window = pyvista.Plotter(off_screen=True, window_size=(64, 64))
    # a technique that does not draw bricks
    handle = volviz.add_volume(window, of, technique="half_angle", transfer_function=function(of))
    window.show(auto_close=False, interactive=False)
    notice = handle.notice
    handle.remove()
    window.close()
    assert "2 x 2 x 2" in notice
