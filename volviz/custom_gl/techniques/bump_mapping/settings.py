"""Settings of bump mapping."""

from __future__ import annotations

from dataclasses import dataclass

from volviz.custom_gl.counterpart_settings import CutSettings
from volviz.custom_gl.settings import INTERPOLATIONS, taken_from
from volviz.errors import SettingError
from volviz.model.parameters import Cost, parameter

DEBUG_VIEWS = (
    ("image", "Image"),
    ("diffuse", "Light alone"),
    ("color", "Colour factor alone"),
    ("normals", "Normal map"),
    ("light", "Light vectors"),
    ("difference", "Cube map against shader"),
)
SURFACES = (
    ("plane", "Cut plane"),
    ("box", "Faces of the crop box"),
    ("both", "Plane and faces"),
    ("mesh", "Mesh"),
)
NORMAL_SOURCES = (
    ("data", "Relief of the data"),
    ("bricks", "Bricks"),
    ("bumps", "Bumps"),
    ("image", "Image file"),
)
NORMALIZATIONS = (("cube_map", "Cube map"), ("shader", "In the shader"))
LIGHTINGS = (("pixel", "Per pixel"), ("vertex", "Per vertex"))
ENCODINGS = (
    ("float", "Floating point"),
    ("bytes", "8-bit colours (0.5 + 0.5 n)"),
    ("bytes_classic", "8-bit colours, classic (128 + 127 n)"),
)
DOT3 = (("rgb", "Into the colour (RGB)"), ("rgba", "Into colour and opacity (RGBA)"))

_PATTERNS = ("bricks", "bumps", "image")


