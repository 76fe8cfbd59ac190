"""A volume in a renderer, as a program holds it: takes values, tells what is shown and what lies at a pixel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, get_args

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.arguments import changed_spec
from volviz.custom_gl.picking import Picked, Sight, first_label, first_visible
from volviz.custom_gl.resolve import ResolvedSpec, Volumes, resolve
from volviz.custom_gl.technique import TechniqueInfo
from volviz.custom_gl.vtk.frame_scheduling import FrameScheduler, Quality
from volviz.custom_gl.vtk.manipulators import Manipulators
from volviz.custom_gl.vtk.plotter_scale import Scale, scale_of, stretched
from volviz.custom_gl.vtk.view_renderer import ViewRenderer, view_renderers_of
from volviz.errors import SettingError
from volviz.model.clipping import Clipping
from volviz.model.light import Light
from volviz.model.render_spec import RenderSpec
from volviz.model.surface_values import SurfaceColors
from volviz.model.transfer.function import TransferFunction
from volviz.reference.surface_pick import pixel_ray
from volviz.volume_data.volume import Volume


class VolumeHandle(ViewRenderer):
    """A volume shown in a renderer by one of the techniques; made by `volviz.add_volume`.

    Attributes
    ----------
    error, status, on_status, quality, accumulates, share, on_gpu_clock
        See `volviz.custom_gl.vtk.view_renderer.ViewRenderer`.
    handles : Manipulators or None
        What can be dragged in the image, while it is shown (`show_manipulators`).
    """

    def __init__(
        self, plotter: Any, spec: RenderSpec, volumes: Volumes | None, scheduler: FrameScheduler | None
    ) -> None:
        self._scale = scale_of(plotter.renderer)
        shown = self._resolved(spec, volumes)
        super().__init__(plotter.renderer, plotter.render_window, shown, scheduler)
        self.plotter = plotter
        self._volumes = volumes
        self.manipulators: Manipulators | None = None

    def _resolved(self, spec: RenderSpec, volumes: Volumes | None) -> ResolvedSpec:
        return replace(resolve(stretched(spec, self._scale), volumes), spec=spec)

    def stretch(self, scale: Scale) -> None:
        """Stretch the volume along x, y, z, as `Plotter.set_scale` does with actors."""
        if scale != self._scale:
            self._scale = scale
            self._show_instead(self._resolved(self.spec, self._volumes).keeping(self._shown))

    # ------------------------------------------------------------------ values

    @property
    def spec(self) -> RenderSpec:
        """What was asked for."""
        return self._shown.spec

    @property
    def resolved(self) -> ResolvedSpec:
        """The same with every choice made."""
        return self._shown

    @property
    def volume(self) -> Volume:
        """The data shown, where `Plotter.set_scale` has put them."""
        return self._shown.volume

    @property
    def technique(self) -> TechniqueInfo:
        """The technique that draws."""
        return self._shown.info

    @property
    def settings(self) -> Any:
        """Settings of the technique."""
        return self._shown.settings

    @property
    def light(self) -> Light:
        """The light."""
        return self._shown.light

    @property
    def light_position(self) -> tuple[float, float, float]:
        """World position of the placed light (also while the headlight is on)."""
        return self._shown.light_position

    @property
    def clipping(self) -> Clipping:
        """Crop box and clip planes."""
        return self._shown.clipping

    @property
    def box_corners(self) -> npt.NDArray[np.float64]:
        """World corners of the cropped box, shape (8, 3); bit 0 of the row is x, bit 1 y, bit 2 z."""
        return self._shown.box_corners

    @property
    def transfer_function(self) -> TransferFunction:
        """The transfer function, in data units."""
        return self._shown.transfer_function

    @property
    def drawn_function(self) -> TransferFunction:
        """The transfer function without regions that the technique does not draw."""
        return self._shown.drawn_function

    @property
    def mesh(self) -> Any:
        """The `ReadyMesh` that the full image shows; None for techniques without triangles, or before there is one.

        See `volviz.custom_gl.mesh_drawing.world_triangles` for its place in the world.
        """
        return self._runner.reported("mesh", None)

    @property
    def surface_colors(self) -> SurfaceColors | None:
        """Values of the surface that are seen instead of its own colours."""
        return self._shown.surface_colors

    def color_surface(self, colors: SurfaceColors | None) -> None:
        """Show values of the surface by colours; the next `render` of the plotter draws them.

        They stay until there is another surface: another volume, technique or setting of the extraction.

        Parameters
        ----------
        colors : SurfaceColors or None
            None gives the surface its own colours back.

        Raises
        ------
        InputError
            The technique draws no triangles that could be coloured.
        """
        self.show(replace(self._shown.spec, surface_colors=colors))

    def show(self, spec: RenderSpec, volumes: Volumes | None = None) -> None:
        """Show what a spec says; the next `render` of the plotter draws it. Nothing happens when it is shown already.

        Parameters
        ----------
        spec : RenderSpec
            What to show.
        volumes : mapping of VolumeKey to Volume, optional
            What its layers refer to; those that were given last need not be given again.

        Raises
        ------
        VolvizError
            A value does not fit; nothing is changed then.
        """
        shown = self._resolved(spec, self._volumes if volumes is None else volumes)
        if self.error is None and spec == self._shown.spec and shown.volumes == self._shown.volumes:
            return
        self._volumes = volumes or self._volumes
        self._show_instead(shown.keeping(self._shown))

    def update(
        self,
        *,
        volume: Volume | None = None,
        technique: str | None = None,
        transfer_function: TransferFunction | None = None,
        settings: Any = None,
        light: Light | None = None,
        clipping: Clipping | None = None,
        quality: Quality | None = None,
        **values: Any,
    ) -> None:
        """Change what is shown; the next `render` of the plotter draws it, where anything is new.

        Parameters
        ----------
        volume, technique, transfer_function, light, clipping : optional
            As in `volviz.add_volume`; what is not given stays. Another technique begins with its own settings.
        settings : object, optional
            Instance of the technique's settings class.
        quality : {"fast", "balanced", "full"}, optional
            How far resolution may drop while something moves.
        **values
            Single settings by name, light and clipping included, as in `volviz.render`.

        Raises
        ------
        VolvizError
            A value does not fit; nothing is changed then.
        """
        if quality is not None and quality not in get_args(Quality):
            raise SettingError(f"quality must be one of {', '.join(get_args(Quality))}, got {quality!r}.")
        changed = changed_spec(
            self._shown.spec, volume=volume, technique=technique, transfer_function=transfer_function,
            settings=settings, light=light, clipping=clipping, **values,
        )  # fmt: skip
        self.show(changed)
        if quality is not None:
            self.quality = quality

    # ------------------------------------------------------------------ by hand

    def pick(self, x: float, y: float) -> Picked | None:
        """What is seen at a pixel, found on the processor; meshes of VTK in front of it are not looked at.

        Parameters
        ----------
        x, y : float
            Column and row in the renderer's viewport, row 0 at the top; whole numbers mean the centre of a pixel.

        Returns
        -------
        Picked or None
            World position, voxel, value and (for surfaces) isovalue or label; None where nothing of the volume is
            seen. Of several layers, the one that alone would be seen nearest.
        """
        camera, (width, height, _, _) = self.view.camera(), self.view.rectangle()
        ray = pixel_ray(camera.view, camera.projection, (width, height), (x, y))
        shown = self._shown
        found = []
        looks = {id(layer.volume): layer.shown.look for layer in shown.labels}
        for volume, function in shown.seen:
            crop = shown.crop if shown.is_one_lattice else Clipping().crop_within(volume.dimensions)
            sight = Sight(
                volume, function, shown.settings, shown.common, ray, crop, shown.drawn_planes, shown.isovalues
            )
            look = looks.get(id(volume))
            picked = (
                first_label(sight, look) if look is not None else (shown.info.pick or first_visible)(sight)
            )
            if picked is not None:
                found.append(picked)
        return min(found, key=lambda picked: np.linalg.norm(picked.position - ray.start), default=None)

    def show_manipulators(self, on: bool = True, *, listens: bool = True) -> None:
        """Show what can be dragged: the light and the cut plane, where the technique has them.

        Parameters
        ----------
        on : bool, default: True
            Show or hide.
        listens : bool, default: True
            Whether VTK's interactor drags them with the left button; False for windows that call
            `Manipulators.grab`, `drag` and `release` themselves.
        """
        if self.manipulators is not None and not on:
            self.manipulators.remove()
            self.manipulators = None
        elif self.manipulators is None and on and not self._removed:
            self.manipulators = Manipulators(self, listens=listens)

    def remove(self) -> None:
        """Take the volume out of the renderer and release its GPU objects; a second call does nothing."""
        if self._removed:
            return
        self.show_manipulators(False)
        self._take_away(window_lives=self.plotter.render_window is not None)


def handles_of(renderer: Any) -> Sequence[VolumeHandle]:
    """Volumes that are shown in a renderer."""
    return [other for other in view_renderers_of(renderer) if isinstance(other, VolumeHandle)]
