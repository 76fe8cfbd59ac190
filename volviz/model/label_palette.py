"""Colours and opacities of labels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Color = tuple[float, float, float]

#: Step of the hue from one label to the next: multiples of the golden ratio stay far apart.
_HUE_STEP = 0.618033988749895
#: Lightness and saturation change with every label as well.
_LIGHTNESS = (0.62, 0.5, 0.72)
_SATURATION = (0.75, 0.6)


def label_colors(labels: npt.NDArray[np.int64]) -> npt.NDArray[np.float64]:
    """The usual colours of labels, shape (n, 3) in 0..1: the same label always has the same one.

    Parameters
    ----------
    labels : ndarray of shape (n,)
    """
    number = np.abs(labels)
    hue = number * _HUE_STEP % 1.0
    light, saturation = np.take(_LIGHTNESS, number % 3), np.take(_SATURATION, number % 2)
    # HSL to RGB (Joblove and Greenberg 1978)
    spread = saturation * np.minimum(light, 1.0 - light)
    k = (np.array([0.0, 8.0, 4.0]) + 12.0 * hue[:, None]) % 12.0
    return np.asarray(light[:, None] - spread[:, None] * np.clip(np.minimum(k - 3.0, 9.0 - k), -1.0, 1.0))


@dataclass(frozen=True)
class LabelLook:
    """How labels are coloured and which are seen.

    Attributes
    ----------
    colors : tuple of (label, colour)
        Those that differ from the usual ones.
    hidden : tuple of ints
        Labels that are not shown; nor is 0.
    opacity : float
        Of the others, 0..1.
    opacities : tuple of (label, float)
        Factors on that of single labels, 0..1.
    """

    colors: tuple[tuple[int, Color], ...] = ()
    hidden: tuple[int, ...] = ()
    opacity: float = 1.0
    opacities: tuple[tuple[int, float], ...] = ()

    def palette(self, labels: npt.NDArray[np.int64]) -> npt.NDArray[np.float32]:
        """Colour and opacity of each label, shape (n, 4).

        Parameters
        ----------
        labels : ndarray of shape (n,)
            With 0 first and the others ascending (`LabelIndices.labels`); what the look says of others is left out.
        """
        palette = np.empty((len(labels), 4), np.float32)
        palette[:, :3] = label_colors(labels)
        palette[:, 3] = self.opacity
        if self.colors:
            place, known = _places(labels, [label for label, _ in self.colors])
            palette[place[known], :3] = np.array([color for _, color in self.colors], np.float32)[known]
        if self.opacities:
            place, known = _places(labels, [label for label, _ in self.opacities])
            palette[place[known], 3] *= np.array([factor for _, factor in self.opacities], np.float32)[known]
        if self.hidden:
            place, known = _places(labels, self.hidden)
            palette[place[known], 3] = 0.0
        palette[0, 3] = 0.0
        return palette


def _places(
    labels: npt.NDArray[np.int64], wanted: Sequence[int]
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.bool_]]:
    """Where labels stand in a list whose first entry is 0 and the others ascend, and which of them do."""
    numbers = np.array(wanted, np.int64)
    if len(labels) == 1:
        return np.zeros(len(numbers), np.int64), numbers == 0
    place = np.minimum(np.searchsorted(labels[1:], numbers) + 1, len(labels) - 1)
    return place, labels[place] == numbers


@dataclass(frozen=True)
class ShownLabels:
    """How a layer of labels is drawn: its look, and whether borders pass between voxels or along them."""

    look: LabelLook
    smooth: bool = True
