"""What the preset menu does: save, rename, delete, import, export, colour maps."""

from __future__ import annotations

from dataclasses import asdict, is_dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QIcon, QImage, QPixmap
from PySide6.QtWidgets import (
    QCheckBox,
    QCompleter,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QInputDialog,
    QLabel,
    QLineEdit,
    QMenu,
    QMessageBox,
    QVBoxLayout,
    QWidget,
)

from volviz.custom_gl.scene_techniques import current_technique, with_lighting, with_technique
from volviz.errors import VolvizError
from volviz.model.scene import Scene
from volviz.model.transfer.channels import simplified, with_ramp
from volviz.model.transfer.formats import colormap_colors, read_preset_file, write_transfer_function
from volviz.model.transfer.presets import Preset, preset_for
from volviz_ui.library_words import translated

if TYPE_CHECKING:
    from volviz.model.transfer.own_presets import OwnPresets
    from volviz_ui.transfer_editor.model import EditorModel

#: Colour maps offered by name: perceptually uniform ones first.
COLORMAPS = (
    "viridis", "magma", "inferno", "plasma", "cividis", "crameri:batlow", "crameri:lajolla", "cmocean:ice",
    "cmocean:thermal", "cmocean:deep", "colorcet:CET_L3",
    "gray", "bone", "matlab:copper", "hot", "matplotlib:coolwarm", "turbo", "jet",
)  # fmt: skip

#: Pixels of a colour map's image in the menu.
ICON = 32


class SaveDialog(QDialog):
    """Name of a preset, and whether the technique goes with it."""

    def __init__(self, name: str, technique: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Save preset"))
        self.name = QLineEdit(name, self)
        self.name.selectAll()
        self.name.setToolTip(self.tr("An existing preset of that name is replaced"))
        self.name.setAccessibleName(self.tr("Name of the preset"))
        words = self.tr("With the technique and its settings (%1)").replace("%1", technique)
        self.with_technique = QCheckBox(words, self)
        self.with_technique.setToolTip(self.tr("Choosing the preset later also brings this technique back"))
        buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Save | QDialogButtonBox.StandardButton.Cancel, self
        )
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        save = buttons.button(QDialogButtonBox.StandardButton.Save)
        self.name.textChanged.connect(lambda text: save.setEnabled(bool(text.strip())))
        save.setEnabled(bool(name.strip()))
        layout = QVBoxLayout(self)
        layout.addWidget(QLabel(self.tr("Name"), self))
        layout.addWidget(self.name)
        layout.addWidget(self.with_technique)
        layout.addWidget(buttons)
        self.setMinimumWidth(360)


