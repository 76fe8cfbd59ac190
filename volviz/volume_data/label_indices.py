"""Labels of a volume as dense indices: what textures of labels and their palettes are made of."""

from __future__ import annotations

import weakref
from dataclasses import dataclass
from threading import Lock
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.volume_data.volume import Volume

#: Labels up to this number of values apart are found by counting instead of sorting.
COUNTED = 2**26


@dataclass(frozen=True, eq=False)
class LabelIndices:
    """The labels of a volume by number.

    Attributes
    ----------
    labels : ndarray of shape (n,), int64
        The labels that occur and 0, which comes first; the others ascend.
    indices : ndarray of shape (Z, Y, X), uint8, uint16 or uint32
        For each voxel the place of its label in `labels`.
    """

    labels: npt.NDArray[np.int64]
    indices: npt.NDArray[Any]


_lock = Lock()
_known: weakref.WeakKeyDictionary[Volume, LabelIndices] = weakref.WeakKeyDictionary()


def are_labels_known(volume: Volume) -> bool:
    """Whether `label_indices_of` has nothing to compute."""
    with _lock:
        return volume in _known


def label_indices_of(volume: Volume) -> LabelIndices:
    """The labels of a volume, found once.

    Raises
    ------
    InputError
        Values that are no whole numbers.
    """
    with _lock:
        known = _known.get(volume)
    if known is None:
        known = _found(_whole_numbers(volume))
        with _lock:
            _known[volume] = known
    return known


def _whole_numbers(volume: Volume) -> npt.NDArray[Any]:
    array = volume.finite_array
    if array.dtype.kind in "iu":
        return array
    whole = np.rint(array)
    if not np.array_equal(whole, array):
        odd = array[whole != array].flat[0]
        raise InputError(
            f"{volume.name}: labels are whole numbers, and it holds {odd:g}; show it as an image layer."
        )
    low, high = volume.range
    if low < -(2**53) or high > 2**53:
        raise InputError(f"{volume.name}: its values reach from {low:g} to {high:g}, too far for labels.")
    return np.asarray(whole.astype(np.int64))


def _found(array: npt.NDArray[Any]) -> LabelIndices:
    low, high = int(array.min()), int(array.max())
    if high - low < COUNTED:
        # plane by plane: differences of a narrow type would overflow, and the whole in a wide one is large
        seen = np.zeros(high - low + 1, bool)
        for plane in array:
            seen[plane.astype(np.int64) - low] = True
        present = np.flatnonzero(seen) + low
    else:
        present = np.unique(array).astype(np.int64)
    labels = np.concatenate([[0], present[present != 0]]).astype(np.int64)
    kind = np.uint8 if len(labels) <= 2**8 else np.uint16 if len(labels) <= 2**16 else np.uint32
    indices = np.empty(array.shape, kind)
    if high - low < COUNTED:
        place = np.zeros(high - low + 1, kind)
        place[labels[1:] - low] = np.arange(1, len(labels))
        for source, target in zip(array, indices, strict=True):
            target[:] = place[source.astype(np.int64) - low]
    else:
        order = np.argsort(labels)
        for source, target in zip(array, indices, strict=True):
            target[:] = order[np.searchsorted(labels[order], source.astype(np.int64))]
    return LabelIndices(labels, indices)
