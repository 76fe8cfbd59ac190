"""Pictures of scenes in files, without a window: what a session says is drawn as the window draws it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from volviz.annotations.composition import Composition
from volviz.annotations.figure import write_picture
from volviz.annotations.planes import subject_of_view
from volviz.annotations.subject import Subject
from volviz.custom_gl.resolve import resolve
from volviz.custom_gl.scene_techniques import drawn_spec
from volviz.embedded_session import saving_options
from volviz.errors import Cancelled
from volviz.model.layers import holding
from volviz.model.picture import Picture
from volviz.model.render_spec import RenderSpec, View
from volviz.model.scene import Scene
from volviz.model.surface_values import DistanceColoring
from volviz.renderer import Renderer
from volviz.volume_data.references import VolumeKey
from volviz.volume_data.volume import Volume


def compose(
    renderer: Renderer,
    scene: Scene,
    picture: Picture,
    volumes: Mapping[VolumeKey, Volume],
    *,
    vector: bool = False,
    note: str = "",
    progress: Callable[[float], None] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> Composition:
    """Draw a picture of a scene at full quality.

    Parameters
    ----------
    renderer : Renderer
        Which draws it, of any size.
    scene : Scene
        With a camera in each view that is seen.
    picture : Picture
        Which views, how large, with what around them.
    volumes : mapping from VolumeKey to Volume
        What the layers show.
    vector : bool
        It is for a file in which what stands around is lines and words.
    note : str
        A line at the lower edge; empty for none.
    progress : callable, optional
        Called with the finished part, 0..1.
    cancel : callable, optional
        Asked now and then; when it returns True, drawing ends with `Cancelled`.

    Returns
    -------
    Composition
        Which `write_composition` writes.

    Raises
    ------
    VolvizError
        Unusable values, no usable OpenGL, or `Cancelled`.
    """
    specs = [_spec(scene, part.view, volumes) for part in picture.parts]
    subjects: list[Subject | None] = [None] * len(specs)
    if note or not picture.contents.is_empty:
        parts = zip(picture.parts, specs, strict=True)
        shown = [subject_of_view(scene, part.view, resolve(spec, volumes), volumes) for part, spec in parts]
        subjects = [replace(subject, note=note or subject.note) for subject in shown]
    composition = Composition(scene, picture, subjects, is_vector=vector)
    for number, (part, spec) in enumerate(zip(picture.parts, specs, strict=True)):
        view = View(scene.view_at(part.view).camera, part.size)
        for fraction, tile in renderer.turns(spec, view, volumes):
            if cancel is not None and cancel():
                raise Cancelled("the picture was cancelled.")
            if tile is not None:
                composition.take(number, *tile)
            if progress is not None:
                progress((number + fraction) / len(picture.parts))
    return composition


def write_composition(
    composition: Composition, path: Path, session: Mapping[str, Any] | None = None, *, alpha: bool = False
) -> None:
    """Write a picture that has been put together, with the session that it carries, and with alpha in any case.

    Raises
    ------
    VolvizError
        The file cannot be written.
    """
    write_picture(
        path, composition.image(alpha=alpha), composition.shapes, composition.ground, composition.picture.dpi,
        **saving_options(path, session),
    )  # fmt: skip


def _spec(scene: Scene, view: int, volumes: Mapping[VolumeKey, Volume]) -> RenderSpec:
    """What a view draws, with distances of surfaces measured."""
    spec = drawn_spec(scene, view)
    if not isinstance(spec.surface_colors, DistanceColoring):
        return spec
    from volviz.compare.distance_colors import colors_of

    whole = replace(spec, layers=tuple(holding(layer, volumes) for layer in spec.layers))
    return replace(spec, surface_colors=colors_of(whole))
