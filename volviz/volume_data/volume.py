"""The volume: scalars on a regular lattice and where that lattice lies in the world."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.volume_data.vectors import finite_vector

if TYPE_CHECKING:
    from volviz.kernels.outliers import NoData

#: Largest deviation from 1 of the length of a column of ``direction``.
UNIT_TOLERANCE = 1e-3

#: Largest deviation of two axes from a right angle, in degrees. Registered images are sheared by a few
#: degrees, which `index_to_world` carries exactly; a tilted gantry shears by 10 to 30 degrees, and such a
#: volume must be resampled.
SHEAR_LIMIT = 8.0

#: Moved volumes that are remembered (`Volume.moved`).
MOVED_KEPT = 16

_KINDS = "buif"


class Volume:
    """Scalars on a regular lattice, with spacing, origin and direction in world units (LPS, as in ITK).

    A volume is immutable and compares by identity: caches of textures, bricks and meshes are keyed by the
    object.

    Parameters
    ----------
    array : array_like of shape (Z, Y, X)
        Scalars in the unit of the data set: bool, integers or floats of any width. Kept without a copy when
        possible and exposed read-only. NaN and infinities are allowed; they count as the lowest finite value
        wherever the volume is drawn, masked values as the lowest one.
    spacing : tuple of 3 floats, default: (1.0, 1.0, 1.0)
        Distance between voxel centres along (x, y, z), in world units, greater than 0.
    origin : tuple of 3 floats, default: (0.0, 0.0, 0.0)
        World position (x, y, z) of the centre of voxel (0, 0, 0).
    direction : array_like of shape (3, 3) or (9,), default: identity
        Matrix whose *columns* are the world directions of the index axes i, j, k, of unit length. Left-handed
        matrices are allowed. The axes may deviate from right angles by `SHEAR_LIMIT` (see `shear`): transform
        positions with `index_to_world`, and gradients with the transpose of `world_to_index`, never with
        `direction` alone.
    unit : str
        Unit of the scalars, "HU" say; empty when unknown.
    name : str
        What to call the data set in the window.
    metadata : mapping, optional
        Anything the reader wants to tell (``"source"``, ``"notes"``); never patient data.

    Raises
    ------
    InputError
        Not three-dimensional, fewer than 2 voxels along an axis, unusable data type or geometry.
    """

    def __init__(
        self,
        array: npt.ArrayLike,
        spacing: Sequence[float] = (1.0, 1.0, 1.0),
        origin: Sequence[float] = (0.0, 0.0, 0.0),
        direction: npt.ArrayLike | None = None,
        *,
        unit: str = "",
        name: str = "volume",
        metadata: Mapping[str, Any] | None = None,
    ) -> None:
        # importing the module of masked arrays takes longer than reading many volumes
        if "numpy.ma" in sys.modules and isinstance(array, np.ma.MaskedArray):
            array = array.filled(array.min() if array.count() else 0)
        scalars = np.asarray(array)
        if scalars.ndim != 3:
            raise InputError(
                f"{name}: a volume needs a three-dimensional array (z, y, x), this one has "
                f"{scalars.ndim} dimensions; choose one channel or time point."
            )
        check_dimensions(scalars.shape[::-1], name)
        if scalars.dtype.kind not in _KINDS:
            raise InputError(
                f"{name}: values of type {scalars.dtype} cannot be shown; make them integers or real numbers."
            )
        if scalars.dtype == np.bool_:
            scalars = scalars.view(np.uint8)
        if not scalars.dtype.isnative:
            scalars = scalars.astype(scalars.dtype.newbyteorder("="))
        if scalars.dtype == np.float16:
            scalars = scalars.astype(np.float32)
        if scalars.dtype.kind == "f" and scalars.dtype.itemsize > 8:
            # long doubles, which neither kernels nor VTK know; what exceeds float64 becomes infinite and is counted
            with np.errstate(over="ignore"):
                scalars = scalars.astype(np.float64)
        scalars = np.ascontiguousarray(scalars)
        if scalars is array:
            scalars = scalars.view()
        scalars.flags.writeable = False

        self.array: npt.NDArray[Any] = scalars
        self.spacing: tuple[float, float, float] = checked_spacing(spacing, name)
        self.origin: tuple[float, float, float] = finite_vector(origin, f"{name}: origin")
        self.direction: npt.NDArray[np.float64] = checked_direction(direction, name)
        self.unit = str(unit)
        self.name = str(name)
        self.metadata: Mapping[str, Any] = MappingProxyType(dict(metadata or {}))
        self._moved: dict[bytes, Volume] = {}

    def __repr__(self) -> str:
        x, y, z = self.dimensions
        return f"<Volume {self.name!r} {x} x {y} x {z} {self.array.dtype}>"

    @property
    def dimensions(self) -> tuple[int, int, int]:
        """Number of voxels along (x, y, z)."""
        z, y, x = self.array.shape
        return int(x), int(y), int(z)

    @cached_property
    def _finite(self) -> tuple[float, float, int]:
        from volviz.kernels.statistics import finite_range

        low, high, nonfinite = finite_range(self.array)
        return float(low), float(high), int(nonfinite)

    @property
    def range(self) -> tuple[float, float]:
        """Lowest and highest finite value, in data units; (0, 0) when no value is finite. Computed once."""
        low, high, _ = self._finite
        return low, high

    @property
    def nonfinite_count(self) -> int:
        """Number of NaN and infinite values."""
        return self._finite[2]

    @cached_property
    def _no_data(self) -> NoData:
        from volviz.kernels.outliers import no_data_of

        return no_data_of(self.array)

    @property
    def no_data(self) -> tuple[float, ...]:
        """Numbers among the values that stand for "no data", -9999 say; nearly always none."""
        return self._no_data.values

    @property
    def data_range(self) -> tuple[float, float]:
        """`range`; where there are numbers for "no data", that of the other values, from a sample of them."""
        return self._no_data.others if self.no_data else self.range

    @cached_property
    def bulk_range(self) -> tuple[float, float]:
        """`range`, unless hot voxels or "no data" stretch it a hundredfold: then that of the bulk of the values."""
        from volviz.kernels.outliers import bulk_range

        return bulk_range(self.array, *self.range, self.no_data)

    @cached_property
    def finite_array(self) -> npt.NDArray[Any]:
        """The scalars as they are drawn: `array` itself, or a copy with the lowest finite value where it has none."""
        if not self.nonfinite_count:
            return self.array
        scalars: npt.NDArray[Any] = np.where(
            np.isfinite(self.array), self.array, self.array.dtype.type(self.range[0])
        )
        scalars.flags.writeable = False
        return scalars

    def moved(self, transform: npt.ArrayLike) -> Volume:
        """The same values elsewhere in the world; nothing is copied.

        Parameters
        ----------
        transform : array_like of shape (4, 4)
            From the world to the world, invertible, with the last row 0, 0, 0, 1. It may shear more than a file may:
            what draws sheared volumes draws it as it is.

        Returns
        -------
        Volume
            The same object for the same matrix, as long as this volume lives.
        """
        matrix = np.asarray(transform, np.float64) @ self.index_to_world
        key = matrix.tobytes()
        if key not in self._moved:
            spacing = np.linalg.norm(matrix[:3, :3], axis=0)
            moved = Volume(
                self.array, tuple(spacing), tuple(matrix[:3, 3]), unit=self.unit, name=self.name,
                metadata=self.metadata,
            )  # fmt: skip
            moved.direction = matrix[:3, :3] / spacing
            moved.direction.flags.writeable = False
            # the last few: a gesture that moves a volume makes many
            self._moved = {**dict(list(self._moved.items())[-MOVED_KEPT + 1 :]), key: moved}
        return self._moved[key]

    @property
    def mean_spacing(self) -> float:
        """Mean distance of neighbouring voxel centres, the default opacity unit distance."""
        return sum(self.spacing) / 3.0

    @cached_property
    def index_to_world(self) -> npt.NDArray[np.float64]:
        """4 x 4 matrix from continuous index (i, j, k, 1) to world (x, y, z, 1)."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.direction * np.asarray(self.spacing)
        matrix[:3, 3] = self.origin
        matrix.flags.writeable = False
        return matrix

    @cached_property
    def world_to_index(self) -> npt.NDArray[np.float64]:
        """4 x 4 inverse of `index_to_world`."""
        matrix: npt.NDArray[np.float64] = np.linalg.inv(self.index_to_world).astype(np.float64)
        matrix.flags.writeable = False
        return matrix

    @property
    def shear(self) -> float:
        """Largest deviation of two of the axes from a right angle, in degrees; 0 for nearly all volumes."""
        return shear_of(self.direction)

    @property
    def extent(self) -> tuple[float, float, float]:
        """World length of the box from first to last voxel centre along the volume's own axes (x, y, z)."""
        x, y, z = ((n - 1) * s for n, s in zip(self.dimensions, self.spacing, strict=True))
        return x, y, z

    @cached_property
    def corners(self) -> npt.NDArray[np.float64]:
        """The 8 world corners of the box, shape (8, 3); bit 0 of the row number is x, bit 1 y, bit 2 z."""
        last = np.asarray(self.dimensions) - 1
        bits = np.array([[c & 1, c >> 1 & 1, c >> 2 & 1] for c in range(8)])
        corners: npt.NDArray[np.float64] = (bits * last).astype(np.float64) @ self.index_to_world[
            :3, :3
        ].T + self.index_to_world[:3, 3]
        corners.flags.writeable = False
        return corners

    @property
    def bounds(self) -> tuple[float, float, float, float, float, float]:
        """World bounds (x0, x1, y0, y1, z0, z1) of the box from first to last voxel centre."""
        low, high = self.corners.min(axis=0), self.corners.max(axis=0)
        return (
            float(low[0]), float(high[0]), float(low[1]), float(high[1]), float(low[2]), float(high[2]),
        )  # fmt: skip

    @property
    def center(self) -> tuple[float, float, float]:
        """World position of the middle of the box."""
        x, y, z = self.corners.mean(axis=0)
        return float(x), float(y), float(z)

    def value_at(self, world: Sequence[float]) -> float | None:
        """Value of the voxel nearest to a world position, None outside the box by more than half a voxel."""
        i, j, k = np.rint(self.world_to_index[:3, :3] @ np.asarray(world, float) + self.world_to_index[:3, 3])
        x, y, z = self.dimensions
        if not (0 <= i < x and 0 <= j < y and 0 <= k < z):
            return None
        return float(self.array[int(k), int(j), int(i)])


