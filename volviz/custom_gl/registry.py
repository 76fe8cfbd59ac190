"""Discovery of techniques: every folder in ``techniques/`` and every ``volviz.techniques`` entry point."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache, lru_cache
from importlib.metadata import entry_points
from typing import Any

from volviz.custom_gl.technique import TechniqueInfo
from volviz.errors import InputError

ENTRY_POINTS = "volviz.techniques"


@lru_cache(maxsize=1)
def techniques() -> dict[str, TechniqueInfo]:
    """All techniques by id, in the order of their lists."""
    from volviz.custom_gl import techniques as package

    found: list[TechniqueInfo] = []
    for module in pkgutil.iter_modules(package.__path__):
        if module.ispkg:
            info = importlib.import_module(f"{package.__name__}.{module.name}").TECHNIQUE
            if info.id != module.name:
                raise RuntimeError(f"technique {info.id!r} lies in the folder {module.name!r}")
            found.append(info)
    for entry in entry_points(group=ENTRY_POINTS):
        info = entry.load()
        if any(info.id == other.id for other in found):
            raise RuntimeError(f"two techniques are called {info.id!r}; the second one is {entry.value}")
        found.append(info)
    return {info.id: info for info in sorted(found, key=lambda info: (info.order, info.id))}


@cache
def technique(technique_id: str) -> TechniqueInfo:
    """The technique of that id; of our own ones only its folder is imported.

    Raises
    ------
    InputError
        There is none; the sentence lists the ids.
    """
    from volviz.custom_gl import techniques as package

    if technique_id in {module.name for module in pkgutil.iter_modules(package.__path__)}:
        info: TechniqueInfo = importlib.import_module(f"{package.__name__}.{technique_id}").TECHNIQUE
        return info
    known = techniques()
    if technique_id not in known:
        raise InputError(f"there is no technique called {technique_id!r}; there are {', '.join(known)}.")
    return known[technique_id]


def known_settings(technique_id: str) -> type[Any] | None:
    """Settings class of a technique, None when there is no such technique; for reading sessions."""
    info = techniques().get(technique_id)
    return None if info is None else info.settings


@lru_cache(maxsize=1)
def families() -> tuple[tuple[TechniqueInfo, ...], ...]:
    """Techniques that show the same thing: ours, followed by those that name one of them as a counterpart."""
    joined = {ident: {ident} for ident in techniques()}
    for ident, info in techniques().items():
        for other in info.counterpart_of:
            if other in joined:
                family = joined[ident] | joined[other]
                joined |= dict.fromkeys(family, family)
    order = list(techniques())
    distinct = dict.fromkeys(tuple(sorted(family, key=order.index)) for family in joined.values())
    return tuple(
        tuple(sorted((techniques()[ident] for ident in family), key=lambda info: bool(info.counterpart_of)))
        for family in distinct
    )


def are_counterparts(first: str, second: str) -> bool:
    """Whether two techniques show the same thing, so that their images can be compared."""
    return first == second or any({first, second} <= {info.id for info in family} for family in families())
