"""RT structure sets: outlines drawn on slices, filled as labels (DICOM PS3.3, C.8.8.5 and C.8.8.6)."""

from __future__ import annotations

import warnings
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.dicom.lattice import same_places
from volviz.volume_data.description import Label

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt

    from volviz.io.reader import LoadRequest

_STRUCTURE_SET = "1.2.840.10008.5.1.4.1.1.481.3"
#: Pixels across the outlines where there are no images whose lattice they could have.
_ACROSS = 200
#: An outline belongs to a slice from which it is not farther away than this, as a fraction of their distance.
_NEAR = 0.5


@dataclass(frozen=True)
class Structure:
    """One outlined thing.

    Attributes
    ----------
    label : Label
    outlines : list of ndarray of shape (N, 3)
        World positions of the corners of closed outlines, each in a plane, mm.
    """

    label: Label
    outlines: list[npt.NDArray[np.float64]] = field(default_factory=list)


@dataclass(frozen=True)
class StructureSet:
    """What a file holds: its structures, and the series of images on which they were drawn."""

    structures: list[Structure]
    series: frozenset[str]
    #: Points and open lines, which enclose nothing.
    left_out: int


def structure_set(path: Path) -> StructureSet | None:
    """The structures of a file; None where it is no structure set, or a damaged one."""
    import pydicom
    from pydicom.config import disable_value_validation

    with warnings.catch_warnings(), disable_value_validation():
        warnings.simplefilter("ignore")
        try:
            data = pydicom.dcmread(path, force=True)
            return _structures(data) if str(data.get("SOPClassUID", "")) == _STRUCTURE_SET else None
        except OSError:
            raise
        except Exception:  # noqa: BLE001 - what a damaged file raises inside the library has no end
            return None


def _structures(data: Any) -> StructureSet:
    names = {
        int(each.ROINumber): str(each.get("ROIName", "")) for each in data.get("StructureSetROISequence", ())
    }
    structures, left_out = [], 0
    for owner in data.get("ROIContourSequence", ()):
        number = int(owner.ReferencedROINumber)
        color = [float(v) / 255.0 for v in owner.get("ROIDisplayColor") or ()]
        known = (color[0], color[1], color[2]) if len(color) == 3 and max(color) <= 1 else None
        structure = Structure(Label(number, names.get(number, ""), known))
        for contour in owner.get("ContourSequence", ()):
            corners = np.array([float(v) for v in contour.get("ContourData") or ()], np.float64)
            closed = str(contour.get("ContourGeometricType", "")).startswith("CLOSED")
            if not closed or len(corners) < 9 or len(corners) % 3 or not np.all(np.isfinite(corners)):
                left_out += 1
                continue
            structure.outlines.append(corners.reshape(-1, 3))
        structures.append(structure)
    series = {
        str(image.SeriesInstanceUID)
        for frame in data.get("ReferencedFrameOfReferenceSequence", ())
        for study in frame.get("RTReferencedStudySequence", ())
        for image in study.get("RTReferencedSeriesSequence", ())
    }
    return StructureSet([each for each in structures if each.outlines], frozenset(series), left_out)


def own_lattice(found: StructureSet) -> tuple[npt.NDArray[np.float64], tuple[int, int, int]]:
    """A lattice around outlines without images: its slices are their planes.

    Returns
    -------
    matrix : ndarray of shape (3, 4)
        Index (i, j, k, 1) to world, mm.
    dimensions : tuple of 3 ints
    """
    outlines = [outline for each in found.structures for outline in each.outlines]
    normal = _normal(max(outlines, key=len))
    across = np.eye(3)[int(np.argmin(np.abs(normal)))]
    row = np.array([1.0, 0, 0]) if abs(normal[2]) > 1 - 1e-6 else np.cross(normal, across)
    row /= np.linalg.norm(row)
    axes = np.stack([row, np.cross(normal, row), normal], axis=1)
    points = np.concatenate(outlines) @ axes
    planes = np.array([float(np.mean(outline @ normal)) for outline in outlines])
    places = same_places(planes)
    depths = np.array([planes[places == n].mean() for n in range(int(places.max()) + 1)])
    step = float(np.median(np.diff(depths))) if len(depths) > 1 else 1.0
    low, high = points.min(axis=0), points.max(axis=0)
    pixel = float(max(high[0] - low[0], high[1] - low[1])) / _ACROSS
    spacing = np.array([pixel, pixel, step])
    first = np.array([low[0] - pixel, low[1] - pixel, depths[0]])
    counts = np.ceil((high + spacing - first) / spacing).astype(int) + 1
    slices = max(round((depths[-1] - depths[0]) / step) + 1, 2)
    return np.c_[axes * spacing, axes @ first], (int(counts[0]), int(counts[1]), slices)


