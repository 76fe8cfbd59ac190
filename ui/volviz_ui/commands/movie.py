"""The commands of the movie: key frames, looking ahead, the film."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject

from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Command, Menu, State, has_volume
from volviz_ui.dialogs.save_film import SaveFilmDialog
from volviz_ui.movie.maker import MovieMaker


class MovieCommands(QObject):
    """Makes the movie of the scene."""

    def __init__(self, context: AppContext, maker: MovieMaker) -> None:
        super().__init__(context.window)
        self._context, self._maker = context, maker

    def menu(self) -> Menu:
        """The table of its commands."""
        tr = self.tr
        return Menu(
            tr("&Movie"),
            [
                Command(
                    "movie.key_frame", tr("Add &key frame"), tr("Let the movie go to the picture as it is now"),
                    self.add_key_frame, keys=("Ctrl+Shift+K",), icon="camera", enabled=has_volume,
                ),
                Command(
                    "movie.save", tr("&Save film…"), tr("Draw the movie at full quality into a file"), self.save,
                    icon="film-strip", enabled=has_movie,
                ),
            ],
        )  # fmt: skip

    def add_key_frame(self) -> None:
        """Put the present picture at the end of the movie, and show the panel."""
        self._context.docks.show("movie")
        self._maker.add_key_frame()

    def save(self) -> SaveFilmDialog:
        """Ask how, and have the film drawn."""
        movie = self._maker.movie
        words = self.tr("%1 frames, %2 s.").replace("%1", str(movie.frame_count))
        dialog = SaveFilmDialog(
            self._context.views.active.viewport.pixel_size, words.replace("%2", f"{movie.seconds:g}"),
            self._context.preferences.folder_of("movie"), self._context.window,
        )  # fmt: skip
        dialog.accepted.connect(lambda: self._draw(dialog))
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def _draw(self, dialog: SaveFilmDialog) -> None:
        self._context.preferences.set_folder_of("movie", str(Path(dialog.path)))
        self._context.docks.show("movie")
        self._maker.draw(
            dialog.path, dialog.pixels, transparent=dialog.is_transparent,
            keep_session=dialog.session.isChecked(), resume=dialog.resume, overwrite=dialog.overwrite,
        )  # fmt: skip


def has_movie(state: State) -> bool:
    """Whether something happens in the movie."""
    return state.has_volume and state.scene.movie.frame_count > 0
