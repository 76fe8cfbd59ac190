"""NaN and infinities are drawn as the lowest value by every technique, values beyond 32-bit floats as others are."""

from __future__ import annotations

import numpy as np
import pytest

import volviz
from tests.render.scenes import blobs, camera, function, image

SIZE = (40, 32)
TECHNIQUES = [name for name in volviz.techniques() if name != "reference"]


def holey() -> volviz.Volume:
    """A field in which single voxels and a corner are no numbers."""
    array = 3.0 + blobs(dtype=np.float32)
    random = np.random.default_rng(11)
    for value in (np.nan, np.inf, -np.inf):
        array[random.random(array.shape) < 0.01] = value
    array[:6, :8, :9] = np.nan
    return volviz.Volume(array, spacing=(1.0, 1.1, 0.9))


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_no_number_is_drawn_as_the_lowest_value(technique: str) -> None:
    holes = holey()
    filled = volviz.Volume(
        np.where(np.isfinite(holes.array), holes.array, holes.range[0]), spacing=holes.spacing
    )
    transfer, view = function(holes), camera(holes)
    # the same first surface for both, and the same grey window, which is chosen from the finite values
    given = {"isovalue": 3.4, "window_level": 4.0, "window_width": 8.0}
    surface = {p.name: given[p.name] for p in volviz.techniques()[technique].parameters if p.name in given}
    seen = image(holes, transfer, view, size=SIZE, technique_id=technique, **surface)
    expected = image(filled, transfer, view, size=SIZE, technique_id=technique, **surface)
    assert expected[..., 3].max() > 0.1
    np.testing.assert_array_equal(seen, expected)


#: What makes fields of 0..1 hard for 32-bit floats: a factor and an offset.
HARD = {"narrow and far from zero": (1e-3, 1e6), "huge": (1e30, 0.0), "tiny": (1e-30, 0.0)}

#: Normals come from gradients, which are squared.
SQUARING = ("isosurface", "marching_cubes", "vtk_isosurface", "vtk_flying_edges")


@pytest.mark.parametrize(
    ("technique", "hard"),
    [
        *((technique, "narrow and far from zero") for technique in TECHNIQUES),
        *((technique, hard) for technique in SQUARING for hard in ("huge", "tiny")),
    ],
)
def test_values_that_floats_cannot_hold_are_drawn_as_others_are(technique: str, hard: str) -> None:
    easy = volviz.Volume(blobs(dtype=np.float64))
    factor, offset = HARD[hard]
    of = volviz.Volume(offset + factor * easy.array)

    def drawn(shown: volviz.Volume) -> np.ndarray:
        low, high = shown.range
        isovalue = low + 0.4 * (high - low)
        names = {p.name for p in volviz.techniques()[technique].parameters}
        surface = {"isovalue": isovalue, "isovalues": (isovalue,)}
        values = {name: value for name, value in surface.items() if name in names}
        return image(shown, function(shown), camera(shown), size=SIZE, technique_id=technique, **values)

    seen, expected = drawn(of), drawn(easy)
    assert expected[..., 3].max() > 0.1
    assert np.isfinite(seen).all()
    # where outlines are, pixels may fall on either side
    assert (np.abs(seen - expected).max(axis=-1) > 0.02).mean() <= 0.005


def test_a_range_wider_than_floats_are_is_drawn() -> None:
    easy = volviz.Volume(blobs(dtype=np.float64))
    wide = volviz.Volume(((2.0 * easy.array - 1.0) * 3e38).astype(np.float32))
    images = [image(of, function(of), camera(of), size=SIZE) for of in (easy, wide)]
    np.testing.assert_allclose(*images, atol=2e-3)


@pytest.mark.parametrize("technique", ["raycast", "isosurface", "vtk_gpu"])
@pytest.mark.parametrize(
    "low_high", [(0.3, 0.1 + 0.2), (2**60, 2**60 + 1024), (np.longdouble(1), np.longdouble(3))], ids=str
)
def test_values_a_rounding_apart_and_long_doubles_are_drawn(technique, low_high):
    low, high = low_high
    array = np.full((9, 8, 7), low)
    array[3:6, 3:6, 2:5] = high
    image = volviz.render(volviz.Volume(array), technique, size=(48, 40))
    assert image[..., 3].max() > 0


def test_values_that_span_all_of_float64_are_refused_in_words():
    array = np.random.default_rng(1).uniform(-1, 1, (8, 8, 8)) * 1.75e308
    with pytest.raises(volviz.VolvizError, match="farther than 64-bit numbers count"):
        volviz.render(volviz.Volume(array), size=(32, 32))


def test_the_reference_sees_what_ray_casting_sees_beside_an_outlier():
    z, y, x = np.mgrid[-1:1:24j, -1:1:24j, -1:1:24j]
    array = np.clip(1 - np.sqrt(x * x + y * y + z * z), 0, 1).astype(np.float32)
    array[1, 1, 1] = 1e6
    function = volviz.TransferFunction.from_points(
        [(0.3, (1, 0, 0, 0)), (0.4, (1, 0, 0, 0.5)), (0.9, (0, 1, 0, 0.9))]
    )
    pair = [
        volviz.render(volviz.Volume(array), t, transfer_function=function, size=(64, 48), dtype="float32")
        for t in ("reference", "raycast")
    ]
    assert np.abs(pair[0] - pair[1]).max() < 2 / 255
