"""A second, slow implementation of the oracle's definitions, written another way."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import map_coordinates

from volviz.kernels.preintegration import MAX_OPACITY


class SlowRenderer:
    """The same definitions once more: one ray at a time, in world space, with SciPy's interpolation."""

    def __init__(self, array, matrix, table, value_range, *, order=1):
        self.array, self.to_index = np.asarray(array, float), np.linalg.inv(matrix)
        self.axes = matrix[:3, :3]
        self.table, self.range, self.order = table, value_range, order

    def values(self, world):
        index = world @ self.to_index[:3, :3].T + self.to_index[:3, 3]
        return self.values_at_index(index)

    def values_at_index(self, index):
        if self.order == 0:
            index = np.floor(index + 0.5)
        return map_coordinates(self.array, index[:, ::-1].T, order=self.order, mode="nearest")

    def rgba(self, values):
        nodes = np.linspace(*self.range, len(self.table))
        return np.stack([np.interp(values, nodes, self.table[:, c]) for c in range(4)], axis=-1)

    def gradients(self, world, delta):
        index = world @ self.to_index[:3, :3].T + self.to_index[:3, 3]
        result = np.zeros_like(world)
        for axis in range(3):
            shift = delta * np.eye(3)[axis]
            slope = (self.values_at_index(index + shift) - self.values_at_index(index - shift)) / (2 * delta)
            column = self.axes[:, axis]
            result += slope[:, None] * column / (column @ column)
        return result

    def interval(self, start, ray, length, crop, planes):
        """Clip the segment start .. start + length ray by half-spaces, one after the other."""
        near, far = 0.0, length
        o = self.to_index[:3, :3] @ start + self.to_index[:3, 3]
        d = self.to_index[:3, :3] @ ray
        half_spaces = []
        for axis in range(3):
            half_spaces.append((o[axis] - crop[2 * axis], d[axis]))
            half_spaces.append((crop[2 * axis + 1] - o[axis], -d[axis]))
        half_spaces += [((start - p) @ np.array(n), ray @ np.array(n)) for p, n in planes]
        for height, slope in half_spaces:
            if abs(slope) < 1e-15:
                if height < 0:
                    return 1.0, 0.0
            elif slope > 0:
                near = max(near, -height / slope)
            else:
                far = min(far, -height / slope)
        return near, far

    def sample_positions(self, near, far, step, first):
        edges = np.append(np.arange(near, far - 1e-10, step), far)
        lengths = np.diff(edges)
        if first == 1.0:
            whole = int(np.floor((far - near) / step + 1e-9))
            edges, lengths = edges[: whole + 1], lengths[:whole]
            return near + step * np.arange(1, whole + 1), np.full(whole, step)
        return edges[:-1] + first * lengths, lengths

    def pixel(
        self, start, ray, length, *, step, first, unit, mode="composite", attenuation=1.0, shading=None,
        gradient_opacity=0.0, gradient_reference=1.0, threshold=-np.inf, crop, planes=(), termination=1.0,
    ):  # fmt: skip
        near, far = self.interval(start, ray, length, crop, planes)
        if far <= near:
            return np.zeros(4)
        t, lengths = self.sample_positions(near, far, step, first)
        if len(t) == 0:
            return np.zeros(4)
        world = start + t[:, None] * ray
        values = self.values(world)
        shown = values >= threshold
        world, values, lengths = world[shown], values[shown], lengths[shown]
        if len(values) == 0:
            return np.zeros(4)
        if mode in {"maximum", "minimum", "average", "attenuated_maximum"}:
            scaled = np.clip((values - self.range[0]) / (self.range[1] - self.range[0]), 0, 1)
            before = np.concatenate(([0.0], np.cumsum(scaled * lengths)[:-1])) / unit
            result = {
                "maximum": values.max(),
                "minimum": values.min(),
                "average": np.average(values, weights=lengths),
                "attenuated_maximum": self.range[0]
                + (scaled * np.exp(-attenuation * before)).max() * (self.range[1] - self.range[0]),
            }[mode]
            r, g, b, a = self.rgba(np.array([result]))[0]
            return np.array([r * a, g * a, b * a, a])
        rgba = self.rgba(values)
        color, alpha = rgba[:, :3], rgba[:, 3]
        if shading is not None or gradient_opacity > 0:
            gradient = self.gradients(world, shading.gradient_delta if shading else 1.0)
            magnitude = np.linalg.norm(gradient, axis=1)
            alpha = alpha * (
                1 - gradient_opacity + gradient_opacity * np.minimum(1, magnitude / gradient_reference)
            )
        if shading is not None:
            normal = gradient / magnitude[:, None]
            eye = -ray
            if shading.light_position is None:
                light = np.broadcast_to(eye, world.shape)
            else:
                light = np.array(shading.light_position) - world
                light = light / np.linalg.norm(light, axis=1, keepdims=True)
            half = light + eye
            half = half / np.linalg.norm(half, axis=1, keepdims=True)
            diffuse = np.abs((normal * light).sum(1))[:, None] * shading.light_color
            highlight = np.abs((normal * half).sum(1))[:, None] ** shading.shininess * shading.light_color
            color = color * (shading.ambient + shading.diffuse * diffuse) + shading.specular * highlight
        if mode == "additive":
            depth = -np.log(1 - np.minimum(alpha, MAX_OPACITY)) * lengths / unit
            return np.minimum(np.append((color * depth[:, None]).sum(0), depth.sum()), 1)
        corrected = 1 - (1 - alpha) ** (lengths / unit)
        transmitted = np.concatenate(([1.0], np.cumprod(1 - corrected)))
        if termination < 1:
            ended = np.flatnonzero(1 - transmitted[1:] >= termination)
            if len(ended):
                corrected, color = corrected[: ended[0] + 1], color[: ended[0] + 1]
                transmitted = transmitted[: ended[0] + 2]
        weights = transmitted[:-1] * corrected
        return np.append((weights[:, None] * color).sum(0), 1 - transmitted[-1])
