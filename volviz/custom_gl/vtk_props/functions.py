"""Our transfer function as VTK's: the same points, so that VTK's tables are exact between them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from volviz.model.transfer.function import TransferFunction

#: Width of a jump as a fraction of the data range: VTK chooses the size of its tables by the nearest two points, and
#: makes none with more entries than this.
JUMP = 1.0 / 16384


def set_functions(prop: Any, function: TransferFunction, data_range: tuple[float, float]) -> None:
    """Give a `vtkVolumeProperty` colours and opacities.

    Parameters
    ----------
    prop : vtkVolumeProperty
        Whose transfer functions are replaced.
    function : TransferFunction
        In values of the image. Two points at one value make a jump.
    data_range : tuple of 2 floats
        Lowest and highest value there.
    """
    colors, opacities = prop.GetRGBTransferFunction(0), prop.GetScalarOpacity(0)
    colors.RemoveAllPoints()
    opacities.RemoveAllPoints()
    width = (data_range[1] - data_range[0]) * JUMP or JUMP
    last: float | None = None
    for point in function.points:
        value = point.value if last is None or point.value > last else last + width
        colors.AddRGBPoint(value, *point.color)
        opacities.AddPoint(value, point.opacity * function.opacity)
        last = value
