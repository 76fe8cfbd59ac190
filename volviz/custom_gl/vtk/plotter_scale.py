"""`Plotter.set_scale` of PyVista: volumes are stretched with everything else, as layers with a transform."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from volviz.model.layers import ImageLayer, LabelLayer
from volviz.model.render_spec import RenderSpec

AnyLayer = TypeVar("AnyLayer", bound=ImageLayer | LabelLayer)
Scale = tuple[float, float, float]
UNSCALED: Scale = (1.0, 1.0, 1.0)


def scale_of(renderer: Any) -> Scale:
    """By what a renderer of PyVista stretches what it shows along x, y, z; 1 for any other renderer."""
    # like VTK's actors, which take 0 for 1
    x, y, z = (float(v) or 1.0 for v in getattr(renderer, "scale", UNSCALED))
    return x, y, z


def stretched(spec: RenderSpec, scale: Scale) -> RenderSpec:
    """A spec with the world of its layers stretched; clip planes and lights stay where they are."""
    if scale == UNSCALED:
        return spec
    return replace(spec, layers=tuple(_stretched_layer(layer, scale) for layer in spec.layers))


def _stretched_layer(layer: AnyLayer, scale: Scale) -> AnyLayer:
    before = np.eye(4) if layer.transform is None else np.asarray(layer.transform)
    # the layer checks it and keeps it as tuples
    transform: Any = np.diag((*scale, 1.0)) @ before
    return replace(layer, transform=transform)


def listen_to_scale(renderer: Any, on_scale: Callable[[Scale], None]) -> None:
    """Call back before a renderer of PyVista stretches its actors, so that its camera sees the new bounds."""
    if not hasattr(renderer, "set_scale") or "set_scale" in vars(renderer):
        return
    set_scale = renderer.set_scale
    signature = inspect.signature(set_scale)

    def set_scale_with_volumes(*args: Any, **keywords: Any) -> Any:
        given = signature.bind(*args, **keywords).arguments
        asked = (given.get(f"{axis}scale") for axis in "xyz")
        x, y, z = (
            old if new is None else float(new) or 1.0
            for old, new in zip(scale_of(renderer), asked, strict=True)
        )
        on_scale((x, y, z))
        return set_scale(*args, **keywords)

    vars(renderer)["set_scale"] = set_scale_with_volumes
