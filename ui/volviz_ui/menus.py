"""The menu bar and the tool bar: where the commands stand."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QLabel, QMenu, QSizePolicy, QToolBar, QToolButton, QWidget

from volviz_ui.dialogs.preferences import quality_choices
from volviz_ui.documents import SAMPLE_PREFIX, title_of
from volviz_ui.editors.simple import CalmComboBox
from volviz_ui.icons import set_icon
from volviz_ui.panels.technique_box import TechniqueBox

if TYPE_CHECKING:
    from volviz_ui.main_window import MainWindow

BACKGROUNDS = (
    ("Gradient", None),
    ("Black", (0.0, 0.0, 0.0)),
    ("Grey", (0.5, 0.5, 0.5)),
    ("White", (1.0, 1.0, 1.0)),
)


class Menus:
    """Builds menu bar and tool bar of the window once."""

    def __init__(self, window: MainWindow) -> None:
        self._window = window
        self.recent = QMenu(window.tr("Open &recent"), window)
        self.samples = QMenu(window.tr("&Samples"), window)
        self.recent.aboutToShow.connect(self._fill_recent)
        self.samples.aboutToShow.connect(self._fill_samples)
        self.samples.setToolTipsVisible(True)
        set_icon(self.recent.menuAction(), "clock-counter-clockwise")
        set_icon(self.samples.menuAction(), "cube")
        self._fill_bar()
        self._fill_tools()

    def _fill_bar(self) -> None:
        window, actions = self._window, self._window.actions_
        bar = window.menuBar()
        file = bar.addMenu(window.tr("&File"))
        file.addActions([actions.open, actions.open_folder])
        file.addMenu(self.recent)
        file.addMenu(self.samples)
        file.addAction(actions.import_raw)
        file.addSeparator()
        file.addActions([actions.open_session, actions.save_session])
        file.addSeparator()
        file.addActions(
            [actions.export_picture, actions.export_mesh, actions.copy_picture, actions.copy_script]
        )
        file.addSeparator()
        file.addAction(actions.quit)

        edit = bar.addMenu(window.tr("&Edit"))
        edit.addActions([actions.undo, actions.redo])
        edit.addSeparator()
        edit.addAction(actions.preferences)

        view = bar.addMenu(window.tr("&View"))
        view.addAction(actions.reset_camera)
        axis = view.addMenu(window.tr("&Look from"))
        axis.addActions(actions.axis_views)
        view.addAction(actions.parallel)
        view.addSeparator()
        view.addActions([*actions.scenery.values(), actions.handles])
        background = view.addMenu(window.tr("Back&ground"))
        for name, color in BACKGROUNDS:
            background.addAction(window.tr(name)).triggered.connect(
                partial(window.view_commands.set_background, color)
            )
        view.addSeparator()
        panels = view.addMenu(window.tr("&Panels"))
        panels.addActions([dock.toggleViewAction() for dock in window.docks])
        panels.addSeparator()
        panels.addAction(actions.reset_layout)
        view.addAction(actions.full_screen)

        technique = bar.addMenu(window.tr("&Technique"))
        technique.addActions(actions.techniques)
        technique.addSeparator()
        technique.addActions([actions.finer, actions.coarser, actions.machinery, actions.reset_settings])

        compare = bar.addMenu(window.tr("&Compare"))
        compare.addActions([actions.one_view, actions.split, actions.four_views, actions.with_vtk])
        compare.addAction(window.compare_dock.toggleViewAction())
        compare.addAction(window.crosscheck_dock.toggleViewAction())
        compare.addSeparator()
        compare.addActions(actions.modes)
        compare.addAction(actions.distances)
        compare.addSeparator()
        compare.addActions([actions.next_view, actions.swap_views, actions.close_view])
        compare.addSeparator()
        compare.addAction(actions.report)
        self.compare = compare

        help_ = bar.addMenu(window.tr("&Help"))
        help_.addActions([actions.shortcuts, actions.about])
        for menu in bar.findChildren(QMenu):
            menu.setToolTipsVisible(True)

    def _fill_tools(self) -> None:
        window, actions = self._window, self._window.actions_
        bar = QToolBar(window.tr("Tools"), window)
        bar.setObjectName("tools")
        bar.setMovable(False)
        bar.setContextMenuPolicy(Qt.ContextMenuPolicy.PreventContextMenu)
        bar.setIconSize(QSize(20, 20))
        bar.addAction(actions.open)
        samples = QToolButton(bar)
        samples.setText(window.tr("Samples"))
        samples.setToolTip(window.tr("Volumes that come with the program"))
        set_icon(samples, "cube")
        samples.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        samples.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        samples.setMenu(self.samples)
        bar.addWidget(samples)
        bar.addSeparator()
        bar.addActions([actions.undo, actions.redo])
        bar.addSeparator()
        self.technique = TechniqueBox(window.store, bar)
        self.technique.setMinimumWidth(190)
        bar.addWidget(_caption(window.tr("Technique"), self.technique))
        bar.addWidget(self.technique)
        self.quality = CalmComboBox(bar)
        self.quality.setToolTip(window.tr("How much is given up while something moves"))
        self.quality.setAccessibleName(window.tr("Quality"))
        self.quality.setMinimumContentsLength(11)
        for value, label in quality_choices(window):
            self.quality.addItem(label, value)
        self.quality.activated.connect(lambda: window.set_quality(self.quality.currentData()))
        bar.addWidget(_caption(window.tr("Quality"), self.quality))
        bar.addWidget(self.quality)
        space = QWidget(bar)
        space.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        bar.addWidget(space)
        bar.addAction(actions.split)
        bar.addSeparator()
        bar.addActions([actions.scenery["box"], actions.scenery["axes"], actions.reset_camera])
        bar.addSeparator()
        bar.addActions([actions.copy_picture, actions.export_picture, actions.shortcuts])
        window.addToolBar(bar)
        self.tools = bar

    def _fill_recent(self) -> None:
        window = self._window
        self.recent.clear()
        for ref in window.preferences.recent:
            action = self.recent.addAction(title_of(ref))
            action.setToolTip(ref.source)
            action.triggered.connect(partial(_open_again, window, ref))
        if self.recent.isEmpty():
            self.recent.addAction(window.tr("Nothing opened yet")).setEnabled(False)
            return
        self.recent.addSeparator()
        self.recent.addAction(window.tr("Forget these")).triggered.connect(window.preferences.forget_recent)

    def _fill_samples(self) -> None:
        from volviz.io.samples import samples

        window = self._window
        if not self.samples.isEmpty():
            return
        for sample in samples():
            action: QAction = self.samples.addAction(sample.label)
            action.setToolTip(f"{sample.description}\n{sample.licence}")
            action.triggered.connect(partial(_open_sample, window, sample.id))


def _open_again(window: MainWindow, ref: object, _checked: bool = False) -> None:
    window.documents.open(ref.source, **dict(ref.hints))  # type: ignore[attr-defined]


def _open_sample(window: MainWindow, sample: str, _checked: bool = False) -> None:
    window.documents.open(SAMPLE_PREFIX + sample)


def _caption(words: str, buddy: QWidget) -> QLabel:
    label = QLabel(words)
    label.setBuddy(buddy)
    label.setContentsMargins(8, 0, 4, 0)
    return label
