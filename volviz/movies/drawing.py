"""A movie drawn frame by frame into files; what was drawn before a kill is not drawn again."""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from volviz import __version__
from volviz.annotations.figure import write_picture
from volviz.annotations.picture import usual_scale
from volviz.embedded_session import saving_options, session_with
from volviz.errors import Cancelled, InputError
from volviz.model.movies.timeline import NOTHING, Timeline
from volviz.model.picture import Picture, PictureContents
from volviz.model.scene import Scene
from volviz.model.session import scene_to_dict
from volviz.movies.encoding import Format, check_encoder, encode, format_of
from volviz.new_files import check_target, written_beside
from volviz.renderer import Renderer
from volviz.scene_drawing import compose
from volviz.scene_volumes import SceneVolumes, framed

#: Share of the progress that drawing takes; the rest is encoding.
DRAWING = 0.9
Progress = Callable[[float, str], object]
_PLAN = "movie.json"


@dataclass(frozen=True)
class MovieFile:
    """What is to be written.

    Attributes
    ----------
    scene : Scene
        What the movie begins with; `Scene.movie` is what happens.
    output : Path
        .mp4, .webm, .gif, .apng, or numbered frames such as frames/%04d.png.
    size : tuple of 2 ints
        Width and height in pixels.
    transparent : bool
        Without background; otherwise it is that of the scene.
    contents : PictureContents
        What stands around the volume; the title is that of the movie.
    keep_session : bool
        The file tells how it was made: the session as metadata. Paths of volumes are part of it.
    """

    scene: Scene
    output: Path
    size: tuple[int, int] = (1280, 720)
    transparent: bool = False
    contents: PictureContents = PictureContents()
    keep_session: bool = True

    @property
    def kind(self) -> Format | None:
        """How it is encoded; None for numbered frames."""
        return format_of(self.output)

    @property
    def folder(self) -> Path:
        """Where the frames lie while they are drawn."""
        if self.kind is None:
            return self.output.parent
        return self.output.with_name(self.output.name + ".frames")

    def frame(self, number: int) -> Path:
        """File of a frame, counted from 0."""
        name = self.output.name % number if self.kind is None else f"{number:06d}.png"
        return self.folder / name

    @property
    def frames(self) -> list[Path]:
        """Files of all frames."""
        return [self.frame(number) for number in range(self.scene.movie.frame_count)]

    @property
    def picture(self) -> Picture:
        """How each frame is made."""
        contents = replace(self.contents, title=self.scene.movie.title)
        view, scale = self.scene.active_index, usual_scale(self.size)
        return Picture.of_view(view, self.size, scale, contents=contents, transparent=self.transparent)

    @property
    def session(self) -> dict[str, Any]:
        """The session that the file tells."""
        return scene_to_dict(self.scene, self.output.absolute().parent)

    @property
    def plan(self) -> dict[str, Any]:
        """All that decides the frames: those of an equal plan are equal to the byte."""
        told = {
            "program": __version__, "picture": self.picture.to_dict(),
            "keep_session": self.keep_session, "session": self.session,
        }  # fmt: skip
        text = json.dumps(told, sort_keys=True)
        return {"frames": self.scene.movie.frame_count, "sha256": hashlib.sha256(text.encode()).hexdigest()}


def write_movie(
    movie: MovieFile,
    volumes: SceneVolumes | None = None,
    *,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
    cancel: Callable[[], bool] | None = None,
) -> int:
    """Draw a movie at full quality and write it.

    Frames are drawn into PNG files, beside the movie in a folder that ends in .frames, and put together at the end.
    They stay there when the work is stopped or killed, and `resume` goes on with them.

    Parameters
    ----------
    movie : MovieFile
    volumes : SceneVolumes, optional
        Reads what the scene shows.
    resume : bool
        Take the frames that are there already.
    overwrite : bool
        Replace an existing file, and frames of another movie.
    progress : callable, optional
        Called with the finished part, 0..1, and words.
    cancel : callable, optional
        Asked now and then; when it returns True, the work ends with `Cancelled`.

    Returns
    -------
    int
        How many frames were drawn; the others were there already.

    Raises
    ------
    VolvizError
        A wrong name, size, scene or movie; frames of an unfinished movie are there and neither `resume` nor
        `overwrite` is asked for; no usable OpenGL; or `Cancelled`.
    """
    kind = movie.kind
    if not movie.scene.movie.passing:
        raise InputError(NOTHING)
    if kind is not None:
        check_encoder(kind, movie.size, transparent=movie.transparent)
        check_target(movie.output, overwrite=overwrite)
    _prepare(movie, resume=resume, overwrite=overwrite)
    drawn = _draw(movie, volumes or SceneVolumes(), progress, cancel)
    if kind is not None:
        _encode(movie, kind, progress, cancel)
        shutil.rmtree(movie.folder, ignore_errors=True)
    return drawn


