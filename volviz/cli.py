"""The command ``volviz``: ``volviz [FILE]`` opens the window, ``volviz COMMAND ...`` works without one."""

from __future__ import annotations

import argparse
import io
import sys
from collections.abc import Sequence
from pathlib import Path

from volviz import __version__
from volviz.errors import VolvizError
from volviz.volume_data.references import is_address

#: Exit status for everything the user can mend.
USER_ERROR = 2


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments after the program's name; the default is ``sys.argv[1:]``.

    Returns
    -------
    int
        Exit status: 0, 1 for a check that does not hold, 2 for bad input or arguments.
    """
    arguments = list(sys.argv[1:] if argv is None else argv)
    # names of files and units may hold characters that a pipe or an old terminal cannot take
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    parser = make_parser()
    from volviz.commands.inputs import budgets_of

    try:
        if not arguments or (arguments[0] not in COMMANDS and not arguments[0].startswith("-")):
            return _open_window(arguments)
        options = parser.parse_args(arguments)
        with budgets_of(options):
            return int(options.run(options))
    except VolvizError as error:
        _say(str(error))
        return USER_ERROR
    except KeyboardInterrupt:
        _say("stopped.")
        return 130
    except BrokenPipeError:
        # the reader of our output has gone, as with `volviz samples | head`
        sys.stderr.close()
        return 0


def make_parser() -> argparse.ArgumentParser:
    """The parser of all commands."""
    from volviz.commands import (
        bench,
        compare,
        convert,
        images,
        inspect,
        labels,
        measure,
        meshes,
        movies,
        pyramid,
        reproduce,
    )

    parser = argparse.ArgumentParser(
        prog="volviz",
        description="Look into volumes. Without a command the window opens, with FILE or a bundled sample; "
        "volviz FILE takes the options for reading that volviz info FILE takes (--time, --channel, ...).",
        epilog="volviz COMMAND --help tells more of a command.",
    )
    parser.add_argument("--version", action="version", version=f"VolViz {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for module in (
        images, movies, reproduce, convert, pyramid, compare, bench, meshes, measure, labels, inspect,
    ):  # fmt: skip
        module.add_commands(commands)
    return parser


COMMANDS = (
    "render", "movie", "reproduce", "convert", "pyramid", "compare", "bench", "isosurface", "crosscheck", "measure",
    "labels", "info", "samples", "techniques", "presets", "looks", "doctor",
)  # fmt: skip


def window_parser() -> argparse.ArgumentParser:
    """The parser of what follows ``volviz`` where no command does."""
    from volviz.commands.inputs import add_hints

    parser = argparse.ArgumentParser(prog="volviz", usage="volviz [FILE] [options]", add_help=False)
    parser.add_argument("files", nargs="*")
    add_hints(parser)
    return parser


def _open_window(arguments: Sequence[str]) -> int:
    from volviz.commands.inputs import budgets_of, hints_of
    from volviz.environment import display_answers

    options = window_parser().parse_args(arguments)
    if len(options.files) > 1:
        raise VolvizError(
            f"one file at a time, got {len(options.files)} arguments beginning with {options.files[0]!r}; "
            "volviz --help lists the commands."
        )
    source = options.files[0] if options.files else None
    elsewhere = source is None or source.startswith("sample:") or is_address(source)
    if source is not None and not elsewhere and not Path(source).expanduser().exists():
        raise VolvizError(
            f"{source}: there is no such file, folder or command; volviz --help lists commands."
        )
    if not display_answers():
        raise VolvizError(
            "there is no display to open a window on; set DISPLAY, or draw pictures without one by "
            "volviz render FILE -o picture.png."
        )
    # the one place where the library imports the desktop program
    from volviz_ui.app.start import main as start

    with budgets_of(options):
        return int(start(source, **hints_of(options)))


def _say(sentence: str) -> None:
    print(f"volviz: {sentence}", file=sys.stderr)
