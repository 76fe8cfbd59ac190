"""The float64 oracle: every volumetric mode, written to be read, on small volumes and images.

A ray is cut into segments of one step from where it enters the box; the last one is shorter. A segment of
length d is represented by one sample. Opacity is per unit length: ``a' = 1 - (1 - a)^(d / unit_distance)``.
Colours are multiplied by a' and blended front to back ("over", premultiplied).

Where the sample of a segment lies is `first_sample`, a fraction of the segment's length; 0.5 is the
midpoint rule. ``first_sample = 1.0`` is the rule of VTK's GPU mapper (9.7, found by experiment on a
homogeneous box): samples at the *far* ends of whole steps, that is at step, 2 step, ...; the rest of the
ray that is shorter than a step is left out.
"""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from volviz.errors import Cancelled, InputError
from volviz.kernels.preintegration import extinction_sums
from volviz.kernels.threads import map_ranges, split_range, worker_count
from volviz.reference.march import Classification, March, draw_colors, draw_preintegrated, draw_scalar
from volviz.reference.rays import Plane, index_to_world_matrix, volume_rays
from volviz.reference.sampling import Float64Array, Shading, make_field, make_lamp, make_plane

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

__all__ = ["MODES", "Shading", "reference_render"]

#: Pieces between which an image can be cancelled.
PIECES = 128

MODES = ("composite", "maximum", "minimum", "average", "additive", "attenuated_maximum")


