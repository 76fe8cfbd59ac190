"""What a technique is: the two protocols, and what the host hands to an image technique.

An `ImageTechnique` draws with our GLSL into a target of ours and knows nothing of VTK. A `PropTechnique` makes props
of VTK, which the host lets VTK draw into the same target. Both are described by one `TechniqueInfo`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.matching import Matching
from volviz.custom_gl.settings import CLASSIFYING_MODES, MODES, CommonSettings, common_settings
from volviz.kernels.slices import crop_corners
from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.parameters import Cost, Parameter, parameters_of, setting_values

if TYPE_CHECKING:
    from volviz.custom_gl.gpu.context import Gpu
    from volviz.custom_gl.gpu.layer_resources import LayerResources
    from volviz.custom_gl.gpu.programs import Program
    from volviz.custom_gl.gpu.resources import VolumeResources
    from volviz.custom_gl.gpu.targets import Target
    from volviz.custom_gl.oracles import OracleScene
    from volviz.custom_gl.picking import Picked, Sight
    from volviz.custom_gl.study import Study
    from volviz.model.label_palette import ShownLabels
    from volviz.model.layers import LayerMode
    from volviz.model.surface_values import SurfaceColors
    from volviz.model.transfer.function import TransferFunction
    from volviz.tasks import Tasks
    from volviz.volume_data.vectors import Vector
    from volviz.volume_data.volume import Volume

Tile = tuple[int, int, int, int]
Matrix = npt.NDArray[np.float64]


@dataclass(frozen=True)
class TechniqueInfo:
    """Everything the program knows about a technique without drawing with it.

    Attributes
    ----------
    id : str
        Name of its folder; what ``technique=`` and ``-t`` take.
    label : str
        What people call it.
    summary : str
        One line on what it does.
    settings : type
        Frozen dataclass of `volviz.model.parameters.parameter` fields.
    create : callable
        Makes a fresh technique object (no OpenGL work yet).
    kind : {"image", "prop"}
        Which protocol `create` gives.
    handles : tuple of str
        What can be dragged in the viewport: "light", "plane".
    debug_views : tuple of (value, label)
        Machinery views, "image" first.
    classic : mapping
        Settings of the well-known teaching programs (``--classic``).
    uses_transfer_function : bool
        Whether the transfer function changes its image.
    by_gradient : bool
        Whether it draws regions over value and gradient (`TransferFunction.by_gradient`).
    inert : mapping of str to str
        Settings that do not change the default image, each with the reason; the contract tests read it.
    order : int
        Place in lists, ascending.
    counterpart_of : tuple of str
        Ids of the techniques beside which it is meant to be looked at: VTK's own mappers name ours.
    colors_surface : bool
        Whether it draws triangles in the colours of given values (`Frame.surface_colors`).
    pick : callable or None
        Finds what is seen along a ray (`volviz.custom_gl.picking.Sight`); None where the first visible place is meant.
    needs_textures : bool
        Whether an image technique reads `Frame.resources`; those of the kind "prop" never do.
    isovalue_setting : str
        Name of the setting that holds the isovalue, or the isovalues, of the surfaces that it shows, in data units and
        None for automatic; empty for techniques that show none.
    matching : Matching
        How its settings meet those of its counterparts.
    extraction : str
        How it extracts a mesh from the volume: a method of `volviz.kernels.marching` (a setting ``method`` goes before
        it) or the name of a filter of VTK; empty where it draws no mesh of an isosurface.
    cursor_setting : str
        Name of the setting that holds a world point, and follows the scene's cursor while it is None; empty for none.
    facing : callable or None
        From its settings the direction towards the viewer, and up, from which its image is meant to be seen by a
        parallel projection; it may give None as well. None where every view is as good.
    turned : callable or None
        Takes its settings and a function that turns directions; gives settings whose plane is turned so. None where
        nothing is.
    study : callable or None
        Says how its convergence on a volume is measured, None where that has too few voxels. Itself None where there is
        nothing in its images to refine.
    oracle : callable or None
        Draws what it shows with some settings by a float64 oracle, as nearly as that knows it: premultiplied RGBA of
        shape (H, W, 4), row 0 at the top.
    is_oracle : bool
        It is an oracle itself: its frame times say nothing, and everything is compared with it.
    draws_layers : bool
        It draws several layers in one ray integral (`Frame.layers`).
    draws_bricks : bool
        It reads scalars by the hook ``fetch`` alone, so that they may come from bricks of several levels
        (`volviz.custom_gl.gpu.brick_resources`).
    samples_rays : bool
        It gathers samples along rays, or in slices across them, as `volviz.reference.ray_profile` does with its
        settings.
    view_slices : callable or None
        For samples in slices perpendicular to the view: from settings, world corners of what is shown (8, 3), direction
        of the view and step in world units the distances between which slices lie, and their number.
    """

    id: str
    label: str
    summary: str
    settings: type[Any]
    create: Callable[[], Any]
    kind: Literal["image", "prop"] = "image"
    manipulators: tuple[str, ...] = ()
    debug_views: tuple[tuple[str, str], ...] = (("image", "Image"),)
    classic: Mapping[str, Any] = field(default_factory=dict)
    uses_transfer_function: bool = True
    by_gradient: bool = False
    inert: Mapping[str, str] = field(default_factory=dict)
    order: int = 100
    counterpart_of: tuple[str, ...] = ()
    needs_textures: bool = True
    colors_surface: bool = False
    pick: Callable[[Sight], Picked | None] | None = None
    isovalue_setting: str = ""
    matching: Matching = field(default_factory=Matching)
    extraction: str = ""
    cursor_setting: str = ""
    facing: Callable[[Any], tuple[Vector, Vector] | None] | None = None
    turned: Callable[[Any, Callable[[Vector], Vector]], Any] | None = None
    study: Callable[[Volume], Study | None] | None = None
    oracle: Callable[[OracleScene, Any], Matrix] | None = None
    is_oracle: bool = False
    draws_layers: bool = False
    draws_bricks: bool = False
    samples_rays: bool = False
    view_slices: Callable[[Any, Matrix, Matrix, float], tuple[float, float, int]] | None = None

    @property
    def uses_textures(self) -> bool:
        """Whether the host must bring the volume onto the GPU for it."""
        return self.kind == "image" and self.needs_textures

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Descriptions of its settings."""
        return parameters_of(self.settings)

    @property
    def isovalue_parameter(self) -> Parameter | None:
        """Description of the setting that holds its isovalues; None where it shows no isosurface."""
        return next((p for p in self.parameters if p.name == self.isovalue_setting), None)

    def isovalues(self, settings: Any, volume: Volume) -> tuple[float, ...]:
        """Values of the isosurfaces that it shows of a volume with these settings, in data units; empty for none."""
        if not self.isovalue_setting:
            return ()
        value = getattr(settings, self.isovalue_setting)
        if value is None:
            return (float(auto_isovalue(volume)),)
        return tuple(float(v) for v in value) if isinstance(value, tuple) else (float(value),)

    def isovalue_values(self, isovalues: Sequence[float]) -> dict[str, Any]:
        """The setting, by name, that shows surfaces of these values; one setting holds the first of them only."""
        parameter = self.isovalue_parameter
        if parameter is None:
            return {}
        return {parameter.name: tuple(isovalues) if parameter.kind == "floats" else isovalues[0]}


