"""Volumes that are computed: an engine block as a scanner would see it, and analytic fields.

All are deterministic: the same arguments give the same bytes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import InputError
from volviz.io.engine import Engine, material_values
from volviz.kernels.threads import executor, worker_count
from volviz.volume_data.volume import Volume

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt

    Coordinate = npt.NDArray[np.float64]
    Field = Callable[[Coordinate, Coordinate, Coordinate], Any]

#: Largest number of voxels along an axis that a generator makes.
MAX_SIZE = 1024


def engine_block(
    size: int = 256, *, seed: int = 20, report: Callable[[float, str], None] | None = None
) -> Volume:
    """An engine block: bores with liners, water jacket, bolt holes, a thin sump, a crankshaft; two metals.

    Around the part lies the faint halo of noise that scattered radiation leaves in real scans; techniques and
    transfer functions must cope with it.

    Parameters
    ----------
    size : int, default: 256
        Voxels along each axis, 16..1024. The part is 256 world units wide whatever the size.
    seed : int
        Of the noise.
    report : callable(fraction, text), optional
        Told about the progress; may raise to stop.

    Returns
    -------
    Volume
        uint8; air about 8, aluminium about 120, steel about 215.
    """
    _checked(size, 16)
    array = np.empty((size, size, size), np.uint8)
    engine = Engine(size)
    slab = max(1, min(8, size // 8))

    def make(first: int) -> None:
        last = min(first + slab, size)
        # one generator a slab, seeded by its place: the order in which threads make them does not matter
        noise = np.random.default_rng([seed, first]).standard_normal((last - first, size, size), np.float32)
        array[first:last] = material_values(engine.distances(first, last), noise, size)

    together = 2 * worker_count() * slab
    for group in range(0, size, together):
        if report is not None:
            report(group / size, "making the engine block")
        # NumPy works outside the interpreter lock: threads help
        list(executor().map(make, range(group, min(group + together, size), slab)))
    step = 256.0 / size
    return Volume(array, (step,) * 3, (-128.0 + step / 2,) * 3, name="Engine block")


def marschner_lobb(size: int = 41, *, frequency: float = 6.0, alpha: float = 0.25) -> Volume:
    """The test signal of Marschner and Lobb on [-1, 1]^3, float32, values 0..1.

    ``rho(x, y, z) = (1 - sin(pi z / 2) + alpha (1 + rho_r(sqrt(x^2 + y^2)))) / (2 (1 + alpha))`` with
    ``rho_r(r) = cos(2 pi f_M cos(pi r / 2))`` (S. Marschner and R. Lobb, An Evaluation of Reconstruction
    Filters for Volume Rendering, IEEE Visualization 1994, section 4). With 41 samples an axis, the ripples of
    frequency 6 lie just below the sampling limit, so that every weakness of interpolation and normals shows.

    Parameters
    ----------
    size : int, default: 41
        Samples along each axis.
    frequency : float, default: 6.0
        f_M of the paper.
    alpha : float, default: 0.25
        Strength of the ripples.
    """

    def field(x: Any, y: Any, z: Any) -> Any:
        ripples = np.cos(2 * np.pi * frequency * np.cos(np.pi * np.hypot(x, y) / 2))
        return (1 - np.sin(np.pi * z / 2) + alpha * (1 + ripples)) / (2 * (1 + alpha))

    return _sampled(field, size, 1.0, "Marschner-Lobb signal")


def sphere(size: int = 64, *, radius: float = 0.8) -> Volume:
    """A sphere as a distance field, float32: the radius minus the distance from the centre, on [-1, 1]^3.

    The isovalue 0 is the sphere itself; gradients have length 1 everywhere but at the centre.
    """
    return _sampled(lambda x, y, z: radius - np.sqrt(x * x + y * y + z * z), size, 1.0, "Sphere")


def torus(size: int = 64, *, radius: float = 0.6, tube: float = 0.25) -> Volume:
    """A torus about z as a distance field, float32: tube radius minus the distance from its circle."""
    return _sampled(lambda x, y, z: tube - np.hypot(np.hypot(x, y) - radius, z), size, 1.0, "Torus")


def cube(size: int = 64) -> Volume:
    """A homogeneous cube, float32: 1 inside, 0 in a margin of an eighth of the size."""
    _checked(size, 8)
    array = np.zeros((size, size, size), np.float32)
    inside = slice(size // 8, size - size // 8)
    array[inside, inside, inside] = 1.0
    step = 2.0 / (size - 1)
    return Volume(array, (step,) * 3, (-1.0,) * 3, name="Homogeneous cube")


def _sampled(field: Field, size: int, half: float, name: str) -> Volume:
    """A field of world coordinates on [-half, half]^3, computed in float64 and stored as float32."""
    _checked(size, 2)
    axis = np.linspace(-half, half, size)
    x, y, z = axis[None, None, :], axis[None, :, None], axis[:, None, None]
    array = np.broadcast_to(field(x, y, z), (size, size, size)).astype(np.float32)
    step = 2 * half / (size - 1)
    return Volume(array, (step,) * 3, (-half,) * 3, name=name)


def _checked(size: int, smallest: int) -> None:
    if not smallest <= size <= MAX_SIZE:
        raise InputError(f"size must lie in {smallest}..{MAX_SIZE} voxels, got {size}.")
