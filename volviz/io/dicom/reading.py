"""From DICOM files to a source of volumes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.io.axes import choose, to_zyx
from volviz.io.dicom import grouping, lattice
from volviz.io.dicom.finding import DIRECTORY_NAME, files_below, files_of_directory
from volviz.io.dicom.headers import Frame, read_frames
from volviz.io.dicom.pixels import is_scaled_alike, slices_of, values_of
from volviz.io.dicom.segmentation import label_map
from volviz.io.dicom.structures import StructureSet, filled, own_lattice, structure_set
from volviz.io.file_source import file_source
from volviz.io.geometry import is_usable
from volviz.io.memory import check_memory
from volviz.io.scaling import rescaled

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.geometry import Geometry
    from volviz.io.reader import LoadRequest


def open_source(request: LoadRequest) -> FileSource:
    """The largest series of a folder, or the one asked for, with all its time points; outlines of a structure set."""
    path = request.path
    if path.is_file() and path.name.upper() != DIRECTORY_NAME and not read_frames(path):
        outlined = structure_set(path)
        if outlined is not None:
            return _structures(request, outlined)
    frames = _frames(request)
    if not frames and any("is cut off" in note for note in request.notes):
        raise request.error("all of its images are cut off: their pixel data is incomplete; get them again.")
    if not frames:
        raise request.error("it holds no DICOM image that can be read; choose another one.")
    entries = grouping.entries_of(frames)
    frames = grouping.one_kind(request, grouping.one_series(request, frames))
    file = frames[0].file
    if file.labels is not None:
        return _segmentation(request, frames)
    if file.is_flat:
        raise request.error(
            "it is a whole slide: one flat image in tiles, and no volume; choose another one."
        )
    stacks = grouping.volumes(request, frames)
    slices, geometry = _lattice(request, stacks[0])

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        stack = stacks[choose(request, "T", len(stacks))]
        if request.box is None:
            return _stack(request, stack, slices)
        i0, i1, j0, j1, k0, k1 = request.box
        if slices.is_complete:
            part = _stack(request, stack[k0:k1], slices.part(k0, k1))
        else:
            part = _stack(request, stack, slices)[k0:k1]
        return np.ascontiguousarray(part[:, j0:j1, i0:i1])

    times = [stack[0].time for stack in stacks]
    known = [time for time in times if time is not None]
    colours = file.samples in (3, 4)
    shape = (len(stacks), slices.count, frames[0].rows, frames[0].columns)
    # no name of a person, no date, no number of a study: only what the image needs
    return file_source(
        request,
        values,
        "TZYXS" if colours else "TZYX",
        (*shape, file.samples) if colours else shape,
        geometry,
        format="DICOM",
        name=f"DICOM {file.modality or 'image'} {slices.count} slices",
        colour=True,
        dtype=f"{'int' if file.is_signed else 'uint'}{file.bits}" if file.bits in (8, 16, 32) else None,
        times=known if len(set(known)) == len(times) and known == sorted(known) else None,
        unit=file.unit,
        length_unit="mm",
        entries=entries,
        modality=file.modality,
    )


def _frames(request: LoadRequest) -> list[Frame]:
    """All frames around the path; those of files that are cut off are left out."""
    path = request.path
    if path.is_dir():
        return _of_files(request, list(files_below(path)))
    if path.name.upper() == DIRECTORY_NAME or not (own := read_frames(path)):
        listed = files_of_directory(path)
        if listed:
            return _of_files(request, listed)
        raise request.error("this DICOM file holds no image that can be read; choose another one.")
    if own[0].file.cut_off:
        raise request.error("the file is cut off: its pixel data is incomplete; get it again.")
    if own[0].file.count > 1:
        return list(own)
    # a file of many frames, or of another kind than the one asked for, does not belong into its stack
    around = _of_files(
        request, [p for p in files_below(path.parent) if p.parent == path.parent], own[0].file.series
    )
    kept = [
        f
        for f in around
        if f.file.count == 1 and f.file.series == own[0].file.series and grouping.alike(f, own[0])
    ]
    files = len({f.file.path for f in kept})
    if files > 1:
        request.note(f"The file is one of {files} slices of a series in its folder; all of them are shown.")
    return kept


def _of_files(request: LoadRequest, paths: list[Path], series: str | None = None) -> list[Frame]:
    """Frames of many files, with a note on those that are cut off (of the series that matters)."""
    found: list[Frame] = []
    for number, path in enumerate(paths):
        request.report(0.3 * number / len(paths), "reading headers")
        frames = read_frames(path)
        if not frames:
            continue
        if not frames[0].file.cut_off:
            found.extend(frames)
        elif series is None or frames[0].file.series == series:
            request.note(f"{path.name} is cut off and was left out.")
    return found


def _lattice(request: LoadRequest, frames: list[Frame]) -> tuple[lattice.SliceLattice, Geometry]:
    """Where the slices of one volume lie."""
    first = frames[0]
    spacing = first.pixel_spacing
    if spacing is None:
        request.note("The header gives no distance between pixels; 1 is taken.")
        spacing = (1.0, 1.0)
    rows = np.array(first.orientation or (1, 0, 0, 0, 1, 0), np.float64).reshape(2, 3)
    normal = first.normal
    step = normal * (first.step or 1.0)
    count = len(frames)
    if any(f.position is None or f.orientation is None for f in frames):
        request.note(
            "The header does not say where the slices lie; they are stacked in the order of their numbers."
        )
        found = lattice.SliceLattice(np.zeros(3), step, np.arange(count, dtype=np.float64), count)
    elif count == 1:
        found = lattice.SliceLattice(np.array(first.position), step, np.zeros(1), 1)
    else:
        found = lattice.fit(request, np.array([f.position for f in frames]), normal, min(spacing))
    matrix = np.c_[rows[0] * spacing[1], rows[1] * spacing[0], found.step]
    if not is_usable(matrix):
        raise request.error("its image orientation or spacing is unusable; the headers are damaged.")
    return found, request.geometry(np.c_[matrix, found.start])


def _stack(request: LoadRequest, frames: list[Frame], slices: lattice.SliceLattice) -> npt.NDArray[Any]:
    """Values of all slices of the lattice; those that are missing lie between their neighbours."""
    first = frames[0]
    # one rescaling at the end costs less memory than one of every slice, whose types may differ
    later = is_scaled_alike(frames)
    array: npt.NDArray[Any] | None = None
    for place, payload in slices_of(request, frames):
        pixels = payload if later else values_of(frames[place], payload)
        if array is None:
            check_memory(request, slices.count * pixels.nbytes)
            array = np.empty((len(frames), *pixels.shape), pixels.dtype)
        elif not np.can_cast(pixels.dtype, array.dtype):
            array = array.astype(np.result_type(array, pixels))
        array[place] = pixels
    assert array is not None
    if later:
        array = rescaled(array, first.slope, first.intercept, in_place=True, may_narrow=False)
    return array if slices.is_complete else _filled(array, slices)


def _filled(array: npt.NDArray[Any], slices: lattice.SliceLattice) -> npt.NDArray[Any]:
    """Slices at whole places of the lattice, linear between those that are there."""
    result = np.empty((slices.count, *array.shape[1:]), array.dtype)
    for place in range(slices.count):
        after = min(int(np.searchsorted(slices.at, place)), len(array) - 1)
        before = max(after - 1, 0)
        gap = slices.at[after] - slices.at[before]
        share = float(np.clip((place - slices.at[before]) / gap, 0.0, 1.0)) if gap > 0 else 1.0
        if share in (0.0, 1.0):
            result[place] = array[after if share else before]
            continue
        value = array[before] + share * (array[after].astype(np.float64) - array[before])
        result[place] = np.rint(value) if array.dtype.kind in "ui" else value
    return result


def _structures(request: LoadRequest, outlined: StructureSet) -> FileSource:
    """Labels inside of outlines, on the lattice of the images beside them, or one around the outlines."""
    if not outlined.structures:
        raise request.error("this structure set holds no closed outlines; there is nothing to fill.")
    if outlined.left_out:
        request.note(f"{outlined.left_out} points and open lines, which enclose nothing, were left out.")
    folder = request.path.parent
    frames = [
        frame
        for path in files_below(folder)
        for frame in read_frames(path)
        if frame.file.series in outlined.series and not frame.file.cut_off
    ]
    if len(frames) > 1:
        # what is said of the images is said when they are opened
        quiet = replace(request, notes=[])
        stack = grouping.volumes(quiet, grouping.one_kind(quiet, frames))[0]
        slices, geometry = _lattice(quiet, stack)
        dimensions = (stack[0].columns, stack[0].rows, slices.count)
        steps = np.reshape(geometry.direction, (3, 3)) * np.asarray(geometry.spacing)
        matrix = np.c_[steps, geometry.origin]
    else:
        matrix, dimensions = own_lattice(outlined)
        geometry = request.geometry(matrix)
        request.note(
            "The images on which the outlines were drawn do not lie in its folder; they are filled on a lattice of "
            f"{geometry.spacing[0]:.3g} mm around them."
        )

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        return to_zyx(filled(request, outlined, matrix, dimensions), "ZYX", request)

    return file_source(
        request, values, "ZYX", dimensions[::-1], geometry, format="DICOM",
        name=f"Outlines of {len(outlined.structures)} structures", is_labels=True,
        labels=[each.label for each in outlined.structures], length_unit="mm", modality="RTSTRUCT",
    )  # fmt: skip


def _segmentation(request: LoadRequest, frames: list[Frame]) -> FileSource:
    """Label map of all segments, on the lattice of all frames."""
    if any(f.position is None or f.orientation is None for f in frames):
        places, alone = np.arange(len(frames)), frames
    else:
        depths = np.array([float(np.dot(frames[0].normal, np.asarray(f.position))) for f in frames])
        places = lattice.same_places(depths)
        alone = [frames[int(np.flatnonzero(places == n)[0])] for n in range(int(places.max()) + 1)]
    before = len(request.notes)
    slices, geometry = _lattice(request, alone)
    # slices without any segment need not be in the file: they are empty, not missing
    request.notes[before:] = [note for note in request.notes[before:] if "missing" not in note]
    at = np.rint(slices.at).astype(np.int64)[places]
    first = frames[0]

    def values(request: LoadRequest) -> npt.NDArray[Any]:
        return to_zyx(label_map(request, frames, at, slices.count), "ZYX", request)

    return file_source(
        request, values, "ZYX", (slices.count, first.rows, first.columns), geometry, format="DICOM",
        name=f"DICOM SEG {slices.count} slices", is_labels=True, labels=first.file.labels or (), length_unit="mm",
        modality="SEG",
    )  # fmt: skip
