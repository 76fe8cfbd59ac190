"""DICOM: a folder of slices, one file of such a folder, or one multi-frame file.

Headers are read with pydicom; pixels too, except compressed ones, which SimpleITK (GDCM) decodes. DICOM
positions and directions are LPS in millimetres already (DICOM PS3.3, C.7.6.2.1.1).
"""

from __future__ import annotations

import warnings
from collections import defaultdict
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import InputError
from volviz.io.axes import brightness, choose
from volviz.io.dicom_headers import Slice, dicom_files, looks_like_dicom, read_header
from volviz.io.file_source import file_source
from volviz.io.geometry import is_usable
from volviz.io.scaling import rescaled

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt

    from volviz.io.file_source import FileSource
    from volviz.io.geometry import Geometry
    from volviz.io.reader import Job

    Pixels = Callable[[Job, list[Slice]], npt.NDArray[Any]]

SUFFIXES = (".dcm", ".dicom", ".ima")

#: Steps between slices may differ from their median by this fraction unnoticed, and by `GAP` with a note.
EVEN = 0.01
GAP = 0.1


def sniff(head: bytes, path: Path) -> bool:
    """Whether this is a DICOM file, or a folder in which DICOM files lie."""
    if path.is_dir():
        return next(dicom_files(path), None) is not None
    return looks_like_dicom(head)


def open_source(job: Job) -> FileSource:
    """The largest series of a folder, or the one asked for, with all its time points."""
    slices = _scan(job)
    if job.path.is_file():
        own = next((s for s in slices if s.path == job.path), None)
        if own is None:
            raise job.error("this DICOM file holds no image that can be read; choose another one.")
        # a file of many frames, or of another kind than the one asked for, does not belong into its stack
        alike = [s for s in slices if (s.series, s.count, _kind(s)) == (own.series, 1, _kind(own))]
        slices = [own] if own.count > 1 else alike
        if len(slices) > 1:
            job.note(
                f"The file is one of {len(slices)} slices of a series in its folder; all of them are shown."
            )
    if not slices:
        raise job.error("the folder holds no DICOM image that can be read; choose another one.")
    series = _same_kind(job, _series(job, slices))
    first = series[0]
    if len(series) == 1 and first.count > 1:
        stacks = _stacks_of_frames(job, first)
        return _source(job, first, stacks, lambda job, frames: _frames(job, first, frames))
    if first.count > 1:
        raise job.error("the series consists of several multi-frame files; open one of them.")
    return _source(job, first, _time_points(job, series), _stack)


def _source(job: Job, first: Slice, stacks: list[list[Slice]], pixels: Pixels) -> FileSource:
    """One stack of slices a time point; the first says where all lie."""

    def values(job: Job) -> npt.NDArray[Any]:
        stack = stacks[choose(job, "T", len(stacks))]
        if job.box is None:
            return pixels(job, stack)
        i0, i1, j0, j1, k0, k1 = job.box
        return np.ascontiguousarray(pixels(job, stack[k0:k1])[:, j0:j1, i0:i1])

    # where the frames of a file lie, it may not say; then one entry stands for all
    where = stacks[0] if stacks[0][0].position is not None else [stacks[0][0]]
    times = [stack[0].time for stack in stacks]
    known = [time for time in times if time is not None]
    # no name of a person, no date, no number of a study: only what the picture needs
    return file_source(
        job,
        values,
        "TZYXS" if first.samples in (3, 4) else "TZYX",
        (len(stacks), len(stacks[0]), first.rows, first.columns, first.samples)[
            : 5 if first.samples in (3, 4) else 4
        ],
        _stack_geometry(job, where),
        format="DICOM",
        name=f"DICOM {first.modality or 'image'} {len(stacks[0])} slices",
        colour=True,
        times=known if len(set(known)) == len(times) and known == sorted(known) else None,
        unit=first.unit,
        length_unit="mm",
        modality=first.modality,
    )


def _scan(job: Job) -> list[Slice]:
    """Headers of all slices around the path; those of files that are cut off are left out."""
    folder = job.path if job.path.is_dir() else job.path.parent
    own: Slice | None = None
    if job.path.is_file():
        with job.path.open("rb") as stream:
            if stream.read(2) == b"\x1f\x8b":
                raise job.error("this DICOM file is packed by gzip; unpack it first.")
        own = read_header(job.path)
        if own is not None and own.cut_off:
            raise job.error("the file is cut off: its pixel data is incomplete; get it again.")
        if own is None or own.count > 1:
            return [own] if own else []
        files = [p for p in dicom_files(folder) if p.parent == folder]
    else:
        files = list(dicom_files(folder))
    found = []
    for number, path in enumerate(files):
        job.report(0.3 * number / len(files), "reading headers")
        header = read_header(path)
        if header is None:
            continue
        if not header.cut_off:
            found.append(header)
        elif own is None or header.series == own.series:
            job.note(f"{path.name} is cut off and was left out.")
    return found


