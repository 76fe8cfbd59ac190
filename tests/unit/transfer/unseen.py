"""Volumes of many kinds, none of which the automatic transfer function was made for."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from volviz.volume_data.volume import Volume

N = 60


def radius() -> np.ndarray:
    axis = np.linspace(-1, 1, N)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    return np.sqrt(x * x + y * y + z * z)


def ct(dtype: str = "int16", offset: float = 0.0, unit: str = "HU", pad: float = -1024.0) -> Volume:
    rng, r = np.random.default_rng(1), radius()
    values = rng.normal(-1000, 15, r.shape)
    values[r < 0.8] = rng.normal(40, 20, (r < 0.8).sum())
    values[(r < 0.75) & (r > 0.68)] = 900
    values[r < 0.2] = 300
    values[r > 1] = pad
    return Volume(np.rint(values + offset).clip(np.iinfo(dtype).min).astype(dtype), unit=unit)


def mri_with_bright_noise() -> Volume:
    rng, r = np.random.default_rng(2), radius()
    values = np.hypot(rng.normal(0, 60, r.shape), rng.normal(0, 60, r.shape))
    values[r < 0.8] += 500
    values[r < 0.6] += 250
    return Volume(values.astype(np.float32), spacing=(1.0, 1.0, 3.0))


def microscopy(offset: float, spots: int, width: float) -> Volume:
    rng = np.random.default_rng(3)
    axis = np.linspace(-1, 1, N)
    values = rng.poisson(offset, (N, N, N)).astype(float)
    for _ in range(spots):
        a, b, c = (np.exp(-((axis - p) ** 2) / width) for p in rng.uniform(-0.9, 0.9, 3))
        values += rng.uniform(200, 3000) * a[:, None, None] * b[:, None] * c
    return Volume(values.astype(np.uint16), spacing=(0.1, 0.1, 0.3))


def zeroed_air() -> Volume:
    r = radius()
    return Volume(np.where(r < 0.7, 90 + 120 * (r < 0.3) - 40 * (r > 0.6), 0).astype(np.uint8))


def outliers() -> Volume:
    values = (1 - radius()).clip(0).astype(np.float32)
    values[3, 4, 5], values[30, 30, 30] = 1e9, -1e6
    return Volume(values)


def nonfinite() -> Volume:
    values = (1 - radius()).clip(0)
    values[:4], values[5, 5] = np.nan, np.inf
    return Volume(values)


def labels() -> Volume:
    r = radius()
    values = np.zeros(r.shape, np.uint8)
    for limit, label in ((0.8, 1), (0.6, 2), (0.4, 7), (0.2, 30)):
        values[r < limit] = label
    return Volume(values)


def many_labels() -> Volume:
    blocks = np.random.default_rng(4).integers(0, 40, (6, 6, 6))
    return Volume(np.kron(blocks, np.ones((9, 9, 9), int)).astype(np.int32))


def bright_background() -> Volume:
    rng, r = np.random.default_rng(5), radius()
    return Volume((240 - 180 * (r < 0.7) + rng.normal(0, 3, r.shape)).clip(0, 255).astype(np.uint8))


def waves() -> Volume:
    axis = np.sin(np.linspace(0, 9, N))
    return Volume(axis[:, None, None] * axis[:, None] * axis * 1e-9)


def huge_values() -> Volume:
    return Volume((1 - radius()) * 1e300)


def thin_stack() -> Volume:
    values = np.random.default_rng(6).integers(0, 60, (3, 200, 200))
    values[1:, 50:150, 50:150] += 900
    return Volume(values.astype(np.uint16), spacing=(0.1, 0.1, 1.0))


def salt() -> Volume:
    return Volume((np.random.default_rng(7).random((N, N, N)) < 0.002).astype(np.float32))


def one_voxel() -> Volume:
    values = np.zeros((150, 150, 150), np.uint8)
    values[97, 91, 93] = 255
    return Volume(values)


def vessels() -> Volume:
    rng, r = np.random.default_rng(8), radius()
    values = rng.normal(100, 10, r.shape)
    axis = np.linspace(-1, 1, N)
    for k in range(5):
        y, x = 0.5 * np.sin(3 * axis + k), 0.6 * np.cos(2 * axis + 2 * k)
        d = (axis[None, :, None] - y[:, None, None]) ** 2 + (axis[None, None, :] - x[:, None, None]) ** 2
        values += 500 * np.exp(-d / 0.002)
    return Volume(values.astype(np.int16))


def two_phases() -> Volume:
    """Both materials reach every face of the box, as in a rock or a foam."""
    rng = np.random.default_rng(10)
    axis = np.linspace(0, 6, N)
    waves = sum(
        np.sin(k * axis)[:, None, None] + np.cos(k * axis + 1)[:, None] + np.sin(k * axis + 2)
        for k in (1, 2, 3)
    )
    return Volume((120 + 40 * (waves > 0) + rng.normal(0, 8, waves.shape)).astype(np.uint8))


def vessels_in_noise_with_a_sentinel() -> Volume:
    values = vessels().array.astype(np.float32)
    values[radius() > 0.95] = -9999.0
    return Volume(values)


def signed_distances() -> Volume:
    return Volume((radius() - 0.6).astype(np.float32))


def shell_below_zero() -> Volume:
    noise = np.random.default_rng(11).normal(0, 100, (N, N, N))
    return Volume((-5000 + 3000 * np.exp(-(((radius() - 0.6) / 0.08) ** 2)) + noise).astype(np.int16))


def speckle_in_a_fan() -> Volume:
    """Ultrasound: speckle, a bright wall, nothing outside of the fan."""
    rng, axis = np.random.default_rng(12), np.linspace(-1, 1, N)
    speckle = np.abs(1 + 0.5 * rng.normal(size=(N, N, N)))
    values = (60 + 120 * (np.abs(radius() - 0.5) < 0.05)) * speckle
    values[np.broadcast_to(np.abs(axis) > 0.5 - 0.4 * axis[:, None], (N, N, N))] = 0
    return Volume(values.clip(0, 255).astype(np.uint8))


def tracer() -> Volume:
    """Emission tomography: counts, a warm body, three hot spots of which one is large and faint."""
    rng, r = np.random.default_rng(13), radius()
    axis = np.linspace(-1, 1, N)
    mean = 0.6 * (r < 0.9)
    for c, width, height in ((0.2, 0.12, 9.0), (-0.4, 0.06, 25.0), (0.0, 0.3, 2.0)):
        spot = np.exp(-(((axis - c) / width) ** 2))
        mean = mean + height * spot[:, None, None] * spot[:, None] * spot
    return Volume((rng.poisson(8 * mean) / 8).astype(np.float32), unit="SUV")


UNSEEN: dict[str, Callable[[], Volume]] = {
    "signed distances": signed_distances,
    "a shell below zero": shell_below_zero,
    "speckle in a fan": speckle_in_a_fan,
    "tracer": tracer,
    "ct": ct,
    "ct with a padded outside": lambda: ct(pad=-3024.0),
    "ct without its unit": lambda: ct(unit=""),
    "ct without its intercept": lambda: ct("uint16", 1024.0, ""),
    "mri with bright noise": mri_with_bright_noise,
    "microscopy": lambda: microscopy(100, 30, 0.01),
    "microscopy, few small spots": lambda: microscopy(400, 4, 0.002),
    "8 bit with zeroed air": zeroed_air,
    "outliers": outliers,
    "nan and infinities": nonfinite,
    "labels": labels,
    "many labels": many_labels,
    "mask": lambda: Volume(radius() < 0.6),
    "bright background": bright_background,
    "tiny values": waves,
    "huge values": huge_values,
    "thin stack": thin_stack,
    "salt": salt,
    "vessels": vessels,
    "two phases": two_phases,
    "a sentinel outside": vessels_in_noise_with_a_sentinel,
    "noise": lambda: Volume(np.random.default_rng(9).random((N, N, N), np.float32)),
    "ramp": lambda: Volume(np.broadcast_to(np.linspace(-1, 1, N, dtype=np.float32), (N, N, N))),
    "two voxels an axis": lambda: Volume(np.arange(8).reshape(2, 2, 2)),
}
#: Next to nothing to see: no empty image is demanded, but no structure either.
FEATURELESS: dict[str, Callable[[], Volume]] = {
    "one voxel": one_voxel,
    "tiny mask": lambda: Volume(radius() < 0.05),
    "constant": lambda: Volume(np.full((20, 30, 40), 7, np.int16)),
    "zeros": lambda: Volume(np.zeros((30, 30, 30), np.float32)),
    "only nan": lambda: Volume(np.full((20, 20, 20), np.nan, np.float32)),
}
