"""The ray loops of the float64 oracle; `volviz.reference.image` says what they compute."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from volviz.kernels.compiled import compiled
from volviz.kernels.preintegration import MAX_OPACITY, Extinction, segment_color
from volviz.reference.sampling import (
    Field,
    Float64Array,
    Lamp,
    Plane,
    gradient_world,
    lighting,
    look_up,
    look_up_plane,
    sample_world,
)

if TYPE_CHECKING:
    from volviz.reference.rays import Rays


class Classification(NamedTuple):
    """Transfer function and what else decides over a sample's weight."""

    table: Float64Array
    low: float
    high: float
    """Data values of the table's first and last entry."""
    lowest_shown: float
    """Samples below this value contribute nothing; -inf = all contribute."""
    gradient_opacity: float
    gradient_reference: float
    extinction: Extinction
    plane: Plane
    """Takes the table's place where samples are classified one by one."""


class March(NamedTuple):
    """How rays are cut into segments."""

    step: float
    first_sample: float
    unit_distance: float
    early_termination: float
    attenuation: float


@compiled
def segment_count(length: float, march: March) -> int:
    """Number of segments of a ray inside; the tolerance keeps rounding from making one of length zero."""
    if length <= 0:
        return 0
    if march.first_sample == 1.0:
        return int(np.floor(length / march.step + 1e-9))
    return int(np.ceil(length / march.step - 1e-11))


@compiled
def gradient_weight(classes: Classification, gradient: tuple[float, float, float]) -> float:
    """What gradient opacity leaves of a sample's opacity."""
    g = classes.gradient_opacity
    if g == 0:
        return 1.0
    magnitude = np.sqrt(gradient[0] ** 2 + gradient[1] ** 2 + gradient[2] ** 2)
    share = min(1.0, magnitude / classes.gradient_reference) if classes.gradient_reference > 0 else 1.0
    return 1.0 - g + g * share


@compiled
def draw_colors(
    rays: Rays,
    field: Field,
    classes: Classification,
    march: March,
    lamp: Lamp,
    additive: bool,
    image: Float64Array,
) -> None:
    """Modes that classify each sample: composite, and additive where `additive` is true."""
    rows, columns = rays.entries.shape
    color = np.empty(3)
    p = np.empty(3)
    for row in range(rows):
        for column in range(columns):
            start, ray = rays.starts[row, column], rays.directions[row, column]
            entry = rays.entries[row, column]
            inside = rays.exits[row, column] - entry
            pixel = image[row, column]
            for k in range(segment_count(inside, march)):
                length = min(march.step, inside - k * march.step)
                t = entry + k * march.step + march.first_sample * length
                for axis in range(3):
                    p[axis] = start[axis] + t * ray[axis]
                value = sample_world(field, p[0], p[1], p[2])
                if value < classes.lowest_shown:
                    continue
                gradient = (0.0, 0.0, 0.0)
                if lamp.on or classes.gradient_opacity > 0 or classes.plane.on:
                    gradient = gradient_world(field, p[0], p[1], p[2])
                if classes.plane.on:
                    magnitude = np.sqrt(gradient[0] ** 2 + gradient[1] ** 2 + gradient[2] ** 2)
                    alpha = look_up_plane(classes.plane, value, magnitude, color)
                else:
                    alpha = look_up(classes.table, classes.low, classes.high, value, 3)
                    for c in range(3):
                        color[c] = look_up(classes.table, classes.low, classes.high, value, c)
                if alpha <= 0:
                    continue
                if lamp.on or classes.gradient_opacity > 0:
                    alpha *= gradient_weight(classes, gradient)
                    if lamp.on and (gradient[0] != 0 or gradient[1] != 0 or gradient[2] != 0):
                        diffuse, highlight = lighting(lamp, gradient, p, ray)
                        for c in range(3):
                            color[c] *= lamp.weights[0] + lamp.weights[1] * diffuse * lamp.color[c]
                            color[c] += lamp.weights[2] * highlight * lamp.color[c]
                units = length / march.unit_distance
                if additive:
                    depth = -np.log1p(-min(alpha, MAX_OPACITY)) * units
                    for c in range(3):
                        pixel[c] += color[c] * depth
                    pixel[3] += depth
                else:
                    alpha = 1.0 - (1.0 - alpha) ** units
                    rest = 1.0 - pixel[3]
                    for c in range(3):
                        pixel[c] += rest * alpha * color[c]
                    pixel[3] += rest * alpha
                    if march.early_termination < 1.0 and pixel[3] >= march.early_termination:
                        break
            if additive:
                for c in range(4):
                    pixel[c] = min(pixel[c], 1.0)