def _series(job: Job, slices: list[Slice]) -> list[Slice]:
    """The slices of one series: the one asked for, else the one with most pixels."""
    groups: dict[str, list[Slice]] = defaultdict(list)
    for item in slices:
        groups[item.series].append(item)
    ordered = sorted(groups.values(), key=lambda g: -sum(s.rows * s.columns * s.count for s in g))
    wanted = job.hints.series
    if wanted is None:
        if len(ordered) > 1:
            sizes = ", ".join(f"{n}: {_words(group)}" for n, group in enumerate(ordered[:8]))
            job.note(f"The largest of {len(ordered)} series is shown; choose with series= ({sizes}).")
        return ordered[0]
    if isinstance(wanted, str) and wanted in groups:
        return groups[wanted]
    if isinstance(wanted, int) and 0 <= wanted < len(ordered):
        return ordered[wanted]
    raise InputError(f"{job.path.name}: series must be 0..{len(ordered) - 1} or a UID, got {wanted!r}.")


def _words(group: list[Slice]) -> str:
    first = group[0]
    return f"{first.modality or 'image'} {first.columns} x {first.rows} x {sum(s.count for s in group)}"


def _same_kind(job: Job, slices: list[Slice]) -> list[Slice]:
    """The slices that fit together in size, type and orientation; scout images are left out."""
    groups: dict[Any, list[Slice]] = defaultdict(list)
    for item in slices:
        groups[_kind(item)].append(item)
    largest = max(groups.values(), key=len)
    if len(groups) > 1:
        left = len(slices) - len(largest)
        job.note(f"{left} slices of another size or orientation (scout images, say) were left out.")
    return largest


def _kind(item: Slice) -> tuple[Any, ...]:
    """What slices of one volume have in common."""
    orientation = None if item.orientation is None else tuple(round(v, 3) for v in item.orientation)
    return (
        item.rows, item.columns, item.samples, item.bits, item.signed, item.pixel_spacing, orientation,
    )  # fmt: skip


def _time_points(job: Job, slices: list[Slice]) -> list[list[Slice]]:
    """Several slices at one position are time points: a stack, sorted along its normal, for each of them."""
    if any(s.position is None or s.orientation is None for s in slices):
        return [sorted(slices, key=lambda s: (s.order[3], s.path.name))]
    normal = np.cross(slices[0].orientation[:3], slices[0].orientation[3:])  # type: ignore[index]
    places: dict[float, list[Slice]] = defaultdict(list)
    for item in slices:
        # positions equal to a hundredth of a millimetre are the same
        places[round(float(np.dot(normal, np.asarray(item.position))), 2)].append(item)
    depth = {len(group) for group in places.values()}
    stacked = [sorted(group, key=lambda s: (s.order, s.path.name)) for _, group in sorted(places.items())]
    if len(depth) > 1:
        job.note("Some slices lie at one and the same position; the first of them was taken.")
        stacked = [group[:1] for group in stacked]
    return [list(stack) for stack in zip(*stacked, strict=True)]


def _stacks_of_frames(job: Job, item: Slice) -> list[list[Slice]]:
    """The frames of a file as slices with a number each: a stack, sorted along its normal, a time point."""
    if len(item.frames) != item.count or item.orientation is None:
        job.note("The header does not say where the frames lie; they are stacked in their order.")
        return [[replace(item, position=None, frame=number) for number in range(item.count)]]
    normal = np.cross(item.orientation[:3], item.orientation[3:])
    order = np.argsort(np.asarray(item.frames) @ normal, kind="stable")
    places = np.round(np.asarray(item.frames)[order] @ normal, 2)
    _, counts = np.unique(places, return_counts=True)
    if len(set(counts.tolist())) > 1:
        raise job.error("its frames do not lie on a regular stack; save it as single slices.")
    sorted_frames = [replace(item, position=item.frames[n], frame=int(n)) for n in order]
    return [sorted_frames[time :: counts[0]] for time in range(counts[0])]


def _stack_geometry(job: Job, slices: list[Slice]) -> Geometry:
    first = slices[0]
    spacing = first.pixel_spacing
    if spacing is None:
        job.note("The header gives no distance between pixels; 1 is taken.")
        spacing = (1.0, 1.0)
    rows = np.array(first.orientation or (1, 0, 0, 0, 1, 0), float).reshape(2, 3)
    if any(s.position is None or s.orientation is None for s in slices):
        job.note(
            "The header does not say where the slices lie; they are stacked in the order of their numbers."
        )
        step = np.cross(rows[0], rows[1]) * (first.step or 1.0)
        start = np.zeros(3)
    else:
        positions = np.array([s.position for s in slices])
        start = positions[0]
        step = _step(job, positions, first)
    matrix = np.c_[rows[0] * spacing[1], rows[1] * spacing[0], step]
    if not is_usable(matrix):
        raise job.error("its image orientation or spacing is unusable; the headers are damaged.")
    return job.geometry(np.c_[matrix, start])


