"""Orientation codes: where the axes of a lattice lead, a letter each, as radiology writes them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError

#: World direction (LPS) of each letter: axis and sign.
LETTERS = {"L": (0, 1), "R": (0, -1), "P": (1, 1), "A": (1, -1), "S": (2, 1), "I": (2, -1)}


def checked_orientation(code: object) -> str:
    """Three letters in capitals.

    Raises
    ------
    InputError
        Others, or two for one axis of the world.
    """
    text = str(code).upper()
    if (
        len(text) != 3
        or any(letter not in LETTERS for letter in text)
        or len({LETTERS[c][0] for c in text}) < 3
    ):
        raise InputError(
            f"orientation must be three letters such as LPS or RAS, one of L and R, one of A and P, one of S and I; "
            f"got {code!r}."
        )
    return text


def direction_of(code: str) -> npt.NDArray[np.float64]:
    """The matrix whose columns are the directions that a code names, shape (3, 3)."""
    matrix = np.zeros((3, 3))
    for column, letter in enumerate(code):
        axis, sign = LETTERS[letter]
        matrix[axis, column] = sign
    return matrix


def orientation_of(direction: npt.ArrayLike) -> str:
    """The code that is nearest to a matrix of directions, shape (3, 3)."""
    matrix = np.asarray(direction, np.float64).reshape(3, 3)
    letters = {pair: letter for letter, pair in LETTERS.items()}
    found = [""] * 3
    rest = np.abs(matrix)
    for _ in range(3):
        # the clearest axis first, so that no axis of the world is named twice
        axis, column = np.unravel_index(int(np.argmax(rest)), (3, 3))
        found[int(column)] = letters[int(axis), 1 if matrix[axis, column] >= 0 else -1]
        rest[axis, :] = rest[:, column] = -1.0
    return "".join(found)
