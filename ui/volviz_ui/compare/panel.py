"""The Compare dock: how views are compared, and what is measured of them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from PySide6.QtCore import QTimer, Signal
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QPushButton, QWidget

from volviz.compare.timing import FrameTimes, ratio
from volviz.model.store import Store
from volviz.model.ticks import NARROW, number_text
from volviz_ui.commands.compare import CompareCommands
from volviz_ui.compare.convergence_plot import ConvergencePlot, Curve
from volviz_ui.compare.distance_section import DistanceSection
from volviz_ui.compare.look_section import LookSection
from volviz_ui.compare.measurements import Measurements
from volviz_ui.compare.metric_table import MetricTable
from volviz_ui.compare.metrics import PairMetrics
from volviz_ui.compare.reports import Reports
from volviz_ui.panels.panel import Panel, Section
from volviz_ui.widgets.focus_order import set_focus_order
from volviz_ui.widgets.progress_bar import ProgressBar
from volviz_ui.widgets.small import quiet_label


class ComparePanel(Panel):
    """Shows metrics of the compared views, A and B."""

    visibility_changed = Signal(bool)
    """Whether somebody looks at the metrics now."""
    timing_requested = Signal()
    match_requested = Signal()
    report_requested = Signal()
    open_requested = Signal()
    convergence_requested = Signal()
    work_cancelled = Signal()

    def __init__(self, store: Store, commands: CompareCommands, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._several = False
        self._works = False
        self.look = LookSection(self.tr("Views"), store, commands, self)
        self.distances = DistanceSection(self.tr("Distance of the surfaces"), store, commands, self)
        self.state = quiet_label("", self)
        self.state.setWordWrap(True)
        self.images = self._images()
        self.sides = self._sides()
        self.time_button = QPushButton(self.tr("Measure frame times"), self)
        self.time_button.setToolTip(
            self.tr("Draw both pictures in full quality five times, in turn, without changing anything")
        )
        self.time_button.clicked.connect(self.timing_requested)
        self.gpu_words = quiet_label("", self)
        self.gpu_words.setWordWrap(True)
        self.gpu_words.hide()
        self.time_ratio = quiet_label("", self)
        self.time_ratio.setWordWrap(True)
        self.meshes = self._meshes()
        self.words = quiet_label("", self)
        self.words.setWordWrap(True)
        self.words.setToolTip(self.tr("What A and B do differently"))
        self.match_button = QPushButton(self.tr("Match settings"), self)
        self.match_button.setToolTip(
            self.tr("Give B the settings of A; where VTK can do a thing in one way only, ours follows")
        )
        self.match_button.clicked.connect(self.match_requested)

        images = Section(self.tr("Pictures"), parent=self)
        images.add_wide(self.images)
        images.add_wide(self.state)
        sides = Section(self.tr("Times and samples"), parent=self)
        sides.add_wide(self.sides)
        sides.add_wide(self.gpu_words)
        sides.add_wide(self.time_ratio)
        sides.add_wide(self.time_button)
        self.mesh_section = Section(self.tr("Meshes"), parent=self)
        self.mesh_section.add_wide(self.meshes)
        settings = Section(self.tr("Differences in settings"), parent=self)
        settings.add_wide(self.words)
        settings.add_wide(self.match_button)
        sections = (self.look, self.distances, images, sides, self.mesh_section, settings, self._orders())
        for section in sections:
            self.add(section)
        self.add(self._report())
        self.show_nothing("")
        set_focus_order(self.body)

    def follow(self, measurements: Measurements, reports: Reports) -> None:
        """Show what is measured and written from now on, and say what is wanted."""
        for signal, slot in (
            (self.visibility_changed, measurements.watch),
            (self.timing_requested, measurements.time),
            (self.match_requested, measurements.match),
            (measurements.figures_found, self.show_metrics),
            (measurements.times_found, self.show_times),
            (measurements.timing_progressed, self.show_timing),
            (measurements.gpu_clock_found, self.show_gpu_clock),
            (measurements.state_changed, self.show_state),
            (measurements.emptied, self.show_nothing),
            (measurements.convergence_outdated, self.show_convergence),
            (measurements.several_changed, self.set_several),
            (measurements.names_changed, self.show_names),
            (measurements.differences_found, self.show_differences),
            (self.report_requested, reports.write_report),
            (self.open_requested, reports.open_report),
            (self.convergence_requested, reports.converge),
            (self.work_cancelled, reports.cancel),
            (reports.work_changed, self.show_work),
            (reports.written, self.show_report),
            (reports.convergence_found, self.show_convergence),
        ):
            signal.connect(slot)
        measurements.tell_pair()

    # ------------------------------------------------------------------ tables

    def _images(self) -> MetricTable:
        tr = self.tr
        return MetricTable(
            [
                ("psnr", tr("PSNR"), tr("Peak signal-to-noise ratio; infinite for equal pictures")),
                (
                    "ssim",
                    tr("SSIM"),
                    tr("Mean structural similarity (7 × 7 pixels); 1 for equal pictures"),
                ),
                ("mean", tr("Mean difference"), tr("Over all pixels and channels, in levels of 0 to 255")),
                ("max", tr("Largest difference"), tr("In levels of 0 to 255, and where: column, row")),
                ("visible", tr("Pixels that differ"), tr("By more than two levels in one of the channels")),
            ],
            columns=1,
            parent=self,
        )

    def _sides(self) -> MetricTable:
        tr = self.tr
        return MetricTable(
            [
                ("time", tr("Frame time"), tr("Median of full pictures of this size, drawn in turn")),
                ("spread", tr("Spread"), tr("Distance of the quartiles as a part of the median")),
                ("gpu", tr("GPU clock"), tr("OpenGL's own time for the same pictures (GL_TIME_ELAPSED), median")),
                ("samples", tr("Samples per ray"), tr("Mean of rays through the volume, by its box and the step")),
                ("longest", tr("Longest ray"), tr("Samples of the ray that takes the most")),
            ],
            columns=2,
            parent=self,
        )  # fmt: skip

    def _meshes(self) -> MetricTable:
        tr = self.tr
        return MetricTable(
            [
                ("faces", tr("Triangles"), tr("After vertices at one place have been merged")),
                ("vertices", tr("Vertices"), tr("Those that a triangle uses")),
                ("area", tr("Area"), tr("In squared units of the world")),
                ("volume", tr("Volume"), tr("That the surface encloses, in cubic units of the world")),
                ("euler", tr("Euler number"), tr("Vertices − edges + triangles: 2 for a ball")),
                ("open", tr("Open edges"), tr("Edges of one triangle only")),
                ("parts", tr("Parts"), tr("Connected parts")),
                (
                    "hausdorff",
                    tr("Largest distance"),
                    tr(
                        "From the vertices and middles of the triangles of A to the nearest place of B, and back; the "
                        "larger one of both is the Hausdorff distance"
                    ),
                ),
            ],
            columns=2,
            parent=self,
        )  # fmt: skip

    def _orders(self) -> Section:
        self.plot = ConvergencePlot(self)
        self.plot.hide()
        self.plot_words = quiet_label("", self)
        self.plot_words.setWordWrap(True)
        self.plot_words.setToolTip(self.tr("Views whose pictures have nothing to converge with"))
        self.plot_words.hide()
        self.convergence_button = QPushButton(self.tr("Measure convergence"), self)
        self.convergence_button.setToolTip(
            self.tr(
                "Draw each view coarser and finer (steps, slices, splats, cells of a mesh) and fit how its error falls "
                "(in a process of its own)"
            )
        )
        self.convergence_button.clicked.connect(self.convergence_requested)
        section = Section(self.tr("Convergence"), parent=self)
        section.add_wide(self.plot)
        section.add_wide(self.plot_words)
        section.add_wide(self.convergence_button)
        return section

    def _report(self) -> Section:
        section = Section(self.tr("Report"), parent=self)
        self.report_button = QPushButton(self.tr("Write report…"), self)
        self.report_button.setToolTip(
            self.tr("All views with pictures, differences, figures and settings, as one page (or JSON, CSV)")
        )
        self.report_button.clicked.connect(self.report_requested)
        self.open_button = QPushButton(self.tr("Open the report"), self)
        self.open_button.setToolTip(self.tr("Show the report that was written in the browser"))
        self.open_button.clicked.connect(self.open_requested)
        self.open_button.hide()
        self.work = quiet_label("", self)
        self.work.setWordWrap(True)
        self.bar = ProgressBar(self)
        self.bar.setAccessibleName(self.tr("Progress of the report or of the convergence"))
        self.bar.setToolTip(self.tr("How far the report or the convergence is"))
        self.cancel_button = QPushButton(self.tr("Cancel"), self)
        self.cancel_button.setToolTip(self.tr("Give up what is being drawn and measured"))
        self.cancel_button.clicked.connect(self.work_cancelled)
        for widget in (self.report_button, self.open_button, self.work, self.bar, self.cancel_button):
            section.add_wide(widget)
        self.show_work(None, "")
        return section

    # ------------------------------------------------------------------ showing

    def show_work(self, fraction: float | None, words: str) -> None:
        """How far a report or the convergence is, None when nothing is under way."""
        running = fraction is not None
        for widget in (self.bar, self.cancel_button):
            widget.setVisible(running)
        self.work.setVisible(running)
        self.work.setText(words or self.tr("Starting…"))
        if fraction is not None:
            self.bar.show_fraction(fraction)
            self.open_button.hide()
        if running and not self._works:
            # the button that began it may lie elsewhere, in a menu say
            QTimer.singleShot(0, self, lambda: self.ensureWidgetVisible(self.cancel_button))
        self._works = running
        self.report_button.setEnabled(self._several and not running)
        self.convergence_button.setEnabled(self._several and not running)

    def show_report(self, name: str) -> None:
        """A report has been written."""
        self.work.setText(self.tr("Written: %1").replace("%1", name))
        self.work.show()
        self.open_button.show()

    def show_convergence(self, curves: Sequence[Curve] = (), sentences: Sequence[str] = ()) -> None:
        """Show how errors fall, and why some views have no curve; none when nothing was measured, or holds."""
        self.plot.set_curves(curves)
        self.plot.setVisible(bool(curves))
        self.plot_words.setText("\n".join(sentences))
        self.plot_words.setVisible(bool(sentences))

    def set_several(self, several: bool) -> None:
        """Whether there is anything to compare."""
        self._several = several
        for button in (self.time_button, self.match_button):
            button.setEnabled(several)
        idle = self.cancel_button.isHidden()
        for button in (self.report_button, self.convergence_button):
            button.setEnabled(several and idle)

    def show_nothing(self, words: str) -> None:
        """There is nothing to compare, and why."""
        self.images.clear()
        self.sides.clear()
        self.meshes.clear()
        self.state.setText(words)
        self.state.setVisible(bool(words))
        self.time_ratio.setText("")
        self.time_ratio.hide()
        self.mesh_section.hide()

    def show_state(self, words: str) -> None:
        """What is being done, or empty."""
        self.state.setText(words)
        self.state.setVisible(bool(words))

    def show_names(self, first: str, second: str) -> None:
        """Name the sides."""
        for table in (self.sides, self.meshes):
            table.set_heads(("A", first), ("B", second))

    def show_metrics(self, metrics: PairMetrics) -> None:
        """Show what was measured of the complete images."""
        p = metrics.images
        column, row = p.max_position
        self.images.set_row(
            "psnr", f"\N{INFINITY}{NARROW}dB" if math.isinf(p.psnr) else f"{p.psnr:.2f}{NARROW}dB"
        )
        self.images.set_row("ssim", f"{p.ssim:.5f}")
        self.images.set_row("mean", f"{p.mean_difference:.3f}")
        place = f"  ({column}, {row})" if p.max_difference else ""
        self.images.set_row("max", f"{p.max_difference:.0f}{place}")
        self.images.set_row("visible", f"{100 * p.visible_share:.2f}{NARROW}%")
        samples = metrics.samples
        self.sides.set_row("samples", *(None if s is None else f"{s.mean:.1f}" for s in samples))
        self.sides.set_row("longest", *(None if s is None else f"{s.maximum:.0f}" for s in samples))
        self._show_meshes(metrics)
        self.show_state("")

    def _show_meshes(self, metrics: PairMetrics) -> None:
        self.mesh_section.setVisible(any(mesh is not None for mesh in metrics.meshes))

        for key, read in (
            ("faces", "faces"), ("vertices", "vertices"), ("area", "area"), ("volume", "volume"),
            ("euler", "euler_characteristic"), ("open", "boundary_edges"), ("parts", "components"),
        ):  # fmt: skip
            values = (None if m is None else number_text(getattr(m, read)) for m in metrics.meshes)
            self.meshes.set_row(key, *values)
        distance = metrics.distance
        self.meshes.set_row(
            "hausdorff",
            None if distance is None else number_text(distance.forward, 4),
            None if distance is None else number_text(distance.backward, 4),
        )
        unit = metrics.length_unit
        for key, words, power in (
            ("area", self.tr("Area"), "²"),
            ("volume", self.tr("Volume"), "³"),
            ("hausdorff", self.tr("Largest distance"), ""),
        ):
            self.meshes.set_caption(key, f"{words} ({unit}{power})" if unit else words)

    def show_times(self, times: tuple[FrameTimes, FrameTimes] | None) -> None:
        """Show frame times, or none."""
        if times is None:
            self.sides.set_row("time", None, None)
            self.sides.set_row("spread", None, None)
            self.sides.set_row("gpu", None, None)
            self.time_ratio.hide()
            return
        self.sides.set_row("time", *(f"{1000 * t.median:.0f}{NARROW}ms" for t in times))
        self.sides.set_row("spread", *(f"{100 * t.spread:.0f}{NARROW}%" for t in times))
        gpu = [t.gpu_median for t in times]
        self.sides.set_row("gpu", *(None if t is None else f"{1000 * t:.1f}{NARROW}ms" for t in gpu))
        factor = ratio(times[1], times[0])
        self.time_ratio.setText(
            self.tr("B takes %1 times as long as A (quartiles %2 to %3).")
            .replace("%1", f"{factor.median:.2f}")
            .replace("%2", f"{factor.low:.2f}")
            .replace("%3", f"{factor.high:.2f}")
        )
        self.time_ratio.show()

    def show_gpu_clock(self, software: str) -> None:
        """Whether OpenGL has a clock of its own here: the name of a renderer that has none, empty otherwise."""
        self.sides.show_row("gpu", not software)
        self.gpu_words.setVisible(bool(software))
        self.gpu_words.setText(
            self.tr(
                "No GPU clock: OpenGL is computed on the processor here (%1), and its query ends before the work does."
            ).replace("%1", software)
        )

    def show_timing(self, fraction: float | None) -> None:
        """How far the measurement of times is, None when there is none."""
        running = fraction is not None
        self.time_button.setText(
            self.tr("Stop (%1 %)").replace("%1", f"{100 * fraction:.0f}")
            if fraction is not None
            else self.tr("Measure frame times")
        )
        self.time_button.setProperty("running", running)

    def show_differences(self, sentences: list[str]) -> None:
        """Say what both views do differently."""
        self.words.setText("\n".join(f"\N{BULLET} {s}" for s in sentences) or self.tr("None that is known."))

    # ------------------------------------------------------------------ whether anybody looks

    def showEvent(self, event: QShowEvent) -> None:
        """Somebody looks: measure."""
        super().showEvent(event)
        self.visibility_changed.emit(True)

    def hideEvent(self, event: QHideEvent) -> None:
        """Nobody looks: measure nothing."""
        super().hideEvent(event)
        self.visibility_changed.emit(False)
