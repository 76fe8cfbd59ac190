"""Labels as a table: voxels, volume and box of each, and what an image has under it."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.errors import Cancelled
from volviz.kernels.label_sums import add_values, count_labels
from volviz.measure.results import cell_volume, length_unit
from volviz.volume_data.label_indices import LabelIndices, label_indices_of
from volviz.volume_data.volume import Volume

Floats = npt.NDArray[np.float64]
Cancel = Callable[[], bool]


@dataclass(frozen=True, eq=False)
class ValuesUnder:
    """What an image has under each label; NaN where it has no finite value there.

    Attributes
    ----------
    name, unit : str
        Of the image and of its values.
    counts : ndarray of shape (n,), int64
        Voxels of the image that lie in the label and have a finite value.
    means, deviations, minima, maxima : ndarrays of shape (n,)
        In `unit`; the deviation is that of the values themselves (divided by their number).
    """

    name: str
    unit: str
    counts: npt.NDArray[np.int64]
    means: Floats
    deviations: Floats
    minima: Floats
    maxima: Floats


@dataclass(frozen=True, eq=False)
class LabelTable:
    """The labels of a volume, without 0, ascending.

    Attributes
    ----------
    labels, counts : ndarrays of shape (n,), int64
        Their numbers, and how many voxels each has.
    volumes : ndarray of shape (n,)
        In cubic units of length.
    boxes : ndarray of shape (n, 6), int64
        Voxels (i0, i1, j0, j1, k0, k1) around each, those of i1, j1 and k1 no more.
    length_unit : str
        Of spacing: "mm" where the file does not say it otherwise.
    values : ValuesUnder or None
        Of an image, where one was given.
    """

    labels: npt.NDArray[np.int64]
    counts: npt.NDArray[np.int64]
    volumes: Floats
    boxes: npt.NDArray[np.int64]
    length_unit: str
    values: ValuesUnder | None = None

    def rows(self, names: Mapping[int, str] | None = None) -> Iterator[dict[str, Any]]:
        """One row a label, by the titles of columns, with units in them."""
        known, values = names or {}, self.values
        unit = f" ({values.unit})" if values is not None and values.unit else ""
        for n, label in enumerate(self.labels.tolist()):
            row = {
                "label": label,
                "name": known.get(label, ""),
                "voxels": int(self.counts[n]),
                f"volume ({self.length_unit}³)": float(self.volumes[n]),
            }
            if values is not None:
                row |= {
                    f"mean{unit}": float(values.means[n]),
                    f"standard deviation{unit}": float(values.deviations[n]),
                    f"minimum{unit}": float(values.minima[n]),
                    f"maximum{unit}": float(values.maxima[n]),
                    "values": int(values.counts[n]),
                }
            yield row

    def to_csv(self, names: Mapping[int, str] | None = None) -> str:
        """All rows as text, with commas between the columns and titles in the first line (RFC 4180)."""
        text = io.StringIO()
        writer: Any = None
        for row in self.rows(names):
            if writer is None:
                writer = csv.DictWriter(text, list(row), lineterminator="\n")
                writer.writeheader()
            writer.writerow({key: f"{v:.9g}" if isinstance(v, float) else v for key, v in row.items()})
        return text.getvalue()


def label_statistics(
    labels: Volume, image: Volume | None = None, *, cancel: Cancel | None = None
) -> LabelTable:
    """Voxels and volume of every label, and what an image has under it.

    Parameters
    ----------
    labels : Volume
        Whole numbers; 0 is nothing.
    image : Volume, optional
        Its values are told by label. It may have voxels of its own: each counts for the label in whose voxel its centre
        lies.
    cancel : callable() -> bool, optional
        Asked now and then; True stops the work.

    Returns
    -------
    LabelTable

    Raises
    ------
    InputError
        Labels that are no whole numbers.
    Cancelled
    """
    known = label_indices_of(labels)
    count = len(known.labels)
    counts, boxes = np.zeros(count, np.int64), np.zeros((count, 6), np.int64)
    count_labels(known.indices, counts, boxes)
    # 0 comes first whether it occurs or not
    table = LabelTable(
        known.labels[1:],
        counts[1:],
        counts[1:].astype(np.float64) * cell_volume(labels),
        boxes[1:],
        length_unit(labels),
    )
    return table if image is None else replace(table, values=_under(labels, known, image, cancel))


def _under(labels: Volume, known: LabelIndices, image: Volume, cancel: Cancel | None) -> ValuesUnder:
    n = len(known.labels)
    counts, means, squares = np.zeros(n, np.int64), np.zeros(n), np.zeros(n)
    low, high = np.full(n, np.inf), np.full(n, -np.inf)
    for rows, values in _planes(labels, known, image, cancel):
        add_values(rows, values, counts, means, squares, low, high)
    deviations = np.sqrt(squares / np.maximum(counts, 1))
    for column in (means, deviations, low, high):
        column[counts == 0] = np.nan
    return ValuesUnder(image.name, image.unit, counts[1:], means[1:], deviations[1:], low[1:], high[1:])


def _planes(
    labels: Volume, known: LabelIndices, image: Volume, cancel: Cancel | None
) -> Iterator[tuple[npt.NDArray[Any], npt.NDArray[Any]]]:
    """Rows of labels and values of the voxels of an image, plane by plane, without those that lie outside."""
    same = image.array.shape == labels.array.shape and np.allclose(
        image.index_to_world, labels.index_to_world, rtol=0.0, atol=1e-6 * min(labels.spacing)
    )
    matrix = labels.world_to_index @ image.index_to_world
    j, i = np.indices(image.array.shape[1:]).reshape(2, -1)
    width, height, depth = labels.dimensions
    for k, plane in enumerate(image.array):
        if cancel is not None and cancel():
            raise Cancelled("The statistics were cancelled.")
        if same:
            yield known.indices[k].ravel(), plane.ravel()
            continue
        places = (
            matrix[:3, 0, None] * i + matrix[:3, 1, None] * j + (matrix[:3, 2] * k + matrix[:3, 3])[:, None]
        )
        x, y, z = np.floor(places + 0.5).astype(np.int64)
        inside = (x >= 0) & (x < width) & (y >= 0) & (y < height) & (z >= 0) & (z < depth)
        if inside.any():
            yield known.indices[z[inside], y[inside], x[inside]], plane.ravel()[inside]