@compiled
def _table_coordinate(classes: Classification, value: float) -> float:
    t = (value - classes.low) / (classes.high - classes.low) if classes.high > classes.low else 0.0
    return min(max(t, 0.0), 1.0) * (len(classes.table) - 1)


@compiled
def draw_preintegrated(
    rays: Rays, field: Field, classes: Classification, march: March, lamp: Lamp, image: Float64Array
) -> None:
    """Composite with the exact integral of each segment."""
    rows, columns = rays.entries.shape
    color = np.empty(3)
    p = np.empty(3)
    place = 0.5 if march.first_sample == 1.0 else march.first_sample
    for row in range(rows):
        for column in range(columns):
            start, ray = rays.starts[row, column], rays.directions[row, column]
            entry = rays.entries[row, column]
            inside = rays.exits[row, column] - entry
            pixel = image[row, column]
            if inside <= 0:
                continue
            for axis in range(3):
                p[axis] = start[axis] + entry * ray[axis]
            front = _table_coordinate(classes, sample_world(field, p[0], p[1], p[2]))
            for k in range(int(np.ceil(inside / march.step - 1e-11))):
                length = min(march.step, inside - k * march.step)
                t = entry + k * march.step + length
                for axis in range(3):
                    p[axis] = start[axis] + t * ray[axis]
                back = _table_coordinate(classes, sample_world(field, p[0], p[1], p[2]))
                red, green, blue, alpha = segment_color(
                    classes.extinction, front, back, length / march.unit_distance
                )
                front = back
                if alpha <= 0:
                    continue
                color[0], color[1], color[2] = red, green, blue
                if lamp.on or classes.gradient_opacity > 0:
                    t += (place - 1.0) * length
                    for axis in range(3):
                        p[axis] = start[axis] + t * ray[axis]
                    gradient = gradient_world(field, p[0], p[1], p[2])
                    weight = gradient_weight(classes, gradient)
                    diffuse, highlight = 0.0, 0.0
                    lit = lamp.on and (gradient[0] != 0 or gradient[1] != 0 or gradient[2] != 0)
                    if lit:
                        diffuse, highlight = lighting(lamp, gradient, p, ray)
                    for c in range(3):
                        if lit:
                            color[c] *= lamp.weights[0] + lamp.weights[1] * diffuse * lamp.color[c]
                            color[c] += lamp.weights[2] * highlight * lamp.color[c] * alpha
                    if weight < 1.0:
                        # the mean opacity per unit length is what gradient opacity acts on, as without
                        # pre-integration
                        units = length / march.unit_distance
                        thinned = 1.0 - (1.0 - weight * (1.0 - (1.0 - alpha) ** (1.0 / units))) ** units
                        for c in range(3):
                            color[c] *= thinned / alpha
                        alpha = thinned
                rest = 1.0 - pixel[3]
                for c in range(3):
                    pixel[c] += rest * color[c]
                pixel[3] += rest * alpha
                if march.early_termination < 1.0 and pixel[3] >= march.early_termination:
                    break


@compiled
def draw_scalar(
    rays: Rays, field: Field, classes: Classification, march: March, mode: int, image: Float64Array
) -> None:
    """Modes that reduce the scalar first: 1 maximum, 2 minimum, 3 average, 5 attenuated maximum."""
    rows, columns = rays.entries.shape
    span = classes.high - classes.low
    for row in range(rows):
        for column in range(columns):
            start, ray = rays.starts[row, column], rays.directions[row, column]
            entry = rays.entries[row, column]
            inside = rays.exits[row, column] - entry
            seen = 0.0
            result = 0.0
            depth = 0.0
            for k in range(segment_count(inside, march)):
                length = min(march.step, inside - k * march.step)
                t = entry + k * march.step + march.first_sample * length
                value = sample_world(
                    field, start[0] + t * ray[0], start[1] + t * ray[1], start[2] + t * ray[2]
                )
                if value < classes.lowest_shown:
                    continue
                if mode == 1:
                    result = value if seen == 0 else max(result, value)
                elif mode == 2:
                    result = value if seen == 0 else min(result, value)
                elif mode == 3:
                    result += value * length
                else:
                    s = min(max((value - classes.low) / span, 0.0), 1.0) if span > 0 else 0.0
                    result = max(result, s * np.exp(-march.attenuation * depth))
                    depth += s * length / march.unit_distance
                seen += length
            if seen == 0:
                continue
            if mode == 3:
                result /= seen
            elif mode == 5:
                result = classes.low + result * span
            alpha = look_up(classes.table, classes.low, classes.high, result, 3)
            for c in range(3):
                image[row, column, c] = alpha * look_up(classes.table, classes.low, classes.high, result, c)
            image[row, column, 3] = alpha
