"""Orders of convergence of techniques that are no ray casters: slices with light, shadow rays, splats, meshes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

import volviz
from tests.render.scenes import POINTS, blobs
from volviz.compare.convergence import Convergence, ConvergenceRun, cropped_to, study
from volviz.compare.plots import axis_words
from volviz.compare.run import Side, compare
from volviz.custom_gl.framing import default_camera
from volviz.custom_gl.registry import technique
from volviz.errors import InputError
from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.light import Light
from volviz.model.render_spec import RenderSpec, View


@dataclass(frozen=True)
class Scene:
    """What is drawn, and from where."""

    spec: RenderSpec
    view: View
    volume: volviz.Volume


def view_of(array: np.ndarray, size: tuple[int, int] = (48, 36)) -> Scene:
    volume = volviz.Volume(array, name="smooth", spacing=(1.0, 1.1, 1.3))
    function = volviz.TransferFunction.from_points(POINTS)
    camera = default_camera(volume, size, transfer_function=function)
    spec = RenderSpec((volviz.ImageLayer(volume, function),), light=Light(headlight=False))
    return Scene(spec, View(camera, size), volume)


@pytest.fixture(scope="module")
def view() -> Scene:
    return view_of(blobs((29, 31, 33), dtype=np.float32))


def measured(view: Scene, ident: str, **settings: object) -> Convergence:
    run = ConvergenceRun(view.spec, view.view, ident, ident, settings)
    fractions = list(run.steps())
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    assert run.result is not None
    return run.result


def test_half_angle_slicing_is_of_second_order_and_its_limit_is_near_the_integral(view: Scene) -> None:
    found = measured(view, "half_angle", slices=64, light_buffer_size=256)
    assert found.parameter == "step"
    assert list(found.errors) == sorted(found.errors, reverse=True)
    assert found.slope == pytest.approx(2.0, abs=0.4)
    # what is left is the light buffer's: it has pixels
    assert found.offset is not None
    assert found.offset < 0.5
    assert "shadow ray" in found.offset_from


def test_half_angle_slicing_with_blurred_light_has_no_integral_to_be_compared_with(view: Scene) -> None:
    how = study(technique("half_angle"), view.volume)
    assert how is not None
    run = ConvergenceRun(
        view.spec, view.view, "h", "half_angle", {"scattering": 0.5}, replace(how, values=(2.0,), best=1.0)
    )
    for _ in run.steps():
        pass
    assert run.result is not None
    assert run.result.offset is None


def test_shadow_rays_of_vtk_are_of_first_order(view: Scene) -> None:
    found = measured(replace(view, view=replace(view.view, size=(24, 18))), "vtk_shadows")
    assert list(found.errors) == sorted(found.errors, reverse=True)
    assert found.slope == pytest.approx(1.0, abs=0.4)
    assert found.reference.startswith("vtk_shadows with step")


@pytest.mark.parametrize("ident", ["splatting", "vtk_point_gaussian"])
@pytest.mark.parametrize("footprint", ["disc", "gaussian"])
def test_pictures_of_splats_come_nearer_to_that_of_every_voxel(
    view: View, ident: str, footprint: str
) -> None:
    found = measured(view, ident, footprint=footprint, isovalue=0.3)
    assert found.axis == "distance of splats"
    assert found.errors[-1] < 0.6 * found.errors[0]
    assert 0.4 < found.slope < 3
    assert found.reference.endswith("every voxel")


@pytest.mark.parametrize("ident", ["marching_cubes", "marching_tetrahedra", "vtk_flying_edges"])
def test_meshes_of_a_ball_are_of_second_order(ident: str) -> None:
    z, y, x = np.indices((40, 39, 38)) - 18.3
    found = measured(view_of((20.0 - np.sqrt(x * x + y * y + z * z)).astype(np.float32)), ident, isovalue=6.0)
    assert found.unit == "voxels"
    assert found.slope == pytest.approx(2.0, abs=0.3)
    assert list(found.max_errors) == sorted(found.max_errors, reverse=True)


def test_a_mesh_that_is_empty_has_no_points_and_no_slope(view: Scene) -> None:
    found = measured(view, "marching_cubes", isovalue=99.0)
    assert found.distances == found.errors == ()
    assert math.isnan(found.slope)


def test_the_automatic_isovalue_stays_the_same_on_every_grid(view: Scene) -> None:
    found = measured(view, "marching_cubes")
    given = measured(view, "marching_cubes", isovalue=auto_isovalue(view.volume))
    assert found.errors == given.errors


def test_volumes_lose_only_their_last_voxels_for_a_common_border() -> None:
    volume = volviz.Volume(np.arange(30 * 26 * 25).reshape(30, 26, 25), spacing=(1, 2, 3), origin=(4, 5, 6))
    cut = cropped_to(volume, 12)
    assert cut.array.shape == (25, 25, 25)
    assert (cut.origin, cut.spacing) == (volume.origin, volume.spacing)
    np.testing.assert_array_equal(cut.array, volume.array[:25, :25, :25])


def test_a_technique_without_a_curve_is_told_in_the_result(view: Scene) -> None:
    found = compare(
        view.spec, view.view, [Side("bump_mapping"), Side("marching_cubes")], frames=0, convergence=True
    )
    assert [c.name for c in found.convergence] == ["marching_cubes"]
    assert len(found.without_curve) == 1
    assert "bump_mapping" in found.without_curve[0]
    with pytest.raises(InputError, match="bump_mapping"):
        ConvergenceRun(view.spec, view.view, "b", "bump_mapping")


def test_the_axis_of_a_plot_tells_what_its_distances_are(view: Scene) -> None:
    found = measured(view, "splatting")
    slices, length = (replace(found, axis=axis) for axis in ("distance of slices", "length of something"))
    assert axis_words([found]) == "distance of splats (voxels)"
    assert axis_words([found, slices, found]) == "distance of splats or slices (voxels)"
    assert axis_words([length, found]) == "distance of splats; length of something (voxels)"
