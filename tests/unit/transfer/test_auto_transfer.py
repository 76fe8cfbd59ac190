"""The first image of any data set is neither empty nor solid."""

from __future__ import annotations

import gzip

import numpy as np
import pytest
import SimpleITK

from tests.unit.transfer.images import image
from tests.unit.transfer.unseen import FEATURELESS, UNSEEN
from volviz.model.transfer.automatic import RAMP, auto_transfer_function
from volviz.model.transfer.first_look import robust_range
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.volume import Volume

LEAST, MOST = 0.05, 0.9


def judge(volume: Volume, azimuth: float, elevation: float) -> tuple[float, float]:
    """Mean alpha inside the box, and how much brightness varies there."""
    pixels, inside = image(volume, auto_transfer_function(volume), azimuth, elevation)
    return float(pixels[inside][:, 3].mean()), float(pixels[inside][:, :3].mean(axis=1).std())


@pytest.mark.parametrize("name", [*UNSEEN, *FEATURELESS])
def test_the_first_picture_is_neither_empty_nor_solid(name: str) -> None:
    volume = {**UNSEEN, **FEATURELESS}[name]()
    for azimuth, elevation in ((30.0, 20.0), (1.0, 1.0), (-120.0, 45.0)):
        alpha, contrast = judge(volume, azimuth, elevation)
        assert LEAST < alpha < MOST
        if name in UNSEEN:
            assert contrast > 0.02


REAL = ["engine.nii.gz", "bonsai.nii.gz", "3DCT_lung.mha", "FLAIR.nrrd", "hydrogenAtom.mha", "nucleon.mha"]


@pytest.mark.parametrize("name", REAL)
def test_real_volumes_give_a_first_picture_with_structure(name: str, shared_data) -> None:
    pixels = SimpleITK.ReadImage(str(shared_data / name))
    alpha, contrast = judge(Volume(SimpleITK.GetArrayFromImage(pixels), pixels.GetSpacing()), 30.0, 20.0)
    assert 0.1 < alpha < 0.8
    assert contrast > 0.1


RAW = {"walnut.raw": ("<u2", (114, 96, 128)), "tooth.raw": (">u2", (161, 94, 103))}


@pytest.mark.parametrize("name", [*RAW, "male_128x256x256_uint8.raw.gz"])
def test_raw_volumes_give_a_first_picture_with_structure(name: str, shared_data) -> None:
    dtype, shape = RAW.get(name, ("u1", (256, 256, 128)))
    data = (shared_data / "raw" / name).read_bytes()
    data = gzip.decompress(data) if name.endswith(".gz") else data
    array = np.frombuffer(data, dtype)[-int(np.prod(shape)) :].reshape(shape)
    alpha, contrast = judge(Volume(array), 30.0, 20.0)
    assert 0.1 < alpha < 0.8
    assert contrast > 0.1


def test_the_air_of_ct_is_invisible_and_bone_is_the_densest() -> None:
    function = auto_transfer_function(UNSEEN["ct"]())
    air, soft, bone = function.evaluate([-1000.0, 40.0, 900.0])[:, 3]
    assert air == 0.0
    assert 0.0 < soft < bone


def test_a_dark_object_in_a_bright_surrounding_is_seen_and_the_surrounding_is_not() -> None:
    dark, bright = auto_transfer_function(UNSEEN["bright background"]()).evaluate([60.0, 240.0])[:, 3]
    assert bright == 0.0
    assert dark > 0.01


def test_two_materials_that_fill_the_box_are_told_apart() -> None:
    thin, dense = auto_transfer_function(UNSEEN["two phases"]()).evaluate([120.0, 160.0])[:, 3]
    assert dense > 0.01
    assert thin < 0.1 * dense


def test_labels_get_flat_pieces_with_the_background_left_out() -> None:
    function = auto_transfer_function(UNSEEN["labels"]())
    colors = function.evaluate([0, 1, 2, 7, 30])
    assert colors[0, 3] == 0
    assert (colors[1:, 3] > 0).all()
    assert len(np.unique(colors[1:, :3].round(3), axis=0)) == 4
    np.testing.assert_allclose(function.evaluate([6.7, 7.3]), np.tile(colors[3], (2, 1)))


def test_the_same_data_in_other_units_look_the_same() -> None:
    volume = UNSEEN["mri with bright noise"]()
    scaled = Volume(volume.array * 1000.0 + 5.0, volume.spacing)
    first, second = auto_transfer_function(volume), auto_transfer_function(scaled)
    np.testing.assert_allclose(
        [p.value * 1000.0 + 5.0 for p in first.points], [p.value for p in second.points], rtol=1e-3
    )
    np.testing.assert_allclose(
        [p.opacity for p in first.points], [p.opacity for p in second.points], rtol=0.05
    )


def test_the_ramp_rises_in_lightness_all_the_way() -> None:
    luminance = np.array(RAMP) @ (0.2126, 0.7152, 0.0722)
    assert (np.diff(luminance) > 0.03).all()


def test_outliers_do_not_widen_the_robust_range() -> None:
    low, high = robust_range(UNSEEN["outliers"]())
    assert 0.0 <= low < high <= 1.0


def test_the_automatic_function_of_a_large_volume_is_timed(benchmark) -> None:
    volume = Volume(np.random.default_rng(1).integers(0, 255, (256, 256, 256), np.uint8))
    volume.range  # noqa: B018 - computed once, when the data are opened
    function = benchmark(lambda: TransferFunction.auto(volume))
    assert function.name == "auto"
