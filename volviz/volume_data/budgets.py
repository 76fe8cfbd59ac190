"""How much memory volumes may take, and how much their textures: what the user says, for the whole process."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, replace

from volviz.errors import InputError

#: Environment variable with the bytes of textures, in megabytes, where nobody has said it otherwise.
TEXTURE_MB = "VOLVIZ_TEXTURE_MB"
_TEXTURE_MB = "2048"


@dataclass(frozen=True)
class Budgets:
    """What the user allows; None leaves it to what is free.

    Attributes
    ----------
    memory : int or None
        Bytes of main memory that a volume may take, with what drawing makes of it.
    texture : int or None
        Bytes of the texture of a volume; None is what ``VOLVIZ_TEXTURE_MB`` says, or 2 GiB.
    """

    memory: int | None = None
    texture: int | None = None

    @property
    def texture_bytes(self) -> int:
        """Bytes of the texture of a volume.

        Raises
        ------
        InputError
            ``VOLVIZ_TEXTURE_MB`` is no number.
        """
        if self.texture is not None:
            return self.texture
        text = os.environ.get(TEXTURE_MB, _TEXTURE_MB)
        if not text.isdigit() or int(text) < 1:
            raise InputError(f"{TEXTURE_MB} must be a whole number of megabytes, at least 1, got {text!r}.")
        return int(text) << 20


_chosen = Budgets()


def budgets() -> Budgets:
    """What the user allows now."""
    return _chosen


def set_budgets(**changes: int | None) -> Budgets:
    """Allow something else from now on; gives back what was allowed before.

    Parameters
    ----------
    memory, texture : int or None
        As in `Budgets`; what is not named stays.
    """
    global _chosen
    before, _chosen = _chosen, replace(_chosen, **changes)
    return before


def parsed_bytes(text: str, what: str) -> int:
    """Bytes of "512MiB", "2 GB" or "1.5g"; a number alone is one of bytes, and all units are powers of 1024.

    Raises
    ------
    InputError
        It is none of these, or less than a megabyte.
    """
    found = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*(?:([kmgt]?)(?:i?b)?)\s*", text.lower())
    count = 0 if found is None else int(float(found[1]) * 1024 ** _exponent(found[2]))
    if count < 1 << 20:
        raise InputError(
            f"{what} takes an amount of memory of at least 1 MiB such as 512MiB or 2GiB, got {text!r}."
        )
    return count


def _exponent(letter: str) -> int:
    return {"": 0, "k": 1, "m": 2, "g": 3, "t": 4}[letter]


def bytes_in_words(count: float) -> str:
    """An amount of memory as people read it: "312 MiB", "1.5 GiB"."""
    return f"{count / 2**30:.3g} GiB" if count >= 2**30 else f"{count / 2**20:.3g} MiB"
