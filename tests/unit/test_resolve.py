"""What a spec means to a renderer, and what is refused before anything is drawn."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

import volviz
from volviz.custom_gl.arguments import changed_spec, spec_of
from volviz.custom_gl.registry import techniques
from volviz.custom_gl.resolve import ResolvedSpec, resolve
from volviz.custom_gl.settings import CommonSettings, common_settings
from volviz.errors import InputError, VolvizError
from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.light import default_position
from volviz.model.parameters import parameters_of
from volviz.model.render_spec import RenderSpec
from volviz.model.surface_values import DistanceColoring, SurfaceColors, SurfaceValues
from volviz.volume_data.references import VolumeKey, VolumeRef


@pytest.fixture(scope="module")
def of() -> volviz.Volume:
    z, y, x = np.mgrid[:9, :10, :11].astype(np.float32)
    return volviz.Volume(x + 2 * y + 3 * z, spacing=(1.0, 2.0, 3.0), origin=(5.0, 6.0, 7.0))


def colors() -> SurfaceColors:
    vertices, faces = np.eye(3, dtype=np.float32), np.array([[0, 1, 2]])
    values = SurfaceValues(vertices, faces, np.zeros(3, np.float32), np.zeros(1, np.float32))
    return SurfaceColors(values, 0.0, 1.0, np.zeros((2, 3), np.uint8))


@pytest.mark.parametrize("ident", list(techniques()))
def test_nothing_is_left_open(of: volviz.Volume, ident: str) -> None:
    found = resolve(RenderSpec((volviz.ImageLayer(of),), ident))
    for field in fields(ResolvedSpec):
        if field.name != "surface_colors":
            assert getattr(found, field.name) is not None, field.name
    assert isinstance(found.settings, techniques()[ident].settings)
    assert found.unit_distance > 0
    assert found.light_position == default_position(of.bounds)
    assert found.crop == (0.0, 10.0, 0.0, 9.0, 0.0, 8.0)
    np.testing.assert_allclose(found.box_corners[0], of.origin)
    np.testing.assert_allclose(found.box_corners[7], (15.0, 24.0, 31.0))
    assert found.transfer_function.domain == "data"
    has_isovalues = bool(techniques()[ident].isovalue_setting)
    assert found.isovalues == ((auto_isovalue(of),) if has_isovalues else ())


def test_every_setting_called_an_isovalue_is_declared_as_one() -> None:
    for info in techniques().values():
        named = [p.name for p in info.parameters if p.name.startswith("isovalue")]
        assert named == ([info.isovalue_setting] if info.isovalue_setting else [])
        if info.isovalue_parameter is not None:
            made = info.settings(**info.isovalue_values([7.0]))
            assert info.isovalues(made, None) == (7.0,)  # type: ignore[arg-type] # nothing is to be looked up


def test_values_that_are_given_stay(of: volviz.Volume) -> None:
    spec = spec_of(
        of, "isosurface", isovalues=(3.0, 1.0), light_position=(1.0, 2.0, 3.0), crop=(-4, 5, 0, 100, 2, 3)
    )
    found = resolve(spec)
    assert found.isovalues == (3.0, 1.0)
    assert found.light_position == (1.0, 2.0, 3.0)
    assert not found.light.headlight
    assert found.crop == (0.0, 5.0, 0.0, 9.0, 2.0, 3.0)
    assert resolve(spec_of(of, opacity_unit_distance=0.25)).unit_distance == 0.25
    assert resolve(spec_of(of)).unit_distance == of.mean_spacing


def test_relative_functions_are_put_into_data_units_and_kept_when_equal(of: volviz.Volume) -> None:
    relative = volviz.TransferFunction.from_points(
        [(0.0, (0, 0, 0, 0)), (1.0, (1, 1, 1, 1))], domain="relative"
    )
    before = resolve(spec_of(of, transfer_function=relative))
    low, high = of.range
    assert [p.value for p in before.transfer_function.points] == [low, high]
    again = resolve(spec_of(of, transfer_function=relative, step=1.0))
    assert again.drawn_function is not before.drawn_function
    assert again.keeping(before).drawn_function is before.drawn_function
    other = resolve(spec_of(of, transfer_function=relative.with_opacity(0.5)))
    assert other.keeping(before) is other


def test_automatic_functions_are_made_once_for_each_volume(of: volviz.Volume) -> None:
    first, second = (resolve(RenderSpec((volviz.ImageLayer(of),))) for _ in range(2))
    assert first.transfer_function is second.transfer_function
    assert first.transfer_function == volviz.TransferFunction.auto(of)


def test_colour_window_and_opacity_become_a_function(of: volviz.Volume) -> None:
    layer = volviz.ImageLayer(of, color="green", window=(3.0, 9.0), opacity=0.25)
    found = resolve(RenderSpec((layer,))).transfer_function
    assert [(p.value, p.opacity) for p in found.points] == [(3.0, 0.0), (9.0, 1.0)]
    assert {p.color for p in found.points} == {layer.color}
    assert found.opacity == 0.25
    whole = resolve(RenderSpec((volviz.ImageLayer(of, color=(1, 0, 0)),))).transfer_function
    assert [p.value for p in whole.points] == list(of.range)
    given = volviz.TransferFunction.auto(of).with_opacity(0.5)
    half = resolve(RenderSpec((volviz.ImageLayer(of, given, opacity=0.5),))).transfer_function
    assert half == given.with_opacity(0.25)


def test_references_mean_what_was_read_of_them(of: volviz.Volume) -> None:
    layer = volviz.ImageLayer(VolumeRef("a.nrrd"), time=2)
    spec = RenderSpec((layer,))
    assert resolve(spec, {VolumeKey(VolumeRef("a.nrrd"), None, 2): of}).volume is of
    for volumes in (None, {}, {VolumeKey(VolumeRef("a.nrrd")): of}):
        with pytest.raises(InputError, match="nrrd has not been read"):
            resolve(spec, volumes)


@pytest.mark.parametrize(
    ("layers", "words"),
    [
        (lambda of: (), "no volume to show"),
        (lambda of: (volviz.ImageLayer(of, visible=False),), "all layers are hidden"),
        (lambda of: 17 * (volviz.ImageLayer(of),), "at most 16 layers are drawn together, got 17"),
        (lambda of: (volviz.ImageLayer(of, mode="mask"),), '"mask" acts on others and shows nothing'),
        (lambda of: (volviz.ImageLayer(of, mode="modulate"),), '"modulate" acts on others and shows nothing'),
    ],
)
def test_layers_that_cannot_be_drawn_yet_are_refused_in_words(
    of: volviz.Volume, layers: Any, words: str
) -> None:
    with pytest.raises(InputError, match=words):
        resolve(RenderSpec(layers(of)))


def test_techniques_for_one_layer_refuse_several(of: volviz.Volume) -> None:
    layers = 2 * (volviz.ImageLayer(of),)
    for ident, info in techniques().items():
        if info.draws_layers:
            assert len(resolve(RenderSpec(layers, ident)).layers) == 2
        else:
            with pytest.raises(InputError, match="draws one layer and 2 are visible; hide the others"):
                resolve(RenderSpec(layers, ident))


def test_layers_are_drawn_in_an_order_of_their_own(of: volviz.Volume) -> None:
    other = volviz.Volume(of.array + 1, spacing=(2.0, 2.0, 2.0))
    layers = (
        volviz.ImageLayer(other, mode="mask"),
        volviz.ImageLayer(of, color="red"),
        volviz.ImageLayer(of, color="green"),
        volviz.ImageLayer(other, visible=False),
    )
    one, reverse = (resolve(RenderSpec(given)) for given in (layers, layers[::-1]))
    assert [(each.volume, each.drawn_function) for each in one.layers] == [
        (each.volume, each.drawn_function) for each in reverse.layers
    ]
    assert one.layers[-1].mode == "mask"
    assert (one.volume, one.transfer_function.points[0].color) == (of, (1.0, 0.0, 0.0))
    assert not one.is_one_lattice


def test_a_moved_layer_lies_where_its_transform_puts_it(of: volviz.Volume) -> None:
    turn = np.array(
        [[0.0, -2.0, 0.0, 5.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, -3.0], [0.0, 0.0, 0.0, 1.0]]
    )
    first, second = (resolve(RenderSpec((volviz.ImageLayer(of, transform=turn),))) for _ in range(2))
    assert first.volume is second.volume
    np.testing.assert_allclose(first.volume.index_to_world, turn @ of.index_to_world)
    assert np.shares_memory(first.volume.array, of.array)
    assert first.transfer_function == resolve(RenderSpec((volviz.ImageLayer(of),))).transfer_function


def test_a_crop_box_cuts_layers_on_other_lattices_as_planes(of: volviz.Volume) -> None:
    layers = (volviz.ImageLayer(of), volviz.ImageLayer(volviz.Volume(of.array)))
    found = resolve(RenderSpec(layers, clipping=volviz.Clipping((1, 5, 2, 6, 3, 7))))
    inside, outside = (of.index_to_world @ (*index, 1.0) for index in ((3.0, 4.0, 5.0), (3.0, 4.0, 7.5)))

    def kept(point: Any) -> bool:
        return all(np.dot(point[:3] - origin, normal) >= 0 for origin, normal in found.drawn_planes)

    assert len(found.drawn_planes) == 6
    assert kept(inside)
    assert not kept(outside)


def test_what_does_not_fit_is_refused_in_words(of: volviz.Volume) -> None:
    good = RenderSpec((volviz.ImageLayer(of),))
    for changes, words in (
        ({"technique": "raycasting"}, "no technique called 'raycasting'"),
        ({"settings": 3}, "raycast takes RaycastSettings, got int"),
        ({"light": "sun"}, "light must be a volviz.Light, got str"),
        ({"clipping": (0, 1)}, "clipping must be a volviz.Clipping"),
        ({"clipping": volviz.Clipping((90, 99, 0, 1, 0, 1))}, "crop leaves nothing along axis i"),
        ({"surface_colors": colors()}, "raycast draws no mesh"),
        (
            {"technique": "marching_cubes", "surface_colors": DistanceColoring("vtk_flying_edges")},
            "colors_of measures distances",
        ),
    ):
        with pytest.raises(InputError, match=words):
            resolve(replace(good, **changes))


# ---------------------------------------------------------------------------------------- keywords


def test_layers_and_volumes_are_told_apart(of: volviz.Volume) -> None:
    function = volviz.TransferFunction.auto(of)
    assert spec_of(of, transfer_function=function).layers == (volviz.ImageLayer(of, function),)
    layer = volviz.ImageLayer(of)
    assert spec_of(layer).layers == spec_of([layer]).layers == (layer,)
    for shown, options, words in (
        (None, {}, "no volume to show"),
        (of.array, {}, "volume must be a volviz.Volume, got ndarray"),
        ([of], {}, "wrap each volume in one"),
        (layer, {"transfer_function": function}, "leave transfer_function out"),
    ):
        with pytest.raises(InputError, match=words):
            spec_of(shown, **options)


def test_a_changed_spec_keeps_what_is_not_named(of: volviz.Volume) -> None:
    spec = spec_of(of, step=0.7, light_color=(1.0, 0.5, 0.5), crop=(1, 5, 1, 5, 1, 5))
    assert changed_spec(spec) == spec
    assert changed_spec(spec, step=0.7, settings=None) == spec
    changed = changed_spec(spec, shading=True, headlight=False)
    assert (changed.settings.step, changed.settings.shading) == (0.7, True)
    assert (changed.light.color, changed.light.headlight) == ((1.0, 0.5, 0.5), False)
    assert changed.clipping == spec.clipping
    assert changed_spec(spec, technique="slicing").settings == techniques()["slicing"].settings()
    with pytest.raises(VolvizError, match="not both"):
        changed_spec(spec, settings=spec.settings, step=1.0)


def test_colours_of_a_surface_end_with_the_surface(of: volviz.Volume) -> None:
    spec = replace(spec_of(of, "marching_cubes", isovalue=20.0), surface_colors=colors())
    kept = (
        {"wireframe": True},
        {"light_position": (1.0, 1.0, 1.0)},
        {"isovalue": 20.0},
        {"technique": "marching_cubes"},
    )
    for same in kept:
        assert changed_spec(spec, **same).surface_colors is spec.surface_colors, same
    other = volviz.Volume(of.array)
    for another in ({"isovalue": 21.0}, {"technique": "vtk_flying_edges"}, {"volume": other}, {"stride": 2}):
        assert changed_spec(spec, **another).surface_colors is None, another


def test_common_settings_are_those_of_the_technique_or_the_usual_ones() -> None:
    described = {field.name for field in fields(CommonSettings)}
    for info in techniques().values():
        settings = info.settings()
        common = common_settings(settings)
        own = {p.name for p in parameters_of(info.settings)}
        for name in described:
            expected = getattr(settings, name) if name in own else getattr(CommonSettings(), name)
            assert getattr(common, name) == expected, (info.id, name)
