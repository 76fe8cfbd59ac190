"""From a click in a picture to a point with its rule and its error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from PySide6.QtCore import QPointF

from volviz.custom_gl.picking import Picked
from volviz.custom_gl.resolve import ResolvedSpec
from volviz.measure.points import isovalue_point, maximum_point, opacity_point
from volviz.measure.results import voxel_covariance
from volviz.model.cursor import cursor_of
from volviz.model.measurements import Point
from volviz.model.scene import Scene
from volviz.reference.surface_pick import PixelRay, pixel_ray
from volviz.volume_data.volume import Volume
from volviz_ui.views.camera_moves import point_on_plane
from volviz_ui.views.view_widget import ViewWidget

#: Voxels before a hit at which the rule begins to look for it: what was cut away lies farther in front.
BEFORE = 2.0
#: Voxels by which a rule may lead away from what was hit and still tell of it.
ASTRAY = 1.5


def point_at(view_widget: ViewWidget, scene: Scene, volume: Volume, position: QPointF) -> Point | None:
    """The point that is meant by a place in a view: on the plane of a slice, else on what is seen there.

    Parameters
    ----------
    view_widget : ViewWidget
    scene : Scene
        What it shows.
    volume : Volume
        Of the active layer.
    position : QPointF
        In pixels of the viewport, from the upper left.

    Returns
    -------
    Point or None
        None where nothing is hit.
    """
    viewport = view_widget.viewport
    size, place = (viewport.width(), viewport.height()), (position.x(), position.y())
    if viewport.shows_slice:
        where = point_on_plane(viewport.view_camera, place, size, cursor_of(scene, volume))
        return Point(where, voxel_covariance(volume))
    handle = view_widget.controller.handle
    if handle is None:
        return None
    ratio = viewport.devicePixelRatioF()
    picked: Picked | None = handle.pick(position.x() * ratio, position.y() * ratio)
    if picked is None:
        return None
    camera = viewport.view_camera
    view, projection = camera.matrices(viewport.aspect, camera.clipping_range(volume.corners))
    ray = pixel_ray(view, projection, size, (position.x() - 0.5, position.y() - 0.5))
    return by_rule(picked, handle.resolved, ray, picked.volume or volume)


def by_rule(picked: Picked, shown: ResolvedSpec | None, ray: PixelRay, volume: Volume) -> Point:
    """What was hit as a point that the rule of the picture finds, with the error of its place along the ray."""
    hit = np.asarray(picked.position)
    placed = Point(picked.position, voxel_covariance(volume))
    reach = BEFORE * max(volume.spacing)
    found: Point | None = None
    if picked.isovalue is not None:
        start = hit - reach * ray.direction
        found = isovalue_point(volume, start, ray.direction, picked.isovalue, length=2 * reach)
        placed = replace(placed, rule="isovalue", number=picked.isovalue)
    elif shown is not None and shown.common.mode == "maximum":
        found = maximum_point(volume, ray.start, ray.direction, length=ray.length)
        placed = replace(placed, rule="maximum", number=picked.value)
    elif shown is not None and shown.common.mode == "composite":
        placed = replace(placed, rule="opacity", number=picked.value)
        if shown.drawn_function.by_gradient is None:
            found = opacity_point(
                volume, ray.start, ray.direction, shown.drawn_function, unit_distance=shown.unit_distance,
                length=ray.length,
            )  # fmt: skip
    if found is None:
        return placed
    # a clip plane or crop box lets the picture begin elsewhere than the whole ray does
    astray = float(np.linalg.norm(np.subtract(found.position, hit)))
    return found if astray <= ASTRAY * max(volume.spacing) else placed
