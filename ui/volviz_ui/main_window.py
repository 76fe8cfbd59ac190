"""The window: viewport in the middle, panels around it, one store that they all observe."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent, QKeyEvent
from PySide6.QtWidgets import QMainWindow

from volviz.custom_gl.scene_techniques import current_settings, current_technique
from volviz.custom_gl.technique import regions_unused
from volviz.kernels.warm_up import warm_up
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.model.volume import Volume
from volviz_ui.action_states import ActionStates
from volviz_ui.actions import Actions
from volviz_ui.app_icon import app_icon
from volviz_ui.autosave import Autosave
from volviz_ui.banner import Banner
from volviz_ui.binding import show_value
from volviz_ui.compare.commands import CompareCommands
from volviz_ui.compare.crosscheck import CrosscheckPanel
from volviz_ui.compare.measurements import Measurements
from volviz_ui.compare.panel import ComparePanel
from volviz_ui.compare.reports import Reports
from volviz_ui.compare.surface_distances import SurfaceDistances
from volviz_ui.dialogs.about import AboutDialog
from volviz_ui.dialogs.error import sentence_of, show_error
from volviz_ui.dialogs.preferences import PreferencesDialog
from volviz_ui.dialogs.shortcuts import ShortcutsDialog
from volviz_ui.dock_layout import VERSION as LAYOUT_VERSION
from volviz_ui.dock_layout import DockLayout
from volviz_ui.documents import SAMPLE_PREFIX, Documents, Opened
from volviz_ui.file_commands import FileCommands
from volviz_ui.isovalue_markers import IsovalueMarkers
from volviz_ui.memory import return_freed_memory
from volviz_ui.menus import Menus
from volviz_ui.panels.data import DataPanel
from volviz_ui.panels.technique import TechniquePanel
from volviz_ui.pointer import Pointer
from volviz_ui.preferences import Preferences
from volviz_ui.ray_inspector.inspector import RayInspector
from volviz_ui.ray_inspector.panel import RayPanel
from volviz_ui.session_commands import SessionCommands
from volviz_ui.status_line import StatusLine
from volviz_ui.surface import Surface
from volviz_ui.theme import Theme
from volviz_ui.thumbnails import Thumbnails
from volviz_ui.transfer_editor import TransferEditor
from volviz_ui.view_commands import ViewCommands
from volviz_ui.views.display import AddVolume, Display
from volviz_ui.views.scenery import Scenery
from volviz_ui.views.view_area import ViewArea
from volviz_ui.views.viewport import Viewport
from volviz_ui.workers import Gate, Workers

MEMORY_DELAY_MS = 2000
SHOWN_AT_FIRST = {"box": False, "axes": False, "marker": True, "bar": False}


class MainWindow(QMainWindow):
    """Puts everything together; holds no state of its own.

    Parameters
    ----------
    theme : Theme
        The theme of the application.
    preferences : Preferences, optional
        What is remembered between two starts.
    add_volume : callable, optional
        `volviz.add_volume`, or what stands in for it.
    autosave_folder : Path, optional
        Where the scene is written for the case of a crash; nowhere when not given.
    """

    def __init__(
        self,
        theme: Theme,
        preferences: Preferences | None = None,
        add_volume: AddVolume | None = None,
        autosave_folder: Path | None = None,
    ) -> None:
        super().__init__()
        if add_volume is None:
            from volviz.custom_gl.host import add_volume as real

            add_volume = real
        self.theme = theme
        self.preferences = preferences if preferences is not None else Preferences()
        self.store = Store()
        self.workers = Workers(self)
        self.gate = self.workers.gate = Gate(self)
        # threads of their own: compiling takes seconds, and no file shall wait for it
        self.compilers = Workers(self)
        self.compilers.gate = self.gate
        self.documents = Documents(self.store, self.workers, self)
        self.setWindowIcon(app_icon())
        self.setWindowTitle("VolViz")
        self.setAcceptDrops(True)
        self.setDockOptions(
            QMainWindow.DockOption.AllowTabbedDocks
            | QMainWindow.DockOption.AllowNestedDocks
            | QMainWindow.DockOption.AnimatedDocks
        )

        self.views = ViewArea(self.store, self.documents, add_volume, self)
        self.setCentralWidget(self.views)
        self.banner = Banner(self.views)
        self.status_line = StatusLine(self)
        self.setStatusBar(self.status_line)

        self.data_panel = DataPanel(self.store, self.workers, self)
        self.technique_panel = TechniquePanel(self.store, self)
        self.transfer_editor = TransferEditor(self.store, self)
        self.ray_panel = RayPanel(self)
        self.compare_commands = CompareCommands(self)
        self.compare_panel = ComparePanel(self.store, self.compare_commands, self)
        self.crosscheck_panel = CrosscheckPanel(self.store, self.workers, self)
        self.transfer_editor.counter.workers.gate = self.gate
        self.dock_layout = DockLayout(
            self,
            data=self.data_panel,
            technique=self.technique_panel,
            transfer=self.transfer_editor,
            ray=self.ray_panel,
            compare=self.compare_panel,
            crosscheck=self.crosscheck_panel,
        )
        self.docks = self.dock_layout.all
        self.ray_dock = self.dock_layout.ray
        self.compare_dock = self.dock_layout.compare
        self.crosscheck_dock = self.dock_layout.crosscheck
        self.thumbnails = Thumbnails(self.workers, self)
        self.transfer_editor.thumbnail_provider = self.thumbnails.request
        self.isovalues = IsovalueMarkers(self.store, self.transfer_editor, self)
        self.ray_inspector = RayInspector(
            self.store,
            self.documents,
            self.workers,
            self.views,
            self.ray_panel,
            self,
        )
        self.measurements = Measurements(
            self.store, self.documents, self.views, self.workers, self.compare_panel, self
        )
        self.surface_distances = SurfaceDistances(
            self.store,
            self.documents,
            self.views,
            self.workers,
            self.compare_panel.distances,
            self.measurements.meshes,
            self,
        )
        self.surface = Surface(self.store, self.workers, self)
        self.reports = Reports(self, self.compare_panel)
        self.file_commands = FileCommands(self)
        self.session_commands = SessionCommands(self)
        self.view_commands = ViewCommands(self)
        self.actions_ = Actions(self)
        self.menus = Menus(self)
        self.action_states = ActionStates(self.store, self.actions_, self.surface, self)
        self.pointer = Pointer(
            self.store, self.documents, self.views, self.status_line, self.transfer_editor, self
        )
        self._last_error: BaseException | None = None
        self._panel_timer = QTimer(self)
        self._panel_timer.setSingleShot(True)
        self._panel_timer.setInterval(0)
        self._panel_timer.timeout.connect(lambda: self.technique_panel.set_volume(self.documents.volume))
        self._memory_timer = QTimer(self)
        self._memory_timer.setSingleShot(True)
        self._memory_timer.setInterval(MEMORY_DELAY_MS)
        self._memory_timer.timeout.connect(return_freed_memory)
        self.autosave = None if autosave_folder is None else Autosave(self.store, autosave_folder, self)
        self._connect()
        self._restore()

    # ------------------------------------------------------------------ the first view

    @property
    def viewport(self) -> Viewport:
        """Where the first view is shown; the others are as large and look through the same camera."""
        return self.views.first.viewport

    @property
    def display(self) -> Display:
        """What shows the first view."""
        return self.views.first.display

    @property
    def scenery(self) -> Scenery:
        """What stands around the volume in the first view."""
        return self.views.first.scenery

    # ------------------------------------------------------------------ putting together

    def _connect(self) -> None:
        self.transfer_editor.failed.connect(
            lambda error: show_error(self, self.tr("Transfer function"), error)
        )
        self.theme.about_to_change.connect(self.technique_panel.forget_forms)
        section = self.technique_panel.surface
        self.surface.facts_changed.connect(section.show_facts)
        self.surface.work_changed.connect(section.show_work)
        section.cancel_wanted.connect(self.surface.cancel)
        section.export_wanted.connect(self.file_commands.export_mesh)
        self.crosscheck_dock.toggleViewAction().triggered.connect(
            lambda shown: shown and self.crosscheck_dock.raise_()
        )
        self.documents.volume_changed.connect(self._on_volume_changed)
        self.documents.opened.connect(self._on_opened)
        self.documents.failed.connect(self._on_failed_to_open)
        self.documents.loading_started.connect(self._on_loading_started)
        self.documents.loading_progressed.connect(lambda fraction, _text: self.banner.set_progress(fraction))
        self.documents.loading_ended.connect(self.banner.hide_progress)
        self.banner.cancelled.connect(self.documents.cancel)
        self.banner.details_wanted.connect(self._show_error_details)
        self.views.failed.connect(self._on_drawing_failed)
        self.views.recovered.connect(self._on_drawing_recovered)
        self.views.status_changed.connect(self._on_status_changed)
        self.views.function_drag_started.connect(self.transfer_editor.begin_shift_stretch)
        self.views.function_dragged.connect(self.transfer_editor.shift_stretch)
        self.views.function_drag_ended.connect(
            lambda cancelled: self.transfer_editor.end_shift_stretch(cancel=cancelled)
        )
        toggle = self.ray_dock.toggleViewAction()
        toggle.triggered.connect(lambda shown: shown and self.ray_panel.plot.setFocus())
        self.ray_dock.visibilityChanged.connect(self.ray_inspector.set_active)
        self.ray_inspector.value_pointed.connect(self.transfer_editor.highlight_value)
        self.transfer_editor.value_hovered.connect(self.ray_panel.plot.mark_value)
        show_value(self.store, lambda scene: scene.view.technique, self._show_technique)
        show_value(self.store, _why_no_regions, self._show_regions_unused)
        show_value(
            self.store, lambda scene: scene.layer and scene.layer.transfer_function, self._show_function
        )
        show_value(self.store, lambda scene: scene.active_index, self._show_active)

    def _restore(self) -> None:
        for name, default in SHOWN_AT_FIRST.items():
            shown = self.preferences.shows(name, default)
            self.actions_.scenery[name].setChecked(shown)
            self.views.show_scenery(name, shown)
        shown = self.preferences.shows("handles", True)
        self.actions_.handles.setChecked(shown)
        self.views.shows_handles = shown
        self.set_quality(self.preferences.quality)
        self.resize(1400, 900)
        kept = self.preferences.window
        # one or the other: Qt leaves a tab bar over the menu when panels in tabs are arranged twice
        if kept is None or not self.restoreState(kept[1], LAYOUT_VERSION):
            self.reset_layout()
        if kept is not None:
            self.restoreGeometry(kept[0])

    def reset_layout(self) -> None:
        """All panels docked, where they belong."""
        self.dock_layout.reset()

    # ------------------------------------------------------------------ opening

    def open(self, source: str) -> None:
        """Open a file, a folder or ``sample:<id>``."""
        if source.startswith(SAMPLE_PREFIX):
            self.documents.open(source)
        else:
            self.file_commands.open_path(source)

    def _on_loading_started(self, name: str) -> None:
        self.banner.show_progress(self.tr("Loading %1…").replace("%1", name))

    def _on_opened(self, opened: Opened) -> None:
        if not opened.ref.source.startswith(SAMPLE_PREFIX):
            self.preferences.add_recent(opened.ref)

    def _on_failed_to_open(self, name: str, error: BaseException) -> None:
        show_error(self, self.tr("%1 was not opened").replace("%1", name), error)

    def _on_volume_changed(self, volume: Volume | None) -> None:
        layer = self.store.scene.layer
        if volume is not None:
            # the histograms wait until the first picture has been drawn
            self.gate.shut()
        self.setWindowTitle("VolViz" if volume is None else f"{volume.name} – VolViz")
        self.views.set_volume(volume, layer.transfer_function if layer else None)
        self.data_panel.set_volume(volume)
        # its widgets are made anew, which has time until the next turn of the event loop
        self._panel_timer.start()
        self.crosscheck_panel.set_volume(volume)
        self.transfer_editor.set_volume(volume)
        self.thumbnails.set_volume(volume)
        self.isovalues.set_volume(volume)
        self.status_line.show_volume(volume)
        self._memory_timer.start()
        if volume is not None:
            # where there is no machine code on disk yet, nobody shall wait for it later
            dtype = volume.array.dtype
            self.compilers.start(
                lambda task: warm_up((dtype,), report=task.report), key="warm up", patient=True
            )

    # ------------------------------------------------------------------ showing

    def _show_regions_unused(self, why_not: str) -> None:
        self.transfer_editor.set_two_dimensional_available(not why_not, why_not)

    def _show_technique(self, _technique: str) -> None:
        self.status_line.show_technique(current_technique(self.store.scene).label)

    def _on_status_changed(self, view: int, status: Any) -> None:
        if status.complete:
            self.gate.open()
        if view == self.views.active.view:
            self.status_line.show_status(status)
            self.surface.show_status(status, self.views.active.display.handle)

    def _show_function(self, function: Any) -> None:
        if self.documents.is_ready_for(self.store.scene):
            self.views.set_function(function)

    def _show_active(self, _index: int) -> None:
        # panes are made by an earlier listener of the store
        status = self.views.active.display.status
        self.status_line.show_technique(current_technique(self.store.scene).label)
        if status is not None:
            self.status_line.show_status(status)
            self.surface.show_status(status, self.views.active.display.handle)

    def set_quality(self, quality: str) -> None:
        """Give up more or less while something moves."""
        self.preferences.quality = quality
        self.views.quality = quality
        self.menus.quality.setCurrentIndex(self.menus.quality.findData(quality))

    def set_theme(self, choice: Any) -> None:
        """Light, dark, or as the system."""
        self.preferences.theme = choice
        self.theme.choice = choice

    def set_full_screen(self, on: bool) -> None:
        """Use the whole screen, or the window again."""
        self.setWindowState(
            self.windowState() | Qt.WindowState.WindowFullScreen
            if on
            else self.windowState() & ~Qt.WindowState.WindowFullScreen
        )

    # ------------------------------------------------------------------ errors of drawing

    def _on_drawing_failed(self, error: BaseException) -> None:
        self.gate.open()
        self._last_error = error
        self.banner.show_error(sentence_of(error))

    def _on_drawing_recovered(self) -> None:
        if not self.banner.shows_progress:
            self.banner.hide()

    def _show_error_details(self) -> None:
        if self._last_error is not None:
            show_error(self, self.tr("The picture could not be drawn"), self._last_error)

    # ------------------------------------------------------------------ dialogs

    def show_preferences(self) -> PreferencesDialog:
        """Open the preferences."""
        dialog = PreferencesDialog(self.theme.choice, self.preferences.quality, self)
        dialog.theme_chosen.connect(self.set_theme)
        dialog.quality_chosen.connect(self.set_quality)
        return self._opened_dialog(dialog)

    def show_shortcuts(self) -> ShortcutsDialog:
        """Open the page of shortcuts."""
        return self._opened_dialog(ShortcutsDialog(self.actions_.groups(), self))

    def show_about(self) -> AboutDialog:
        """Say what this program is."""
        return self._opened_dialog(AboutDialog(self._opengl(), self))

    def _opened_dialog(self, dialog: Any) -> Any:
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def _opengl(self) -> str:
        window = self.viewport.render_window
        if window is None:
            return ""
        lines = window.ReportCapabilities().splitlines()
        found = [line.split(":", 1)[1].strip() for line in lines if line.startswith("OpenGL renderer")]
        return found[0] if found else ""

    # ------------------------------------------------------------------ events

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Files and folders may be dropped anywhere on the window."""
        if any(url.isLocalFile() for url in event.mimeData().urls()):
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Open what was dropped."""
        paths = [url.toLocalFile() for url in event.mimeData().urls() if url.isLocalFile()]
        event.acceptProposedAction()
        self.file_commands.open_dropped(paths)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Escape leaves the full screen."""
        if event.key() == Qt.Key.Key_Escape and self.isFullScreen():
            self.actions_.full_screen.setChecked(False)
            self.set_full_screen(False)
        else:
            super().keyPressEvent(event)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Remember the layout; end the work and release the GPU while the context lives."""
        if not self.isFullScreen():
            self.preferences.window = (self.saveGeometry(), self.saveState(LAYOUT_VERSION))
        self.pointer.stop()
        self._memory_timer.stop()
        self._panel_timer.stop()
        if self.autosave is not None:
            self.autosave.close()
        self.file_commands.close()
        self.ray_inspector.close()
        self.transfer_editor.close_workers()
        self.measurements.close()
        self.surface_distances.close()
        self.reports.close()
        self.compilers.close()
        self.workers.close()
        self.views.close_views()
        self.documents.close()
        super().closeEvent(event)


def _why_no_regions(scene: Scene) -> str:
    return regions_unused(current_technique(scene), current_settings(scene))