def _normal(outline: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Unit vector across the plane of an outline, upwards."""
    middle = outline - outline.mean(axis=0)
    normal = np.cross(middle, np.roll(middle, -1, axis=0)).sum(axis=0)
    length = float(np.linalg.norm(normal))
    if length == 0:
        return np.array([0.0, 0.0, 1.0])
    normal = normal / length
    upwards: npt.NDArray[np.float64] = normal if normal[int(np.argmax(np.abs(normal)))] > 0 else -normal
    return upwards


def filled(
    request: LoadRequest,
    found: StructureSet,
    matrix: npt.NDArray[np.float64],
    dimensions: tuple[int, int, int],
) -> npt.NDArray[Any]:
    """Labels: voxels whose middle lies inside of the outlines of a structure, by the even-odd rule.

    Parameters
    ----------
    matrix : ndarray of shape (3, 4)
        Index (i, j, k, 1) to world, mm.
    dimensions : tuple of 3 ints
        Voxels along (x, y, z).

    Returns
    -------
    ndarray of shape (z, y, x), uint8, or uint16 where a number needs it
        0 where nothing is; where structures overlap the one that comes later in the file, and a note says so.
    """
    width, height, depth = dimensions
    highest = max((each.label.number for each in found.structures), default=0)
    labels = np.zeros((depth, height, width), np.uint8 if highest < 256 else np.uint16)
    back = np.linalg.inv(matrix[:, :3])
    overlap, outside = False, 0
    for number, structure in enumerate(found.structures):
        request.report(number / len(found.structures), "filling outlines")
        slices: dict[int, list[npt.NDArray[np.float64]]] = defaultdict(list)
        for outline in structure.outlines:
            corners = (outline - matrix[:, 3]) @ back.T
            at = float(corners[:, 2].mean())
            if not -_NEAR <= at < depth - 1 + _NEAR or np.ptp(corners[:, 2]) > 2 * _NEAR:
                outside += 1
                continue
            slices[round(at)].append(corners[:, :2])
        for k, outlines in slices.items():
            inside = np.zeros((height, width), bool)
            for outline in outlines:
                inside ^= _inside(outline, width, height)
            overlap = overlap or bool(np.any(labels[k][inside]))
            labels[k][inside] = structure.label.number
    if overlap:
        request.note("Structures overlap; where they do, the one that comes later in the file is shown.")
    if outside:
        request.note(f"{outside} outlines lie outside of the slices, or across them, and were left out.")
    return labels


def _inside(outline: npt.NDArray[np.float64], width: int, height: int) -> npt.NDArray[np.bool_]:
    """Pixels whose middle lies inside of one closed outline of shape (N, 2), row by row."""
    inside = np.zeros((height, width), bool)
    start, end = outline, np.roll(outline, -1, axis=0)
    low, high = np.minimum(start[:, 1], end[:, 1]), np.maximum(start[:, 1], end[:, 1])
    first, last = max(int(np.ceil(low.min())), 0), min(int(np.floor(high.max())), height - 1)
    for row in range(first, last + 1):
        # an edge holds its lower end, not its upper one, so that a corner is counted once
        cut = (low <= row) & (row < high)
        a, b = start[cut], end[cut]
        crossings = np.sort(a[:, 0] + (row - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1]))
        for left, right in zip(crossings[::2], crossings[1::2], strict=False):
            inside[row, max(int(np.ceil(left)), 0) : max(int(np.floor(right)) + 1, 0)] ^= True
    return inside