class PresetCommands(QObject):
    """Commands on presets and files.

    Parameters
    ----------
    model : EditorModel
        The function that is saved and replaced.
    own : OwnPresets
        Where the user's presets lie.
    widget : QWidget
        Parent of dialogs.
    """

    failed = Signal(object)
    """An error to show: a `VolvizError`."""
    presets_changed = Signal()
    """The user's presets are others now."""

    def __init__(self, model: EditorModel, own: OwnPresets, widget: QWidget) -> None:
        super().__init__(widget)
        self._model = model
        self._own = own
        self._widget = widget

    def take(self, preset: Preset) -> None:
        """Put a preset on the data; its technique, settings and light too, in one step of the history."""
        model = self._model
        volume = model.volume
        function = preset.transfer_function if volume is None else preset_for(preset, volume)
        label = self.tr("Preset %1").replace("%1", translated(preset.label))
        technique, values = preset.technique, preset.settings

        def taken(scene: Scene) -> Scene:
            changed = scene.with_layer(transfer_function=function)
            if technique is not None:
                return with_technique(changed, technique, values)
            return changed if values is None else with_lighting(changed, values)

        try:
            taken(model.store.scene)
        except VolvizError as error:
            self.failed.emit(error)
            model.apply(function, label, ())
            return
        model.select(())
        model.store.update(taken, label=label)

    def save(self) -> None:
        """Ask for a name and save the present function."""
        function = self._model.function
        if function is None:
            return
        known = self._own.all()
        name = function.name if function.name in known else self.tr("My preset")
        technique = translated(current_technique(self._model.store.scene).label)
        dialog = SaveDialog(name, technique, self._widget)
        if dialog.exec() == QDialog.DialogCode.Accepted:
            self.save_as(dialog.name.text(), with_technique=dialog.with_technique.isChecked())
        dialog.deleteLater()

    def save_as(self, label: str, *, with_technique: bool = False) -> None:
        """Save the present function under a name."""
        function = self._model.function
        if function is None:
            return
        view = self._model.store.scene.view
        settings = next((s for key, s in view.settings if key == view.technique), None)
        preset = Preset(
            id="own", label=label, description="", transfer_function=function, unit=self._model.unit,
            technique=view.technique if with_technique else None,
            settings=_plain(settings) if with_technique and settings is not None else None,
        )  # fmt: skip

        def save() -> None:
            stored = self._own.save(preset, label)
            # the function is that preset from now on
            self._model.apply(replace(function, name=stored.label), self.tr("Save preset"), ())
            self.presets_changed.emit()

        self._try(save)

    def rename(self) -> None:
        """Ask which of the own presets gets which name."""
        label = self._ask_which(self.tr("Rename preset"))
        if label is not None:
            self.rename_one(label)

    def rename_one(self, label: str) -> None:
        """Ask for another name of an own preset."""
        new, ok = QInputDialog.getText(
            self._widget, self.tr("Rename preset"), self.tr("New name"), QLineEdit.EchoMode.Normal, label
        )
        if ok and new.strip() and new != label:
            self._try(lambda: self._own.rename(label, new))
            self.presets_changed.emit()

    def delete(self) -> None:
        """Ask which of the own presets goes."""
        label = self._ask_which(self.tr("Delete preset"))
        if label is not None:
            self.delete_one(label)

    def delete_one(self, label: str) -> None:
        """Ask whether an own preset is to go."""
        question = self.tr("Delete the preset “%1” for good?").replace("%1", label)
        answer = QMessageBox.question(self._widget, self.tr("Delete preset"), question)
        if answer == QMessageBox.StandardButton.Yes:
            self._try(lambda: self._own.delete(label))
            self.presets_changed.emit()

    def import_file(self) -> None:
        """Ask for a file of any known kind."""
        kinds = self.tr("Transfer functions (*.json *.vp *.dat);;All files (*)")
        path, _ = QFileDialog.getOpenFileName(self._widget, self.tr("Import transfer function"), "", kinds)
        if path:
            self.read(Path(path))

    def read(self, path: Path) -> None:
        """Put the function of a file on the data."""
        self._try(lambda: self.take(read_preset_file(path)))

    def export_file(self) -> None:
        """Ask where to write the present function."""
        if self._model.function is None:
            return
        kinds = {
            self.tr("VolViz preset (*.json)"): ".json",
            self.tr("ParaView colour map (*.json)"): ".json",
            self.tr("3D Slicer volume property (*.vp)"): ".vp",
            self.tr("Raw table of 256 entries (*.dat)"): ".dat",
        }
        path, kind = QFileDialog.getSaveFileName(
            self._widget, self.tr("Export transfer function"), "", ";;".join(kinds)
        )
        if path:
            target = Path(path)
            if target.suffix.lower() not in (".json", ".vp", ".dat"):
                target = target.with_name(target.name + kinds.get(kind, ".json"))
            self.write(target, paraview="ParaView" in kind)

    def write(self, path: Path, *, paraview: bool = False) -> None:
        """Write the present function to a file."""
        function = self._model.function
        if function is None:
            return
        name = function.name or path.stem
        preset = Preset(
            id=name, label=name, description="", transfer_function=function, unit=self._model.unit
        )
        self._try(lambda: write_transfer_function(preset, path, self._model.data_range, paraview=paraview))

    def apply_colormap(self, name: str) -> None:
        """Put the colours of a colour map over the visible part of the function; opacities stay."""
        function = self._model.function
        if function is None:
            return

        def change() -> None:
            seen = function.visible_range(self._model.data_range)
            low, high = seen if seen is not None else (None, None)
            colored = with_ramp(function, colormap_colors(name), low, high)
            self._model.apply(colored, self.tr("Colour map %1").replace("%1", name), ())

        self._try(change)

    def ask_colormap(self) -> None:
        """Ask for the name of any colour map of cmap."""
        import cmap

        names = sorted(cmap.Catalog().unique_keys())
        dialog = QInputDialog(self._widget)
        dialog.setWindowTitle(self.tr("Colour map"))
        dialog.setLabelText(self.tr("Name, as in matplotlib or cmap (with _r: reversed)"))
        dialog.setTextValue("viridis")
        field = dialog.findChild(QLineEdit)
        if field is not None:
            completer = QCompleter(names, field)
            completer.setFilterMode(Qt.MatchFlag.MatchContains)
            completer.setCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
            field.setCompleter(completer)
        if dialog.exec() == QDialog.DialogCode.Accepted:
            self.apply_colormap(dialog.textValue().strip())
        dialog.deleteLater()

    def simplify(self) -> None:
        """Leave out points that hardly bend the curve, as after reading a table of 256 entries."""
        if self._model.function is not None:
            self._model.apply(simplified(self._model.function, 1.5 / 255), self.tr("Simplify"), ())

    def fill_colormap_menu(self, menu: QMenu) -> None:
        """Entries with an image of each colour map."""
        for name in COLORMAPS:
            action = menu.addAction(name)
            action.triggered.connect(lambda _checked=False, name=name: self.apply_colormap(name))
            action.setIcon(_colormap_icon(name))
        menu.addSeparator()
        menu.addAction(self.tr("By name…")).triggered.connect(self.ask_colormap)

    def _ask_which(self, title: str) -> str | None:
        labels = list(self._own.all())
        if not labels:
            QMessageBox.information(self._widget, title, self.tr("There are no presets of your own yet."))
            return None
        label, ok = QInputDialog.getItem(self._widget, title, self.tr("Preset"), labels, 0, False)
        return label if ok else None

    def _try(self, action: Any) -> None:
        try:
            action()
        except VolvizError as error:
            self.failed.emit(error)


def _plain(settings: Any) -> dict[str, Any] | None:
    return asdict(settings) if is_dataclass(settings) and not isinstance(settings, type) else None


def _colormap_icon(name: str) -> QIcon:
    import numpy as np

    row = np.rint(colormap_colors(name, ICON) * 255).astype(np.uint8)
    pixels = np.ascontiguousarray(np.repeat(row[None], ICON, axis=0))
    image = QImage(pixels.tobytes(), ICON, ICON, 3 * ICON, QImage.Format.Format_RGB888)
    return QIcon(QPixmap.fromImage(image))
