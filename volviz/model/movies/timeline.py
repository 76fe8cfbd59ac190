"""What a scene is at any moment of its movie."""

from __future__ import annotations

from bisect import bisect_right
from itertools import accumulate

from volviz.errors import InputError
from volviz.model.movie import Movie, Step, Surroundings
from volviz.model.movies.camera_path import CameraPath
from volviz.model.movies.moves import KeyFrame
from volviz.model.scene import Scene

#: What is said of a movie in which nothing happens.
NOTHING = "nothing happens in this movie yet; add a move, or at least two key frames."


class Timeline:
    """The steps of a movie, each beginning where the one before ended.

    Parameters
    ----------
    scene : Scene
        What the movie begins with, with a camera in its active view; its `movie` is what happens.
    about : Surroundings

    Raises
    ------
    InputError
        There are no steps, or the scene has not what one of them is about.
    """

    def __init__(self, scene: Scene, about: Surroundings) -> None:
        self.movie: Movie[Scene] = scene.movie
        self._steps = self.movie.passing
        if not self._steps:
            raise InputError(NOTHING)
        self._about = about
        self._ends = list(accumulate(step.seconds for step in self._steps))
        place = self.movie.place
        self._starts = [scene if place is None else place.at(scene, 1.0, about)]
        for step in self._steps:
            self._starts.append(self._passed(step, self._starts[-1], 1.0))
        self._paths = dict(self._camera_paths())

    def at(self, seconds: float) -> Scene:
        """The scene at a moment from 0 to the length of the movie."""
        steps = self._steps
        number = min(bisect_right(self._ends, seconds), len(steps) - 1)
        begin = self._ends[number] - steps[number].seconds
        scene = self._passed(steps[number], self._starts[number], (seconds - begin) / steps[number].seconds)
        path = self._paths.get(number)
        return scene if path is None else scene.with_camera(path.at(seconds), scene.active_index)

    def frame(self, number: int) -> Scene:
        """The scene of a frame, counted from 0."""
        return self.at(self.movie.moment(number))

    def _passed(self, step: Step[Scene], start: Scene, fraction: float) -> Scene:
        passed, scene = step.passed(fraction), start
        for move in step.moves:
            scene = move.at(scene, passed, self._about)
        return scene

    def _camera_paths(self) -> list[tuple[int, CameraPath]]:
        """For each step of a run of key frames that are not stopped at, the path through all of them."""
        found: list[tuple[int, CameraPath]] = []
        run: list[int] = []
        for number, step in enumerate((*self._steps, None)):
            if (
                step is not None
                and step.easing == "path"
                and any(isinstance(m, KeyFrame) for m in step.moves)
            ):
                run.append(number)
                continue
            if len(run) > 1:
                cameras = [self._starts[n].view.camera for n in (*run, run[-1] + 1)]
                moments = [
                    self._ends[run[0]] - self._steps[run[0]].seconds,
                    *(self._ends[n] for n in run),
                ]
                known = [camera for camera in cameras if camera is not None]
                if len(known) == len(cameras):
                    found += [(n, CameraPath(known, moments)) for n in run]
            run = []
        return found
