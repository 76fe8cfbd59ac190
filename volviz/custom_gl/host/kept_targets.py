"""Targets of the sizes that a volume's pictures were last drawn in."""

from __future__ import annotations

from volviz.custom_gl.gpu.context import Gpu
from volviz.custom_gl.gpu.targets import Target

#: Targets of different sizes that are kept: full, and some levels of interaction.
KEPT = 3


class KeptTargets:
    """The last few targets of one owner; older ones are dropped."""

    def __init__(self, owner: int) -> None:
        self._owner = owner
        self._names: dict[Target, str] = {}

    def get(self, gpu: Gpu, purpose: str, size: tuple[int, int], shown: Target | None) -> Target:
        """A target to draw into; `shown`, which holds the picture now shown, is not dropped for it."""
        name = f"{purpose} {size[0]} x {size[1]} of {self._owner}"
        target = gpu.targets.get(name, size)
        # the one used last stands last
        self._names.pop(target, None)
        self._names[target] = name
        for old in list(self._names)[:-KEPT]:
            if old is not shown:
                gpu.targets.drop(self._names.pop(old))
        return target

    def release(self, gpu: Gpu) -> None:
        """Drop all."""
        for name in self._names.values():
            gpu.targets.drop(name)
        self._names.clear()
