"""Settings that bring two techniques as near to one another as they come, and the rest in words.

Settings of the same name mean the same almost everywhere (`OTHER_MEANING`), so matching copies values. What a technique
cannot follow is a property of it: VTK's ray caster samples the far ends of whole steps, whatever ours does. So ours
follows where it can, and a sentence says what stays different where it cannot.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from volviz.custom_gl.registry import technique as technique_info
from volviz.custom_gl.registry import techniques
from volviz.errors import SettingError
from volviz.model.light import Light
from volviz.model.parameters import make_settings, parameters_of

#: Opacity at which VTK's GPU mapper ends a ray, fixed in its shader.
VTK_TERMINATION = 1.0 - 1.0 / 255.0

_SAMPLING: Mapping[str, Any] = {
    "first_sample": 1.0,
    "early_termination": VTK_TERMINATION,
    "gradient_delta": 1.0,
    "gradient_opacity": 0.0,
    "density_threshold": 0.0,
    "preintegrated": False,
    "mipmaps": False,
    "jitter": False,
}
_MESH: Mapping[str, Any] = {"color_by": "color", "parts": "all", "smoothing": 0, "decimation": 0.0}

#: What the technique of that id always does, by the names of our settings.
FIXED: Mapping[str, Mapping[str, Any]] = {
    "vtk_gpu": {name: value for name, value in _SAMPLING.items() if name != "jitter"},
    "vtk_fixed_point": _SAMPLING,
    "vtk_isosurface": {"bisections": 0, "gradient_delta": 1.0},
    "vtk_marching_cubes": _MESH,
    "vtk_flying_edges": _MESH,
    "vtk_point_gaussian": {"blur_radius": 0.0, "shading": False, "splat_color": "transfer_function"},
    "vtk_shadows": {
        "first_sample": 1.0,
        "gradient_delta": 1.0,
        "gradient_opacity": 0.0,
        "density_threshold": 0.0,
    },
    "vtk_normal_map": {"surface": "plane", "normal_source": "data", "lighting": "pixel", "dot3": "rgb"},
}


#: Settings of one name that mean something else in two techniques: the share of blurred light that half-angle slicing
#: looks up, and VTK's blend from lighting by the gradient (0, without any shadow) to scattering with shadows (2).
OTHER_MEANING: Mapping[frozenset[str], frozenset[str]] = {
    frozenset({"half_angle", "vtk_shadows"}): frozenset({"scattering"}),
}
#: How a technique that always lights shows matter that is not lit by its gradient: its colour, as bright as its light.
UNLIT: Mapping[str, Mapping[str, Any]] = {"vtk_shadows": {"diffuse": 1.0, "specular": 0.0}}


@lru_cache(maxsize=1)
def _families() -> dict[str, frozenset[str]]:
    """For every technique, those that show the same thing, itself included."""
    families = {ident: {ident} for ident in techniques()}
    for ident, info in techniques().items():
        for other in info.counterpart_of:
            if other in families:
                joined = families[ident] | families[other]
                for member in joined:
                    families[member] = joined
    return {ident: frozenset(members) for ident, members in families.items()}


def are_counterparts(first: str, second: str) -> bool:
    """Whether two techniques show the same thing, so that their pictures can be compared."""
    return second in _families().get(first, frozenset({first}))


def match(technique: str, settings: Any, other: str, *, light: Light | None = None) -> tuple[Any, list[str]]:
    """Settings of another technique that stand for those of the first, and what differs all the same.

    Parameters
    ----------
    technique : str
        Id of the technique that is set, ours or VTK's.
    settings : object
        Its settings.
    other : str
        Id of the technique that shall follow.
    light : Light, optional
        The light of the scene; without it, it sits at the eye.

    Returns
    -------
    settings : object
        Instance of the settings class of `other`.
    differences : list of str
        A sentence each.

    Raises
    ------
    InputError
        There is no such technique.
    """
    info = technique_info(other)
    values: dict[str, Any] = {}
    known = {p.name: p for p in info.parameters}
    wanted = {p.name: getattr(settings, p.name) for p in parameters_of(type(settings))}
    wanted |= FIXED.get(technique, {})
    if wanted.get("shading") is False:
        wanted |= UNLIT.get(other, {})
    if technique in UNLIT:
        wanted["shading"] = any(wanted[name] != value for name, value in UNLIT[technique].items())
    for name in OTHER_MEANING.get(frozenset({technique, other}), ()):
        wanted.pop(name, None)
    for name, value in wanted.items():
        if name in known:
            try:
                values[name] = known[name].checked(value)
            except SettingError:
                continue
    followed = make_settings(info.settings, values, owner=other)
    return followed, differences(technique, settings, other, followed, light=light)


def follow(technique: str, values: Mapping[str, Any], other: str) -> dict[str, Any]:
    """Values by name, with those replaced that another technique can have in one way only."""
    known = {p.name for p in technique_info(technique).parameters}
    return dict(values) | {name: value for name, value in FIXED.get(other, {}).items() if name in known}


# ---------------------------------------------------------------------------------------- what differs, in words


@dataclass(frozen=True)
class _Side:
    """A technique with its settings, as the rules see it."""

    ident: str
    settings: Any
    light: Light

    def get(self, name: str) -> Any:
        """A setting, or what the technique always does; None where it has no such thing."""
        return getattr(self.settings, name, FIXED.get(self.ident, {}).get(name))


@dataclass(frozen=True)
class _Rule:
    """A sentence for pairs in which one side is among `of`, when the other one asks for it."""

    of: tuple[str, ...]
    when: Callable[[_Side, _Side], bool]
    words: str


_GPU = ("vtk_gpu", "vtk_shadows")
_RAYS = ("vtk_gpu", "vtk_fixed_point")
_MESHES = ("vtk_marching_cubes", "vtk_flying_edges")


def _is_ours(side: _Side) -> bool:
    return not side.ident.startswith("vtk_")


def _lit(side: _Side) -> bool:
    """Whether highlights and normals are seen."""
    return side.get("shading") is not False and side.get("specular") is not None


_RULES = (
    _Rule(
        _GPU,
        lambda _, other: other.get("first_sample") not in (None, 1.0),
        "{it} samples the far ends of whole steps and leaves the rest of a ray out, which is first_sample = 1; "
        "{other} has first_sample = {first_sample:g}.",
    ),
    _Rule(
        ("vtk_fixed_point",),
        lambda _, other: _is_ours(other),
        "{it} samples on a grid of steps from the eye and leaves the rest of a ray out; its numbers have 15 bits.",
    ),
    _Rule(
        ("vtk_gpu",),
        lambda _, other: other.get("early_termination") not in (None, VTK_TERMINATION),
        "{it} ends a ray at an opacity of 254/255, {other} at {early_termination:g}.",
    ),
    _Rule(
        ("vtk_fixed_point",),
        lambda _, other: other.get("shading") is True,
        "{it} rounds normals to some thousand directions.",
    ),
    _Rule(
        (*_RAYS, *_MESHES, "vtk_isosurface"),
        lambda it, other: _is_ours(other) and _lit(it) and _lit(other) and it.get("specular") > 0,
        "Highlights of {it} are Phong's (the reflected light), those of {other} are Blinn's (the half vector).",
    ),
    _Rule(
        (*_RAYS, "vtk_isosurface", "vtk_shadows"),
        lambda _, other: other.get("gradient_delta") not in (None, 1.0) and _lit(other),
        "{it} takes gradients over one voxel to either side, {other} over {gradient_delta:g}.",
    ),
    _Rule(
        ("vtk_gpu", "vtk_isosurface", "vtk_shadows"),
        lambda it, other: _is_ours(other) and _lit(it) and not it.light.headlight and it.get("ambient") > 0,
        "With a light that does not sit at the eye, {it} leaves the ambient part of the material out.",
    ),
    _Rule(
        (*_RAYS, "vtk_shadows"),
        lambda _, other: (other.get("gradient_opacity") or 0.0) > 0.0,
        "{it} is shown without the gradient opacity of {other}.",
    ),
    _Rule(
        (*_RAYS, "vtk_shadows"),
        lambda _, other: (other.get("density_threshold") or 0.0) > 0.0,
        "{it} is shown without the density threshold of {other}.",
    ),
    _Rule(
        _RAYS,
        lambda _, other: bool(other.get("preintegrated")),
        "{it} classifies samples, {other} whole pieces of ray by a pre-integrated table.",
    ),
    _Rule(
        _RAYS,
        lambda _, other: bool(other.get("mipmaps")),
        "{it} always samples the full data, {other} takes coarser levels from afar.",
    ),
    _Rule(
        _RAYS,
        lambda it, other: bool(it.get("jitter")) or bool(other.get("jitter")),
        "Jitter is another noise in {it} than in {other}.",
    ),
    _Rule(
        _RAYS,
        lambda it, other: _is_ours(other) and it.get("mode") == other.get("mode") == "average",
        "In the mode average, {it} shows the mean of scalar times opacity in grey; {other} classifies the mean.",
    ),
    _Rule(
        _RAYS,
        lambda it, other: _is_ours(other) and it.get("mode") == other.get("mode") == "additive",
        "In the mode additive, {it} adds scalar times opacity and shows the sum in grey; {other} adds emitted colours.",
    ),
    _Rule(
        _RAYS,
        lambda it, other: it.get("mode") != other.get("mode"),
        "{it} has no mode {mode}; it shows {its_mode} instead.",
    ),
    _Rule(
        ("vtk_isosurface",),
        lambda _, other: (other.get("bisections") or 0) > 0,
        "{it} interpolates once between two samples, {other} bisects {bisections} times before.",
    ),
    _Rule(
        _MESHES,
        lambda _, other: other.get("method") == "topological" or other.ident == "marching_tetrahedra",
        "{it} decides ambiguous cells by its table, {other} by the data inside or by tetrahedra.",
    ),
    _Rule(
        _MESHES,
        lambda _, other: other.get("color_by") not in (None, "color"),
        "{it} has one colour, {other} is coloured by {color_by}.",
    ),
    _Rule(
        _MESHES,
        lambda _, other: bool(other.get("smoothing") or other.get("decimation")),
        "{it} shows the mesh as it was extracted, {other} smoothed or decimated.",
    ),
    _Rule(
        ("vtk_point_gaussian",),
        lambda _, other: other.get("shading") is True,
        "Splats of {it} are unlit.",
    ),
    _Rule(
        ("vtk_point_gaussian",),
        lambda it, other: it.get("footprint") == "disc" and (other.get("blur_radius") or 0.0) > 0.0,
        "{it} has no blur.",
    ),
    _Rule(
        ("vtk_point_gaussian",),
        lambda it, other: _is_ours(other) and it.get("footprint") == "gaussian",
        "{it} blends Gaussians in the order of the voxels, each with the opacity of the transfer function; {other} "
        "sorts them and keeps the opacity of the matter they stand for.",
    ),
    _Rule(
        ("vtk_shadows",),
        lambda _, other: other.ident == "half_angle",
        "{it} casts a grey shadow ray from every sample and scatters by its own model; {other} carries coloured light "
        "from slice to slice.",
    ),
    _Rule(
        ("vtk_normal_map",),
        lambda _, other: other.ident == "bump_mapping",
        "{it} reads colours and normals from pictures of the plane, {other} from the volume in every pixel.",
    ),
    _Rule(
        ("vtk_normal_map",),
        lambda _, other: (other.get("surface"), other.get("normal_source")) not in ((None, None), ("plane", "data")),
        "{it} shows the relief of the data on the cut plane only.",
    ),
)  # fmt: skip


def differences(
    first: str, first_settings: Any, second: str, second_settings: Any, *, light: Light | None = None
) -> list[str]:
    """What two techniques with these settings do differently beside plain unequal settings, a sentence each.

    Parameters
    ----------
    first, second : str
        Ids of the techniques, in any order.
    first_settings, second_settings : object
        Their settings.
    light : Light, optional
        The light of the scene; without it, it sits at the eye.
    """
    shared = light if light is not None else Light()
    sides = _Side(first, first_settings, shared), _Side(second, second_settings, shared)
    sentences = []
    for it, other in (sides, sides[::-1]):
        if it.ident == other.ident or not are_counterparts(it.ident, other.ident):
            continue
        for rule in _RULES:
            if it.ident in rule.of and rule.when(it, other):
                values = {
                    p.name: getattr(other.settings, p.name) for p in parameters_of(type(other.settings))
                }
                sentences.append(
                    rule.words.format(
                        **(values | {"it": it.ident, "other": other.ident, "its_mode": it.get("mode")})
                    )
                )
    return sentences
