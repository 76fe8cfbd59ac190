"""All techniques against their counterparts on all bundled samples."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from volviz.custom_gl.registry import families
from volviz.custom_gl.technique import TechniqueInfo
from volviz.io import load
from volviz.io.samples import samples
from volviz.volume_data.volume import Volume


def suite_groups() -> list[tuple[TechniqueInfo, ...]]:
    """Techniques that stand for one another; those without any counterpart are left out."""
    return [family for family in families() if len(family) > 1]


def suite_volumes() -> list[Callable[[], tuple[Volume, str | None]]]:
    """The bundled samples, each as a function that loads it and gives it with the preset that shows it well."""
    return [partial(_loaded, f"sample:{sample.id}", sample.preset) for sample in samples()]


def _loaded(source: str, preset: str | None) -> tuple[Volume, str | None]:
    return load(source), preset
