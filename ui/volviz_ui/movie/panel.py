"""The panel of a movie: what happens, a moment to look at, and the film."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QMenu,
    QPushButton,
    QToolButton,
    QWidget,
)

from volviz.errors import VolvizError
from volviz.model.movie import EASINGS, Easing, Movie, Step
from volviz.model.movies.moves import KeyFrame
from volviz.model.movies.words import EXAMPLES, steps_of, words_of
from volviz.model.scene import Scene
from volviz_ui.editors.number import NoWheelSlider, NumberField
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.movie.maker import MovieMaker
from volviz_ui.panels.panel import Panel, Section
from volviz_ui.session.documents import Documents
from volviz_ui.style.icons import set_icon
from volviz_ui.widgets.binding import show_value
from volviz_ui.widgets.progress_bar import ProgressBar
from volviz_ui.widgets.small import quiet_label, small_button

#: Positions of the slider of moments.
MOMENTS = 1000


class MoviePanel(Panel):
    """Steps of the movie in a list, the moment that is looked at, and how far the film is.

    Attributes
    ----------
    save_requested : signal ()
        The film is to be saved.
    """

    save_requested = Signal()

    def __init__(self, maker: MovieMaker, documents: Documents, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._maker = maker
        self._add_steps()
        self._add_look()
        self._add_film()
        maker.moment_changed.connect(self._show_moment)
        maker.work_changed.connect(self._show_work)
        show_value(documents, lambda shown: shown.scene.movie, self._show_movie)
        show_value(documents, lambda shown: shown.volume is not None, self._show_usable)
        self._show_moment(-1.0)
        self._show_work(None, "")

    # ------------------------------------------------------------------ making

    def _add_steps(self) -> None:
        tr = self.tr
        section = Section(tr("Steps"), parent=self)
        self.steps = QListWidget(section)
        self.steps.setAccessibleName(tr("Steps of the movie"))
        self.steps.setToolTip(tr("What happens, from top to bottom; drag to reorder"))
        self.steps.setDragDropMode(QAbstractItemView.DragDropMode.InternalMove)
        self.steps.setMinimumHeight(96)
        self.steps.currentRowChanged.connect(lambda _row: self._show_step())
        self.steps.model().rowsMoved.connect(self._on_moved)
        section.add_wide(self.steps)
        self.add_button = QToolButton(section)
        self.add_button.setText(tr("Add"))
        self.add_button.setToolTip(tr("Add a move or a key frame at the end"))
        self.add_button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        set_icon(self.add_button, "plus", "quiet")
        self.add_button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.add_button.setMenu(self._menu())
        self.key_button = QToolButton(section)
        self.key_button.setText(tr("Key frame"))
        self.key_button.setToolTip(tr("Add the picture as it is now: the movie goes there"))
        self.key_button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        set_icon(self.key_button, "camera", "quiet")
        self.key_button.clicked.connect(self._maker.add_key_frame)
        self.renew_button = small_button(
            "arrows-clockwise", tr("Make this key frame the picture as it is now"), section
        )
        self.renew_button.clicked.connect(lambda: self._maker.update_key_frame(self.steps.currentRow()))
        self.remove_button = small_button("trash", tr("Remove this step (Delete)"), section)
        self.remove_button.clicked.connect(self._remove)
        delete = QShortcut(QKeySequence(QKeySequence.StandardKey.Delete), self.steps)
        delete.setContext(Qt.ShortcutContext.WidgetShortcut)
        delete.activated.connect(self._remove)
        row = QWidget(section)
        buttons = QHBoxLayout(row)
        buttons.setContentsMargins(0, 0, 0, 0)
        for button in (self.add_button, self.key_button):
            buttons.addWidget(button)
        buttons.addStretch(1)
        for small in (self.renew_button, self.remove_button):
            buttons.addWidget(small)
        section.add_wide(row)
        self.seconds = NumberField(parent=section)
        self.seconds.setRange(0.1, 3600.0)
        self.seconds.setDecimals(2)
        self.seconds.set_unit("s")
        self.seconds.setToolTip(tr("How long the chosen step takes"))
        self.seconds.valueChanged.connect(self._on_seconds)
        section.add_row(tr("Takes"), self.seconds)
        self.easing = NoWheelComboBox(section)
        names = {"gentle": tr("Gently"), "even": tr("Evenly"), "path": tr("Without stopping")}
        for easing in EASINGS:
            self.easing.addItem(names[easing], easing)
        self.easing.setToolTip(tr("How the chosen step begins and ends"))
        self.easing.currentIndexChanged.connect(self._on_easing)
        section.add_row(tr("Passes"), self.easing)
        self.words = QLineEdit(section)
        self.words.setPlaceholderText(EXAMPLES[0])
        self.words.setToolTip(
            tr("Moves in words, added with Enter. For example:") + "\n" + "\n".join(EXAMPLES)
        )
        self.words.setAccessibleName(tr("Moves in words"))
        self.words.returnPressed.connect(self._on_words)
        section.add_row(tr("In words"), self.words)
        self.complaint: QLabel = quiet_label(parent=section)
        self.complaint.setWordWrap(True)
        self.complaint.hide()
        section.add_wide(self.complaint)
        self.add(section)

    def _menu(self) -> QMenu:
        menu, tr = QMenu(self), self.tr
        ready: tuple[tuple[str, str] | None, ...] = (
            (tr("Full turn"), "turn 360 degrees in 8 s"),
            (tr("Full turn about the vertical axis of the world (z)"), "turn 360 degrees about z in 8 s"),
            (tr("To one side and back"), "swing 60 degrees in 4 s"),
            (tr("Zoom in"), "zoom in by 2 in 3 s"),
            (tr("Zoom out"), "zoom out by 2 in 3 s"),
            None,
            (tr("Cut from left to right"), "cut from left to right in 4 s"),
            (tr("Cut from top to bottom"), "cut from top to bottom in 4 s"),
            (tr("Cut from front to back"), "cut from front to back in 4 s"),
            None,
            (tr("Time passes"), "play in 4 s"),
            (tr("Slices go from feet to head (along z)"), "scroll toward z in 6 s"),
            (tr("Wait"), "hold 1 s"),
        )
        for entry in ready:
            if entry is None:
                menu.addSeparator()
            else:
                menu.addAction(entry[0]).triggered.connect(partial(self._add, entry[1]))
        return menu

    def _add_look(self) -> None:
        tr = self.tr
        section = Section(tr("Look ahead"), parent=self)
        self.play = small_button("play", tr("Play the movie in the views"), section)
        self.play.clicked.connect(self._on_play)
        self.stop = small_button("stop", tr("Back to the picture"), section)
        self.stop.clicked.connect(self._maker.stop)
        self.slider = NoWheelSlider(section)
        self.slider.setRange(0, MOMENTS)
        self.slider.setAccessibleName(tr("Moment of the movie"))
        self.slider.setToolTip(tr("Look at a moment; the picture comes back afterwards"))
        self.slider.valueChanged.connect(self._on_slider)
        self.moment: QLabel = quiet_label(parent=section)
        row = QWidget(section)
        line = QHBoxLayout(row)
        line.setContentsMargins(0, 0, 0, 0)
        line.setSpacing(4)
        for widget, stretch in ((self.play, 0), (self.stop, 0), (self.slider, 1), (self.moment, 0)):
            line.addWidget(widget, stretch)
        section.add_wide(row)
        self.add(section)

    def _add_film(self) -> None:
        tr = self.tr
        section = Section(tr("Film"), parent=self)
        self.fps = NoWheelComboBox(section)
        for fps in (12, 24, 25, 30, 50, 60):
            self.fps.addItem(str(fps), fps)
        self.fps.setToolTip(tr("Frames a second of the film"))
        self.fps.currentIndexChanged.connect(self._on_fps)
        section.add_row(tr("Frames a second"), self.fps)
        self.title = QLineEdit(section)
        self.title.setToolTip(tr("Written over the film"))
        self.title.editingFinished.connect(self._on_title)
        section.add_row(tr("Title"), self.title)
        self.save_button = QPushButton(tr("Save film…"), section)
        self.save_button.setToolTip(tr("Draw the movie at full quality into a file"))
        self.save_button.clicked.connect(self.save_requested)
        section.add_wide(self.save_button)
        self.bar = ProgressBar(section)
        self.bar.setAccessibleName(tr("Progress of the film"))
        self.bar_words: QLabel = quiet_label(parent=section)
        self.cancel = small_button("x", tr("Stop drawing; finished frames are kept"), section)
        self.cancel.clicked.connect(self._maker.cancel)
        self.work = QWidget(section)
        row = QHBoxLayout(self.work)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.bar, 1)
        row.addWidget(self.bar_words)
        row.addWidget(self.cancel)
        section.add_wide(self.work)
        self.add(section)

    # ------------------------------------------------------------------ showing

    def _show_movie(self, movie: Movie[Scene]) -> None:
        row = self.steps.currentRow()
        grows = len(movie.steps) > self.steps.count()
        with QSignalBlocker(self.steps):
            self.steps.clear()
            for number, step in enumerate(movie.steps):
                self.steps.addItem(self._words(step, is_place=number == 0 and movie.place is not None))
            self.steps.setCurrentRow(len(movie.steps) - 1 if grows else min(row, len(movie.steps) - 1))
        with QSignalBlocker(self.fps):
            if self.fps.findData(movie.fps) < 0:
                self.fps.addItem(str(movie.fps), movie.fps)
            self.fps.setCurrentIndex(self.fps.findData(movie.fps))
        if not self.title.hasFocus():
            self.title.setText(movie.title)
        self._show_step()
        self._show_moment(-1.0)

    def _words(self, step: Step[Scene], *, is_place: bool) -> str:
        words = self.tr(" and ").join(words_of(move) for move in step.moves) or self.tr("wait")
        words = words[0].upper() + words[1:]
        return (
            self.tr("Begins with: %1").replace("%1", words) if is_place else f"{words}  ·  {step.seconds:g} s"
        )

    def _show_step(self) -> None:
        movie, row = self._maker.movie, self.steps.currentRow()
        step = movie.steps[row] if 0 <= row < len(movie.steps) else None
        takes_time = step is not None and not (row == 0 and movie.place is not None)
        for widget in (self.seconds, self.easing):
            widget.setEnabled(takes_time)
        self.remove_button.setEnabled(step is not None)
        is_key = step is not None and any(isinstance(move, KeyFrame) for move in step.moves)
        self.renew_button.setEnabled(is_key)
        if step is not None:
            with QSignalBlocker(self.seconds), QSignalBlocker(self.easing):
                self.seconds.setValue(step.seconds)
                self.easing.setCurrentIndex(self.easing.findData(step.easing))

    def _show_moment(self, moment: float) -> None:
        movie = self._maker.movie
        can = movie.frame_count > 0
        for widget in (self.play, self.slider):
            widget.setEnabled(can)
        self.save_button.setEnabled(can and not self._maker.is_drawing)
        self.stop.setEnabled(self._maker.is_ahead)
        at = max(moment, 0.0)
        if not self.slider.isSliderDown():
            with QSignalBlocker(self.slider):
                self.slider.setValue(round(MOMENTS * at / movie.seconds) if can else 0)
        self.moment.setText(f"{at:.1f} / {movie.seconds:.1f} s" if can else "")
        playing = self._maker.is_playing
        set_icon(self.play, "pause" if playing else "play", "quiet")
        name = self.tr("Pause") if playing else self.tr("Play the movie in the views")
        self.play.setToolTip(name)
        self.play.setAccessibleName(name)

    def _show_work(self, fraction: float | None, words: str) -> None:
        self.work.setVisible(fraction is not None)
        if fraction is not None:
            self.bar.show_fraction(fraction)
            self.bar_words.setText(words)
        self._show_moment(-1.0)

    def _show_usable(self, on: bool) -> None:
        self.widget().setEnabled(on)

    # ------------------------------------------------------------------ doing

    def _add(self, words: str) -> None:
        self._maker.add(*steps_of(words))

    def _on_words(self) -> None:
        try:
            steps = steps_of(self.words.text())
        except VolvizError as error:
            self.complaint.setText(str(error))
            self.complaint.show()
            return
        self.complaint.hide()
        self.words.clear()
        self._maker.add(*steps)

    def _remove(self) -> None:
        row = self.steps.currentRow()
        if row >= 0:
            self._maker.remove(row)

    def _on_moved(self, _parent: object, start: int, _end: int, _to_parent: object, row: int) -> None:
        self._maker.move(start, row - 1 if row > start else row)

    def _change_step(self, change: Callable[[Step[Scene]], Step[Scene]]) -> None:
        row = self.steps.currentRow()
        if row >= 0:
            self._maker.change_step(row, change(self._maker.movie.steps[row]))

    def _on_seconds(self, seconds: float) -> None:
        self._change_step(lambda step: replace(step, seconds=seconds))

    def _on_easing(self, _index: int) -> None:
        easing: Easing = self.easing.currentData()
        self._change_step(lambda step: replace(step, easing=easing))

    def _on_fps(self, _index: int) -> None:
        fps = int(self.fps.currentData())
        self._maker.change(lambda movie: replace(movie, fps=fps), self.tr("Change the movie"))

    def _on_title(self) -> None:
        title = self.title.text()
        self._maker.change(lambda movie: replace(movie, title=title), self.tr("Change the title"))

    def _on_play(self) -> None:
        if self._maker.is_playing:
            self._maker.pause()
        else:
            self._maker.play()

    def _on_slider(self, value: int) -> None:
        self._maker.show(self._maker.movie.seconds * value / MOMENTS)
