"""How convergence is measured: fitted orders, what each technique is refined by, and words where nothing is."""

from __future__ import annotations

import math

import numpy as np
import pytest

from volviz.compare.convergence import fitted_line, study, why_not
from volviz.custom_gl.registry import technique, techniques
from volviz.custom_gl.study import STRIDES, diagonal, splat_distance, splat_lattices
from volviz.volume_data.volume import Volume

DISTANCES = (4.0, 2.8, 2.0, 1.4, 1.0)


def volume(
    shape: tuple[int, int, int] = (40, 50, 60), spacing: tuple[float, float, float] = (1, 1, 1)
) -> Volume:
    return Volume(np.zeros(shape, np.uint8), spacing=spacing)


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0, 3.3])
def test_the_order_of_a_power_is_found(power: float) -> None:
    factor, slope = fitted_line(DISTANCES, [0.7 * d**power for d in DISTANCES])
    assert factor == pytest.approx(0.7)
    assert slope == pytest.approx(power)


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0, 3.3])
def test_errors_against_a_picture_that_is_hardly_finer_have_the_order_of_the_limit(power: float) -> None:
    errors = [0.7 * (d**power - 0.5**power) for d in DISTANCES]
    factor, slope = fitted_line(DISTANCES, errors, 0.5)
    assert slope == pytest.approx(power, abs=0.002)
    assert factor == pytest.approx(0.7, rel=0.01)
    # without knowing of it, the order would come out too high
    assert fitted_line(DISTANCES, errors)[1] > power + 0.05


def test_rounding_is_left_out_of_a_fit() -> None:
    errors = [d**2 for d in DISTANCES[:-1]] + [1e-9]
    assert fitted_line(DISTANCES, errors, least=1e-6)[1] == pytest.approx(2.0)
    assert all(math.isnan(number) for number in fitted_line(DISTANCES, [1e-9] * 5, least=1e-6))


def test_every_technique_is_refined_by_something_or_it_is_told_why_not() -> None:
    refined = {}
    for ident, info in techniques().items():
        found = study(info, volume())
        if found is None:
            words = why_not(info)
            assert words.startswith(ident)
            assert words.endswith(".")
            continue
        refined[ident] = found.parameter
        assert found.parameter in {p.name for p in info.parameters}
        for value in (*found.values, found.best):
            # a whole number for what is counted
            given = value if value is None or found.parameter == "step" else int(value)
            next(p for p in info.parameters if p.name == found.parameter).checked(given)
    assert refined["half_angle"] == refined["vtk_shadows"] == "step"
    assert refined["splatting"] == refined["vtk_point_gaussian"] == "splats_per_axis"
    assert refined["marching_tetrahedra"] == "stride"
    assert "bump_mapping" not in refined


def test_finest_pictures_of_large_volumes_stay_within_what_a_technique_can_do() -> None:
    large = volume((512, 512, 512))
    half_angle, shadows = (study(technique(ident), large) for ident in ("half_angle", "vtk_shadows"))
    assert half_angle is not None
    assert shadows is not None
    assert diagonal(large) / half_angle.best <= 2048
    assert diagonal(large) / shadows.best <= 701
    assert list(half_angle.values) == sorted(half_angle.values, reverse=True)
    assert half_angle.values[-1] > 2 * half_angle.best


def test_lattices_of_splats_come_closer_and_their_distance_is_that_of_the_coarsest_axis() -> None:
    thick = volume((20, 60, 80), (1.0, 1.0, 2.0))
    counts = splat_lattices(thick).values
    distances = [splat_distance(thick, round(n)) for n in counts]
    assert distances == sorted(distances, reverse=True)
    assert distances[-1] > splat_distance(thick, None) == 2.0
    assert splat_distance(thick, 20) == 4.0


def test_what_has_too_few_voxels_to_leave_some_out_has_no_curve() -> None:
    tiny = volume((12, 40, 40))
    assert study(technique("marching_cubes"), tiny) is None
    assert "too few voxels" in why_not(technique("marching_cubes"))
    few, enough = (study(technique("marching_cubes"), volume((n, 40, 40))) for n in (13, 25))
    assert few is not None
    assert enough is not None
    assert (few.values, enough.values) == ((3.0, 2.0), STRIDES)
