"""Whether values are labels, and which."""

from __future__ import annotations

import numpy as np

from volviz.model.transfer.first_look import FirstLook, Floats

#: Distinct values up to which whole numbers are taken for labels.
MOST_LABELS = 64


def label_values(look: FirstLook) -> Floats | None:
    """The distinct values when the data look like a label map: few whole numbers in flat patches."""
    if not look.integer:
        return None
    distinct = np.unique(look.values)
    if not 2 <= len(distinct) <= MOST_LABELS:
        return None
    if len(distinct) == 2:
        return distinct
    inside = look.values != commonest(look.shell)
    if not inside.any() or (look.gradient[inside] == 0).mean() < 0.25:
        return None
    # A smooth field of few grey levels changes by one level at a time; labels meet in any order.
    if len(distinct) > 8:
        ranks = np.searchsorted(distinct, look.values)
        jumps = np.concatenate([np.abs(np.diff(ranks, axis=axis)).ravel() for axis in range(3)])
        jumps = jumps[jumps > 0]
        if (jumps == 1).mean() > 0.8:
            return None
    return distinct


def commonest(values: Floats) -> float:
    """The value that most of the values have."""
    distinct, counts = np.unique(values, return_counts=True)
    return float(distinct[np.argmax(counts)])