@dataclass(frozen=True)
class BumpSettings:
    """Which surface is shown, where its normals and colours come from, and how they are lit."""

    surface: str = parameter(
        "plane",
        "Surface",
        "A plane through the volume, the faces of the crop box, both, or a mesh: a coarse isosurface or one from a "
        "file.",
        choices=SURFACES,
        group="Surface",
        cost=Cost.DATA,
    )
    plane_origin: tuple[float, float, float] | None = taken_from(
        CutSettings,
        "plane_origin",
        tooltip="A point of the cut plane in world space; patterns are laid out from it.",
        enabled_by=("surface", ("plane", "both")),
    )
    plane_normal: tuple[float, float, float] | None = taken_from(
        CutSettings,
        "plane_normal",
        enabled_by=("surface", ("plane", "both")),
    )
    plane_up: tuple[float, float, float] | None = parameter(
        None,
        "Upper side",
        "Direction that is up in patterns and images on the surface.",
        kind="vector",
        optional=True,
        none_label="the volume's own third axis",
        group="Surface",
        enabled_by=("normal_source", _PATTERNS),
    )
    mesh_file: str | None = parameter(
        None,
        "Mesh file",
        "A mesh in the world of the volume: STL, OBJ, PLY, VTK and others. Patterns follow its texture "
        "coordinates when it has any; colours and relief come from the data it goes through.",
        kind="path",
        optional=True,
        none_label="isosurface of the data",
        group="Surface",
        enabled_by=("surface", ("mesh",)),
        cost=Cost.DATA,
    )
    isovalue: float | None = parameter(
        None,
        "Isovalue",
        "Value of the data on the mesh; automatic splits the object from what surrounds it.",
        kind="float",
        optional=True,
        none_label="from the histogram",
        group="Surface",
        enabled_by=("surface", ("mesh",)),
        cost=Cost.DATA,
    )
    stride: int = parameter(
        4,
        "Stride",
        "The mesh is made from every n-th voxel; the normal map gives back the detail that its triangles "
        "lack.",
        kind="int",
        unit="voxels",
        minimum=1,
        maximum=32,
        group="Surface",
        enabled_by=("surface", ("mesh",)),
        cost=Cost.DATA,
    )
    normal_source: str = parameter(
        "data",
        "Normal map",
        "Where the normals come from: the gradient of the data, a pattern, or an image file.",
        choices=NORMAL_SOURCES,
        group="Relief",
        cost=Cost.PROGRAM,
    )
    bump_strength: float = taken_from(
        CutSettings,
        "bump_strength",
        tooltip="Height of the relief: 0 is smooth, negative turns hills into hollows. At 1 the whole range of the "
        "data is six voxels high, and patterns and images are as they were made.",
    )
    gradient_delta: float = taken_from(
        CutSettings,
        "gradient_delta",
        enabled_by=("normal_source", ("data",)),
    )
    tile_size: float | None = parameter(
        None,
        "Tile size",
        "Edge of one repeat of a pattern or image, in world units.",
        kind="float",
        optional=True,
        none_label="a quarter of the box",
        minimum=1e-9,
        logarithmic=True,
        soft_minimum=1.0,
        soft_maximum=1000.0,
        group="Relief",
        enabled_by=("normal_source", _PATTERNS),
    )
    normal_image: str | None = parameter(
        None,
        "Image file",
        "A colour image is taken as a normal map, a grey one as heights; it repeats over the surface.",
        kind="path",
        optional=True,
        none_label="round bumps",
        group="Relief",
        enabled_by=("normal_source", ("image",)),
        cost=Cost.TEXTURE,
    )
    flip_green: bool = parameter(
        False,
        "Flip green",
        "For images whose green channel points down instead of up.",
        group="Relief",
        enabled_by=("normal_source", ("image",)),
    )
    color_source: str = taken_from(
        CutSettings,
        "color_source",
    )
    flat_color: tuple[float, float, float] = taken_from(
        CutSettings,
        "flat_color",
    )
    cut_out: bool = taken_from(
        CutSettings,
        "cut_out",
        tooltip="Leaves out places that the transfer function makes fully transparent, such as air; off, the whole "
        "surface is opaque.",
    )
    density_threshold: float = parameter(
        0.0, "Density threshold", "Values below this fraction of the data range are left out.",
        group="Colour", minimum=0.0, maximum=1.0,
    )  # fmt: skip
    interpolation: str = parameter(
        "linear", "Interpolation", "Between voxel centres, or the nearest voxel as a block.",
        choices=INTERPOLATIONS, group="Colour", cost=Cost.PROGRAM,
    )  # fmt: skip
    ambient: float = taken_from(
        CutSettings,
        "ambient",
    )
    diffuse: float = taken_from(
        CutSettings,
        "diffuse",
    )
    lighting: str = parameter(
        "pixel",
        "Lighting",
        "Where the light is computed: in every pixel, or at the vertices and interpolated, which loses all "
        "detail between them.",
        choices=LIGHTINGS,
        group="Lighting",
        cost=Cost.PROGRAM,
    )
    subdivisions: int = parameter(
        16,
        "Subdivisions",
        "Pieces into which the edges of the plane's and the box's triangles are divided for lighting per "
        "vertex.",
        kind="int",
        minimum=1,
        maximum=128,
        group="Lighting",
        enabled_by=("lighting", ("vertex",)),
    )
    self_shadowing: bool = parameter(
        False,
        "Self-shadowing",
        "Darkens slopes that face the light while the surface itself is turned away from it.",
        group="Lighting",
        cost=Cost.PROGRAM,
    )
    normalization: str = parameter(
        "cube_map",
        "Normalisation",
        "How interpolated light vectors are brought back to length 1: looked up in a cube map, or computed.",
        choices=NORMALIZATIONS,
        group="DOT3",
        cost=Cost.PROGRAM,
    )
    cube_map_size: int = parameter(
        32,
        "Cube map size",
        "Texels along the edges of the six faces of the normalisation cube map.",
        kind="int",
        unit="texels",
        minimum=2,
        maximum=512,
        logarithmic=True,
        group="DOT3",
        enabled_by=("normalization", ("cube_map",)),
        cost=Cost.TEXTURE,
    )
    encoding: str = parameter(
        "float",
        "Encoding",
        "How normals and light vectors are kept: as floating-point numbers, or as 8-bit colours whose DOT3 "
        "product is the light, as on the first cards that could do it.",
        choices=ENCODINGS,
        group="DOT3",
        cost=Cost.PROGRAM,
    )
    dot3: str = parameter(
        "rgb",
        "DOT3 result",
        "RGB: the light is a grey. RGBA: it is the opacity as well, so that dark places let the background "
        "through.",
        choices=DOT3,
        group="DOT3",
        cost=Cost.PROGRAM,
    )
    two_passes: bool = parameter(
        False,
        "Two passes",
        "Draws the light first and multiplies the colour on top of it in a second pass, instead of both at "
        "once. The picture is the same.",
        group="DOT3",
        cost=Cost.PROGRAM,
    )
    display: str = parameter(
        "image",
        "Show",
        "The picture, or what it is made of. Vectors are shown as colours 0.5 + 0.5 v; the difference of the "
        "two ways to normalise 32 times enlarged.",
        choices=DEBUG_VIEWS,
        group="Machinery",
        cost=Cost.PROGRAM,
    )

    def __post_init__(self) -> None:
        for name in ("plane_normal", "plane_up"):
            vector = getattr(self, name)
            if vector is not None and not any(vector):
                raise SettingError(
                    f"{name} is a direction and cannot be (0, 0, 0); give another one or none."
                )
