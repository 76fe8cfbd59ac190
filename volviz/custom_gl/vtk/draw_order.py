"""Order of translucent things: VTK's plain translucent pass draws props in the order in which they were added."""

from __future__ import annotations

from typing import Any

import numpy as np


def sort_translucent(renderer: Any, hooks: set[int]) -> None:
    """Let translucent props and volumes be drawn from far to near, by the middles of their bounds.

    They do not interpenetrate: a translucent mesh is drawn before or after a volume as a whole.

    Parameters
    ----------
    renderer : vtkRenderer
        Its props are reordered where needed.
    hooks : set of int
        ``id`` of the actors that stand for volumes.
    """
    props = renderer.GetViewProps()
    direction = np.array(renderer.GetActiveCamera().GetDirectionOfProjection())
    translucent = [prop for prop in props if id(prop) in hooks or _is_translucent(prop)]
    if len(translucent) < 2:
        return

    def distance(prop: Any) -> float:
        bounds = prop.GetBounds()
        return float(direction @ np.array(bounds).reshape(3, 2).mean(axis=1)) if bounds else 0.0

    wanted = sorted(translucent, key=distance, reverse=True)
    if all(a is b for a, b in zip(wanted, translucent, strict=True)):
        return
    # only the list of props changes: taking a prop out of the renderer itself would release its GPU objects
    for prop in wanted:
        props.RemoveItem(prop)
    for prop in wanted:
        props.AddItem(prop)


def _is_translucent(prop: Any) -> bool:
    flat = prop.IsA("vtkActor2D")
    return bool(prop.GetVisibility() and not flat and prop.HasTranslucentPolygonalGeometry())