def _prepare(movie: MovieFile, *, resume: bool, overwrite: bool) -> None:
    """An empty folder for the frames, or one with frames of the same movie."""
    folder, plan = movie.folder, movie.plan
    there = [path for path in movie.frames if path.exists()]
    if there:
        known = _known_plan(folder)
        if resume and known != plan:
            raise InputError(
                f"{folder}: the frames there are those of another movie or size; remove them, or draw all anew "
                "(overwrite=True, --overwrite)."
            )
        if not resume and not overwrite:
            raise InputError(
                f"{folder}: {len(there)} of {plan['frames']} frames are there already; go on with them "
                "(resume=True, --resume), or draw all anew (overwrite=True, --overwrite)."
            )
        if not resume:
            for path in there:
                path.unlink()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _remove_halves(movie)
        with written_beside(folder / _PLAN) as part:
            part.write_text(json.dumps(plan) + "\n", encoding="utf-8")
    except OSError as error:
        raise InputError(f"{folder}: the frames cannot be written ({error.strerror or error}).") from None


def _remove_halves(movie: MovieFile) -> None:
    """Frames that a kill has left half written, under the names that `written_beside` gives them."""
    names = {path.name for path in movie.frames}
    for path in movie.folder.glob(".*-*.png"):
        if path.name.partition("-")[2] in names:
            path.unlink(missing_ok=True)


def _known_plan(folder: Path) -> Any:
    try:
        return json.loads((folder / _PLAN).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def _draw(
    movie: MovieFile, volumes: SceneVolumes, progress: Progress | None, cancel: Callable[[], bool] | None
) -> int:
    """Draw the frames that are not there, and tell how many."""
    scene = framed(movie.scene, volumes.of(movie.scene, cancel), movie.size)
    timeline = Timeline(scene, volumes.surroundings(scene))
    count, drawn = scene.movie.frame_count, 0
    picture = movie.picture
    with Renderer(movie.size) as renderer:
        for number, path in enumerate(movie.frames):
            if progress is not None:
                share = number / count * (DRAWING if movie.kind else 1.0)
                progress(share, f"frame {number + 1} of {count}")
            if cancel is not None and cancel():
                raise _cancelled(number, count)
            if path.exists():
                continue
            now = timeline.frame(number)
            note = f"{scene.movie.moment(number):.1f} s" if scene.movie.stamp else ""
            try:
                composition = compose(
                    renderer, now, picture, volumes.of(now, cancel), note=note, cancel=cancel
                )
            except Cancelled:
                raise _cancelled(number, count) from None
            # numbered frames are pictures of their own
            told = session_with(now, picture, path) if movie.kind is None and movie.keep_session else None
            # packing it well would take longer than drawing a small one
            write_picture(path, composition.image(), compress_level=1, **saving_options(path, told))
            drawn += 1
    return drawn


def _cancelled(done: int, count: int) -> Cancelled:
    return Cancelled(f"the movie was cancelled; {done} of {count} frames are kept.")


def _encode(
    movie: MovieFile, kind: Format, progress: Progress | None, cancel: Callable[[], bool] | None
) -> None:
    told = {"title": movie.scene.movie.title} if movie.scene.movie.title else {}
    if movie.keep_session:
        told["comment"] = json.dumps(movie.session)
    with written_beside(movie.output) as part:
        encode(
            movie.frames, part, kind,
            fps=movie.scene.movie.fps, size=movie.size, transparent=movie.transparent, metadata=told,
            progress=None if progress is None else lambda x: progress(DRAWING + (1.0 - DRAWING) * x, "encoding"),
            cancel=cancel,
        )  # fmt: skip
