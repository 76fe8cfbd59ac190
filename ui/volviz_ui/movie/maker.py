"""The movie of the scene: its steps are edited, looked at ahead, and drawn into a file by a process of its own."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject, QTemporaryDir, QTimer, Signal

from volviz.custom_gl.scene_techniques import surroundings
from volviz.errors import VolvizError
from volviz.model.movie import Movie, Step
from volviz.model.movies.moves import KeyFrame
from volviz.model.movies.timeline import Timeline
from volviz.model.scene import Scene
from volviz.model.session import SUFFIX, save_session
from volviz.model.store import with_change
from volviz_ui.app_context import AppContext
from volviz_ui.session.command_process import CommandProcess

PREVIEW = "movie preview"
#: Milliseconds between two looks ahead while the movie plays.
PLAY_MS = 33
#: Seconds that a new step takes.
SECONDS = 2.0


class MovieMaker(QObject):
    """Edits `Scene.movie`, plays it in the views, and has it drawn.

    While a moment of the movie is looked at, the views show it and the scene comes back afterwards; a change that the
    user makes meanwhile ends the look and stays.
    """

    moment_changed = Signal(float)
    """Second of the movie that is seen; below 0 when the scene itself is."""
    work_changed = Signal(object, str)
    """How far the film is, 0..1, and what is being done; None when nothing is."""
    written = Signal(str)
    """Path of the film."""
    failed = Signal(str, object)
    """What failed, and why."""

    def __init__(self, context: AppContext) -> None:
        super().__init__(context.window)
        self._context = context
        self._store = context.store
        self._kept: Scene | None = None
        self._ahead: Scene | None = None
        self._line: Timeline | None = None
        self._moment = 0.0
        self._begun = 0.0
        self._is_showing = False
        self._film: str = ""
        self._folder: QTemporaryDir | None = None
        self._timer = QTimer(self)
        self._timer.setInterval(PLAY_MS)
        self._timer.timeout.connect(self._tick)
        self.process = CommandProcess(self)
        self.process.progressed.connect(self.work_changed.emit)
        self.process.finished.connect(self._on_finished)
        self.process.failed.connect(self._on_failed)
        self._store.changed.connect(self._on_scene_changed)

    # ------------------------------------------------------------------ steps

    @property
    def movie(self) -> Movie[Scene]:
        """The movie as it is now."""
        return self._store.scene.movie

    def change(self, change: Callable[[Movie[Scene]], Movie[Scene]], label: str) -> None:
        """Make another movie of it; a step of the history."""
        self.stop()
        try:
            self._store.update(lambda scene: replace(scene, movie=change(scene.movie)), label=label)
        except VolvizError as error:
            self.failed.emit(self.tr("The movie was not changed"), error)

    def add(self, *steps: Step[Scene]) -> None:
        """Put steps at the end."""
        self.change(lambda movie: replace(movie, steps=(*movie.steps, *steps)), self.tr("Add to the movie"))

    def add_key_frame(self) -> None:
        """Put the present picture at the end."""
        self.stop()
        scene = replace(self._store.scene, movie=Movie())
        number = 1 + sum(isinstance(move, KeyFrame) for step in self.movie.steps for move in step.moves)
        name = self.tr("Key frame %1").replace("%1", str(number))
        self.add(Step((KeyFrame(scene, name),), SECONDS, "path"))

    def remove(self, number: int) -> None:
        """Take a step away."""
        self.change(
            lambda movie: replace(movie, steps=(*movie.steps[:number], *movie.steps[number + 1 :])),
            self.tr("Remove from the movie"),
        )

    def move(self, number: int, to: int) -> None:
        """Put a step before or after others."""

        def moved(movie: Movie[Scene]) -> Movie[Scene]:
            steps = list(movie.steps)
            steps.insert(to, steps.pop(number))
            return replace(movie, steps=tuple(steps))

        if to != number:
            self.change(moved, self.tr("Reorder the movie"))

    def change_step(self, number: int, step: Step[Scene]) -> None:
        """Put another step in the place of one."""
        self.change(
            lambda movie: replace(movie, steps=(*movie.steps[:number], step, *movie.steps[number + 1 :])),
            self.tr("Change the movie"),
        )

    def update_key_frame(self, number: int) -> None:
        """Make a key frame of what is seen now."""
        self.stop()
        step = self.movie.steps[number]
        scene = replace(self._store.scene, movie=Movie())
        moves = tuple(replace(m, scene=scene) if isinstance(m, KeyFrame) else m for m in step.moves)
        self.change_step(number, replace(step, moves=moves))

    # ------------------------------------------------------------------ looking ahead

    @property
    def is_ahead(self) -> bool:
        """Whether a moment of the movie is seen instead of the scene."""
        return self._kept is not None

    @property
    def is_playing(self) -> bool:
        """Whether the movie plays."""
        return self._timer.isActive()

    def show(self, moment: float) -> bool:
        """Look at a moment, in seconds; False when there is nothing to see (and that was said)."""
        if self._kept is None and not self._begin():
            return False
        assert self._line is not None
        self._moment = min(max(moment, 0.0), self._line.movie.seconds)
        self._show(replace(self._line.at(self._moment), movie=self._line.movie))
        self.moment_changed.emit(self._moment)
        return True

    def play(self) -> None:
        """Play on from the moment that is seen, or from the beginning."""
        at_end = self._line is not None and self._moment >= self._line.movie.seconds
        if self.show(0.0 if at_end or self._kept is None else self._moment):
            self._begun = time.monotonic() - self._moment
            self._timer.start()

    def pause(self) -> None:
        """Stand still at the moment that is seen."""
        self._timer.stop()
        self.moment_changed.emit(self._moment)

    def stop(self) -> None:
        """Show the scene itself again."""
        self._timer.stop()
        kept, self._kept, self._line = self._kept, None, None
        if kept is None:
            return
        self._show(kept)
        self._store.end_gesture(PREVIEW)
        self._moment = 0.0
        self.moment_changed.emit(-1.0)

    def _begin(self) -> bool:
        shown = self._context.documents.shown
        if shown.volume is None:
            return False
        try:
            about = surroundings(shown.volumes.values(), self._context.player.count)
            self._line = Timeline(self._store.scene, about)
        except VolvizError as error:
            self.failed.emit(self.tr("The movie cannot be played"), error)
            return False
        self._kept = self._ahead = self._store.scene
        self._store.begin_gesture(PREVIEW)
        return True

    def _show(self, scene: Scene) -> None:
        self._is_showing = True
        try:
            self._store.update(scene, record=False)
        finally:
            self._is_showing = False
        self._ahead = scene

    def _on_scene_changed(self, _old: Scene, new: Scene) -> None:
        """Somebody else has changed what is looked at: that counts, and the look ends."""
        if self._kept is None or self._is_showing:
            return
        self._kept = with_change(self._kept, self._ahead, new)
        self.stop()

    def _tick(self) -> None:
        assert self._line is not None
        movie, moment = self._line.movie, time.monotonic() - self._begun
        if moment >= movie.seconds:
            if movie.loops:
                self._begun += movie.seconds
                moment -= movie.seconds
            else:
                self.show(movie.seconds)
                self.pause()
                return
        self.show(moment)

    # ------------------------------------------------------------------ the film

    @property
    def is_drawing(self) -> bool:
        """Whether a film is being drawn."""
        return self.process.is_running

    def draw(
        self,
        path: str,
        size: tuple[int, int],
        *,
        transparent: bool,
        keep_session: bool,
        resume: bool,
        overwrite: bool,
    ) -> bool:
        """Have the movie drawn into a file; the rest is told by the signals. False when it cannot begin.

        Parameters
        ----------
        path : str
            .mp4, .webm, .gif, .apng or numbered frames.
        size : tuple of 2 ints
            Width and height in pixels.
        transparent : bool
            Without background.
        keep_session : bool
            The file tells how it was made.
        resume : bool
            Go on with frames that are there.
        overwrite : bool
            Replace what is there.
        """
        self.stop()
        folder = QTemporaryDir()
        session = Path(folder.path()) / f"movie{SUFFIX}"
        try:
            save_session(self._store.scene, session)
        except VolvizError as error:
            self.failed.emit(self.tr("The movie was not saved"), error)
            return False
        arguments = ["movie", str(session), "-o", path, "--size", f"{size[0]}x{size[1]}"]
        arguments += ["--resume"] if resume else []
        arguments += ["--overwrite"] if overwrite else []
        arguments += ["--background", "none"] if transparent else []
        arguments += [] if keep_session else ["--no-session"]
        names = self._context.views.active.annotations.contents.names
        arguments += ["--show", ",".join(names)] if names else []
        self._film, self._folder = path, folder
        self.work_changed.emit(0.0, "")
        self.process.start(arguments, Path(path).parent)
        return True

    def cancel(self) -> None:
        """Stop drawing; frames that are finished stay, for the next time."""
        self.process.cancel()
        self._folder = None
        self.work_changed.emit(None, "")

    def close(self) -> None:
        """The window closes."""
        self.stop()
        if self.is_drawing:
            self.process.cancel()
            self._folder = None

    def _on_finished(self) -> None:
        self._folder = None
        self.work_changed.emit(None, "")
        self.written.emit(self._film)

    def _on_failed(self, words: str) -> None:
        self._folder = None
        self.work_changed.emit(None, "")
        self.failed.emit(self.tr("The movie was not saved"), VolvizError(words))
