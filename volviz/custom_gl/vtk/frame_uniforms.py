"""Uniforms that every shader shares, from the values of a frame. Pure arithmetic."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from volviz.custom_gl.vtk.progressive import sample_phase

if TYPE_CHECKING:
    from volviz.custom_gl.technique import Frame

Matrix = npt.NDArray[np.float64]

#: Below any scalar.
LARGEST_FLOAT = 3e38


def shared_uniforms(frame: Frame) -> dict[str, Any]:
    """Values of the uniforms declared in ``glsl/``, by name; matrices are float64 arrays, row-major."""
    volume, texels, common = frame.volume, frame.resources.texels, frame.common
    to_world = frame.texture_to_world
    scale, offset = texels.index_to_texture

    uniforms: dict[str, Any] = {
        "u_clip_to_texture": np.linalg.inv(frame.texture_to_clip),
        "u_texture_to_clip": frame.texture_to_clip,
        "u_world_to_texture": frame.world_to_texture,
        "u_world_metric_x": tuple(to_world[0, :3]),
        "u_world_metric_y": tuple(to_world[1, :3]),
        "u_world_metric_z": tuple(to_world[2, :3]),
        **box_uniforms(frame),
        "u_planes": _planes(frame, to_world),
        "u_size": tuple(float(n) for n in frame.size),
        "u_scalar_map": (texels.scale, texels.offset),
        "u_voxels": tuple(1.0 / scale),
        "u_gradient_to_world": np.linalg.inv(volume.index_to_world[:3, :3]).T,
        "u_gradient_delta": common.gradient_delta * frame.resources.voxel_scale,
        # 0 leaves nothing out, not even what lies below the bulk of the values
        "u_density_threshold": common.density_threshold or -LARGEST_FLOAT,
        "u_inverse_unit_distance": 1.0 / frame.unit_distance,
        "u_gradient_opacity": common.gradient_opacity,
        "u_inverse_gradient_scale": 1.0,
        "u_index_to_texture_scale": tuple(scale),
        "u_index_to_texture_offset": tuple(offset),
        "u_texture_to_centred": frame.recentred(to_world),
        "u_eye_centred": tuple(frame.viewpoint - frame.center),
        "u_view_direction": tuple(frame.camera.direction),
        "u_light_centred": tuple(frame.light_source - frame.center),
        "u_light_color": frame.light_color,
        "u_flat_gradient": 1e-5 / volume.mean_spacing,
        "u_material": (
            common.ambient, common.diffuse, common.specular, common.shininess,
        ),
        "u_first_sample": sample_phase(common.first_sample, frame.sequence),
        "u_early_termination": common.early_termination,
        "u_jitter": common.jitter,
        "u_jitter_seed": float(frame.sequence),
        "u_attenuation": common.attenuation,
        "u_step": frame.step_world,
    }  # fmt: skip
    if common.gradient_opacity > 0:
        uniforms["u_inverse_gradient_scale"] = 1.0 / frame.resources.gradient_scale
    uniforms |= frame.resources.brick_uniforms()
    uniforms |= frame.resources.table_uniforms(frame.transfer_function, interactive=frame.interactive)
    return uniforms


def box_uniforms(frame: Frame) -> dict[str, Any]:
    """The box of what is shown, in texture coordinates."""
    scale, offset = frame.resources.texels.index_to_texture
    crop = np.array(frame.crop).reshape(3, 2)
    return {
        "u_box_low": tuple(crop[:, 0] * scale + offset),
        "u_box_high": tuple(crop[:, 1] * scale + offset),
    }


def _planes(frame: Frame, to_world: Matrix) -> Matrix:
    """Clip planes in texture coordinates, four numbers each, scaled for tests with one tolerance."""
    planes = np.zeros((len(frame.planes), 4))
    # distances in lengths of the volume, or nearly: dividing by a power of two rounds nothing
    unit = 2.0 ** -math.frexp(float(np.linalg.norm(frame.volume.extent)))[1]
    for row, (origin, normal) in enumerate(frame.planes):
        n = np.asarray(normal) * unit
        planes[row, :3] = to_world[:3, :3].T @ n
        planes[row, 3] = n @ (to_world[:3, 3] - np.asarray(origin))
    # flat: four planes are not a matrix
    return planes.ravel()


def pixel_size(frame: Frame) -> float:
    """World size of a pixel of the target at the nearest part of the box, but not nearer than a tenth of its depth."""
    projection = frame.camera.projection
    height = frame.size[1]
    if frame.camera.parallel:
        return float(2.0 / (projection[1, 1] * height))
    depths = (frame.box_corners - frame.camera.eye) @ frame.camera.direction
    near = max(float(depths.min()), 0.1 * float(depths.max()), 1e-12)
    return float(2.0 * near / (projection[1, 1] * height))


def box_tiles(
    corners: Matrix, view_projection: Matrix, size: tuple[int, int], tile: tuple[int, int]
) -> tuple[tuple[int, int, int, int], ...]:
    """Tiles (x, y, width, height) of the target that the box may touch, row by row from the bottom.

    A box that reaches behind the eye touches all of them.
    """
    clip = np.c_[corners, np.ones(len(corners))] @ view_projection.T
    width, height = size
    x0, y0, x1, y1 = 0, 0, width, height
    if np.all(clip[:, 3] > 1e-9):
        ndc = clip[:, :2] / clip[:, 3:]
        low = np.floor((ndc.min(axis=0) * 0.5 + 0.5) * size) - 1
        high = np.ceil((ndc.max(axis=0) * 0.5 + 0.5) * size) + 1
        x0, y0 = (int(max(v, 0)) for v in low)
        x1, y1 = (int(min(v, n)) for v, n in zip(high, size, strict=True))
    tiles = []
    # aligned to the tiles of software rasterisers, which draw 64 x 64 pixels at a time
    for y in range(y0 - y0 % 64, y1, tile[1]):
        for x in range(x0 - x0 % 64, x1, tile[0]):
            left, bottom = max(x, x0), max(y, y0)
            right, top = min(x + tile[0], x1), min(y + tile[1], y1)
            if right > left and top > bottom:
                tiles.append((left, bottom, right - left, top - bottom))
    return tuple(tiles)


def level_of_detail(frame: Frame) -> int:
    """Level of the scalars that fits the size of a pixel.

    Full images take the full data unless the technique's ``mipmaps`` is on. While something moves, software
    OpenGL reads the level that is about as fine as its few pixels: most of its time goes into fetching
    voxels that lie far apart.
    """
    if frame.joint is not None:
        # layers that share a texture have one level
        return 0
    finest = frame.resources.finest
    moving = frame.interactive and frame.gpu.limits.software
    if not moving and not frame.common.mipmaps:
        return finest
    if frame.common.interpolation == "nearest":
        # labels must not be averaged
        return 0
    voxels = pixel_size(frame) / frame.volume.mean_spacing
    level = math.floor(math.log2(max(voxels, 1e-9)) + (0.0 if moving else 0.5))
    return min(max(level, finest), frame.resources.coarsest)