def _step(job: Job, positions: npt.NDArray[np.float64], first: Slice) -> npt.NDArray[np.float64]:
    """Vector from one slice to the next; refuses stacks that are no lattice."""
    if len(positions) == 1:
        assert first.orientation is not None
        normal = np.cross(first.orientation[:3], first.orientation[3:])
        return np.asarray(normal * (first.step or 1.0))
    mean = (positions[-1] - positions[0]) / (len(positions) - 1)
    gaps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    usual = float(np.median(gaps))
    straying = np.linalg.norm(
        positions - positions[0] - np.arange(len(positions))[:, None] * mean, axis=1
    ).max()
    uneven = float(np.abs(gaps - usual).max()) / usual
    if uneven > GAP or straying > 0.5 * usual:
        raise job.error(
            f"its slices lie {gaps.min():.3g} to {gaps.max():.3g} mm apart: slices are missing, or it is no "
            "regular stack; complete it or resample it first."
        )
    if uneven > EVEN:
        job.note(f"Slices lie {gaps.min():.4g} to {gaps.max():.4g} mm apart; their mean distance is taken.")
    return np.asarray(mean)


def _stack(job: Job, slices: list[Slice]) -> npt.NDArray[Any]:
    first = slices[0]
    # one rescaling at the end costs less memory; decoders of compressed pixels apply it slice by slice anyway
    later = len({(s.slope, s.intercept) for s in slices}) == 1 and not any(s.compressed for s in slices)
    array: npt.NDArray[Any] | None = None
    for number, item in enumerate(slices):
        job.report(0.3 + 0.7 * number / len(slices), "reading slices")
        pixels = _gray(job, _pixels(job, item, rescale=not later), item)
        if pixels.shape != (first.rows, first.columns):
            raise job.error("its pixels do not fit its header; the file is damaged.", item.path)
        if array is None:
            array = np.empty((len(slices), *pixels.shape), pixels.dtype)
        elif not np.can_cast(pixels.dtype, array.dtype):
            array = array.astype(np.result_type(array, pixels))
        array[number] = pixels
    assert array is not None
    return rescaled(array, first.slope, first.intercept) if later else array


def _frames(job: Job, item: Slice, frames: list[Slice]) -> npt.NDArray[Any]:
    """Frames of one multi-frame file, in the order of their slices."""
    job.report(0.3, "reading frames")
    array = _gray(job, _pixels(job, item, rescale=True), item)
    if array.shape != (item.count, item.rows, item.columns):
        raise job.error("its pixels do not fit its header; the file is damaged.")
    numbers = [each.frame for each in frames]
    return array if numbers == list(range(item.count)) else np.ascontiguousarray(array[numbers])


def _gray(job: Job, pixels: npt.NDArray[Any], item: Slice) -> npt.NDArray[Any]:
    if item.samples in (3, 4) and pixels.ndim > 2 and pixels.shape[-1] == item.samples:
        if job.channel is None:
            job.note("Colours are shown as their brightness; take one component with channel=0, 1 or 2.")
            return brightness(pixels)
        return np.asarray(pixels[..., choose(job, "S", item.samples)])
    return pixels


def _pixels(job: Job, item: Slice, *, rescale: bool) -> npt.NDArray[Any]:
    """Pixels of one file, (rows, columns[, samples]) or (frames, rows, columns[, samples])."""
    decoded = _decoded(item.path) if item.compressed else None
    if decoded is not None:
        return decoded
    try:
        import pydicom
        from pydicom.config import disable_value_validation

        with warnings.catch_warnings(), disable_value_validation():
            warnings.simplefilter("ignore")
            pixels = pydicom.dcmread(item.path, force=True).pixel_array
    except OSError:
        raise
    except Exception:  # noqa: BLE001 - what damaged pixels raise inside the library and its codecs has no end
        raise job.error("its pixels cannot be decoded; the file is damaged.", item.path) from None
    return rescaled(pixels, item.slope, item.intercept) if rescale else pixels


def _decoded(path: Path) -> npt.NDArray[Any] | None:
    """Compressed pixels through SimpleITK, rescaled by it; None when it cannot decode them."""
    import SimpleITK

    # damaged files are answered with an exception; the warnings beside it would only repeat it on the
    # terminal
    shown = SimpleITK.ProcessObject.GetGlobalWarningDisplay()
    SimpleITK.ProcessObject.GlobalWarningDisplayOff()
    try:
        array = np.asarray(SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path))))
    except (RuntimeError, UnicodeError):
        # the second one: a name that is not text, which SimpleITK does not take
        return None
    finally:
        SimpleITK.ProcessObject.SetGlobalWarningDisplay(shown)
    return array[0] if array.shape[0] == 1 else array
