"""Movies in session files."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from volviz.model.movie import Move, Movie, Step
from volviz.model.movies.moves import PLAIN_MOVES, KeyFrame, move_values
from volviz.model.scene import Scene

SceneToDict = Callable[[Scene], dict[str, Any]]
SceneFromDict = Callable[[Any], Scene]


def movie_to_dict(movie: Movie[Scene], scene_to_dict: SceneToDict) -> dict[str, Any]:
    """Plain data for JSON; `movie_from_dict` gives back an equal movie.

    Parameters
    ----------
    movie : Movie
    scene_to_dict : callable
        Writes the scene of a key frame.
    """

    def plain(move: Any) -> dict[str, Any]:
        if isinstance(move, KeyFrame):
            return {"kind": move.kind, "name": move.name, "scene": scene_to_dict(move.scene)}
        return {"kind": move.kind, **move_values(move)}

    steps = [
        {"moves": [plain(m) for m in step.moves], "seconds": step.seconds, "easing": step.easing}
        for step in movie.steps
    ]
    return {"steps": steps, "fps": movie.fps, "title": movie.title, "stamp": movie.stamp}


def movie_from_dict(data: Mapping[str, Any], scene_from_dict: SceneFromDict) -> Movie[Scene]:
    """The movie that `movie_to_dict` described.

    Raises
    ------
    KeyError, TypeError, ValueError, VolvizError
        The data are damaged.
    """

    def move(told: Mapping[str, Any]) -> Move[Scene]:
        if told["kind"] == KeyFrame.kind:
            return KeyFrame(scene_from_dict(told["scene"]), str(told["name"]))
        values = {name: value for name, value in told.items() if name != "kind"}
        return PLAIN_MOVES[told["kind"]](
            **{name: tuple(value) if isinstance(value, list) else value for name, value in values.items()}
        )

    steps = tuple(
        Step(tuple(move(m) for m in step["moves"]), float(step["seconds"]), step["easing"])
        for step in data["steps"]
    )
    return Movie(steps, int(data["fps"]), str(data["title"]), bool(data["stamp"]))
