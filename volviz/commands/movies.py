"""``volviz movie``: turns, cuts and key frames, drawn frame by frame at full quality."""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from volviz.commands.drawing import add_look_options, parse_size
from volviz.commands.inputs import add_input
from volviz.commands.layers import add_layer_option
from volviz.commands.progress import ProgressLine
from volviz.errors import InputError
from volviz.model.picture import SWITCHES

if TYPE_CHECKING:
    from volviz.model.movie import Movie
    from volviz.model.scene import Scene

_FPS, _SIZE = 24, "1280x720"


def add_commands(commands: Any) -> None:
    """Add ``movie``."""
    parser = commands.add_parser(
        "movie",
        help="draw a turn, a cut or key frames into a film",
        description="Draws a movie off-screen at full quality: MP4 or WebM (with PyAV), GIF, animated PNG (.apng) "
        "or numbered PNG files (frames/%%04d.png). FILE may be a session with a movie of its own. A movie that was "
        "stopped goes on with --resume.",
    )
    add_input(parser, optional=True, several_channels=True)
    add_layer_option(parser)
    parser.add_argument("-o", "--output", required=True, metavar="FILE", help="what is written")
    moves = parser.add_argument_group("what happens")
    moves.add_argument(
        "--turn", type=float, metavar="DEG", help="turn by so many degrees; 360 can be played in a loop"
    )
    moves.add_argument(
        "--axis",
        default="up",
        metavar="AXIS",
        help="axis of --turn: up (default), x, y, z, or a side such as superior",
    )
    moves.add_argument(
        "--steps",
        metavar="WORDS",
        help='such as "turn 360 degrees about z in 8 s, then cut from left to right in 4 s"',
    )
    moves.add_argument(
        "--frames", type=int, metavar="N", help="number of frames; steps last longer or shorter for it"
    )
    moves.add_argument("--fps", type=int, metavar="N", help=f"frames a second (default {_FPS})")
    parser.add_argument(
        "--show", default="", metavar="NAMES", help=f"what stands around the volume: {', '.join(SWITCHES)}"
    )
    moves.add_argument("--stamp", action="store_true", help="write the second over the picture")
    moves.add_argument("--title", metavar="WORDS", help="written over the picture")
    parser.add_argument("--resume", action="store_true", help="go on with a movie that was stopped")
    parser.add_argument("--overwrite", action="store_true", help="replace an existing file")
    parser.add_argument(
        "--no-session",
        action="store_true",
        help="do not write into the file how it was made (paths of volumes)",
    )
    add_look_options(parser)
    parser.set_defaults(run=run, size=_SIZE, background=None)


def run(options: argparse.Namespace) -> int:
    """Draw the movie and say where it lies and how long it took."""
    from volviz.commands.scene import scene_of_options
    from volviz.custom_gl.offscreen import background_color
    from volviz.model.picture import PictureContents
    from volviz.movies.drawing import MovieFile, write_movie

    size, output = parse_size(options.size), Path(options.output).expanduser()
    scene, volumes = scene_of_options(options, size)
    scene = replace(scene, movie=_movie(options, scene))
    transparent = (options.background or "").lower() == "none"
    if options.background is not None and not transparent:
        scene = replace(scene, background=background_color(options.background))
    contents = PictureContents.of([name for name in options.show.split(",") if name.strip()])
    movie = MovieFile(scene, output, size, transparent, contents, not options.no_session)
    begin = time.perf_counter()
    with ProgressLine() as line:
        drawn = write_movie(
            movie, volumes, resume=options.resume, overwrite=options.overwrite, progress=line.show,
            cancel=lambda: line.is_stopping,
        )  # fmt: skip
    count, seconds = scene.movie.frame_count, time.perf_counter() - begin
    before = "" if drawn == count else f" ({count - drawn} of them drawn before)"
    what = f"{count} frames of {size[0]} x {size[1]}{before}, {scene.movie.seconds:.4g} s long"
    print(f"{output}: {what}, drawn in {seconds:.2f} s")
    return 0


def _movie(options: argparse.Namespace, scene: Scene) -> Movie[Scene]:
    """The movie that the options tell, or that of the scene."""
    from volviz.model.movie import Movie, Step
    from volviz.model.movies.moves import Turn
    from volviz.model.movies.words import steps_of

    if options.turn is not None and options.steps is not None:
        raise InputError("give either --turn or --steps, not both; --steps can turn as well.")
    movie: Movie[Scene] = scene.movie
    fps = options.fps if options.fps is not None else movie.fps if movie.steps else _FPS
    if options.steps is not None:
        movie = Movie(steps_of(options.steps))
    elif options.turn is not None:
        movie = Movie((Step((Turn(options.turn, options.axis),), 4.0, "even"),))
    elif not movie.steps:
        raise InputError('there is no movie yet: give --turn 360, or --steps "turn 360 degrees in 8 s".')
    title = movie.title if options.title is None else options.title
    movie = replace(movie, fps=fps, title=title, stamp=options.stamp or movie.stamp)
    if options.frames is None:
        return movie
    if options.frames < 1:
        raise InputError(f"--frames takes a number of at least 1, got {options.frames}.")
    factor = options.frames / (movie.fps * movie.seconds)
    return replace(movie, steps=tuple(replace(step, seconds=step.seconds * factor) for step in movie.steps))
