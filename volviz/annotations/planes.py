"""What one view of a scene shows of the others, and what annotations tell of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from volviz.annotations.shapes import Color
from volviz.annotations.subject import Floats, Subject, subject_of
from volviz.custom_gl.resolve import ResolvedSpec, Volumes
from volviz.custom_gl.scene_techniques import current_settings, faced
from volviz.kernels.slices import crop_corners, slice_polygons
from volviz.measure.readings import words_beside
from volviz.model.cursor import cursor_of
from volviz.model.scene import Scene
from volviz.volume_data.volume import Volume

#: Colours of planes, as they are known from other viewers of medical images.
PLANE_COLORS: dict[str, Color] = {
    "axial": (0.95, 0.33, 0.25),
    "coronal": (0.45, 0.75, 0.33),
    "sagittal": (0.95, 0.82, 0.30),
    "oblique": (0.35, 0.65, 1.0),
}


def subject_of_view(scene: Scene, view: int, shown: ResolvedSpec, volumes: Volumes) -> Subject:
    """What can be told of the picture of a view.

    Parameters
    ----------
    scene : Scene
    view : int
        Number of the view.
    shown : ResolvedSpec
        What it draws.
    volumes : mapping of VolumeKey to Volume
        What the layers of the scene show.
    """
    subject, facing = replace(subject_of(shown, volumes), facing=faced(scene, view)), faced(scene, view)
    layer = scene.layer
    if layer is None:
        return subject
    volume = volumes[layer.key]
    plane = None
    if facing is not None:
        # what lies within half a voxel of a plane lies in it
        normal = np.asarray(facing[0])
        reach = 0.5 / float(np.abs(volume.world_to_index[:3, :3] @ normal).max())
        plane = (cursor_of(scene, volume), facing[0], 1.001 * reach)
    measured = tuple((each, words_beside(each, volume)) for each in scene.measurements)
    return replace(subject, lines=plane_lines(scene, volume, view), measurements=measured, plane=plane)


def plane_lines(scene: Scene, volume: Volume, view: int) -> tuple[tuple[Color, Floats], ...]:
    """Colours and world points (N, 3), joined by lines, of what a view shows of the planes of others.

    A view that faces a plane shows where the others cut it, all others their outlines.
    """
    cursor, own = np.asarray(cursor_of(scene, volume)), faced(scene, view)
    reach = float(np.linalg.norm(volume.extent))
    found = []
    for number in range(len(scene.views)):
        other = faced(scene, number)
        if other is None or number == view:
            continue
        color = PLANE_COLORS[current_settings(scene, number).plane]
        normal = np.asarray(other[0])
        if own is None:
            corners = crop_corners(volume.index_to_world, None, volume.dimensions)
            vertices, counts = slice_polygons(corners, normal, [normal @ cursor])
            if counts[0]:
                outline = vertices[0, : counts[0]]
                found.append((color, np.concatenate([outline, outline[:1]])))
            continue
        along = np.cross(normal, own[0])
        length = float(np.linalg.norm(along))
        if length > 1e-6:
            found.append((color, cursor + np.outer((-reach, reach), along / length)))
    return tuple(found)
