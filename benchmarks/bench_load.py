"""How long `volviz.load` takes, beside the library that people would use instead.

Run: python benchmarks/bench_load.py [SIZE]

Files are written to a temporary folder first and read once before they are timed, so that the disk does not count.
The processor time beside the wall time tells how busy the machine was with other things.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import nibabel
import numpy as np
import SimpleITK
import tifffile

from volviz.io import load
from volviz.io.generate import engine_block

REPEATS = 5


def best(call: Callable[[], object]) -> tuple[float, float]:
    """Shortest wall and processor time of some calls, in seconds."""
    call()
    wall, cpu = [], []
    for _ in range(REPEATS):
        started, busy = time.perf_counter(), time.process_time()
        call()
        wall.append(time.perf_counter() - started)
        cpu.append(time.process_time() - busy)
    return min(wall), min(cpu)


def with_itk(path: Path) -> object:
    return SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))


def series_with_itk(path: Path) -> object:
    names = SimpleITK.ImageSeriesReader.GetGDCMSeriesFileNames(str(path))
    return SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(names))


def write_series(folder: Path, array: np.ndarray) -> Path:
    folder.mkdir()
    writer = SimpleITK.ImageFileWriter()
    writer.KeepOriginalImageUIDOn()
    for n, pixels in enumerate(array):
        image = SimpleITK.GetImageFromArray(pixels[None].astype(np.int16))
        tags = {
            "0008|0060": "CT",
            "0020|000e": "1.2.3.4",
            "0020|0013": str(n),
            "0020|0032": f"0\\0\\{n}",
            "0020|0037": "1\\0\\0\\0\\1\\0",
        }
        for tag, value in tags.items():
            image.SetMetaData(tag, value)
        writer.SetFileName(str(folder / f"{n:04d}.dcm"))
        writer.Execute(image)
    return folder


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("size", type=int, nargs="?", default=256)
    size = parser.parse_args().size
    array = engine_block(size).array
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        image = SimpleITK.GetImageFromArray(array)
        rows: list[tuple[str, Path, str, Callable[[Path], object]]] = []
        for suffix, packed in (
            (".nii", False),
            (".nii.gz", True),
            (".nrrd", True),
            (".mha", False),
            (".mha", True),
        ):
            path = folder / f"{'packed' if packed else 'plain'}{suffix}"
            SimpleITK.WriteImage(image, str(path), packed)
            rows.append((path.name, path, "SimpleITK", with_itk))
        rows.append(
            (
                "packed.nii.gz",
                folder / "packed.nii.gz",
                "nibabel",
                lambda p: np.asarray(nibabel.load(p).dataobj),
            )
        )
        np.save(folder / "v.npy", array)
        rows.append(("v.npy", folder / "v.npy", "numpy", np.load))
        tifffile.imwrite(folder / "v.tif", array, photometric="minisblack", compression="zlib", metadata=None)
        rows.append(("v.tif (zlib)", folder / "v.tif", "tifffile", tifffile.imread))
        series = write_series(folder / "series", array)
        rows.append((f"DICOM, {size} slices", series, "SimpleITK", series_with_itk))
        print(f"{size}^3, best of {REPEATS}, milliseconds: wall (processor)")
        for name, path, other, reading in rows:
            ours, theirs = (
                best(lambda path=path: load(path)),
                best(lambda path=path, reading=reading: reading(path)),
            )
            print(
                f"{name:20} volviz {1e3 * ours[0]:7.1f} ({1e3 * ours[1]:7.1f})   "
                f"{other:9} {1e3 * theirs[0]:7.1f} ({1e3 * theirs[1]:7.1f})"
            )


if __name__ == "__main__":
    main()
