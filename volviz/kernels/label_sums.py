"""Counts, boxes and sums of values for each label, in one pass over the voxels."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.kernels.compiled import compiled

Array = npt.NDArray[Any]


@compiled
def count_labels(indices: Array, counts: Array, boxes: Array) -> None:
    """Count the voxels of each label and find the box around them.

    Parameters
    ----------
    indices : ndarray of shape (Z, Y, X), unsigned integers
        Row of its label for each voxel.
    counts : ndarray of shape (n,), int64
        Filled; zeros before.
    boxes : ndarray of shape (n, 6), int64
        Filled with (i0, i1, j0, j1, k0, k1), the last ones no more; of labels that do not occur i0 > i1.
    """
    depth, height, width = indices.shape
    for row in range(len(counts)):
        boxes[row, 0], boxes[row, 2], boxes[row, 4] = width, height, depth
    for k in range(depth):
        for j in range(height):
            for i in range(width):
                row = indices[k, j, i]
                counts[row] += 1
                box = boxes[row]
                box[0], box[1] = min(box[0], i), max(box[1], i + 1)
                box[2], box[3] = min(box[2], j), max(box[3], j + 1)
                box[4], box[5] = min(box[4], k), max(box[5], k + 1)


@compiled
def add_values(
    indices: Array, values: Array, counts: Array, means: Array, squares: Array, low: Array, high: Array
) -> None:
    """Add the finite values of voxels to what is known of their labels (Welford 1962).

    Parameters
    ----------
    indices, values : ndarrays of shape (n,)
        Row of its label, and value of each voxel.
    counts, means, squares, low, high : ndarrays of shape (labels,), int64 and float64
        Number, mean, sum of squared distances from it, and limits of the values so far.
    """
    for place in range(len(indices)):
        value = float(values[place])
        if np.isfinite(value):
            row = indices[place]
            counts[row] += 1
            away = value - means[row]
            means[row] += away / counts[row]
            squares[row] += away * (value - means[row])
            low[row] = min(low[row], value)
            high[row] = max(high[row], value)
