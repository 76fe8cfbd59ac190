"""Finding a name by a few of its letters."""

from __future__ import annotations

WHOLE, START, INITIALS, SCATTERED = 60.0, 40.0, 50.0, 20.0
"""Points for letters that stand together, for doing so at the start of a word, for letters that begin words, and for
letters that only follow one another."""


def match_score(wanted: str, text: str) -> float | None:
    """How well a text fits what was typed.

    Parameters
    ----------
    wanted : str
        Words, or a few letters of them, in any order; case does not matter.
    text : str
        Where they are looked for.

    Returns
    -------
    float or None
        More is better, 0 for nothing typed; None when a word does not occur at all.
    """
    low, total = text.lower(), 0.0
    for word in wanted.lower().split():
        points = _word_score(word, low)
        if points is None:
            return None
        total += points
    return total


def _word_score(word: str, text: str) -> float | None:
    at = text.find(word)
    starts = [
        i for i, letter in enumerate(text) if letter.isalnum() and (i == 0 or not text[i - 1].isalnum())
    ]
    if at >= 0:
        begun = next((start for start in starts if text.startswith(word, start)), None)
        if begun is not None:
            return WHOLE + START - 0.1 * begun
        return WHOLE - 0.1 * at
    initials = "".join(text[start] for start in starts)
    if word in initials:
        return INITIALS - 0.1 * initials.index(word)
    first = last = -1
    for letter in word:
        last = text.find(letter, last + 1)
        if last < 0:
            return None
        first = last if first < 0 else first
    # letters far apart are hardly what was meant
    return SCATTERED * len(word) / (last - first + 1)
