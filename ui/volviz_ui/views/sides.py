"""A and B: which two views are compared, as a badge in each header and as two lists in the Compare panel."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QActionGroup, QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QMenu, QToolButton, QWidget

from volviz.custom_gl.scene_techniques import current_technique
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.model.view_edits import with_side
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.library_words import translated
from volviz_ui.widgets.binding import show_value

LETTERS = ("A", "B")
BADGE = 22


def view_name(scene: Scene, view: int) -> str:
    """What a view is called in lists: its number, counted from the upper left, and its technique."""
    return f"{view + 1}  {translated(current_technique(scene, view).label)}"


def side_of(scene: Scene, view: int) -> int | None:
    """0 for A, 1 for B, None for a view that is not compared."""
    return scene.pair.index(view) if scene.pair is not None and view in scene.pair else None


def choose_side(store: Store, side: int, view: int) -> None:
    """Compare a view as A (0) or B (1); like the mode no step of the history.

    When it is the other side already, the two exchange their letters. The active view stays among those seen.
    """
    store.update(partial(with_side, side=side, view=view), label="Comparison", record=False)


class SideBadge(QToolButton):
    """The letter of a compared view, the number of another one; a click offers to compare something else.

    Parameters
    ----------
    store : Store
        The scene.
    view : int
        Number of the view.
    """

    def __init__(self, store: Store, view: int, parent: QWidget) -> None:
        super().__init__(parent)
        self._store = store
        self._view = view
        self.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._menu = QMenu(self)
        self._menu.aboutToShow.connect(self._fill)
        self.setMenu(self._menu)
        show_value(store, lambda scene: side_of(scene, view), self._show)

    def sizeHint(self) -> QSize:
        """A square."""
        return QSize(BADGE, BADGE)

    def _show(self, side: int | None) -> None:
        number = str(self._view + 1)
        self.setText(number if side is None else LETTERS[side])
        if side is None:
            words = self.tr("View %1 is not compared now; click to compare it").replace("%1", number)
        else:
            words = (
                self.tr("View %1 is %2 of the comparison; click to choose another")
                .replace("%1", number)
                .replace("%2", LETTERS[side])
            )
        self.setToolTip(words)
        self.setAccessibleName(words)
        self.update()

    def _fill(self) -> None:
        """Side by side every view can become either; laid over each other, any view can come here."""
        scene, menu = self._store.scene, self._menu
        menu.clear()
        group = QActionGroup(menu)
        own = side_of(scene, self._view)
        overlaid = scene.comparison.mode != "side_by_side"
        if overlaid and own is not None:
            for view in range(len(scene.views)):
                words = self.tr("%1: view %2").replace("%1", LETTERS[own])
                action = menu.addAction(words.replace("%2", view_name(scene, view)))
                action.triggered.connect(partial(self._choose, own, view))
                action.setCheckable(True)
                action.setChecked(view == self._view)
                group.addAction(action)
            return
        for side, letter in enumerate(LETTERS):
            action = menu.addAction(self.tr("Compare view %1 as %2").replace("%2", letter))
            action.setText(action.text().replace("%1", str(self._view + 1)))
            action.triggered.connect(partial(self._choose, side, self._view))
            action.setCheckable(True)
            action.setChecked(side == own)
            group.addAction(action)

    def _choose(self, side: int, view: int, _checked: bool = False) -> None:
        choose_side(self._store, side, view)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """A letter on the accent colour, or a number in a quiet frame."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        role, palette = QPalette.ColorRole, self.palette()
        square = QRectF(0, 0, BADGE - 2, BADGE - 2)
        square.moveCenter(QRectF(self.rect()).center())
        compared = side_of(self._store.scene, self._view) is not None
        edge = role.Text if self.hasFocus() else role.Highlight if compared else role.Mid
        painter.setPen(palette.color(edge))
        painter.setBrush(palette.color(role.Highlight if compared else role.Button))
        painter.drawRoundedRect(square.adjusted(0.5, 0.5, -0.5, -0.5), 4, 4)
        painter.setPen(palette.color(role.HighlightedText if compared else role.PlaceholderText))
        font = painter.font()
        font.setBold(compared)
        painter.setFont(font)
        painter.drawText(square, Qt.AlignmentFlag.AlignCenter, self.text())
        painter.end()


class SideBox(NoWheelComboBox):
    """The list that says and chooses which view is A (side 0) or B (1)."""

    def __init__(self, store: Store, side: int, parent: QWidget) -> None:
        super().__init__(parent)
        self._store = store
        self._side = side
        letter = LETTERS[side]
        self.setAccessibleName(self.tr("View that is %1").replace("%1", letter))
        self.setToolTip(
            self.tr("Which view is A: left of the line of a wipe, and what a difference takes away")
            if side == 0
            else self.tr("Which view is B: right of the line of a wipe, and what a difference takes A from")
        )
        show_value(store, _sides, self._show)
        self.activated.connect(lambda index: choose_side(store, side, index))

    def _show(self, sides: tuple[tuple[str, ...], tuple[int, int] | None]) -> None:
        names, pair = sides
        self.clear()
        self.addItems(list(names))
        if pair is not None:
            self.setCurrentIndex(pair[self._side])


def _sides(scene: Scene) -> tuple[tuple[str, ...], tuple[int, int] | None]:
    return tuple(view_name(scene, view) for view in range(len(scene.views))), scene.pair
