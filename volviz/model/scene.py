"""The scene: a frozen tree of values that decides the image."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from operator import itemgetter
from typing import Any, Literal

from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.comparison import Comparison
from volviz.model.layers import ImageLayer, LabelLayer, changed_layers
from volviz.model.light import Light
from volviz.model.measurements import Measurement
from volviz.model.movie import Movie
from volviz.model.render_spec import DEFAULT_TECHNIQUE
from volviz.model.time_range import TimeRange
from volviz.volume_data.vectors import Vector

Color = tuple[float, float, float]
Layout = Literal["grid", "large"]
LAYOUTS: tuple[Layout, ...] = ("grid", "large")


@dataclass(frozen=True)
class SceneView:
    """One viewport: technique, its settings, camera.

    Attributes
    ----------
    technique : str
        Id of the technique that draws.
    settings : tuple of (technique id, settings)
        Settings of every technique that was changed, by id; the others have their defaults.
    camera : Camera or None
        None until the first image is framed.
    own_camera : bool
        It looks from a place of its own; the others share one camera.
    """

    technique: str = DEFAULT_TECHNIQUE
    settings: tuple[tuple[str, Any], ...] = ()
    camera: Camera | None = None
    own_camera: bool = False

    def settings_for(self, technique: str, default: Callable[[], Any]) -> Any:
        """Settings of a technique, made by `default` when none are stored."""
        for key, value in self.settings:
            if key == technique:
                return value
        return default()

    def with_settings(self, technique: str, settings: Any) -> SceneView:
        """The view with other settings for a technique; defaults leave no entry, so that equal views compare equal."""
        kind = type(settings)
        if self.settings_for(technique, kind) == settings:
            return self
        changed = {**dict(self.settings), technique: settings}
        if settings == kind():
            del changed[technique]
        return replace(self, settings=tuple(sorted(changed.items(), key=itemgetter(0))))


@dataclass(frozen=True)
class Scene:
    """Everything that decides the image, as one value.

    Attributes
    ----------
    layers : tuple of ImageLayer or LabelLayer
        What is shown.
    light, clipping, background
        Shared by all views.
    views : tuple of SceneView
        One to four; those without a camera of their own share one.
    active : int
        Number of the view that panels and keys act on.
    comparison : Comparison
        How several views are looked at together.
    cursor : tuple of 3 floats or None
        World point that slices go through and that cross-hairs mark; None is the middle of the volume.
    tilt : tuple of 3 tuples of 3 floats or None
        Rows of the rotation by which axial, coronal and sagittal slices are turned together; None for not at all.
    layout : {"grid", "large"}
        Views of equal size, or the first one large beside the others.
    active_layer : int
        Number of the layer that panels act on, where it is an image layer (see `layer`).
    measurements : tuple of Measurement
        What is measured and marked in the world.
    time_range : {"fixed", "widest", "each"}
        How colours follow the values from one time point to the next (`volviz.model.time_range`).
    movie : Movie
        What happens to it in time; without steps there is none.
    """

    layers: tuple[ImageLayer | LabelLayer, ...] = ()
    light: Light = Light()
    clipping: Clipping = Clipping()
    background: Color | None = None
    views: tuple[SceneView, ...] = (SceneView(),)
    active: int = 0
    comparison: Comparison = Comparison()
    cursor: Vector | None = None
    tilt: tuple[Vector, Vector, Vector] | None = None
    layout: Layout = "grid"
    active_layer: int = 0
    measurements: tuple[Measurement, ...] = ()
    time_range: TimeRange = "fixed"
    movie: Movie[Scene] = Movie()

    @property
    def layer(self) -> ImageLayer | None:
        """The image layer that panels act on and that techniques for one volume draw; None without any."""
        at = self.layer_index
        layer = None if at is None else self.layers[at]
        return layer if isinstance(layer, ImageLayer) else None

    @property
    def layer_index(self) -> int | None:
        """Its number: that of the active layer, or of the first image layer where that is none."""
        images = [n for n, layer in enumerate(self.layers) if isinstance(layer, ImageLayer)]
        return self.active_layer if self.active_layer in images else next(iter(images), None)

    @property
    def view(self) -> SceneView:
        """The view that panels and keys act on."""
        return self.views[self.active_index]

    @property
    def active_index(self) -> int:
        """Number of the active view, within those that there are."""
        return min(max(self.active, 0), len(self.views) - 1)

    def view_at(self, index: int | None = None) -> SceneView:
        """A view by its number: the active one for None, the last one when there are not so many."""
        return self.view if index is None else self.views[min(index, len(self.views) - 1)]

    @property
    def pair(self) -> tuple[int, int] | None:
        """Numbers of the two views that are compared, A and B; None when there is one view only."""
        return self.comparison.pair_of(len(self.views)) if len(self.views) > 1 else None

    @property
    def seen(self) -> tuple[int, ...]:
        """Numbers of the views that are to be seen, or whose difference is."""
        pair = self.pair
        overlaid = pair is not None and self.comparison.mode != "side_by_side"
        return pair if pair is not None and overlaid else tuple(range(len(self.views)))

    def with_layer(self, **changes: Any) -> Scene:
        """The scene with its `layer` changed; without one, as it is.

        A transfer function takes the place of a colour and window.
        """
        at = self.layer_index
        if changes.get("transfer_function") is not None:
            changes = {"color": None, "window": None, **changes}
        return self if at is None else replace(self, layers=changed_layers(self.layers, at, **changes))

    def with_active_layer(self, number: int) -> Scene:
        """The scene whose panels act on another layer."""
        return replace(self, active_layer=number)

    def with_view(self, index: int | None = None, /, **changes: Any) -> Scene:
        """The scene with one view changed, the active one unless another is named."""
        at = self.active_index if index is None else index
        views = list(self.views)
        views[at] = replace(views[at], **changes)
        return replace(self, views=tuple(views))

    def with_camera(self, camera: Camera | None, index: int | None = None) -> Scene:
        """The scene seen from another place: in one view that has its own camera, else in all that share one."""
        if index is not None and index < len(self.views) and self.views[index].own_camera:
            return self.with_view(index, camera=camera)
        views = (view if view.own_camera else replace(view, camera=camera) for view in self.views)
        return replace(self, views=tuple(views))

    def with_view_count(self, count: int) -> Scene:
        """The scene with so many views: new ones repeat the active one, those at the end go."""
        repeated = self.view if not self.view.own_camera else self.views[0]
        views = (*self.views, *(count - len(self.views)) * (repeated,))[: max(count, 1)]
        comparison = replace(self.comparison, pair=self.comparison.pair if count > 2 else (0, 1))
        return replace(
            self, views=views, active=min(self.active_index, len(views) - 1), comparison=comparison
        )

    def without_view(self, index: int) -> Scene:
        """The scene with one view closed; the last one stays."""
        if len(self.views) == 1:
            return self
        views = (*self.views[:index], *self.views[index + 1 :])
        active = self.active_index - (self.active_index > index)
        comparison = self.comparison.without_view(index, len(self.views))
        return replace(self, views=views, active=min(active, len(views) - 1), comparison=comparison)
