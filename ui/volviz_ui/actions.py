"""All commands of the window, each made once: menus, tool bar, keys and page of shortcuts show the same."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject
from PySide6.QtGui import QAction, QActionGroup, QKeySequence

from volviz.custom_gl.scene_techniques import choose_technique, drawing_techniques
from volviz_ui.icons import set_icon

if TYPE_CHECKING:
    from volviz_ui.main_window import MainWindow

Keys = str | QKeySequence.StandardKey | list[str]


class Actions(QObject):
    """The commands, by name as attributes.

    Parameters
    ----------
    window : MainWindow
        Whose methods they call.
    """

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self._window = window
        standard = QKeySequence.StandardKey
        w, tr = window, self.tr
        files = w.file_commands
        views = w.view_commands

        self.open = self._make(
            tr("&Open…"), files.open_file, standard.Open, "folder-open", tr("Open a volume from a file")
        )
        self.open_folder = self._make(
            tr("Open &DICOM folder…"),
            files.open_folder,
            "Ctrl+Shift+O",
            "folder",
            tr("Open the series in a folder"),
        )
        self.import_raw = self._make(
            tr("&Import raw file…"),
            files.import_raw,
            "",
            "file",
            tr("Open a file of bare values; say how to read it"),
        )
        self.open_session = self._make(
            tr("Open &session…"),
            w.session_commands.open_session,
            "",
            "",
            tr("Restore a whole scene: volume, colours, technique, camera"),
        )
        self.save_session = self._make(
            tr("Sa&ve session…"),
            w.session_commands.save_session,
            standard.Save,
            "floppy-disk",
            tr("Save the whole scene, to go on another day"),
        )
        self.export_picture = self._make(
            tr("&Export picture…"),
            files.export_picture,
            "Ctrl+E",
            "export",
            tr("Draw the picture at any size into a file"),
        )
        self.export_mesh = self._make(
            tr("Export &mesh…"),
            files.export_mesh,
            "Ctrl+Shift+E",
            "export",
            tr("Write the mesh that marching cubes or tetrahedra show to a file"),
        )
        self.copy_picture = self._make(
            tr("&Copy picture"),
            files.copy_picture,
            "Ctrl+Shift+C",
            "copy",
            tr("Put the viewport on the clipboard"),
        )
        self.copy_script = self._make(
            tr("Copy as P&ython"),
            files.copy_script,
            "",
            "code",
            tr("Put a script that draws this picture on the clipboard"),
        )
        self.quit = self._make(tr("&Quit"), w.close, standard.Quit, "", tr("Close the window"))

        self.undo = self._make(
            tr("&Undo"), w.documents.undo, standard.Undo, "arrow-u-up-left", tr("Take back the last change")
        )
        self.redo = self._make(
            tr("&Redo"), w.documents.redo, ["Ctrl+Y", "Ctrl+Shift+Z"], "arrow-u-up-right", tr("Do it again")
        )
        self.preferences = self._make(
            tr("&Preferences…"), w.show_preferences, "Ctrl+,", "gear", tr("Theme and quality")
        )

        self.reset_camera = self._make(
            tr("Re&set camera"),
            views.reset_camera,
            ["Home", "F"],
            "frame-corners",
            tr("See the whole volume again"),
        )
        self.axis_views: list[QAction] = []
        for letter, words in (
            ("A", tr("From &anterior (front)")),
            ("P", tr("From &posterior (back)")),
            ("L", tr("From &left")),
            ("R", tr("From &right")),
            ("S", tr("From &superior (above)")),
            ("I", tr("From &inferior (below)")),
        ):
            action = self._make(
                words,
                lambda key=letter: views.show_axis_view(key),
                letter,
                "",
                tr("Look along an axis of the world"),
            )
            self.axis_views.append(action)
        self.parallel = self._make(
            tr("Para&llel projection"), views.set_parallel, "O", "", tr("Without perspective"), checkable=True
        )
        self.scenery = {
            name: self._make(
                words, lambda on, key=name: views.show_scenery(key, on), keys, icon, tooltip, checkable=True
            )
            for name, words, keys, icon, tooltip in (
                ("box", tr("&Box"), "B", "bounding-box", tr("Outline of the volume")),
                ("axes", tr("A&xes with units"), "X", "ruler", tr("Axes around the volume, in world units")),
                (
                    "marker",
                    tr("&Orientation marker"),
                    "M",
                    "compass",
                    tr("Directions of the world, in the corner"),
                ),
                ("bar", tr("&Colour bar"), "C", "", tr("Colours of the values")),
            )
        }
        self.handles = self._make(
            tr("&Handles"),
            views.show_handles,
            "H",
            "",
            tr("Knobs in the picture that move the light and the cut plane, where the technique has them"),
            checkable=True,
        )
        self.full_screen = self._make(
            tr("&Full screen"),
            w.set_full_screen,
            standard.FullScreen,
            "corners-out",
            tr("Use the whole screen"),
            checkable=True,
        )
        if self.full_screen.shortcut().isEmpty():
            self.full_screen.setShortcut("F11")
        self.reset_layout = self._make(
            tr("Reset la&yout"), w.reset_layout, "", "", tr("All panels back to their places")
        )

        self.techniques: list[QAction] = []
        group = QActionGroup(self)
        for number, info in enumerate(drawing_techniques(), start=1):
            action = self._make(
                info.label,
                lambda _on=True, key=info.id: choose_technique(w.store, key),
                str(number) if number <= 9 else "",
                "",
                info.summary,
                checkable=True,
            )
            action.setData(info.id)
            group.addAction(action)
            self.techniques.append(action)
        self.finer = self._make(
            tr("&More slices, smaller steps"),
            lambda: views.refine(1),
            ["+", "="],
            "",
            tr("Sample the volume more finely"),
        )
        self.coarser = self._make(
            tr("&Fewer slices, larger steps"),
            lambda: views.refine(-1),
            "-",
            "",
            tr("Sample the volume more coarsely"),
        )
        self.machinery = self._make(
            tr("&View the machinery"),
            views.toggle_machinery,
            "W",
            "",
            tr("Wireframe, or what else the technique can show"),
        )
        self.reset_settings = self._make(
            tr("&Reset settings"),
            views.reset_settings,
            "",
            "",
            tr("All settings of this technique back to their defaults"),
        )

        self._make_compare()
        self.shortcuts = self._make(
            tr("&Shortcuts"), w.show_shortcuts, ["?", "F1"], "keyboard", tr("Keys and mouse")
        )
        self.about = self._make(tr("&About VolViz"), w.show_about, "", "info", tr("Version and licence"))

    def _make_compare(self) -> None:
        compare, tr = self._window.compare_commands, self.tr
        self.one_view = self._make(
            tr("&One view"), lambda: compare.set_view_count(1), "Ctrl+1", "", tr("The first view alone")
        )
        self.split = self._make(
            tr("&Two views"),
            compare.split,
            "Ctrl+2",
            "square-half",
            tr("Compare two techniques or settings, with one camera"),
            checkable=True,
        )
        self.four_views = self._make(
            tr("&Four views"), lambda: compare.set_view_count(4), "Ctrl+4", "", tr("Compare four of them")
        )
        self.modes: list[QAction] = []
        modes = QActionGroup(self)
        for mode, words, key, tooltip in (
            ("side_by_side", tr("&Side by side"), "F6", tr("All views beside one another")),
            ("wipe", tr("&Wipe"), "F7", tr("View B over view A, up to a line that can be dragged")),
            ("blink", tr("&Blink"), "F8", tr("Views A and B in turn")),
            ("difference", tr("&Difference"), "F9", tr("What view B has that view A has not")),
        ):
            action = self._make(
                words, lambda _on=True, key=mode: compare.set_mode(key), key, "", tooltip, checkable=True
            )
            action.setData(mode)
            modes.addAction(action)
            self.modes.append(action)
        self.distances = self._make(
            tr("Distance of the s&urfaces"),
            compare.color_distances,
            "Shift+F9",
            "",
            tr("Colour two surfaces of triangles by the distance of their points to each other"),
            checkable=True,
        )
        self.with_vtk = self._make(
            tr("Compare with &VTK"),
            compare.compare_with_vtk,
            "Ctrl+K",
            "",
            tr("What VTK's own mapper draws, with the same settings, beside the active view"),
        )
        self.report = self._make(
            tr("Write &report…"),
            self._window.reports.write_report,
            "",
            "",
            tr("All views with pictures, differences, figures and settings in one file"),
        )
        self.next_view = self._make(
            tr("&Next view"),
            compare.activate_next,
            "N",
            "",
            tr("Let the Technique panel and the keys act on the next view"),
        )
        self.swap_views = self._make(
            tr("E&xchange A and B"),
            compare.swap,
            "",
            "",
            tr("Let the compared views, A and B, change places"),
        )
        self.close_view = self._make(
            tr("&Close the view"),
            compare.close_active,
            "Ctrl+W",
            "",
            tr("Close the active view; the others stay"),
        )

    def groups(self) -> list[tuple[str, list[QAction]]]:
        """The commands by menu, for the page of shortcuts."""
        tr = self.tr
        return [
            (
                tr("File"),
                [
                    self.open,
                    self.open_folder,
                    self.save_session,
                    self.export_picture,
                    self.export_mesh,
                    self.copy_picture,
                    self.quit,
                ],
            ),
            (tr("Edit"), [self.undo, self.redo, self.preferences]),
            (
                tr("View"),
                [
                    self.reset_camera,
                    *self.axis_views,
                    self.parallel,
                    *self.scenery.values(),
                    self.handles,
                    self._window.ray_dock.toggleViewAction(),
                    self.full_screen,
                ],
            ),
            (tr("Technique"), [*self.techniques, self.finer, self.coarser, self.machinery]),
            (
                tr("Compare"),
                [
                    self.one_view,
                    self.split,
                    self.four_views,
                    self.with_vtk,
                    self._window.compare_dock.toggleViewAction(),
                    *self.modes,
                    self.distances,
                    self.next_view,
                    self.close_view,
                ],
            ),
            (tr("Help"), [self.shortcuts]),
        ]

    def _make(
        self,
        words: str,
        slot: Callable[..., object],
        keys: Keys,
        icon: str,
        tooltip: str,
        *,
        checkable: bool = False,
    ) -> QAction:
        action = QAction(words, self._window)
        if isinstance(keys, list):
            action.setShortcuts([QKeySequence(key) for key in keys])
        elif keys:
            action.setShortcut(keys)
        key_words = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
        action.setToolTip(f"{tooltip} ({key_words})" if key_words else tooltip)
        action.setStatusTip("")
        action.setCheckable(checkable)
        if icon:
            set_icon(action, icon)
        if checkable:
            # with an icon the menu would not show whether it is switched on
            action.setIconVisibleInMenu(False)
            action.triggered.connect(slot)
        else:
            action.triggered.connect(lambda _checked=False: slot())
        # the window must know the action even when no menu shows it: its keys act everywhere
        self._window.addAction(action)
        return action