def unused_regions(info: TechniqueInfo, settings: Any) -> str:
    """Why a technique with these settings draws the curve and not the regions; empty when it draws them.

    Parameters
    ----------
    info : TechniqueInfo
        The technique.
    settings : object
        Instance of its settings class.
    """
    if not info.by_gradient:
        return f"{info.label} draws the curve; regions over value and gradient wait."
    mode = common_settings(settings).mode
    if mode not in CLASSIFYING_MODES:
        label = dict(MODES).get(mode, mode)
        return f"{label} classifies one value per ray and draws the curve; regions wait."
    return ""


def drawn_function(info: TechniqueInfo, settings: Any, function: TransferFunction) -> TransferFunction:
    """The function as a technique with these settings draws it: without regions that are switched off or unused.

    The same object where nothing is to be left out, since textures are keyed by it.
    """
    if function.by_gradient is None or (function.by_gradient.enabled and not unused_regions(info, settings)):
        return function
    return replace(function, by_gradient=None)


def surface_settings(settings: Any) -> dict[str, Any]:
    """The settings that decide which triangles a technique extracts, by name: those whose change costs `DATA`."""
    costs = {p.name: p.cost for p in parameters_of(type(settings))}
    return {name: value for name, value in setting_values(settings).items() if costs[name] is Cost.DATA}


