"""Compiles the kernels, or loads their machine code from disk, before anybody waits for them.

    python -m volviz.kernels.warm_up

The first call of a kernel with arguments of new types takes from a tenth of a second to some seconds; its machine code
then lies on disk for all later processes.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence

import numpy as np
import numpy.typing as npt

#: Types of scalars that files commonly have.
COMMON = ("uint8", "uint16", "int16", "float32")


def jobs(dtype: npt.DTypeLike) -> Iterator[tuple[str, Callable[[], object]]]:
    """What is to be called for scalars of one type: name and function, the most likely to be missed first."""
    from volviz.kernels import brick_gradients, gradient, histogram, preintegration, slices, splats
    from volviz.kernels.marching import extract

    tiny = np.zeros((5, 5, 5), dtype)
    tiny[2, 2, 2] = 1
    # as volumes keep theirs
    tiny.flags.writeable = False
    box = np.array([[c & 1, c >> 1 & 1, c >> 2 & 1] for c in range(8)], float)
    table = np.linspace(0.0, 1.0, 8, dtype=np.float32)[:, None].repeat(4, axis=1)
    # one bin a value, as the window has for whole numbers, and many, as it has for others
    yield "histogram", lambda: histogram.histogram(tiny, 2, (-0.5, 1.5))
    yield "slices", lambda: slices.slice_polygons(box, (0.0, 0.0, 1.0), np.array([0.25, 0.5]))
    yield "pre-integration", lambda: preintegration.preintegration_table(table, 1.0, 8)
    yield "gradients", lambda: gradient.gradient_statistics(tiny, (1.0, 1.0, 1.0))
    yield "marching cubes", lambda: extract.warm_up(dtype)
    yield "joint histogram", lambda: histogram.joint_histogram(tiny, bins=(4, 4))
    yield "bounds of gradients", lambda: brick_gradients.brick_gradient_bounds(tiny, lowest=0.0)
    yield "splats", lambda: splats.select_splats(tiny, 0.5)
    yield "tetrahedra", lambda: extract.warm_up(dtype, ("tetrahedra",))


def warm_up(
    dtypes: Sequence[npt.DTypeLike] = COMMON,
    *,
    report: Callable[[float, str], None] | None = None,
) -> None:
    """Call every kernel once for scalars of these types.

    Parameters
    ----------
    dtypes : sequence of dtype
        Types of scalars.
    report : callable, optional
        Told before each piece of work which part of all is done, 0..1, and what comes next; may raise to stop.
    """
    work = [(f"{name}, {np.dtype(dtype)}", run) for dtype in dtypes for name, run in jobs(dtype)]
    for number, (name, run) in enumerate(work):
        if report is not None:
            report(number / len(work), name)
        run()


def main() -> None:
    """Warm up for the common types and say how long it took."""
    begin = time.perf_counter()
    warm_up()
    sys.stdout.write(f"Kernels are compiled ({time.perf_counter() - begin:.0f} s).\n")


if __name__ == "__main__":
    main()