def check_dimensions(dimensions: Sequence[int], name: str) -> None:
    """Refuse, by an `InputError`, fewer than 2 voxels along one of the axes (x, y, z)."""
    if min(dimensions) < 2:
        sizes = " x ".join(str(n) for n in dimensions)
        raise InputError(
            f"{name}: a volume needs at least 2 voxels along every axis, this one has {sizes} (x, y, z); "
            "open a stack of images instead of a single one."
        )


def checked_spacing(spacing: Sequence[float], name: str) -> tuple[float, float, float]:
    """Distances along (x, y, z) as floats; `InputError` unless all are finite and greater than 0."""
    checked = finite_vector(spacing, f"{name}: spacing")
    if min(checked) <= 0:
        raise InputError(f"{name}: spacing must be greater than 0 along every axis, got {checked}.")
    return checked


def checked_direction(direction: npt.ArrayLike | None, name: str) -> npt.NDArray[np.float64]:
    """Directions of the index axes as a read-only 3 x 3 matrix of float64; None is the identity.

    Raises
    ------
    InputError
        Not a matrix with columns of unit length, or sheared by more than `SHEAR_LIMIT`.
    """
    if direction is None:
        matrix = np.eye(3)
    else:
        try:
            matrix = np.array(direction, dtype=np.float64).reshape(3, 3)
        except (TypeError, ValueError):
            raise InputError(f"{name}: direction must be a 3 x 3 matrix, got {direction!r}.") from None
    lengths = np.linalg.norm(matrix, axis=0)
    if not np.allclose(lengths, 1.0, atol=UNIT_TOLERANCE):
        raise InputError(f"{name}: direction needs columns of unit length, theirs are {lengths.round(6)}.")
    shear = shear_of(matrix)
    if shear > SHEAR_LIMIT:
        raise InputError(
            f"{name}: the axes of the volume are sheared by {shear:.1f} degrees (a tilted gantry, say), "
            f"more than the {SHEAR_LIMIT:g} that can be drawn; resample it onto a rectangular lattice first."
        )
    matrix.flags.writeable = False
    return matrix


def shear_of(matrix: npt.NDArray[np.float64]) -> float:
    """Largest deviation of two columns of unit length from a right angle, in degrees."""
    products = matrix.T @ matrix - np.diag(np.sum(matrix * matrix, axis=0))
    return float(np.degrees(np.arcsin(min(1.0, np.abs(products).max()))))