@dataclass(frozen=True)
class FrameCamera:
    """The camera of one frame, in OpenGL conventions (column vectors, clip z in -1..1), float64.

    Attributes
    ----------
    view, projection : ndarray of shape (4, 4)
        World to eye, eye to clip.
    eye : ndarray of shape (3,)
        World position of the eye.
    direction : ndarray of shape (3,)
        Unit world vector along the view.
    parallel : bool
        Parallel projection.
    """

    view: Matrix
    projection: Matrix
    eye: Matrix
    direction: Matrix
    parallel: bool

    @property
    def view_projection(self) -> Matrix:
        """World to clip."""
        return np.asarray(self.projection @ self.view)


@dataclass
class Frame:
    """What the host gives an image technique for one image. Valid during `plan` and `draw` only.

    Attributes
    ----------
    gpu : Gpu
        Programs, textures and targets of the current OpenGL context.
    target : Target
        RGBA32F, single-sample, premultiplied, with depth; cleared before the first chunk.
    size : tuple of 2 ints
        Width and height of the target in pixels; may be smaller than the window.
    window_size : tuple of 2 ints
        Width and height of the viewport that the image will fill.
    volume : Volume
        The data.
    resources : VolumeResources
        Textures of the volume and its transfer function (see `volviz.custom_gl.gpu.resources`).
    transfer_function : TransferFunction
        In data units; with `by_gradient` only where regions are to be drawn (see `drawn_function`).
    settings : object
        Instance of the technique's settings class.
    common : CommonSettings
        The same as the parts that all techniques share read it.
    isovalues : tuple of floats
        Values of the isosurfaces to be shown, in data units (`TechniqueInfo.isovalue_setting`).
    unit_distance : float
        Length of ray to which the opacities of the transfer function refer, in world units.
    camera : FrameCamera
        Where the eye is.
    light_position : ndarray of shape (3,)
        World position of the light; the eye for a headlight.
    light_color : tuple of 3 floats
        Its colour.
    headlight : bool
        Whether the light sits at the eye.
    crop : tuple of 6 floats
        Box that is shown, in continuous voxel indices, within the volume.
    planes : tuple of (origin, normal)
        Clip planes in world space.
    scene_depth : texture or None
        Resolved depth of the opaque VTK geometry, window depth 0..1, of `window_size`; None = nothing opaque.
    step_scale : float
        Factor on the step while interacting; 1 for a full image.
    level : int
        Level of detail of the scalars, 0 = full; `resources` is set to it while the technique draws.
    sequence : int
        Number of the accumulated image, 0 for the first; seeds the jitter.
    interactive : bool
        Drawn during a gesture at lower quality.
    tiles : tuple of (x, y, width, height)
        Parts of the target that the box touches, for techniques that work pixel by pixel.
    uniforms : dict
        Uniforms that all shaders share, by name, as `apply` sets them; techniques read the properties instead.
    tasks : Tasks
        Where the technique has its work done that takes longer than a turn of an event loop; closed when the
        technique is released. Each task that ends asks for another frame.
    surface_colors : SurfaceColors or None
        Values of the surface that are to be seen instead of its own colours, where the technique can
        (`TechniqueInfo.colors_surface`).
    layers : tuple of Frame
        Where several layers are drawn in one integral, or labels, each as if it were alone, the first one like this
        frame, image layers before labels; empty where one volume is drawn. Their places in shaders are those in this
        tuple (`volviz.custom_gl.shader_source`).
    joint : LayerResources or None
        Textures that several layers share.
    mode : {"add", "mask", "modulate"}
        How the volume joins other layers (`volviz.ImageLayer`).
    labels : ShownLabels or None
        Of a layer of labels, how it is drawn.
    leads : bool
        Of one of several layers, whether it is the first that is seen, which settings of isosurfaces mean.
    joined_to : Frame or None
        Of one of several layers, the frame of all: it says the step and from where surfaces are seen.
    """

    gpu: Gpu
    target: Target
    size: tuple[int, int]
    window_size: tuple[int, int]
    volume: Volume
    resources: VolumeResources
    transfer_function: TransferFunction
    settings: Any
    common: CommonSettings
    isovalues: tuple[float, ...]
    unit_distance: float
    camera: FrameCamera
    light_position: Matrix
    light_color: tuple[float, float, float]
    headlight: bool
    crop: tuple[float, float, float, float, float, float]
    planes: tuple[tuple[tuple[float, float, float], tuple[float, float, float]], ...]
    scene_depth: Any
    step_scale: float
    level: int
    sequence: int
    interactive: bool
    tiles: tuple[Tile, ...]
    uniforms: dict[str, Any]
    tasks: Tasks
    surface_colors: SurfaceColors | None = None
    layers: tuple[Frame, ...] = ()
    joint: LayerResources | None = None
    mode: LayerMode = "add"
    labels: ShownLabels | None = None
    leads: bool = False
    joined_to: Frame | None = None

    @property
    def center(self) -> Matrix:
        """World position that centred coordinates count from: the middle of the volume."""
        return np.asarray(self.volume.center if self.joined_to is None else self.joined_to.center)

    @property
    def box_corners(self) -> Matrix:
        """World corners of the cropped box, shape (8, 3); bit 0 of the row is x, bit 1 y, bit 2 z."""
        return crop_corners(self.volume.index_to_world, self.crop, self.volume.dimensions)

    @cached_property
    def texture_to_world(self) -> Matrix:
        """4 x 4 matrix from texture coordinates of the selected level to the world."""
        scale, offset = self.resources.texels.index_to_texture
        to_index = np.eye(4)
        to_index[:3, :3] = np.diag(1.0 / scale)
        to_index[:3, 3] = -offset / scale
        return np.asarray(self.volume.index_to_world @ to_index)

    @cached_property
    def world_to_texture(self) -> Matrix:
        """Its inverse."""
        return np.asarray(np.linalg.inv(self.texture_to_world))

    @cached_property
    def texture_to_clip(self) -> Matrix:
        """4 x 4 matrix from texture coordinates to clip space."""
        return np.asarray(self.camera.view_projection @ self.texture_to_world)

    def recentred(self, to_world: Matrix) -> Matrix:
        """A 4 x 4 matrix to the world as one to centred coordinates: world units from `center`."""
        moved = to_world.copy()
        # in float64, before shaders round to float32
        moved[:3, 3] -= self.center
        return moved

    @cached_property
    def viewpoint(self) -> Matrix:
        """World position from which surfaces are seen; far behind the view for parallel projection."""
        if self.joined_to is not None:
            return self.joined_to.viewpoint
        if not self.camera.parallel:
            return self.camera.eye
        extent = float(np.linalg.norm(self.volume.extent))
        return np.asarray(np.array(self.volume.center) - self.camera.direction * (1e4 * extent))

    @property
    def light_source(self) -> Matrix:
        """World position from which the light comes: the viewpoint for a headlight."""
        return self.viewpoint if self.headlight else self.light_position

    @property
    def step_world(self) -> float:
        """Distance between samples in world units (settings that have a ``step``): that of the finest layer."""
        if self.joined_to is not None:
            return self.joined_to.step_world
        finest = min(min(each.volume.spacing) for each in (self, *self.layers))
        return float(self.common.step) * finest * self.step_scale

    def program(
        self,
        vertex: Path,
        fragment: Path,
        defines: Mapping[str, object] | None = None,
        hooks: Mapping[str, str | Path] | None = None,
        *,
        many_vertices: bool = False,
        table_length: float | None = None,
    ) -> Program:
        """A program with the defines that depend on the frame, ready to draw (see `apply`).

        Parameters
        ----------
        vertex, fragment : Path
            Shader files.
        defines : mapping, optional
            Beside ``SCENE_DEPTH`` (there is opaque geometry to stop at), ``CLIP_PLANES`` (their number),
            ``TABLE_FOLDED`` (a table of more than one row) and ``NEAREST``, ``SHADING`` and ``GRADIENT_OPACITY``, which
            follow the settings of these names; can override them.
        hooks : mapping, optional
            Files for hooks; ``classify`` and ``shade`` follow the transfer function and the setting ``shading``
            unless they are named.
        many_vertices : bool, default: False
            Meshes and splats, whose vertex shader is kept free of other work.
        table_length : float, optional
            Length of ray, in unit distances, to which opacities in the table of the transfer function belong; None
            is one.
        """
        common = self.common
        shared: dict[str, object] = {
            "SCENE_DEPTH": self.scene_depth is not None,
            "CLIP_PLANES": len(self.planes),
            "NEAREST": common.interpolation == "nearest",
            "SHADING": common.shading,
            "GRADIENT_OPACITY": common.gradient_opacity > 0,
        }
        regions = self.transfer_function.by_gradient is not None
        chosen: dict[str, str | Path] = {
            "classify": "classify/regions.glsl" if regions else "classify/curve.glsl",
            "shade": "shade/lit.glsl" if common.shading else "shade/unlit.glsl",
        }
        if self.joint is None:
            shared["TABLE_FOLDED"] = self.resources.folds_table(self.transfer_function)
            chosen["fetch"] = self.resources.fetch
        else:
            shared |= self.joint.defines(self)
            chosen |= self.joint.hooks(self)
        program = self.gpu.programs.get(
            vertex,
            fragment,
            shared | dict(defines or {}),
            chosen | dict(hooks or {}),
            many_vertices=many_vertices,
        )
        self.apply(program, table_length)
        return program

    def apply(self, program: Program, table_length: float | None = None) -> None:
        """Set every shared uniform that the program has and bind the shared textures to their units."""
        # uniforms stay with the program, bindings do not survive what VTK draws between two chunks
        if program.is_taken_over(self):
            for number, layer in enumerate(self.layers):
                program.set(layer.uniforms, number)
            program.set(self.uniforms)
        if self.joint is not None:
            self.joint.bind(program, self)
        else:
            self.resources.bind(program, self, table_length)


