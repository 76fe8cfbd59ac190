"""All techniques against their counterparts on all bundled samples."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from volviz.custom_gl.registry import techniques
from volviz.custom_gl.technique import TechniqueInfo
from volviz.io import load
from volviz.io.samples import samples
from volviz.model.volume import Volume

#: Techniques of ours that draw the same thing by different methods.
ALIKE = (("raycast", "two_pass_raycast", "slicing"), ("marching_cubes", "marching_tetrahedra"))


def suite_groups() -> list[list[TechniqueInfo]]:
    """Techniques that stand for one another: ours, and those of VTK that name ours as counterparts.

    Techniques without any counterpart are left out.
    """
    known = techniques()
    groups: list[list[str]] = [[ident for ident in group if ident in known] for group in ALIKE]
    placed = {ident for group in groups for ident in group}
    groups += [[ident] for ident, info in known.items() if ident not in placed and not info.counterpart_of]
    for ident, info in known.items():
        theirs = info.counterpart_of
        for group in groups:
            if ident not in group and any(other in group for other in theirs):
                group.append(ident)
    return [[known[ident] for ident in group] for group in groups if len(group) > 1]


def suite_volumes() -> list[Callable[[], tuple[Volume, str | None]]]:
    """The bundled samples, each as a function that loads it and gives it with the preset that shows it well."""
    return [partial(_loaded, f"sample:{sample.id}", sample.preset) for sample in samples()]


def _loaded(source: str, preset: str | None) -> tuple[Volume, str | None]:
    return load(source), preset