def reference_render(
    array: npt.NDArray[Any],
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    origin: Sequence[float] = (0.0, 0.0, 0.0),
    direction: npt.ArrayLike | None = None,
    *,
    table: npt.ArrayLike,
    value_range: tuple[float, float],
    table_range: tuple[float, float] | None = None,
    view: npt.ArrayLike,
    projection: npt.ArrayLike,
    size: tuple[int, int],
    step_world: float,
    first_sample: float = 0.5,
    unit_distance: float | None = None,
    mode: str = "composite",
    attenuation: float = 1.0,
    early_termination: float = 1.0,
    shading: Shading | None = None,
    gradient_opacity: float = 0.0,
    gradient_reference: float | None = None,
    crop: Sequence[float] | None = None,
    clip_planes: Sequence[Plane] = (),
    interpolation: str = "linear",
    preintegrated: bool = False,
    density_threshold: float = 0.0,
    gradient_table: npt.ArrayLike | None = None,
    gradient_range: tuple[float, float] | None = None,
    gradient_delta: float = 1.0,
    progress: Callable[[float], None] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> Float64Array:
    """The image that a perfect renderer would draw, in float64.

    Parameters
    ----------
    array : ndarray of shape (Z, Y, X)
        Scalars; NaN and infinities count as the lowest finite value. Trilinear, clamped to the first and
        last voxel.
    spacing, origin, direction
        Geometry in (x, y, z), world units; the columns of `direction` are the world directions of i, j, k.
    table : array_like of shape (n, 4)
        Straight RGBA over `table_range`; entry i at ``lo + i (hi - lo) / (n - 1)``, linear between, clamped.
    value_range : (lo, hi)
        Lowest and highest value of the data.
    table_range : (lo, hi), optional
        Data values of the first and last entry; the default is `value_range`, which "attenuated_maximum" always uses.
    view, projection : array_like of shape (4, 4)
        World to eye and eye to clip space, OpenGL conventions, column vectors. Rays begin on the near plane
        (so the camera may be inside the volume) and end on the far plane.
    size : (w, h)
        Pixels; rays go through their centres.
    step_world : float
        Length of a segment in world units.
    first_sample : float, default: 0.5
        Place of the sample in its segment, 0..1; see the module's text for 1.0.
    unit_distance : float, optional
        World length to which the table's opacities refer; default the mean spacing.
    mode : {"composite", "maximum", "minimum", "average", "additive", "attenuated_maximum"}
        ``maximum``, ``minimum`` and ``average`` (weighted by length) act on the scalar; the result is
        classified once, with the table's opacity as it is. ``additive`` is the sum of colour x extinction x
        length, alpha the sum of extinction x length, both clamped to 1; extinction is ``-ln(1 - min(a,
        MAX_OPACITY)) / unit_distance``. ``attenuated_maximum`` is the maximum of ``s exp(-attenuation S)``,
        s the value scaled to 0..1 over `value_range`, S the integral of s in unit distances over the
        segments *before* this one; the maximum is scaled back and classified like ``maximum``.
    attenuation : float
        For ``attenuated_maximum``, per unit distance.
    early_termination : float, default: 1.0
        A composited ray ends when its alpha reaches this; 1.0 = never.
    shading : Shading, optional
        Lighting of ``composite`` and ``additive``; None = colours as classified.
    gradient_opacity : float, default: 0.0
        0..1: the opacity is multiplied by ``w = 1 - g + g min(1, |grad| / gradient_reference)`` before the
        correction for length. With `preintegrated`, w multiplies the segment's mean opacity per unit
        length: alpha A over d units becomes ``1 - (1 - w (1 - (1 - A)^(1/d)))^d``, and the colour is scaled
        along.
    gradient_reference : float, optional
        Gradient magnitude, data units per world unit, from which on nothing is taken away; default a
        quarter of the range per mean spacing.
    crop : tuple of 6 floats, optional
        (i0, i1, j0, j1, k0, k1) in continuous voxel indices.
    clip_planes : sequence of (origin, normal)
        World space; the normal points to the kept side. Segments are counted from where the ray enters what
        is left.
    interpolation : {"linear", "nearest"}
    preintegrated : bool, default: False
        ``composite`` only: the value is linear along each segment, from its front to its back end, and the
        segment's integral is exact; `first_sample` is then only where gradients are taken (1.0 counts as
        0.5).
    density_threshold : float, default: 0.0
        Samples with a value below ``lo + density_threshold (hi - lo)`` contribute nothing, in any mode:
        they count neither in the mean's sum nor in its length. A ray without a contributing sample is
        empty.
    gradient_table : array_like of shape (m, n, 4), optional
        Straight RGBA over gradient magnitude (rows) and value (columns, over `value_range`), which ``composite``
        and ``additive`` take instead of `table`; bilinear in colours weighted by opacity, clamped.
    gradient_range : (lo, hi), optional
        Of its first and last row, data units per world unit.
    gradient_delta : float, default: 1.0
        Distance of the central differences in voxels, where `shading` does not say it.

    Returns
    -------
    ndarray of shape (h, w, 4), float64
        Premultiplied RGBA, row 0 at the top; colours are not clamped (highlights may exceed alpha).

    Raises
    ------
    InputError
        An argument outside what is described here.
    Cancelled
        `cancel` said so.
    """
    low, high = value_range
    if mode not in MODES:
        raise InputError(f"mode must be one of {', '.join(MODES)}, got {mode!r}.")
    if not step_world > 0 or not 0 <= first_sample <= 1:
        raise InputError(
            "step_world must be above 0 and first_sample between 0 and 1, "
            f"got {step_world:g} and {first_sample:g}."
        )
    if preintegrated and mode != "composite":
        raise InputError(f'preintegrated needs mode "composite", got {mode!r}.')
    if gradient_table is not None and (preintegrated or mode not in ("composite", "additive")):
        raise InputError('gradient_table needs mode "composite" or "additive", not pre-integrated.')
    matrix = index_to_world_matrix(spacing, origin, direction)
    mean_spacing = float(np.mean(spacing))
    first, last = value_range if table_range is None or mode == "attenuated_maximum" else table_range
    rgba = np.ascontiguousarray(table, np.float64)
    extinction = extinction_sums(rgba)
    lowest_shown = low + density_threshold * (high - low) if density_threshold > 0 else -np.inf
    if preintegrated and density_threshold > 0:
        shown = np.linspace(first, last, len(rgba)) >= lowest_shown
        extinction = extinction_sums(rgba * np.where(shown[:, None], 1.0, [1.0, 1.0, 1.0, 0.0]))
    classification = Classification(
        table=rgba,
        low=float(first),
        high=float(last),
        lowest_shown=float(lowest_shown),
        gradient_opacity=float(gradient_opacity),
        gradient_reference=float(
            gradient_reference if gradient_reference is not None else (high - low) / (4 * mean_spacing)
        ),
        extinction=extinction,
        plane=make_plane(gradient_table, value_range, gradient_range),
    )
    march = March(
        step=float(step_world),
        first_sample=float(first_sample),
        unit_distance=float(unit_distance if unit_distance is not None else mean_spacing),
        early_termination=float(early_termination),
        attenuation=float(attenuation),
    )
    delta = shading.gradient_delta if shading is not None else gradient_delta
    field = make_field(array, matrix, interpolation=interpolation, delta=delta, value_range=value_range)
    lamp = make_lamp(shading)
    rays = volume_rays(
        array.shape, matrix, view=view, projection=projection, size=size, crop=crop, clip_planes=clip_planes
    )
    image = np.zeros((size[1], size[0], 4))

    def rows(first: int, last: int) -> None:
        part = rays.rows(first, last)
        target = image[first:last]
        if preintegrated:
            draw_preintegrated(part, field, classification, march, lamp, target)
        elif mode in {"composite", "additive"}:
            draw_colors(part, field, classification, march, lamp, mode == "additive", target)
        else:
            draw_scalar(part, field, classification, march, MODES.index(mode), target)

    if progress is None and cancel is None:
        map_ranges(rows, size[1])
    else:
        _few_at_a_time(rows, size[1], progress, cancel)
    return image


def _few_at_a_time(
    rows: Callable[[int, int], None],
    count: int,
    progress: Callable[[float], None] | None,
    cancel: Callable[[], bool] | None,
) -> None:
    """All rows on threads of their own, with word on how far they are."""
    done = 0
    lock = threading.Lock()

    def some(bounds: tuple[int, int]) -> None:
        nonlocal done
        if cancel is not None and cancel():
            raise Cancelled("the reference picture was cancelled.")
        rows(*bounds)
        with lock:
            done += bounds[1] - bounds[0]
            if progress is not None:
                progress(done / count)

    with ThreadPoolExecutor(worker_count(), thread_name_prefix="volviz-reference") as pool:
        list(pool.map(some, split_range(count, PIECES)))
