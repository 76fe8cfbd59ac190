"""VTK's XML images (.vti): an array at the points for every channel, colours as one array of components."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.io.writers.content import Content
    from volviz.io.writers.request import SaveRequest


def write(content: Content, request: SaveRequest) -> None:
    """Write one time point."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

    from volviz.io.vtk_writing import write_by_vtk

    image = vtkImageData()
    image.SetDimensions(*content.lattice.dimensions)
    image.SetSpacing(*content.lattice.spacing)
    image.SetOrigin(*content.lattice.origin)
    image.SetDirectionMatrix(*(v for row in content.lattice.direction for v in row))
    # VTK looks at the memory of NumPy, which must stay as long as the image does
    kept: list[npt.NDArray[Any]] = []

    def add(array: npt.NDArray[Any], name: str, components: int = 1) -> None:
        flat = array.reshape(-1, components) if components > 1 else array.reshape(-1)
        kept.append(flat)
        scalars = numpy_to_vtk(flat)
        scalars.SetName(name)
        image.GetPointData().AddArray(scalars)

    if content.is_colour:
        add(content.all_channels(0, request), "colour", content.channel_count or 1)
    else:
        for channel, name in enumerate(content.channel_names()):
            add(content.array(0, channel, request), name)
    image.GetPointData().SetActiveScalars(image.GetPointData().GetArrayName(0))
    writer = vtkXMLImageDataWriter()
    writer.SetInputData(image)
    writer.EncodeAppendedDataOff()
    if request.compress:
        # the higher levels take several times as long for a tenth less
        writer.SetCompressionLevel(1)
    else:
        writer.SetCompressorTypeToNone()
    write_by_vtk(writer, request.path, lambda done: request.report(0.5 + 0.5 * done), request.cancel)
    request.report(1.0)
    if writer.GetErrorCode():
        raise request.error("VTK cannot write it; check the free space.")
