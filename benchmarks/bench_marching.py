"""Time and memory of our isosurfaces against VTK and scikit-image.

    python benchmarks/bench_marching.py                the table of methods on 256^3, and of sizes
    python benchmarks/bench_marching.py --memory       peak memory as well (1024^3, some minutes)

Both sides run in one process and in turn; medians are given, normals are included, VTK runs on all processors
where it can. Beside the time on the clock stands the processor time of all threads, which other programs on
the machine disturb less. The numbers in docs/marching.md come from here.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from volviz import Volume
from volviz.compare.vtk_contours import run_vtk_contour, vtk_image
from volviz.kernels.marching import marching_cubes
from volviz.meshes.polydata import extract_isosurface

ISOVALUE = 60.5


def shell_field(n: int) -> np.ndarray:
    """A thick shell, waves inside it, and noise over everything: float32, (n, n, n), about 0..240."""
    axis = np.arange(n, dtype=np.float32) / n - 0.5
    z, y, x = axis[:, None, None], axis[None, :, None], axis[None, None, :]
    radius = np.sqrt(x * x + y * y + z * z)
    field = 120 * np.exp(-(((radius - 0.35) / 0.04) ** 2))
    field += 100 * np.sin(40 * x) * np.sin(40 * y) * np.sin(40 * z) * (radius < 0.45)
    field += 20 * np.random.default_rng(0).random((n, n, n), dtype=np.float32)
    return np.clip(field, 0, 255)


def sparse_field(n: int) -> np.ndarray:
    """A ball of half the width as uint8, (n, n, n), made plane by plane."""
    axis = (np.arange(n, dtype=np.float32) / n - 0.5) ** 2
    field = np.empty((n, n, n), np.uint8)
    for k in range(n):
        radius = np.sqrt(axis[k] + axis[:, None] + axis[None, :])
        field[k] = np.clip(128 + 400 * (0.25 - radius), 0, 255)
    return field


def machine() -> str:
    """Processor and number of cores in use."""
    name = "unknown processor"
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text().splitlines():
            if line.startswith("model name"):
                name = line.split(":", 1)[1].strip()
                break
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return f"{name}, {cores} cores"


def interleaved(runs: dict[str, Callable[[], object]], repeats: int) -> dict[str, tuple[float, float]]:
    """Median seconds on the clock and of the processors, run in turn after one round for warming up."""
    seconds: dict[str, list[tuple[float, float]]] = {name: [] for name in runs}
    for turn in range(repeats + 1):
        for name, run in runs.items():
            start, work = time.perf_counter(), time.process_time()
            run()
            if turn:
                seconds[name].append((time.perf_counter() - start, time.process_time() - work))
    medians = {name: np.median(times, axis=0) for name, times in seconds.items()}
    return {name: (float(clock), float(work)) for name, (clock, work) in medians.items()}


HEADER = "triangles | ours | vtkFlyingEdges3D, threaded | ratio | ours, CPU | VTK, CPU | ratio"


def row_against_threaded_vtk(name: str, volume: Volume, method: str, repeats: int) -> str:
    """A row of a table: ours as PolyData against threaded Flying Edges."""
    image = vtk_image(volume)
    times = interleaved(
        {
            "vtk": lambda: run_vtk_contour(image, ISOVALUE, threaded=True),
            "ours": lambda: extract_isosurface(volume, ISOVALUE, method=method),
        },
        repeats,
    )
    triangles = extract_isosurface(volume, ISOVALUE, method=method).n_cells
    cells = [f"{name}", f"{triangles}"]
    for kind in range(2):
        ours, theirs = times["ours"][kind], times["vtk"][kind]
        cells += [f"{ours * 1e3:.1f} ms", f"{theirs * 1e3:.1f} ms", f"{theirs / ours:.2f}"]
    return f"| {' | '.join(cells)} |"


def print_methods(repeats: int) -> None:
    field = shell_field(256)
    print(f"\n| 256^3 | {HEADER} |\n{'|---' * 8}|")
    for dtype in (np.uint8, np.int16, np.float32):
        volume = Volume(field.astype(dtype))
        for method in ("lorensen", "topological", "tetrahedra") if dtype is np.uint8 else ("lorensen",):
            print(row_against_threaded_vtk(f"{np.dtype(dtype).name}, {method}", volume, method, repeats))


def print_slow_ones() -> None:
    """The implementations that take seconds, three runs each."""
    volume = Volume(shell_field(256).astype(np.uint8))
    image = vtk_image(volume)
    runs: dict[str, Callable[[], object]] = {
        "ours": lambda: extract_isosurface(volume, ISOVALUE),
        "vtkFlyingEdges3D, sequential": lambda: run_vtk_contour(image, ISOVALUE),
        "vtkMarchingCubes": lambda: run_vtk_contour(image, ISOVALUE, "vtkMarchingCubes"),
    }
    try:
        from skimage.measure import marching_cubes as other
    except ImportError:
        print("scikit-image is not installed, so it is left out")
    else:
        runs["skimage.measure.marching_cubes"] = lambda: other(volume.array, ISOVALUE)
    times = interleaved(runs, 3)
    print("\n| 256^3 uint8 | time | ours is faster by | CPU |\n|---|---|---|---|")
    for name, (clock, work) in times.items():
        print(f"| {name} | {clock * 1e3:.1f} ms | {clock / times['ours'][0]:.1f} | {work * 1e3:.1f} ms |")


def print_sizes(repeats: int) -> None:
    print(f"\n| uint8, lorensen | {HEADER} |\n{'|---' * 8}|")
    for n in (64, 128, 256, 512):
        volume = Volume(shell_field(n).astype(np.uint8))
        print(row_against_threaded_vtk(f"{n}^3", volume, "lorensen", repeats if n < 512 else 3))


def measure_memory(n: int, kind: str) -> None:
    """One extraction; prints input, output and the peak above the input in MB."""
    field = {"shell": lambda: shell_field(n).astype(np.uint8), "ball": lambda: sparse_field(n)}[kind]()
    marching_cubes(field[:64, :64, :64], ISOVALUE)
    # The peak so far belongs to making the field: only what comes on top of the present is ours.
    before = _resident()
    Path("/proc/self/clear_refs").write_text("5")
    seen: list[float] = []
    start = time.perf_counter()
    vertices, faces, normals = marching_cubes(
        field, 128.0 if kind == "ball" else ISOVALUE, progress=seen.append
    )
    seconds = time.perf_counter() - start
    peak = _peak() - before
    output = (vertices.nbytes + faces.nbytes + normals.nbytes) / 1e6
    total = field.nbytes / 1e6 + output
    print(
        f"| {n}^3 {kind} | {field.nbytes / 1e6:.0f} | {output:.0f} | {peak:.0f} "
        f"| {(field.nbytes / 1e6 + peak) / total:.2f} | {seconds:.2f} s | {len(seen)} |"
    )


def _resident() -> float:
    return _status("VmRSS")


def _peak() -> float:
    return _status("VmHWM") if Path("/proc/self/status").exists() else _maximum()


def _maximum() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


def _status(key: str) -> float:
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(key):
            return float(line.split()[1]) * 1024 / 1e6
    raise RuntimeError(f"{key} is not in /proc/self/status")


def print_memory() -> None:
    """Each in its own process, so that one does not hide in the peak of another."""
    print(
        "\n| MB | input | output | peak above input | (input + peak) / (input + output) | time | progress calls |"
    )
    print("|---" * 7 + "|", flush=True)
    for n, kind in ((256, "shell"), (512, "shell"), (1024, "ball")):
        subprocess.run([sys.executable, __file__, "--measure", str(n), kind], check=True)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument("--memory", action="store_true", help="peak memory as well")
    parser.add_argument("--only-memory", action="store_true", help="peak memory and nothing else")
    parser.add_argument("--measure", nargs=2, metavar=("N", "KIND"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.measure:
        measure_memory(int(arguments.measure[0]), arguments.measure[1])
        return
    print(machine())
    if not arguments.only_memory:
        print_methods(arguments.repeats)
        print_slow_ones()
        print_sizes(arguments.repeats)
    if arguments.memory or arguments.only_memory:
        print_memory()


if __name__ == "__main__":
    main()
