"""A volume as VTK's image, placed in the world by a matrix of the prop.

The image lies in its own frame, at the origin and without a direction: not all of VTK's mappers know the direction
matrix, all know the matrix of their prop. A left-handed lattice is mirrored along its first axis, since a prop with a
mirroring matrix shows its back faces.

VTK computes with 32-bit floats. Scalars that these cannot hold, a narrow range far from zero or very large and very
small numbers, are handed over as fractions of their range.
"""

from __future__ import annotations

import ctypes
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.vtk_props import vtk_imports as vtk

if TYPE_CHECKING:
    from volviz.model.transfer.function import TransferFunction
    from volviz.volume_data.volume import Volume

#: A range narrower than this share of its values is handed over as fractions.
NARROW = 1e-3
#: So are values beyond these: VTK's shaders and filters square them.
SMALLEST, LARGEST = 1e-12, 1e12
#: VTK's volume mappers have tables of even width over all values: outliers farther from the range of the bulk than so
#: many times its width are brought nearer.
OUTLIERS = 16.0

Matrix = npt.NDArray[np.float64]


class PlacedImage:
    """A volume for VTK's mappers.

    Parameters
    ----------
    volume : Volume
        What it is made from.
    stride : int, default: 1
        Takes every n-th voxel along each axis.
    for_tables : bool, default: False
        Bring outliers nearer, for mappers that look values up in tables.

    Attributes
    ----------
    volume, stride
        As given.
    image : vtkImageData
        Scalars and spacing; shares the memory of the volume where it can.
    to_world : ndarray of shape (4, 4)
        From the image's own coordinates (x, y, z), in world units, to the world: a turn and a shift.
    mirrored : bool
        The first axis runs the other way.
    """

    def __init__(self, volume: Volume, stride: int = 1, *, for_tables: bool = False) -> None:
        self.volume, self.stride = volume, stride
        self.mirrored = bool(np.linalg.det(volume.direction) < 0)
        low, high = volume.bulk_range if needs_fractions(*volume.range) else volume.range
        #: Data value of 0, and of 1 less that, in the image; None where it holds the values as they are.
        self._unit = (low, high - low) if needs_fractions(*volume.range) else None
        limits = _table_limits(volume) if for_tables else None
        first, last = np.clip(volume.range, *limits) if limits else volume.range
        #: Lowest and highest value of the volume as they stand in the image.
        self.range = self.value(float(first)), self.value(float(last))
        # held for as long as VTK reads its memory
        self._scalars = _scalars(volume, stride, limits, self._unit, mirrored=self.mirrored)
        dimensions = self._scalars.shape[::-1]
        self.image = vtk.vtkImageData()
        self.image.SetDimensions(*dimensions)
        self.image.SetSpacing(*(stride * s for s in volume.spacing))
        scalars = vtk.numpy_to_vtk(
            self._scalars.reshape(-1), deep=False, array_type=vtk.get_vtk_array_type(self._scalars.dtype)
        )
        scalars.SetName("scalars")
        self.image.GetPointData().SetScalars(scalars)
        self.to_world = np.eye(4)
        self.to_world[:3, :3] = volume.direction
        self.to_world[:3, 3] = volume.origin
        if self.mirrored:
            length = (dimensions[0] - 1) * stride * volume.spacing[0]
            self.to_world[:3, 3] += volume.direction[:, 0] * length
            self.to_world[:3, 0] *= -1.0

    def value(self, value: float) -> float:
        """A data value as it stands in the image."""
        return value if self._unit is None else (value - self._unit[0]) / self._unit[1]

    def function(self, function: TransferFunction) -> TransferFunction:
        """A transfer function over data values as one over those of the image."""
        if self._unit is None:
            return function
        return replace(function, points=tuple(replace(p, value=self.value(p.value)) for p in function.points))

    @property
    def matrix(self) -> Any:
        """`to_world` as a vtkMatrix4x4."""
        matrix = vtk.vtkMatrix4x4()
        matrix.DeepCopy(self.to_world.ravel())
        return matrix


def needs_fractions(low: float, high: float) -> bool:
    """Whether 32-bit floats are too coarse for values between these, or do not reach them."""
    largest = max(abs(low), abs(high))
    return high > low and not (SMALLEST <= largest <= LARGEST and high - low >= NARROW * largest)


def _table_limits(volume: Volume) -> tuple[float, float] | None:
    """Between which values outliers are brought; None where there are no outliers."""
    low, high = volume.bulk_range
    if (low, high) == volume.range:
        return None
    reach = OUTLIERS * (high - low)
    return low - reach, high + reach


def _scalars(
    volume: Volume,
    stride: int,
    limits: tuple[float, float] | None,
    unit: tuple[float, float] | None,
    *,
    mirrored: bool,
) -> npt.NDArray[Any]:
    """The scalars in a type that all mappers take, as memory that VTK accepts; it only reads it."""
    array = volume.finite_array[::stride, ::stride, ::stride]
    if limits is not None:
        array = np.clip(array, *limits)
    if unit is not None:
        fractions = (array.astype(np.float64) - unit[0]) / unit[1]
        array = np.clip(fractions, -LARGEST, LARGEST).astype(np.float32)
    elif array.dtype.kind in "iu" and array.dtype.itemsize == 8:
        array = array.astype(np.float64)
    array = np.ascontiguousarray(array[:, :, ::-1] if mirrored else array)
    if array.flags.writeable:
        return array
    # VTK refuses memory that is marked read-only, also for reading
    memory = memoryview((ctypes.c_char * array.nbytes).from_address(array.ctypes.data)).cast("B")
    return np.asarray(np.frombuffer(memory, array.dtype).reshape(array.shape))
