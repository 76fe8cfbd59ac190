"""The data dock: what is loaded, what part of it is shown."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QPushButton, QWidget

from volviz.model.store import Store
from volviz.volume_data.volume import Volume
from volviz_ui.panels.clip_planes import ClipPlanes
from volviz_ui.panels.crop import CropBox
from volviz_ui.panels.histogram import HistogramView
from volviz_ui.panels.layers import LayerList
from volviz_ui.panels.panel import Panel, Section
from volviz_ui.panels.part import PartChooser
from volviz_ui.panels.value_label import ValueLabel
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import volume_of
from volviz_ui.session.workers import Workers
from volviz_ui.widgets.binding import show_value
from volviz_ui.widgets.small import quiet_label


class DataPanel(Panel):
    """The layers, facts about the active one, which part of it is shown, its histogram, crop box and clip planes."""

    correction_requested = Signal()

    def __init__(
        self, store: Store, documents: Documents, workers: Workers, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._properties: dict[str, ValueLabel] = {}
        layers = Section(self.tr("Layers"), parent=self)
        self.layers = LayerList(store, documents, self)
        layers.add_wide(self.layers)

        properties = Section(self.tr("Volume"), parent=self)
        properties.rows.setVerticalSpacing(3)
        for key, label, tooltip in (
            ("name", self.tr("Name"), self.tr("What the data set is called")),
            ("size", self.tr("Size"), self.tr("Voxels along x, y, z")),
            ("type", self.tr("Type"), self.tr("Type of the values and memory they take")),
            ("spacing", self.tr("Spacing"), self.tr("Distance between voxel centres along x, y, z")),
            ("extent", self.tr("Extent"), self.tr("Length of the box along x, y, z")),
            ("range", self.tr("Range"), self.tr("Lowest and highest finite value, with the unit")),
            ("nonfinite", self.tr("Not finite"), self.tr("Number of values that are NaN or infinite")),
        ):
            value = ValueLabel(tooltip, properties)
            value.setAccessibleName(label)
            words = properties.add_row(label, value, tooltip=tooltip)
            words.setProperty("quiet", True)
            self._properties[key] = value
        properties.rows.setColumnMinimumWidth(0, 64)
        self._nonfinite_row = (properties.rows.itemAtPosition(properties.rows.rowCount() - 1, 0), value)
        self.notes = quiet_label()
        self.notes.setWordWrap(True)
        self.notes.setToolTip(self.tr("What the reader has to say about the file"))
        properties.add_wide(self.notes)
        self.correct = QPushButton(self.tr("What was understood…"), properties)
        self.correct.setToolTip(
            self.tr("Axes, spacing and units of the file, to be corrected where they are wrong")
        )
        self.correct.clicked.connect(self.correction_requested)
        properties.add_wide(self.correct)

        part = Section(self.tr("Channel"), parent=self)
        self.part = PartChooser(store, documents, self)
        part.add_wide(self.part)
        self.part.needed.connect(part.setVisible)
        part.setVisible(False)

        shown = Section(self.tr("Histogram"), parent=self)
        self.histogram = HistogramView(documents, workers, self)
        shown.add_wide(self.histogram)

        crop = Section(self.tr("Crop box"), parent=self)
        self.crop = CropBox(store, documents, self)
        crop.add_wide(self.crop)

        planes = Section(self.tr("Clip planes"), parent=self)
        self.planes = ClipPlanes(store, documents, self)
        planes.add_wide(self.planes)
        for section in (layers, properties, part, shown, crop, planes):
            self.add(section)
        show_value(documents, volume_of, self._show_volume)

    def _show_volume(self, volume: Volume | None) -> None:
        texts = dict.fromkeys(self._properties, "–") if volume is None else properties_of(volume)
        for key, label in self._properties.items():
            label.show_text(texts[key])
        has_nonfinite = volume is not None and volume.nonfinite_count > 0
        item, value = self._nonfinite_row
        value.setVisible(has_nonfinite)
        if item is not None and item.widget() is not None:
            item.widget().setVisible(has_nonfinite)
        self.correct.setEnabled(volume is not None)
        self.notes.setText(notes_of(volume))
        self.notes.setVisible(bool(self.notes.text()))


def properties_of(volume: Volume) -> dict[str, str]:
    """The facts about a volume in words."""
    low, high = volume.range
    unit = f" {volume.unit}" if volume.unit else ""
    length = str(volume.metadata.get("length_unit", "mm"))
    megabytes = volume.array.nbytes / 1e6
    return {
        "name": volume.name,
        "size": " × ".join(str(n) for n in volume.dimensions),
        "type": f"{volume.array.dtype}, {megabytes:.3g} MB",
        "spacing": " × ".join(f"{s:.4g}" for s in volume.spacing) + f" {length}",
        "extent": " × ".join(f"{s:.4g}" for s in volume.extent) + f" {length}",
        "range": f"{low:.6g} … {high:.6g}{unit}",
        "nonfinite": f"{volume.nonfinite_count:,}".replace(",", " "),
    }


def notes_of(volume: Volume | None) -> str:
    """What the reader noted about the file."""
    if volume is None:
        return ""
    notes = volume.metadata.get("notes", ())
    return notes if isinstance(notes, str) else "\n".join(str(note) for note in notes)
