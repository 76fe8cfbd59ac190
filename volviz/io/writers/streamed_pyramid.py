"""A pyramid of any size as OME-Zarr, block by block: what is written goes on where it was stopped.

Blocks consist of whole chunks, so that each chunk is written once, by one thread, and the bytes do not depend on their
number. What is finished stands in a list beside the arrays until all is.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import Cancelled, InputError, VolvizError
from volviz.io.writers.content import Content
from volviz.io.writers.ome_zarr import (
    create_array,
    pyramid_factors,
    reduced_shape,
    write_metadata,
)
from volviz.io.writers.request import SaveRequest
from volviz.io.writers.saving import tell_losses
from volviz.io.writers.table import WRITERS
from volviz.kernels.halving import halved, most_frequent
from volviz.new_files import check_target

if TYPE_CHECKING:
    from volviz.volume_data.source import Cancel, Progress, VolumeSource

#: Voxels along an edge of the blocks of the finest level, and of the others, which are made of blocks twice as long.
BLOCK, BLOCK_ABOVE = 256, 128
#: Bytes that a block takes for each of its voxels and bytes of a value: itself, means in 32 bits, and their terms.
COPIES = 6
_PLAN, _DONE = "volviz-plan.json", "volviz-done.txt"


@dataclass(frozen=True)
class _Job:
    """A block of a level: where it lies among time points, channels, and (z, y, x)."""

    level: int
    index: tuple[int, ...]
    low: tuple[int, int, int]
    high: tuple[int, int, int]

    @property
    def name(self) -> str:
        return " ".join(map(str, (self.level, *self.index, *self.low)))

    @property
    def voxels(self) -> int:
        return int(np.prod(np.subtract(self.high, self.low)))


def write_pyramid(
    source: VolumeSource,
    path: str | os.PathLike[str],
    *,
    time: int | None = None,
    channel: int | str | None = None,
    labels: bool | None = None,
    workers: int | None = None,
    memory: int | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> tuple[str, ...]:
    """Write all of a source in several resolutions, without having all of it in memory.

    Parameters
    ----------
    source : VolumeSource
        Its finest level is read, box by box.
    path : str or path
        A folder that ends in .zarr. What is unfinished lies beside it and is gone on with by the next call.
    time, channel
        The one that is written; None writes all.
    labels : bool, optional
        Coarser voxels have the most frequent value instead of the mean; default: what the source says.
    workers : int, optional
        Threads; default: as many as there are processors, and as the memory allows.
    memory : int, optional
        Bytes that blocks in work may take.
    overwrite, progress, cancel
        As for `volviz.save`.

    Returns
    -------
    tuple of str
        What the format cannot say of the data.

    Raises
    ------
    InputError
        Another ending, or something that is not to be replaced.
    LoadError
        The source cannot be read.
    VolvizError
        It cannot be written.
    Cancelled
    """
    target = Path(os.fspath(path)).expanduser().absolute()
    if target.suffix.lower() != ".zarr":
        raise InputError(
            f"{target.name}: a pyramid is written as OME-Zarr; choose a name that ends in .zarr."
        )
    check_target(target, overwrite=overwrite, folder=True)
    # found again by the next call
    part = target.with_name(f".{target.name}.unfinished")
    request = SaveRequest(part, target, progress=progress, cancel=cancel)
    content = Content(source, request, time=time, channel=channel)
    if labels is not None:
        content.is_labels = labels
    two = [pair for n in source.levels[0].dimensions for pair in (0, min(n, 2))]
    content.begin(source.read(0, time or 0, channel, two).array.dtype)
    tell_losses(next(each for each in WRITERS if each.id == "ome-zarr"), content, request)
    pyramid = _Pyramid(content, request, time or 0, channel)
    try:
        pyramid.write(_threads(workers, memory, content.dtype.itemsize))
        if target.exists():
            shutil.rmtree(target)
        part.rename(target)
    except (OSError, ValueError) as error:
        words = getattr(error, "strerror", None) or str(error).partition("[")[0]
        raise VolvizError(
            f"{target.name}: it cannot be written ({words.strip()}); check the free space and call it again, which "
            "goes on where it was."
        ) from None
    return tuple(request.notes)


def _threads(workers: int | None, memory: int | None, itemsize: int) -> int:
    most = workers or os.cpu_count() or 1
    if memory is not None:
        most = min(most, memory // (COPIES * BLOCK**3 * itemsize))
    return max(most, 1)


class _Pyramid:
    """One pyramid in progress."""

    def __init__(self, content: Content, request: SaveRequest, time: int, channel: int | str | None) -> None:
        self.content, self.request = content, request
        self.time, self.channel = time, channel
        self.factors = pyramid_factors(content)
        self.shapes = [reduced_shape(content.shape, factor) for factor in self.factors]
        self.arrays: list[Any] = []

    def write(self, threads: int) -> None:
        """Write what is not there yet, level after level."""
        done = self._go_on()
        leading = [n for n in (self.content.time_count, self.content.channel_count) if n]
        self.arrays = [
            create_array(self.request, "0.5", str(level), (*leading, *shape), self.content, may_exist=True)
            for level, shape in enumerate(self.shapes)
        ]
        jobs = [list(self._jobs(level)) for level in range(len(self.shapes))]
        total = sum(job.voxels for level in jobs for job in level)
        written = 0
        with (self.request.path / _DONE).open("a", encoding="utf-8") as log:
            for level in jobs:
                written += sum(job.voxels for job in level if job.name in done)
                for job in self._finished([job for job in level if job.name not in done], threads):
                    written += job.voxels
                    log.write(f"{job.name}\n")
                    log.flush()
                    words = f"level {job.level} of {len(jobs)}"
                    self.request.report(written / total, words)
        coarser: Any = "mode" if self.content.is_labels else "mean"
        write_metadata(self.content, self.request, "0.5", self.factors, coarser)
        for name in (_PLAN, _DONE):
            (self.request.path / name).unlink()

    def _go_on(self) -> set[str]:
        """Names of the jobs that an earlier call has finished; what does not belong to this one is thrown away."""
        content, part = self.content, self.request.path
        plan = {
            "source": content.source.metadata.get("source", content.name),
            "content_id": content.source.content_id,
            "type": content.dtype.str, "labels": content.is_labels, "shapes": [list(s) for s in self.shapes],
            "time": self.time, "times": content.time_count, "channel": self.channel,
            "channels": content.channel_count, "blocks": [BLOCK, BLOCK_ABOVE],
        }  # fmt: skip
        try:
            if json.loads((part / _PLAN).read_text(encoding="utf-8")) == plan:
                lines = (part / _DONE).read_text(encoding="utf-8").splitlines(keepends=True)
                # the last line may be cut off
                return {line.strip() for line in lines if line.endswith("\n")}
        except (OSError, ValueError):
            pass
        shutil.rmtree(part, ignore_errors=True)
        part.mkdir(parents=True)
        (part / _PLAN).write_text(json.dumps(plan), encoding="utf-8")
        (part / _DONE).touch()
        return set()

    def _jobs(self, level: int) -> Iterator[_Job]:
        edge = BLOCK if level == 0 else BLOCK_ABOVE
        leading = [range(n) for n in (self.content.time_count, self.content.channel_count) if n]
        shape = self.shapes[level]
        for index in product(*leading):
            for z, y, x in product(*(range(0, n, edge) for n in shape)):
                high = tuple(min(v + edge, n) for v, n in zip((z, y, x), shape, strict=True))
                yield _Job(level, index, (z, y, x), (high[0], high[1], high[2]))

    def _finished(self, jobs: Sequence[_Job], threads: int) -> Iterator[_Job]:
        """Do jobs on threads; each as soon as it is finished."""
        waiting, running = list(jobs)[::-1], set[Future[_Job]]()
        with ThreadPoolExecutor(threads, thread_name_prefix="volviz-pyramid") as pool:
            while waiting or running:
                while waiting and len(running) < threads:
                    running.add(pool.submit(self._do, waiting.pop()))
                ended, running = wait(running, return_when=FIRST_COMPLETED)
                for future in ended:
                    yield future.result()

    def _do(self, job: _Job) -> _Job:
        if self.request.cancel is not None and self.request.cancel():
            raise Cancelled(f"Writing {self.request.target.name} was cancelled.")
        where = tuple(slice(low, high) for low, high in zip(job.low, job.high, strict=True))
        values = self._read(job) if job.level == 0 else self._reduced(job)
        self.arrays[job.level][(*job.index, *where)].write(values).result()
        return job

    def _read(self, job: _Job) -> Any:
        content = self.content
        index = list(job.index)
        time = index.pop(0) if content.time_count else self.time
        channel = index.pop(0) if content.channel_count else self.channel
        # a source gives two voxels along each axis at least
        low = [min(a, n - 2) for a, n in zip(job.low, self.shapes[0], strict=True)]
        (z0, y0, x0), (z1, y1, x1) = low, job.high
        box = (x0, x1, y0, y1, z0, z1)
        values = content.source.read(0, time, channel, box, self.request.cancel).array
        values = values[tuple(slice(a - b, None) for a, b in zip(job.low, low, strict=True))]
        return values.astype(content.dtype, copy=False)

    def _reduced(self, job: _Job) -> Any:
        below = job.level - 1
        step = [b // a for a, b in zip(self.factors[below], self.factors[job.level], strict=True)]
        where = tuple(
            slice(low * s, min(high * s, n))
            for low, high, s, n in zip(job.low, job.high, step, self.shapes[below], strict=True)
        )
        values = np.asarray(self.arrays[below][(*job.index, *where)].read().result())
        if self.content.is_labels:
            return most_frequent(values, step)
        return halved(values, step, is_labels=False)
