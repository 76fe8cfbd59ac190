"""The transfer-function editor: a row of commands, the plot, the fields of what is chosen."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QPointF, QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QMenu,
    QSizePolicy,
    QStackedWidget,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from volviz.model.transfer.automatic_2d import auto_regions
from volviz.model.transfer.function import TransferFunction
from volviz.model.transfer.function_2d import TransferFunction2D
from volviz.model.transfer.own_presets import OwnPresets
from volviz.model.transfer.presets import Preset, preset_for, presets
from volviz_ui.library_words import translated
from volviz_ui.session.loaded_scene import volume_of
from volviz_ui.style.icons import set_icon
from volviz_ui.transfer_editor.arrange import context_menu, fill_arrange_menu, fill_shape_menu
from volviz_ui.transfer_editor.dimension_switch import DimensionSwitch
from volviz_ui.transfer_editor.fields import Fields
from volviz_ui.transfer_editor.fields_2d import RegionFields
from volviz_ui.transfer_editor.help_dialog import HelpDialog
from volviz_ui.transfer_editor.histogram_worker import HistogramWorker
from volviz_ui.transfer_editor.joint import JointCounter
from volviz_ui.transfer_editor.model import EditorModel
from volviz_ui.transfer_editor.plot import TransferPlot
from volviz_ui.transfer_editor.plot_2d import GradientPlot
from volviz_ui.transfer_editor.preset_commands import PresetCommands
from volviz_ui.transfer_editor.preset_popup import PresetPopup, ThumbnailProvider
from volviz_ui.widgets.binding import show_value
from volviz_ui.widgets.focus_order import set_focus_order

if TYPE_CHECKING:
    from volviz.model.store import Store
    from volviz.volume_data.volume import Volume
    from volviz_ui.session.documents import Documents


class TransferEditor(QWidget):
    """Edits the transfer function of the first layer.

    Parameters
    ----------
    store : Store
        Every edit goes there, a drag as one step of the history.
    documents : Documents
        What is shown: the function and the volume that it colours.
    parent : QWidget, optional
        Owner.
    own_presets : OwnPresets, optional
        Where the user's presets lie; default: the user's settings folder.
    """

    failed = Signal(object)
    """An error to show in words: a `VolvizError`."""
    isovalue_moved = Signal(int, float)
    """The user drags the isovalue of that index."""
    value_hovered = Signal(object)
    """Value under the pointer, None when it has left the plot."""

    def __init__(
        self,
        store: Store,
        documents: Documents,
        parent: QWidget | None = None,
        *,
        own_presets: OwnPresets | None = None,
    ) -> None:
        super().__init__(parent)
        self.setAccessibleName(self.tr("Transfer-function editor"))
        self.own_presets = own_presets if own_presets is not None else OwnPresets()
        self.model = EditorModel(store, documents, self)
        self.counter = HistogramWorker(self)
        self._pending: Volume | None = None
        self.plot = TransferPlot(self.model, self.counter, self)
        self.fields = Fields(self.model, self)
        self.joint = JointCounter(self)
        self.gradient_plot = GradientPlot(self.model, self.joint, self)
        self.region_fields = RegionFields(self.gradient_plot, self)
        self.popup = PresetPopup(self.own_presets, self)
        self.commands = PresetCommands(self.model, self.own_presets, self)
        self._as_taken: dict[tuple[str, Volume | None], tuple[TransferFunction, str]] = {}
        self._build()
        self._connect()
        self.set_two_dimensional_available(False)
        self._on_function_changed()
        show_value(documents, volume_of, self._show_volume)

    def sizeHint(self) -> QSize:
        """A wide, low dock."""
        return QSize(1100, 228)

    # ------------------------------------------------------------------ for the window

    def _show_volume(self, volume: Volume | None) -> None:
        """Show presets and histograms of another volume; counted when the editor is first seen."""
        self.popup.set_volume(volume)
        self.joint.set_volume(volume)
        if self._is_two_dimensional():
            self.joint.count()
        self._pending = volume
        if volume is None or self.isVisible():
            self._count()

    @property
    def thumbnail_provider(self) -> ThumbnailProvider | None:
        """Called as ``provider(preset, function, deliver)`` one after the other while the presets are shown.

        It renders the preset on the volume, when idle, and calls ``deliver(QImage)`` on the GUI thread.
        """
        return self.popup.provider

    @thumbnail_provider.setter
    def thumbnail_provider(self, provider: ThumbnailProvider | None) -> None:
        self.popup.provider = provider

    def set_isovalues(
        self, values: tuple[float, ...], colors: tuple[tuple[float, float, float], ...] = ()
    ) -> None:
        """Show markers for isovalues; `isovalue_moved` says when one is dragged."""
        self.plot.set_markers(values, colors)

    def highlight_value(self, value: float | None) -> None:
        """Mark a value in the plot, the sample of a ray say."""
        self.plot.set_highlight(value)

    def begin_shift_stretch(self) -> None:
        """A drag with the modifier starts in the viewport."""
        self._drag_start: TransferFunction | None = self.model.function
        self.model.begin()

    def shift_stretch(self, right: float, up: float) -> None:
        """The drag has gone so far, in fractions of the viewport's size: right shifts, up stretches."""
        start = self._drag_start
        if start is not None and self.model.in_gesture:
            low, high = self.model.data_range
            middle = (start.points[0].value + start.points[-1].value) / 2
            function = start.stretched(2.0 ** min(max(up * 4.0, -6.0), 6.0), middle)
            self.model.apply(function.shifted(right * (high - low)), self.tr("Shift and stretch"))

    def end_shift_stretch(self, *, cancel: bool = False) -> None:
        """The drag in the viewport is over."""
        if cancel:
            self.model.cancel()
        else:
            self.model.finish()

    def set_two_dimensional_available(self, available: bool, why_not: str = "") -> None:
        """Whether the technique that draws can use regions over value and gradient: shows the switch 1D | 2D.

        Where it cannot, a sentence on the reason keeps the switch in sight, with its second half disabled.
        """
        self.dimensions.offer(available=available, why_not=why_not)
        self._show_dimension()

    def set_automatic(self) -> None:
        """Put the automatic function on the data."""
        if self._is_two_dimensional():
            self.gradient_plot.set_automatic()
        elif self.model.volume is not None:
            self.model.apply(TransferFunction.auto(self.model.volume), self.tr("Automatic function"), ())

    def close_workers(self) -> None:
        """Stop counting: the window closes."""
        self.counter.close()
        self.joint.close()

    # ------------------------------------------------------------------ building

    def _build(self) -> None:
        self.preset_button = self._button("", self.tr("Choose a preset"), text=True)
        self.preset_button.setMinimumWidth(168)
        self.preset_button.setAutoRaise(False)
        self.preset_button.setAccessibleName(self.tr("Preset"))
        set_icon(self.preset_button, "swatches")
        self.auto_button = self._button(
            self.tr("Auto"), self.tr("A first function from the histogram of the data"), text=True
        )
        set_icon(self.auto_button, "magic-wand")
        self.more_button = self._button("", self.tr("Save, import and export presets"), "dots-three-vertical")
        self.dimensions = DimensionSwitch(self)
        self.shape_button = self._button(
            self.tr("Shape"), self.tr("Put a peak, box or ramp on the curve"), text=True
        )
        set_icon(self.shape_button, "plus")
        self.arrange_button = self._button(
            self.tr("Arrange"), self.tr("Align, distribute, flip and scale the chosen points"), text=True
        )
        set_icon(self.arrange_button, "align-bottom")
        self.color_button = self._button(
            self.tr("Colours"), self.tr("Put a colour map on the function; opacities stay"), text=True
        )
        set_icon(self.color_button, "palette")
        self.log_counts_button = self._toggle(
            "chart-bar", self.tr("Logarithmic heights of the histogram"), on=True
        )
        self.log_values_button = self._toggle(
            "arrows-out-line-horizontal", self.tr("Logarithmic value axis: room for values near zero")
        )
        self.fine_button = self._toggle(
            "arrows-out-line-vertical", self.tr("Fine opacity axis: room for small opacities"), on=True
        )
        self.fit_data_button = self._button("", self.tr("Show the range of the data (Home)"), "frame-corners")
        self.fit_function_button = self._button("", self.tr("Show all points (End)"), "selection-all")
        self.percentile_button = self._button(
            "", self.tr("Show the middle 99 % of the voxels, without outliers"), "arrows-in-line-horizontal"
        )
        self._words = 0
        """Width of the words that the buttons do without at present."""
        self._fill_menus()
        self._bar = bar = QHBoxLayout()
        bar.setContentsMargins(0, 0, 0, 0)
        bar.setSpacing(4)
        for widget in (self.preset_button, self.auto_button, self.more_button):
            bar.addWidget(widget)
        bar.addWidget(self.dimensions)
        bar.addWidget(self._line())
        for widget in (self.color_button, self.shape_button, self.arrange_button):
            bar.addWidget(widget)
        bar.addSpacing(8)
        bar.addWidget(self.dimensions.note, 100)
        bar.addStretch(1)
        for widget in (self.log_counts_button, self.log_values_button, self.fine_button):
            bar.addWidget(widget)
        bar.addWidget(self._line())
        for widget in (self.fit_data_button, self.percentile_button, self.fit_function_button):
            bar.addWidget(widget)
        body = QHBoxLayout()
        body.setContentsMargins(0, 0, 0, 0)
        body.setSpacing(4)
        self.plots, self.sides = QStackedWidget(self), QStackedWidget(self)
        for stack, pages in (
            (self.plots, (self.plot, self.gradient_plot)), (self.sides, (self.fields, self.region_fields)),
        ):  # fmt: skip
            for page in pages:
                stack.addWidget(page)
        self.sides.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Preferred)
        body.addWidget(self.plots, 1)
        body.addWidget(self.sides)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 4, 8, 4)
        layout.setSpacing(4)
        layout.addLayout(bar)
        layout.addLayout(body, 1)
        set_focus_order(self)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Where the bar is too narrow, the icons do without their words."""
        super().resizeEvent(event)
        style = Qt.ToolButtonStyle
        buttons = (self.auto_button, self.color_button, self.shape_button, self.arrange_button)
        with_words = self.auto_button.toolButtonStyle() == style.ToolButtonTextBesideIcon
        spare = self._bar.contentsRect().width() - self._bar.sizeHint().width()
        if self.dimensions.note.isVisible():
            spare += self.dimensions.note.sizeHint().width()
        if with_words and spare < 0:
            before = sum(button.sizeHint().width() for button in buttons)
            for button in buttons:
                button.setToolButtonStyle(style.ToolButtonIconOnly)
            self._words = before - sum(button.sizeHint().width() for button in buttons)
        elif not with_words and spare >= self._words:
            for button in buttons:
                button.setToolButtonStyle(style.ToolButtonTextBesideIcon)

    def _button(self, label: str, tip: str, icon: str = "", *, text: bool = False) -> QToolButton:
        button = QToolButton(self)
        button.setText(label)
        button.setToolTip(tip)
        button.setAccessibleName(label or tip)
        button.setAutoRaise(True)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        button.setMinimumSize(30, 28)
        if text:
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        if icon:
            set_icon(button, icon)
        return button

    def _toggle(self, icon: str, tip: str, *, text: str = "", on: bool = False) -> QToolButton:
        button = self._button(text, tip, icon)
        button.setCheckable(True)
        button.setChecked(on)
        return button

    def _line(self) -> QFrame:
        line = QFrame(self)
        line.setFrameShape(QFrame.Shape.VLine)
        line.setFrameShadow(QFrame.Shadow.Plain)
        line.setObjectName("section_line")
        line.setFixedWidth(1)
        line.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
        return line

    def _fill_menus(self) -> None:
        commands = self.commands
        more = QMenu(self)
        groups = (
            (
                (self.tr("Save as preset…"), "floppy-disk", commands.save),
                (self.tr("Rename preset…"), "pencil-simple", commands.rename),
                (self.tr("Delete preset…"), "trash", commands.delete),
            ),
            (
                (self.tr("Import…"), "download-simple", commands.import_file),
                (self.tr("Export…"), "upload-simple", commands.export_file),
            ),
            ((self.tr("Simplify points"), "polygon", commands.simplify),),
            ((self.tr("Keys and mouse…"), "keyboard", self.show_help),),
        )
        for group in groups:
            if not more.isEmpty():
                more.addSeparator()
            for label, icon, slot in group:
                action = more.addAction(label)
                set_icon(action, icon)
                action.triggered.connect(slot)
        colors, shapes, arrange = QMenu(self), QMenu(self), QMenu(self)
        shapes.setToolTipsVisible(True)
        colors.aboutToShow.connect(self._on_colors_shown)
        fill_shape_menu(shapes, self.plot)
        fill_arrange_menu(arrange, self.plot)
        for button, menu in (
            (self.more_button, more),
            (self.color_button, colors),
            (self.shape_button, shapes),
            (self.arrange_button, arrange),
        ):
            button.setMenu(menu)
            # the arrow stands in the text: Fusion would draw its own over the corner of the letters
            button.setStyleSheet("QToolButton::menu-indicator { image: none; }")
            if button is not self.more_button:
                button.setText(f"{button.text()} ▾")
            button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)

    def _connect(self) -> None:
        model, plot = self.model, self.plot
        model.function_changed.connect(self._on_function_changed)
        self.dimensions.chosen.connect(self._on_dimension_chosen)
        plot.color_requested.connect(self.fields.choose_color)
        plot.fields_requested.connect(self._on_fields_requested)
        plot.menu_requested.connect(self._on_menu_requested)
        plot.marker_moved.connect(self.isovalue_moved)
        plot.hovered.connect(self.value_hovered)
        self.commands.failed.connect(self.failed)
        self.commands.presets_changed.connect(self._on_presets_changed)
        self.popup.chosen.connect(self._on_preset_chosen)
        self.popup.rename_asked.connect(self.commands.rename_one)
        self.popup.delete_asked.connect(self.commands.delete_one)
        self.preset_button.clicked.connect(self.show_presets)
        self.auto_button.clicked.connect(self.set_automatic)
        self.log_counts_button.toggled.connect(plot.set_log_counts)
        self.log_values_button.toggled.connect(plot.set_log_values)
        self.fine_button.toggled.connect(plot.set_fine_opacity)
        self.fit_data_button.clicked.connect(plot.fit_data)
        self.fit_function_button.clicked.connect(plot.fit_function)
        self.percentile_button.clicked.connect(lambda _checked: plot.fit_percentiles())

    # ------------------------------------------------------------------ one or two dimensions

    def _is_two_dimensional(self) -> bool:
        function = self.model.function
        by_gradient = None if function is None else function.by_gradient
        return self.dimensions.available and by_gradient is not None and by_gradient.enabled

    def _on_dimension_chosen(self, two: bool) -> None:
        """The switch decides what is drawn, so it is an edit like any other."""
        function = self.model.function
        if function is None or two == self._is_two_dimensional():
            return
        label = self.tr("Two-dimensional function") if two else self.tr("Function of the value")
        if function.by_gradient is not None:
            by_gradient = replace(function.by_gradient, enabled=two)
        elif self.model.volume is not None:
            by_gradient = auto_regions(self.model.volume)
        else:
            by_gradient = TransferFunction2D()
        self.model.apply(replace(function, by_gradient=by_gradient), label, ())

    def _show_dimension(self) -> None:
        two = self._is_two_dimensional()
        function = self.model.function
        regions = None if function is None else function.by_gradient
        waiting = regions is not None and regions.enabled and not self.dimensions.available
        self.dimensions.show_state(two=two, waiting=waiting)
        self.plots.setCurrentIndex(int(two))
        self.sides.setCurrentIndex(int(two))
        for button in (
            self.color_button, self.shape_button, self.arrange_button, self.log_counts_button,
            self.log_values_button, self.fine_button, self.fit_data_button, self.fit_function_button,
            self.percentile_button,
        ):  # fmt: skip
            button.setVisible(not two)
        if two:
            self.joint.count()

    # ------------------------------------------------------------------ reactions

    def show_help(self) -> None:
        """Open the page of keys and mouse."""
        HelpDialog(self).open()

    def show_presets(self) -> None:
        """Open the images of the presets."""
        function = self.model.function
        self.popup.open_below(self.preset_button, "" if function is None else function.name)

    def showEvent(self, event: object) -> None:
        """Seen for the first time with this volume: count it now."""
        super().showEvent(event)  # type: ignore[arg-type]
        if self._pending is not None:
            self._count()

    def _count(self) -> None:
        volume, self._pending = self._pending, None
        self.counter.set_volume(volume)

    def _on_function_changed(self) -> None:
        function = self.model.function
        self._show_dimension()
        for button in (
            self.preset_button, self.auto_button, self.more_button, self.color_button, self.shape_button,
            self.arrange_button,
        ):  # fmt: skip
            button.setEnabled(function is not None)
        label, is_changed = self._preset_of(function)
        about = self.tr("%1, changed since").replace("%1", label) if is_changed else label
        self.preset_button.setToolTip("\n".join(filter(None, (about, self.tr("Choose a preset")))))
        shown = self.preset_button.fontMetrics().elidedText(
            label or self.tr("Presets"), Qt.TextElideMode.ElideRight, 112 if is_changed else 124
        )
        shown = f"{shown} * ▾" if is_changed else f"{shown} ▾"
        if self.preset_button.text() != shown:
            self.preset_button.setText(shown)

    def _preset_of(self, function: TransferFunction | None) -> tuple[str, bool]:
        """What the preset of a function is called, and whether the function has been changed since it was taken."""
        if function is None or not function.name:
            return "", False
        name, volume = function.name, self.model.volume
        key = (name, volume)
        if key not in self._as_taken:
            preset = presets().get(name) or self.own_presets.all().get(name)
            taken = function if preset is None or volume is None else preset_for(preset, volume)
            label = (
                self.tr("Automatic")
                if name == "auto"
                else name
                if preset is None
                else translated(preset.label)
            )
            # of other volumes nobody asks any more
            self._as_taken = {k: v for k, v in self._as_taken.items() if k[1] is volume}
            self._as_taken[key] = (taken, label)
        taken, label = self._as_taken[key]
        return label, function != taken

    def _on_presets_changed(self) -> None:
        self._as_taken.clear()
        self._on_function_changed()

    def _on_preset_chosen(self, preset: Preset) -> None:
        self.commands.take(preset)

    def _on_colors_shown(self) -> None:
        menu = self.color_button.menu()
        if menu.isEmpty():
            menu.setStyleSheet("")
            self.commands.fill_colormap_menu(menu)

    def _on_fields_requested(self) -> None:
        field = self.fields.value
        field.setFocus(Qt.FocusReason.ShortcutFocusReason)
        field.selectAll()

    def _on_menu_requested(self, at: QPointF) -> None:
        menu = context_menu(self.plot, at)
        menu.aboutToHide.connect(menu.deleteLater)
        menu.popup(self.plot.mapToGlobal(at.toPoint()))
