"""The window: viewport in the middle, panels around it, one store that they all observe."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from PySide6.QtCore import QEvent, Qt, QTimer, QUrl
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent, QKeyEvent
from PySide6.QtWidgets import QMainWindow, QVBoxLayout, QWidget

from volviz.custom_gl.scene_techniques import current_settings, current_technique
from volviz.custom_gl.technique import unused_regions
from volviz.kernels.warm_up import warm_up
from volviz.model.layers import LabelLayer
from volviz.model.store import Store
from volviz.volume_data.references import SAMPLE_PREFIX, is_address
from volviz.volume_data.volume import Volume
from volviz_ui.app.empty_picture import EmptyPicture
from volviz_ui.app.messages import WindowMessages
from volviz_ui.app_context import AppContext
from volviz_ui.commands.bars import ToolBar, fill_menu_bar
from volviz_ui.commands.compare import CompareCommands
from volviz_ui.commands.edit import EditCommands
from volviz_ui.commands.file import FileCommands
from volviz_ui.commands.help import HelpCommands
from volviz_ui.commands.looks import LookCommands
from volviz_ui.commands.measure import MeasureCommands
from volviz_ui.commands.movie import MovieCommands
from volviz_ui.commands.picture import PictureCommands
from volviz_ui.commands.presets import PresetsOfFunction
from volviz_ui.commands.session import SessionCommands
from volviz_ui.commands.table import CommandTable
from volviz_ui.commands.technique import TechniqueCommands
from volviz_ui.commands.time import TimeCommands
from volviz_ui.commands.view import ViewCommands
from volviz_ui.compare.crosscheck import CrosscheckPanel
from volviz_ui.compare.measurements import Measurements
from volviz_ui.compare.panel import ComparePanel
from volviz_ui.compare.reports import Reports
from volviz_ui.compare.surface_distances import SurfaceDistances
from volviz_ui.labels.panel import LabelPanel
from volviz_ui.library_words import translated
from volviz_ui.measuring.panel import MeasurementsPanel
from volviz_ui.measuring.tool import MeasureTool
from volviz_ui.movie.maker import MovieMaker
from volviz_ui.movie.panel import MoviePanel
from volviz_ui.panels.data import DataPanel
from volviz_ui.panels.technique import TechniquePanel
from volviz_ui.ray_inspector.inspector import RayInspector
from volviz_ui.ray_inspector.panel import RayPanel
from volviz_ui.session.autosave import Autosave
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene, volume_of
from volviz_ui.session.memory import return_freed_memory
from volviz_ui.session.mesh_summary import ShownMesh
from volviz_ui.session.opening import Opened
from volviz_ui.session.preferences import Preferences
from volviz_ui.session.time_player import Repeat, TimePlayer
from volviz_ui.session.workers import Gate, Workers
from volviz_ui.style.app_icon import app_icon
from volviz_ui.style.theme import Theme
from volviz_ui.transfer_editor import TransferEditor
from volviz_ui.transfer_editor.isovalue_markers import IsovalueMarkers
from volviz_ui.transfer_editor.thumbnails import Thumbnails
from volviz_ui.views.annotations import Annotations
from volviz_ui.views.pointer import Pointer
from volviz_ui.views.time_bar import TimeBar
from volviz_ui.views.view_controller import ViewController
from volviz_ui.views.view_grid import ViewGrid
from volviz_ui.views.viewport import Viewport
from volviz_ui.widgets.binding import show_value
from volviz_ui.widgets.docks import Docks

MEMORY_DELAY_MS = 2000


class MainWindow(QMainWindow):
    """Puts everything together; holds no state of its own.

    Parameters
    ----------
    theme : Theme
        The theme of the application.
    preferences : Preferences, optional
        What is remembered between two starts.
    autosave_folder : Path, optional
        Where the scene is written for the case of a crash; nowhere when not given.
    """

    def __init__(
        self,
        theme: Theme,
        preferences: Preferences | None = None,
        autosave_folder: Path | None = None,
    ) -> None:
        super().__init__()
        self._may_close = False
        self.theme = theme
        self.preferences = preferences if preferences is not None else Preferences()
        self.store = Store()
        self.workers = Workers(self)
        self.gate = self.workers.gate = Gate(self)
        # threads of their own: compiling takes seconds, and no file shall wait for it
        self.compilers = Workers(self)
        self.compilers.gate = self.gate
        self.documents = Documents(self.store, self.workers, self, corrections=self.preferences.correction)
        self.setWindowIcon(app_icon())
        self.setWindowTitle("VolViz[*]")
        self.setAcceptDrops(True)
        self.setDockOptions(
            QMainWindow.DockOption.AllowTabbedDocks
            | QMainWindow.DockOption.AllowNestedDocks
            | QMainWindow.DockOption.AnimatedDocks
        )

        self.views = ViewGrid(self.store, self.documents, self)
        self.player = TimePlayer(self.store, self.documents, self.gate, self)
        self.time_bar = TimeBar(self.player, self)
        middle = QWidget(self)
        column = QVBoxLayout(middle)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.views, 1)
        column.addWidget(self.time_bar)
        self.setCentralWidget(middle)
        self.messages = WindowMessages(self, self.documents, self.views)
        self.docks = Docks(self)
        self.surface = ShownMesh(self.store, self.workers, self)
        self.measure_tool = MeasureTool(self.store, self.documents, self.views, self)
        self.context = AppContext(
            window=self,
            store=self.store,
            documents=self.documents,
            workers=self.workers,
            player=self.player,
            preferences=self.preferences,
            theme=theme,
            views=self.views,
            docks=self.docks,
            surface=self.surface,
            tool=self.measure_tool,
            messages=self.messages,
        )
        self._make_panels()
        self._make_commands()
        self._memory_timer = QTimer(self)
        self._memory_timer.setSingleShot(True)
        self._memory_timer.setInterval(MEMORY_DELAY_MS)
        self._memory_timer.timeout.connect(return_freed_memory)
        self.autosave = None if autosave_folder is None else Autosave(self.store, autosave_folder, self)
        self._connect()
        self._restore()

    def _make_panels(self) -> None:
        store, documents, workers, views, tr = self.store, self.documents, self.workers, self.views, self.tr
        self.compare_commands = CompareCommands(self.context)
        self.data_panel = DataPanel(store, documents, workers, self)
        self.technique_panel = TechniquePanel(store, documents, self)
        self.transfer_editor = TransferEditor(store, documents, self)
        self.ray_panel = RayPanel(self)
        self.compare_panel = ComparePanel(store, self.compare_commands, self)
        self.label_panel = LabelPanel(store, documents, workers, self)
        self.crosscheck_panel = CrosscheckPanel(documents, workers, self)
        self.movie_maker = MovieMaker(self.context)
        self.movie_panel = MoviePanel(self.movie_maker, documents, self)
        docks = self.docks
        docks.add("data", tr("Data"), self.data_panel, tr("What is loaded, and what is cut away"))
        docks.add("technique", tr("Technique"), self.technique_panel, tr("How the volume is drawn"))
        docks.add(
            "transfer",
            tr("Transfer function"),
            self.transfer_editor,
            tr("Which values get which colour and opacity"),
        )
        docks.add(
            "ray", tr("Ray inspector"), self.ray_panel,
            tr("Follow the ray behind a pixel, sample by sample: click in the picture"), ("Ctrl+I",),
        )  # fmt: skip
        docks.add(
            "compare", tr("Compare"), self.compare_panel,
            tr("How two views are compared, and what is measured of them"), ("Ctrl+M",),
        )  # fmt: skip
        self.measurements_panel = MeasurementsPanel(store, documents, self)
        docks.add(
            "measurements", tr("Measurements"), self.measurements_panel,
            tr("What was measured and marked, with its numbers"), ("Ctrl+Shift+M",),
        )  # fmt: skip
        docks.add(
            "labels", tr("Labels"), self.label_panel,
            tr("The labels of a segmentation: show, colour and measure them"), ("Ctrl+B",),
        )  # fmt: skip
        docks.add(
            "crosscheck", tr("Cross-check"), self.crosscheck_panel,
            tr("Compare our mesh with those of VTK, difference by difference"),
        )  # fmt: skip
        docks.add(
            "movie", tr("Movie"), self.movie_panel,
            tr("Turns, cuts and key frames, drawn into a film"), ("Ctrl+Shift+V",),
        )  # fmt: skip
        self.transfer_editor.counter.workers.gate = self.gate
        self.thumbnails = Thumbnails(documents, workers, self)
        self.transfer_editor.thumbnail_provider = self.thumbnails.request
        self.isovalues = IsovalueMarkers(store, documents, self.transfer_editor, self)
        self.ray_inspector = RayInspector(documents, workers, views, self.ray_panel, self)
        self.measurements = Measurements(store, documents, views, workers, self)
        self.measurements.figures_found.connect(views.show_metrics)
        self.surface_distances = SurfaceDistances(documents, views, workers, self.measurements.meshes, self)
        self.compare_panel.distances.follow(self.surface_distances)
        self.reports = Reports(self.context)
        self.compare_panel.follow(self.measurements, self.reports)
        self.empty_picture = EmptyPicture(store, documents, views, self.messages.banner, self)
        self.pointer = Pointer(store, documents, views, self.messages.status_line, self.transfer_editor, self)

    def _make_commands(self) -> None:
        context = self.context
        self.commands = CommandTable(context)
        self.session_commands = SessionCommands(context)
        self.picture_commands = PictureCommands(context)
        self.file_commands = FileCommands(context, self.session_commands, self.picture_commands)
        self.look_commands = LookCommands(context, self.thumbnails.request)
        self.time_commands = TimeCommands(context)
        self.view_commands = ViewCommands(context, self.look_commands, self.time_commands)
        self.edit_commands = EditCommands(context, self.view_commands)
        self.measure_commands = MeasureCommands(
            context, self.measure_tool, self.measurements_panel, self.view_commands
        )
        self.technique_commands = TechniqueCommands(context)
        self.movie_commands = MovieCommands(context, self.movie_maker)
        self.help_commands = HelpCommands(context, self.commands)
        in_bar = (
            self.file_commands,
            self.edit_commands,
            self.view_commands,
            self.technique_commands,
            self.measure_commands,
            self.compare_commands,
            self.movie_commands,
            self.help_commands,
        )
        fill_menu_bar(self.menuBar(), [self.commands.add(each.menu()) for each in in_bar], self.commands)
        self.commands.add(PresetsOfFunction(self.transfer_editor).menu())
        self.tools = ToolBar(context, self.commands, self.file_commands, self.view_commands)
        self.addToolBar(self.tools)

    # ------------------------------------------------------------------ the first view

    @property
    def viewport(self) -> Viewport:
        """Where the first view is shown; the others are as large and look through the same camera."""
        return self.views.first.viewport

    @property
    def controller(self) -> ViewController:
        """What shows the first view."""
        return self.views.first.controller

    @property
    def annotations(self) -> Annotations:
        """What stands around the volume in the first view."""
        return self.views.first.annotations

    # ------------------------------------------------------------------ putting together

    def _connect(self) -> None:
        self.transfer_editor.failed.connect(
            lambda error: self.messages.show_error(self.tr("Transfer function"), error)
        )
        self.theme.about_to_change.connect(self.technique_panel.forget_forms)
        section = self.technique_panel.surface
        self.surface.summary_changed.connect(section.show_properties)
        self.surface.work_changed.connect(section.show_work)
        section.cancel_requested.connect(self.surface.cancel)
        section.export_requested.connect(self.file_commands.export_mesh)
        self.data_panel.layers.add_requested.connect(self.file_commands.add_layer)
        self.data_panel.correction_requested.connect(self.file_commands.show_understood)
        self.data_panel.layers.labels_requested.connect(self._on_labels_requested)
        self.player.preparation = self.views.preparations
        self.player.failed.connect(self._on_time_failed)
        self.views.drawn.connect(self._on_drawn)
        self.player.repeat = self.preferences.repeat
        self.time_bar.repeat_chosen.connect(self._set_repeat)
        self.movie_panel.save_requested.connect(self.movie_commands.save)
        self.movie_maker.failed.connect(self.messages.show_error)
        self.movie_maker.written.connect(
            lambda path: self.messages.show_status(self.tr("%1 is drawn.").replace("%1", path))
        )
        self.compare_commands.report_requested.connect(self.reports.write_report)
        self.documents.opened.connect(self._on_opened)
        self.session_commands.unsaved.changed.connect(self.setWindowModified)
        self.views.failed.connect(self.gate.open)
        self.views.status_changed.connect(self._on_status_changed)
        self.views.function_drag_started.connect(self.transfer_editor.begin_shift_stretch)
        self.views.function_dragged.connect(self.transfer_editor.shift_stretch)
        self.views.function_drag_ended.connect(
            lambda cancelled: self.transfer_editor.end_shift_stretch(cancel=cancelled)
        )
        self.pointer.label_clicked.connect(self._on_label_clicked)
        self.pointer.label_double_clicked.connect(self._on_label_double_clicked)
        self.label_panel.fly_requested.connect(self.pointer.fly_to)
        show_value(self.documents, _has_labels, self._show_labels, now=False)
        self.docks["ray"].visibilityChanged.connect(self.ray_inspector.set_active)
        self.ray_inspector.value_pointed.connect(self.transfer_editor.highlight_value)
        self.transfer_editor.value_hovered.connect(self.ray_panel.plot.mark_value)
        show_value(self.documents, lambda shown: shown.scene.view.technique, self._show_technique)
        show_value(self.documents, _why_no_regions, self._show_regions_unused)
        show_value(self.documents, volume_of, self._show_volume, now=False)
        show_value(self.documents, volume_of, self.messages.status_line.show_volume)
        show_value(self.documents, lambda shown: shown.scene.active_index, self._show_active)

    def _restore(self) -> None:
        self.view_commands.restore()
        self.resize(1400, 900)
        kept = self.preferences.window
        self.docks.reset()
        if kept is not None:
            self.docks.restore(kept[1])
        if kept is not None:
            self.restoreGeometry(kept[0])

    # ------------------------------------------------------------------ opening

    def open(self, source: str, **hints: Any) -> None:
        """Open a file, a folder or ``sample:<id>``; hints as for `volviz.load`."""
        if source.startswith(SAMPLE_PREFIX) or hints:
            self.documents.open(source, **hints)
        else:
            self.file_commands.open_path(source)

    def _on_opened(self, opened: Opened) -> None:
        if not opened.key.ref.source.startswith(SAMPLE_PREFIX):
            self.preferences.add_recent(opened.key)
        # keys mean the picture now
        self.views.active.viewport.setFocus()

    def _show_volume(self, volume: Volume | None) -> None:
        # [*] is where the system shows that something is unsaved
        self.setWindowTitle("VolViz[*]" if volume is None else f"{volume.name}[*] – VolViz")
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
        label = translated(current_technique(self.documents.shown.scene).label)
        self.messages.status_line.show_technique(label)

    def _on_status_changed(self, view: int, status: Any) -> None:
        if status.complete or (status.bricks is not None and status.resolution >= 1):
            self.gate.open()
        if view == self.views.active.view:
            self.messages.status_line.show_status(status)
            self.surface.show_status(status, self.views.active.controller.handle)

    def _show_active(self, _index: int) -> None:
        status = self.views.active.controller.status
        self._show_technique("")
        if status is not None:
            self.messages.status_line.show_status(status)
            self.surface.show_status(status, self.views.active.controller.handle)

    # ------------------------------------------------------------------ labels

    def _show_labels(self, there_are: bool) -> None:
        if there_are:
            self.docks.show("labels")

    def _on_labels_requested(self, layer: int) -> None:
        self.label_panel.show_layer(layer)
        self.docks.show("labels")

    def _on_label_clicked(self, layer: int, label: int) -> None:
        self.label_panel.show_layer(layer)
        self.label_panel.choose(label)

    def _on_label_double_clicked(self, layer: int, label: int) -> None:
        self._on_label_clicked(layer, label)
        self.label_panel.fly_to(label)

    # ------------------------------------------------------------------ time

    def _on_drawn(self) -> None:
        if self.views.show_present:
            self.player.note_drawn()

    def _on_time_failed(self, number: int, error: BaseException) -> None:
        title = self.tr("Time point %1 was not read").replace("%1", str(number))
        self.messages.show_error(title, error)

    def _set_repeat(self, repeat: Repeat) -> None:
        self.player.repeat = self.preferences.repeat = repeat

    # ------------------------------------------------------------------ events

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Files and folders may be dropped anywhere on the window."""
        if any(self._place_of(url) for url in event.mimeData().urls()):
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Open what was dropped; with Shift it becomes a further layer."""
        paths = [place for url in event.mimeData().urls() if (place := self._place_of(url))]
        event.acceptProposedAction()
        if event.modifiers() & Qt.KeyboardModifier.ShiftModifier and self.documents.volume is not None:
            self.file_commands.add_dropped(paths)
        else:
            self.file_commands.open_dropped(paths)

    @staticmethod
    def _place_of(url: QUrl) -> str:
        """A path or an address that can be opened; an empty text for anything else."""
        if url.isLocalFile():
            return url.toLocalFile()
        return url.toString() if is_address(url.toString()) else ""

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Escape leaves a presentation and the full screen."""
        if event.key() == Qt.Key.Key_Escape and self.isFullScreen():
            self.view_commands.set_presentation(False)
            self.view_commands.set_full_screen(False)
        else:
            super().keyPressEvent(event)

    def _close_for_good(self) -> None:
        self._may_close = True
        self.close()

    def changeEvent(self, event: QEvent) -> None:
        """The window manager may end the full screen, too."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.WindowStateChange:
            self.commands.refresh()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask about unsaved changes; remember the layout, end the work, release the GPU while the context lives."""
        if self.session_commands.must_ask and not self._may_close:
            event.ignore()
            self.session_commands.unless_unsaved(self._close_for_good)
            return
        if not self.isFullScreen():
            self.preferences.window = (self.saveGeometry(), self.docks.state())
        self.pointer.stop()
        self.empty_picture.stop()
        self._memory_timer.stop()
        if self.autosave is not None:
            self.autosave.close()
        self.session_commands.unsaved.close()
        self.picture_commands.close()
        self.ray_inspector.close()
        self.transfer_editor.close_workers()
        self.measurements.close()
        self.surface_distances.close()
        self.reports.close()
        self.movie_maker.close()
        self.compilers.close()
        self.player.close()
        self.workers.close()
        self.views.close_views()
        self.documents.close()
        super().closeEvent(event)


def _has_labels(shown: LoadedScene) -> bool:
    return any(isinstance(layer, LabelLayer) for layer in shown.scene.layers)


def _why_no_regions(shown: LoadedScene) -> str:
    return unused_regions(current_technique(shown.scene), current_settings(shown.scene))
