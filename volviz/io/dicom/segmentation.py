"""DICOM segmentations as label maps: every voxel has the number of its segment (DICOM PS3.3, C.8.20)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.dicom.pixels import slices_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from volviz.io.dicom.headers import Frame
    from volviz.io.reader import LoadRequest


def label_map(
    request: LoadRequest, frames: Sequence[Frame], places: npt.NDArray[np.int64], count: int
) -> npt.NDArray[Any]:
    """Numbers of segments on the lattice of a segmentation.

    Parameters
    ----------
    frames : sequence of Frame
        Of all segments.
    places : ndarray of shape (N,)
        Index of the slice that each frame lies in.
    count : int
        Number of slices.

    Returns
    -------
    ndarray of shape (count, rows, columns), uint8, or uint16 where a number needs it
        0 where no segment is; where segments overlap the one with the higher number, and a note says so.
    """
    first = frames[0]
    highest = max(f.segment for f in frames)
    labels = np.zeros((count, first.rows, first.columns), np.uint8 if highest < 256 else np.uint16)
    order = sorted(range(len(frames)), key=lambda n: (frames[n].segment, n))
    overlap = False
    for at, pixels in slices_of(request, [frames[n] for n in order]):
        frame, place = frames[order[at]], int(places[order[at]])
        if frame.segment == 0:
            # a label map: the pixels are the numbers
            if int(pixels.max()) > np.iinfo(labels.dtype).max:
                labels = labels.astype(np.uint16)
            labels[place] = pixels
            continue
        inside = (
            2 * pixels.astype(np.float64) >= first.file.fractional if first.file.fractional else pixels > 0
        )
        overlap = overlap or bool(np.any(labels[place][inside]))
        labels[place][inside] = np.maximum(labels[place][inside], frame.segment)
    if overlap:
        request.note("Segments overlap; where they do, the one with the higher number is shown.")
    if first.file.fractional:
        request.note("The segments are fractions; a voxel belongs to a segment from one half on.")
    return labels
