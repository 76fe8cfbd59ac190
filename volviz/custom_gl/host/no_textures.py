"""Stands for the textures of a volume where the technique needs none."""

from __future__ import annotations


class NoTextures:
    """Always complete; every level is the full one."""

    complete = True
    coarsest = 0

    def upload(self, max_bytes: int | None = None) -> bool:
        """There is nothing to upload."""
        del max_bytes
        return True

    def select(self, level: int) -> None:
        """There is one level only."""


NO_TEXTURES = NoTextures()
