"""The bundled samples and the generators."""

from __future__ import annotations

import numpy as np
import pytest

from volviz.data_files import data_file
from volviz.errors import Cancelled, InputError
from volviz.io import generate, info, load
from volviz.io.samples import default_sample, samples


@pytest.mark.parametrize("item", samples(), ids=lambda item: item.id)
def test_every_sample_opens_and_says_what_it_is(item):
    told: list[float] = []
    volume = load(f"sample:{item.id}", progress=lambda fraction, _: told.append(fraction))
    assert volume.name == item.label
    assert volume.metadata["source"] == f"sample:{item.id}"
    assert min(volume.dimensions) >= 40
    low, high = volume.range
    assert low < high
    assert told[-1] == 1
    assert told == sorted(told)
    for words in (item.label, item.description, item.licence, item.source, item.modality):
        assert words


def test_the_first_sample_is_a_real_one():
    assert default_sample() is samples()[0]
    assert default_sample().file is not None


def test_presets_that_samples_suggest_exist():
    for item in samples():
        if item.preset is not None:
            data_file("presets", f"{item.preset}.json")


def test_bundled_volumes_are_small_and_their_origin_is_written_down():
    readme = data_file("README.md").read_text()
    total = 0
    for item in samples():
        if item.file is not None:
            total += data_file(*item.file.split("/")).stat().st_size
            assert item.file in readme
    assert total < 9_000_000
    for name in ("mni.txt", "pyradiomics.txt", "mricron-data.txt"):
        assert "Copyright" in data_file("licenses", name).read_text()
        assert name in readme


def test_the_chest_is_in_hounsfield_units_with_lungs_of_air():
    volume = load("sample:ct-chest")
    assert volume.unit == "HU"
    values, counts = np.unique(volume.array // 50 * 50, return_counts=True)
    around = dict(zip(values.tolist(), counts.tolist(), strict=True))
    # two peaks: lung and room air below -700, soft tissue around 0 to 100
    assert sum(n for v, n in around.items() if -1050 <= v < -700) > 0.2 * volume.array.size
    assert sum(n for v, n in around.items() if -150 <= v < 100) > 0.2 * volume.array.size


def test_heads_look_to_the_front():
    """In LPS, y grows to the back: low slices hold the cerebellum there, and nothing in front."""
    volume = load("sample:mri-brain")
    _, y, x = (n // 2 for n in volume.array.shape)
    low = volume.array[30:50, :, x - 20 : x + 20] > 60
    positions = np.array([(volume.index_to_world @ (0, j, 0, 1))[1] for j in range(volume.array.shape[1])])
    mass = low.sum(axis=(0, 2))
    assert (positions * mass).sum() / mass.sum() > positions.mean() + 10
    assert y > 0


def test_the_engine_is_the_same_every_time_and_like_itself_at_every_size():
    small = generate.engine_block(64)
    np.testing.assert_array_equal(small.array, generate.engine_block(64).array)
    assert not np.array_equal(small.array, generate.engine_block(64, seed=21).array)
    large = generate.engine_block(128)
    assert small.extent[0] + small.spacing[0] == pytest.approx(large.extent[0] + large.spacing[0])
    halved = large.array.reshape(64, 2, 64, 2, 64, 2).mean(axis=(1, 3, 5))
    # thin parts are softer in the small one: a few voxels differ much, most of them hardly
    assert np.mean(np.abs(halved - small.array)) < 4


def test_the_engine_has_two_metals_air_and_a_halo_of_noise():
    array = generate.engine_block(128).array
    air = array[:8, :8, :8].astype(float)
    assert 3 < air.mean() < 8
    assert air.std() > 0.5
    counts = np.bincount(array.ravel(), minlength=256)
    assert counts[105:136].sum() > 0.05 * array.size
    assert counts[200:231].sum() > 0.003 * array.size
    # between air and metal: the halo, brighter than air, dimmer than aluminium
    assert counts[12:30].sum() > 0.02 * array.size


def test_making_the_engine_can_be_cancelled():
    asked = iter(range(100))
    with pytest.raises(Cancelled):
        load("sample:engine", cancel=lambda: next(asked) > 1)


def test_the_marschner_lobb_signal_has_its_known_values():
    volume = generate.marschner_lobb(41)
    middle = volume.array[20, 20]
    # rho_r(0) = cos(12 pi) = 1 in the middle; at x = 1: cos(12 pi cos(pi / 2)) = 1
    assert middle[20] == pytest.approx((1 - 0 + 0.25 * 2) / 2.5)
    assert middle[40] == pytest.approx((1 - 0 + 0.25 * 2) / 2.5)
    # z = -1 is the bright end
    assert volume.array[0, 20, 20] == pytest.approx((1 + 1 + 0.5) / 2.5)
    assert volume.array[40, 20, 20] == pytest.approx(0.5 / 2.5)
    assert volume.range[0] >= 0
    assert volume.range[1] <= 1


def test_sphere_and_torus_are_distance_fields():
    for volume in (generate.sphere(65), generate.torus(65)):
        gradients = np.gradient(volume.array.astype(float), *volume.spacing[::-1])
        length = np.sqrt(sum(g * g for g in gradients))
        near = np.abs(volume.array) < 0.1
        assert length[near] == pytest.approx(1, abs=0.03)
    sphere = generate.sphere(65, radius=0.8)
    assert sphere.value_at((0, 0, 0)) == pytest.approx(0.8)
    assert (sphere.array > 0).sum() * np.prod(sphere.spacing) == pytest.approx(
        4 / 3 * np.pi * 0.8**3, rel=0.01
    )


def test_the_cube_is_homogeneous():
    volume = generate.cube(64)
    assert set(np.unique(volume.array)) == {0.0, 1.0}
    assert volume.array.sum() == 48**3


@pytest.mark.parametrize(
    "make", [generate.engine_block, generate.marschner_lobb, generate.sphere, generate.cube]
)
def test_impossible_sizes_are_refused(make):
    for size in (1, 5000):
        with pytest.raises(InputError, match=f"got {size}"):
            make(size)


def test_hints_apply_to_samples_too():
    volume = load("sample:sphere", spacing=(1, 2, 3), name="mine", unit="K")
    assert (volume.spacing, volume.name, volume.unit) == ((1, 2, 3), "mine", "K")
    assert info("sample:cube")["dims"] == [64, 64, 64]
