"""Matching: the same values on both sides, and words for what cannot be matched."""

from __future__ import annotations

import pytest

from volviz.compare.matching import differences, follow, match, match_sides
from volviz.custom_gl.registry import are_counterparts, technique, techniques
from volviz.model.light import Light
from volviz.model.parameters import make_settings

VTK = [ident for ident in techniques() if ident.startswith("vtk_")]


def made(ident, **values):
    return make_settings(technique(ident).settings, values, owner=ident)


def test_values_of_the_same_name_are_copied():
    ours = made(
        "raycast", step=0.25, opacity_unit_distance=2.5, shading=True, ambient=0.4, interpolation="nearest"
    )
    theirs, _ = match("raycast", ours, "vtk_gpu")
    assert (theirs.step, theirs.opacity_unit_distance, theirs.shading) == (0.25, 2.5, True)
    assert (theirs.ambient, theirs.interpolation) == (0.4, "nearest")


def test_ours_follows_what_vtk_always_does():
    ours, words = match("vtk_gpu", made("vtk_gpu", step=0.3), "raycast")
    assert (ours.step, ours.first_sample, ours.early_termination) == (0.3, 1.0, 1 - 1 / 255)
    assert words == []


def test_what_vtk_cannot_follow_is_said():
    ours = made("raycast", mode="attenuated_maximum", gradient_opacity=0.5, density_threshold=0.1)
    theirs, words = match("raycast", ours, "vtk_gpu")
    assert theirs.mode == "composite"
    text = " ".join(words)
    for part in ("attenuated_maximum", "first_sample = 0.5", "gradient opacity", "density threshold"):
        assert part in text


@pytest.mark.parametrize("ident", VTK)
def test_every_technique_of_vtk_has_a_counterpart_and_what_it_fixes_is_a_setting_of_one(ident):
    ours = technique(ident).counterpart_of
    assert ours
    assert all(are_counterparts(ident, other) and are_counterparts(other, ident) for other in ours)
    known = {p.name for other in ours for p in technique(other).parameters}
    assert set(technique(ident).matching.fixed) <= known
    # and can be had
    for other in ours:
        make_settings(technique(other).settings, follow(other, {}, ident), owner=other)


@pytest.mark.parametrize("ident", VTK)
def test_matching_there_and_back_gives_the_same(ident):
    for other in technique(ident).counterpart_of:
        theirs = made(ident)
        ours, _ = match(ident, theirs, other)
        again, _ = match(other, ours, ident)
        shared = {p.name for p in technique(ident).parameters} & {p.name for p in technique(other).parameters}
        assert shared
        assert all(getattr(again, name) == getattr(theirs, name) for name in shared)


@pytest.mark.parametrize("ident", list(techniques()))
def test_every_pair_has_sentences_that_can_be_read(ident):
    for other in techniques():
        for values in ({}, {"mode": "additive"}, {"shading": True}, {"footprint": "gaussian"}):
            names = {p.name for p in technique(ident).parameters}
            one = made(ident, **{k: v for k, v in values.items() if k in names})
            two, words = match(ident, one, other, light=Light(headlight=False))
            assert words == differences(ident, one, other, two, light=Light(headlight=False))
            assert all(w.endswith(".") and "{" not in w for w in words)
            if not are_counterparts(ident, other) or ident == other:
                assert words == []


def test_a_placed_light_is_part_of_the_words():
    ours = made("raycast", shading=True)
    assert any("ambient" in w for w in match("raycast", ours, "vtk_gpu", light=Light(headlight=False))[1])
    assert not any("ambient" in w for w in match("raycast", ours, "vtk_gpu")[1])


def test_sides_of_a_comparison_follow_ours_and_vtks_rules():
    first, second, third = match_sides(
        [("raycast", {"step": 0.25}), ("vtk_gpu", {}), ("slicing", {"early_termination": 1.0})]
    )
    assert first.settings.first_sample == third.settings.first_sample == 1.0
    assert first.settings.step == second.settings.step == 0.25
    assert third.settings.early_termination == 1.0
    assert any("254/255" in w for w in third.differences["vtk_gpu"])
    assert not first.differences["vtk_gpu"]


def test_two_sides_of_one_technique_do_not_follow_one_another():
    first, second = match_sides([("raycast", {"step": 1.5, "mode": "maximum"}), ("raycast", {})])
    assert (first.settings.step, second.settings.step, second.settings.mode) == (1.5, 0.5, "composite")


def test_sides_that_are_not_matched_keep_their_defaults():
    first, second = match_sides([("raycast", {"step": 0.25}), ("vtk_gpu", {})], matched=False)
    assert (first.settings.first_sample, second.settings.step) == (0.5, 0.5)
    assert first.differences["vtk_gpu"]


@pytest.mark.parametrize("given", [0.0, 0.5])
def test_vtks_shadows_are_not_switched_off_by_a_setting_of_the_same_name(given: float) -> None:
    settings = make_settings(technique("half_angle").settings, {"scattering": given}, owner="half_angle")
    followed, _ = match("half_angle", settings, "vtk_shadows")
    # 0 would be lighting by the gradient alone, without any shadow
    assert followed.scattering == technique("vtk_shadows").settings().scattering > 0
    back, _ = match("vtk_shadows", followed, "half_angle")
    assert back.scattering == technique("half_angle").settings().scattering


def test_matter_that_is_not_lit_by_its_gradient_is_as_bright_in_vtks_shadows() -> None:
    make = technique("half_angle").settings
    plain, _ = match("half_angle", make(shading=False), "vtk_shadows")
    lit, _ = match("half_angle", make(shading=True), "vtk_shadows")
    assert (plain.diffuse, plain.specular) == (1.0, 0.0)
    assert (lit.diffuse, lit.specular) == (make().diffuse, make().specular)