@runtime_checkable
class ImageTechnique(Protocol):
    """Draws an image of the volume in chunks, into the frame's target.

    `plan` and `draw` are called with the context current and the OpenGL state reset to defaults. `draw` must be
    stateless between calls, except for what lies in targets of the technique's own; the host may stop after any
    chunk and begin a new frame.

    Three class attributes are optional: `writes_depth` (bool), the depth of `Frame.target` goes into VTK's depth
    buffer; `least_resolution` (float), linear fraction of the full resolution below which nothing gets cheaper,
    for techniques that give up detail by `Frame.step_scale` instead; `accumulates` (bool, True unless said), whether
    the mean of images seen through other points of the pixels is a better one. So is the property `mesh`: the
    triangles that the last full image showed.
    """

    def plan(self, frame: Frame) -> int:
        """Prepare what the frame needs and say into how many chunks its drawing is divided (at least 1).

        0 means that a task of `Frame.tasks` must end first: the last image stays, and `plan` is asked again when one
        has ended. `plan` itself never waits (`volviz.tasks.LatestResult` gives what there is).
        """

    def draw(self, frame: Frame, chunk: int) -> None:
        """Draw one chunk, 0 <= chunk < plan(frame), in ascending order."""

    def release(self) -> None:
        """Release what the technique itself holds on the GPU; the context is current."""


