"""Draws VTK's own props as if they were a technique of ours: into the frame's target, in pieces, at any resolution.

The props stand in a renderer of their own, which shares window and camera with the plotter's and has exactly one light.
It is never rendered as a whole: each prop is asked to draw itself while a float framebuffer is bound. So VTK's images
are kept, refined, read and timed as ours are, and volumes are cut into tiles by a scissor box.
"""

from __future__ import annotations

import time
from typing import Any

import moderngl

from volviz.custom_gl.shader_source import GLSL
from volviz.custom_gl.technique import Frame, PropTechnique, Tile
from volviz.custom_gl.vtk import vtk_imports as vtk
from volviz.custom_gl.vtk.prop_tiles import TileSizes

_GL_ONE = 1
_GL_LEQUAL = 0x0203
_GL_SRC_ALPHA = 0x0302
_GL_ONE_MINUS_SRC_ALPHA = 0x0303
_GL_CULL_FACE = 0x0B44
_GL_DEPTH_TEST = 0x0B71
_GL_BLEND = 0x0BE2
_VTK_FLOAT = 10

#: Pixels of a tile of an image that comes in pieces; larger tiles mean that nobody waits in between.
LARGEST_PIECE = 256 * 64


class _FloatWindow:
    """A float framebuffer of VTK's, whose depth has the format of the window's: VTK's mappers copy from it."""

    def __init__(self, window: Any) -> None:
        self._window = window
        self._fbo: Any = None
        self.size = (0, 0)
        self.color: Any = None
        self.depth: Any = None

    def prepare(self, frame: Frame) -> None:
        """The size of the frame; transparent, and as deep as the opaque scene."""
        if self.size != frame.size:
            self._make(frame)
        gl = frame.gpu.gl
        state = self._window.GetState()
        state.PushFramebufferBindings()
        self._fbo.Bind()
        # not released: that would delete VTK's framebuffer
        bound = gl.detect_framebuffer()
        bound.use()
        gl.viewport = (0, 0, *frame.size)
        gl.scissor = None
        bound.depth_mask = True
        bound.clear(0.0, 0.0, 0.0, 0.0, depth=1.0)
        if frame.scene_depth is not None:
            _write_depth(frame, frame.scene_depth)
        frame.target.fbo.use()
        state.ResetFramebufferBindings()
        state.PopFramebufferBindings()

    def _make(self, frame: Frame) -> None:
        self.release()
        window, (width, height) = self._window, frame.size
        self._fbo = vtk.vtkOpenGLFramebufferObject()
        self._fbo.SetContext(window)
        state = window.GetState()
        state.PushFramebufferBindings()
        self._fbo.PopulateFramebuffer(
            width, height, True, 1, _VTK_FLOAT, True,
            window.GetRenderBufferTargetDepthSize(), 0, bool(window.GetStencilCapable()),
        )  # fmt: skip
        state.PopFramebufferBindings()
        gl = frame.gpu.gl
        self.size = frame.size
        color = self._fbo.GetColorAttachmentAsTextureObject(0).GetHandle()
        depth = self._fbo.GetDepthAttachmentAsTextureObject().GetHandle()
        self.color = gl.external_texture(color, frame.size, 4, 0, "f4")
        self.depth = gl.external_texture(depth, frame.size, 1, 0, "f4")
        for texture in (self.color, self.depth):
            texture.filter = (gl.NEAREST, gl.NEAREST)

    def bind(self) -> None:
        """Draw into it from now on; VTK must know the state of OpenGL."""
        self._fbo.Bind()

    def copy_to(self, frame: Frame, *, depth: bool) -> None:
        """Its image into the frame's target, whose framebuffer is bound; its depth as well on request."""
        gpu, gl = frame.gpu, frame.gpu.gl
        program = gpu.programs.get(
            GLSL / "fullscreen.vert", GLSL / "composite.frag", {"ENLARGE": False, "SCENE_DEPTH": False}
        )
        program.set({"u_image_size": tuple(float(n) for n in frame.size), "u_weight": 1.0})
        program.use_texture("t_image", self.color)
        gl.enable_only(moderngl.NOTHING)
        gpu.draw_fullscreen(program)
        if depth:
            _write_depth(frame, self.depth)

    def release(self) -> None:
        """Release the framebuffer; the context is current."""
        if self._fbo is not None:
            self._fbo.ReleaseGraphicsResources(self._window)
        self._fbo = self.color = self.depth = None
        self.size = (0, 0)


