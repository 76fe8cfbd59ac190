"""The section on the mesh in the image: its metrics, the work on it, the way to a file."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QPushButton, QWidget

from volviz_ui.panels.panel import Section
from volviz_ui.panels.value_label import ValueLabel
from volviz_ui.session.mesh_summary import MeshSummary
from volviz_ui.style.icons import set_icon
from volviz_ui.widgets.progress_bar import ProgressBar

NOTHING = "–"


class MeshSection(Section):
    """Shows what `volviz_ui.session.mesh_summary.Surface` found out."""

    export_requested = Signal()
    cancel_requested = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("", parent=parent)
        self.title = self.tr("Mesh")
        self.header.setText(self.title)
        self.rows.setVerticalSpacing(3)
        self.summary: dict[str, ValueLabel] = {}
        for key, label, tooltip in (
            ("triangles", self.tr("Triangles"), self.tr("Number of triangles, after the filters")),
            ("vertices", self.tr("Vertices"), self.tr("Number of vertices that triangles share")),
            ("area", self.tr("Area"), self.tr("Area of all triangles, in world units")),
            (
                "volume",
                self.tr("Volume"),
                self.tr(
                    "What the mesh encloses, in world units; where it is open, the hole counts as a cone"
                ),
            ),
            ("parts", self.tr("Parts"), self.tr("Connected parts, and whether the mesh is closed")),
        ):
            value = ValueLabel(tooltip, self)
            value.setAccessibleName(label)
            words = self.add_row(label, value, tooltip=tooltip)
            words.setProperty("quiet", True)
            self.summary[key] = value
        self.rows.setColumnMinimumWidth(0, 112)

        self.work = QWidget(self)
        self.bar = ProgressBar(self.work)
        self.bar.setAccessibleName(self.tr("Progress of the mesh"))
        self.bar.setToolTip(self.tr("How far the mesh is; the last one is shown meanwhile"))
        self.stop = QPushButton(self.tr("Cancel"), self.work)
        self.stop.setToolTip(self.tr("Keep the mesh that is shown, and the settings it was made with"))
        self.stop.clicked.connect(self.cancel_requested)
        line = QHBoxLayout(self.work)
        line.setContentsMargins(0, 4, 0, 0)
        line.setSpacing(8)
        line.addWidget(self.bar, 1)
        line.addWidget(self.stop)
        # its place is kept, so that nothing jumps while a slider moves
        keeps = self.work.sizePolicy()
        keeps.setRetainSizeWhenHidden(True)
        self.work.setSizePolicy(keeps)
        self.work.hide()
        self.add_wide(self.work)
        self.export = QPushButton(self.tr("Export mesh…"), self)
        self.export.setToolTip(self.tr("Write the mesh to a file: STL, PLY, OBJ, VTP, glTF"))
        set_icon(self.export, "export")
        self.export.setEnabled(False)
        self.export.clicked.connect(self.export_requested)
        self.add_wide(self.export)

    def show_properties(self, summary: MeshSummary | None) -> None:
        """Show the metrics of a mesh, or that there are none yet."""
        texts = words_of(summary)
        for key, label in self.summary.items():
            label.show_text(texts.get(key, NOTHING))
        self.export.setEnabled(summary is not None and summary.metrics.faces > 0)

    def show_work(self, fraction: float | None) -> None:
        """Show how far the mesh in work is, None for none."""
        self.work.setVisible(fraction is not None)
        if fraction is not None:
            self.bar.show_fraction(fraction)


def words_of(summary: MeshSummary | None) -> dict[str, str]:
    """The metrics in words."""
    if summary is None:
        return {}
    metrics: Any = summary.metrics
    square, cube = (f" {summary.length_unit}{power}" if summary.length_unit else "" for power in "²³")
    thousands = {name: f"{getattr(metrics, name):,}".replace(",", "\N{NARROW NO-BREAK SPACE}")
                 for name in ("faces", "vertices", "components")}  # fmt: skip
    if not metrics.faces:
        state = ""
    elif metrics.is_closed:
        state = ", closed"
    elif metrics.non_manifold_edges:
        state = ", not a manifold"
    else:
        state = ", open at the border"
    return {
        "triangles": thousands["faces"],
        "vertices": thousands["vertices"],
        "area": f"{metrics.area:,.6g}{square}".replace(",", "\N{NARROW NO-BREAK SPACE}"),
        "volume": f"{metrics.volume:,.6g}{cube}".replace(",", "\N{NARROW NO-BREAK SPACE}"),
        "parts": thousands["components"] + state,
    }