@runtime_checkable
class PropTechnique(Protocol):
    """Shows the volume by props of VTK, which the host draws into the frame's target.

    Attributes
    ----------
    props : sequence of vtkProp
        What is drawn, in this order: volumes, or actors.
    by_tiles : bool
        The props can be drawn piece by piece through a scissor box, at about the cost of the pieces.
    writes_depth : bool
        The depth of the frame goes into VTK's depth buffer (surfaces).
    within_tiles : bool
        Nothing is drawn outside the frame's tiles.
    ambient_from_light : bool
        The mapper multiplies the ambient part of the material with an ambient colour of the light.
    seconds_per_pixel : float
        What a pixel of the full image costs on software OpenGL, roughly; measured from the second image on.
    """

    by_tiles: bool
    writes_depth: bool
    within_tiles: bool
    ambient_from_light: bool
    seconds_per_pixel: float

    @property
    def props(self) -> Sequence[Any]:
        """What is drawn."""

    def prepare(self, frame: Frame) -> bool:
        """Make the props show the values of a frame; False while a task of `Frame.tasks` has to end first.

        `Frame.resources` and `Frame.uniforms` are empty here: VTK brings the volume onto the GPU itself.
        """

    def check(self) -> None:
        """Raise what VTK complained about while it drew the props."""

    def release(self, window: Any) -> None:
        """Release what the props hold on the GPU; the context is current."""