class PropRenderer:
    """An image technique that lets VTK draw the props of a `PropTechnique`.

    Parameters
    ----------
    technique : PropTechnique
        Makes the props.
    window : vtkRenderWindow
        Whose context draws.
    camera : callable
        Gives the `vtkCamera` of the plotter's renderer.
    """

    #: VTK draws through its own camera: there is no image beside the first one.
    accumulates = False

    def __init__(self, technique: PropTechnique, window: Any, camera: Any) -> None:
        self._technique = technique
        self._window = window
        self._camera = camera
        # the one for full images, and the one for those in between
        self._stages = {False: _FloatWindow(window), True: _FloatWindow(window)}
        self._renderer = vtk.vtkRenderer()
        self._renderer.SetRenderWindow(window)
        self._renderer.EraseOff()
        self._renderer.AutomaticLightCreationOff()
        self._light = vtk.vtkLight()
        # from 90 degrees on it is no cone
        self._light.SetConeAngle(180.0)
        self._renderer.AddLight(self._light)
        self._pieces: list[Tile] = []
        self._sizes = TileSizes(technique.seconds_per_pixel)

    @property
    def writes_depth(self) -> bool:
        """Whether the depth of the image counts (surfaces)."""
        return self._technique.writes_depth

    @property
    def within_tiles(self) -> bool:
        """Whether nothing is drawn outside the tiles."""
        return self._technique.within_tiles

    @property
    def notice(self) -> str:
        """What the image shows differently from what was asked for."""
        return str(getattr(self._technique, "notice", ""))

    def plan(self, frame: Frame) -> int:
        """One chunk per piece where the props can be cut, else one, and one for the copy; 0 while they are prepared."""
        if not self._technique.prepare(frame):
            return 0
        self._stages[frame.interactive].prepare(frame)
        if not frame.tiles:
            self._pieces = []
        elif not self._technique.by_tiles:
            self._pieces = [(0, 0, *frame.size)]
        elif frame.interactive or any(w * h > LARGEST_PIECE for _, _, w, h in frame.tiles):
            # to be drawn at once
            self._pieces = list(frame.tiles)
        else:
            self._sizes.begin()
            self._pieces = self._sizes.cut(frame.tiles)
        return len(self._pieces) + 1

    def draw(self, frame: Frame, chunk: int) -> None:
        """Let VTK draw one piece; the last chunk takes what is drawn into the frame's target."""
        stage = self._stages[frame.interactive]
        if chunk == len(self._pieces):
            stage.copy_to(frame, depth=self._technique.writes_depth)
            return
        begin = time.perf_counter()
        self._draw_props(frame, stage, self._pieces[chunk])
        self._technique.check()
        if not frame.interactive:
            # without waiting, only the submission of the work would be timed
            frame.gpu.gl.finish()
            self._sizes.note(self._pieces[chunk], time.perf_counter() - begin)

    def _draw_props(self, frame: Frame, stage: _FloatWindow, tile: Tile) -> None:
        window, renderer, camera = self._window, self._renderer, self._camera()
        state = window.GetState()
        # what was drawn before went past VTK
        window.GetShaderCache().ReleaseCurrentShader()
        state.Reset()
        state.PushFramebufferBindings()
        tiles = window.GetTileViewport()
        window.SetTileViewport(0.0, 0.0, 1.0, 1.0)
        try:
            stage.bind()
            self._use_defaults(state)
            width, height = window.GetSize()
            renderer.SetViewport(0.0, 0.0, frame.size[0] / width, frame.size[1] / height)
            if renderer.GetActiveCamera() is not camera:
                renderer.SetActiveCamera(camera)
            self._place_light(frame)
            renderer.UpdateLights()
            if frame.scene_depth is not None:
                self._count_a_prop()
            camera.Render(renderer)
            state.vtkglScissor(*tile)
            for prop in self._technique.props:
                if prop.IsA("vtkVolume"):
                    prop.RenderVolumetricGeometry(renderer)
                elif prop.HasTranslucentPolygonalGeometry():
                    state.vtkglDepthMask(False)
                    prop.RenderTranslucentPolygonalGeometry(renderer)
                else:
                    prop.RenderOpaqueGeometry(renderer)
        finally:
            window.SetTileViewport(*tiles)
            window.GetShaderCache().ReleaseCurrentShader()
            state.PopFramebufferBindings()
            frame.target.fbo.use()
            frame.gpu.gl.viewport = (0, 0, *frame.size)
            frame.gpu.gl.scissor = None

    def _count_a_prop(self) -> None:
        """Have the renderer render an actor without points, once.

        `vtkFixedPointVolumeRayCastMapper` reads the depth of the scene only in a renderer that has counted a prop.
        """
        renderer = self._renderer
        if renderer.GetNumberOfPropsRendered():
            return
        nothing = vtk.vtkActor()
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputData(vtk.vtkPolyData())
        nothing.SetMapper(mapper)
        # VTK's culler would leave out what has no bounds
        renderer.GetCullers().RemoveAllItems()
        renderer.AddActor(nothing)
        renderer.Render()
        renderer.RemoveActor(nothing)
        nothing.ReleaseGraphicsResources(self._window)

    @staticmethod
    def _use_defaults(state: Any) -> None:
        """The state in which VTK's renderer draws its props."""
        state.vtkglEnable(_GL_BLEND)
        state.vtkglBlendFuncSeparate(_GL_SRC_ALPHA, _GL_ONE_MINUS_SRC_ALPHA, _GL_ONE, _GL_ONE_MINUS_SRC_ALPHA)
        state.vtkglEnable(_GL_DEPTH_TEST)
        state.vtkglDepthFunc(_GL_LEQUAL)
        state.vtkglDepthMask(True)
        state.vtkglColorMask(True, True, True, True)
        state.vtkglDisable(_GL_CULL_FACE)

    def _place_light(self, frame: Frame) -> None:
        self._light.SetColor(*frame.light_color)
        # of ours, the colour of the light does not reach the ambient part; VTK asks the light for it
        ambient = 1.0 if self._technique.ambient_from_light else 0.0
        self._light.SetAmbientColor(ambient, ambient, ambient)
        # volumes know a light at the eye as a case of its own, in which alone all of them have an ambient part
        if frame.headlight and any(prop.IsA("vtkVolume") for prop in self._technique.props):
            self._light.SetLightTypeToHeadlight()
            self._light.PositionalOff()
        else:
            self._light.SetLightTypeToSceneLight()
            self._light.PositionalOn()
            self._light.SetPosition(*frame.light_source)
            self._light.SetFocalPoint(*frame.volume.center)
        self._renderer.UpdateLightsGeometryToFollowCamera()

    def release(self) -> None:
        """Release what VTK and we hold on the GPU; the context is current."""
        self._technique.release(self._window)
        for stage in self._stages.values():
            stage.release()
        self._renderer.RemoveAllLights()
        self._renderer.SetActiveCamera(None)
        self._renderer.SetRenderWindow(None)


def _write_depth(frame: Frame, depth: Any) -> None:
    """Window depth from a texture into the bound framebuffer, where it is not the far plane."""
    gpu, gl = frame.gpu, frame.gpu.gl
    program = gpu.programs.get(GLSL / "fullscreen.vert", GLSL / "depth_out.frag")
    program.use_texture("t_image_depth", depth)
    # colours stay by blending, as where images are put over VTK's
    gl.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
    gl.blend_func = (moderngl.ZERO, moderngl.ONE)
    gl.depth_func = "<="
    gpu.draw_fullscreen(program)
    gl.depth_func = "<"
    gl.enable_only(moderngl.NOTHING)
