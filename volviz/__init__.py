"""VolViz: look into volumes, and see how volume rendering works.

The public names are imported on first use, so that ``import volviz`` loads neither VTK nor OpenGL nor Qt.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from volviz.environment import prepare as _prepare

__version__ = "0.1.0"

if TYPE_CHECKING:
    from volviz import measure as measure
    from volviz.api import presets as presets
    from volviz.api import show as show
    from volviz.api import techniques as techniques
    from volviz.custom_gl.vtk import VolumeHandle as VolumeHandle
    from volviz.custom_gl.vtk import add_volume as add_volume
    from volviz.errors import VolvizError as VolvizError
    from volviz.io import load as load
    from volviz.io import open as open  # noqa: A004 - as in tifffile, PIL
    from volviz.io import save as save
    from volviz.kernels.marching import marching_cubes as marching_cubes
    from volviz.measure.label_table import label_statistics as label_statistics
    from volviz.meshes.polydata import extract_isosurface as extract_isosurface
    from volviz.model.camera import Camera as Camera
    from volviz.model.clipping import Clipping as Clipping
    from volviz.model.layers import ImageLayer as ImageLayer
    from volviz.model.layers import LabelLayer as LabelLayer
    from volviz.model.light import Light as Light
    from volviz.model.looks.choice import looks as looks
    from volviz.model.looks.look import Look as Look
    from volviz.model.picture import PictureContents as PictureContents
    from volviz.model.transfer.function import TransferFunction as TransferFunction
    from volviz.renderer import Renderer as Renderer
    from volviz.renderer import render as render
    from volviz.slice_images import plane_points as plane_points
    from volviz.slice_images import slice_image as slice_image
    from volviz.volume_data.volume import Volume as Volume

#: Rooms that are public as a whole.
_ROOMS = ("measure",)
_PUBLIC = {
    "Camera": "volviz.model.camera",
    "Clipping": "volviz.model.clipping",
    "ImageLayer": "volviz.model.layers",
    "LabelLayer": "volviz.model.layers",
    "Light": "volviz.model.light",
    "PictureContents": "volviz.model.picture",
    "Look": "volviz.model.looks.look",
    "Renderer": "volviz.renderer",
    "TransferFunction": "volviz.model.transfer.function",
    "Volume": "volviz.volume_data.volume",
    "VolumeHandle": "volviz.custom_gl.vtk",
    "VolvizError": "volviz.errors",
    "add_volume": "volviz.custom_gl.vtk",
    "extract_isosurface": "volviz.meshes.polydata",
    "label_statistics": "volviz.measure.label_table",
    "load": "volviz.io",
    "looks": "volviz.model.looks.choice",
    "open": "volviz.io",
    "marching_cubes": "volviz.kernels.marching",
    "plane_points": "volviz.slice_images",
    "presets": "volviz.api",
    "render": "volviz.renderer",
    "save": "volviz.io",
    "show": "volviz.api",
    "slice_image": "volviz.slice_images",
    "techniques": "volviz.api",
}

# only environment variables are set here; they are read when VTK, Qt or numba are imported, by us or by the
# caller
_prepare()

__all__ = ["__version__", *_PUBLIC, *_ROOMS]  # noqa: PLE0604 - the keys are strings


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name in _ROOMS:
        return import_module(f"volviz.{name}")
    if name not in _PUBLIC:
        raise AttributeError(f"module 'volviz' has no attribute {name!r}")
    value = getattr(import_module(_PUBLIC[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_PUBLIC, *_ROOMS})
