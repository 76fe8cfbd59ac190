"""What may stand around the volume: box, axes with units, orientation marker, colour bar."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyvista as pv

from volviz.model.surface_values import SurfaceColors
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.volume import Volume
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.transfer_editor.axes import round_values
from volviz_ui.views.viewport import Viewport

TOP, BOTTOM = "#3b4450", "#14171b"
"""Colours of the background: dark in both themes, since light is added up in front of it."""

FOREGROUND = "#c8d0d8"
_EDGES = [(a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit]
NAMES = ("box", "axes", "marker", "bar")


class Annotations:
    """Adds to the viewport what the user switches on, and keeps it right when the volume changes."""

    def __init__(self, viewport: Viewport) -> None:
        self._viewport = viewport
        self._volume: Volume | None = None
        self._function: TransferFunction | None = None
        self._shown: dict[str, bool] = dict.fromkeys(NAMES, False)
        self._box: Any = None
        self._bar: Any = None
        self._values: SurfaceColors | None = None
        self._words = ""
        self._values_shown: Any = None
        self._marker = False
        self._has_letters = False
        viewport.set_background(BOTTOM, top=TOP)

    @property
    def has_letters(self) -> bool:
        """Whether directions are written at the edges already, in the place of the marker."""
        return self._has_letters

    @has_letters.setter
    def has_letters(self, has_letters: bool) -> None:
        if has_letters != self._has_letters:
            self._has_letters = has_letters
            self.show("marker", self._shown["marker"])

    def is_shown(self, name: str) -> bool:
        """Whether "box", "axes", "marker" or "bar" is switched on."""
        return self._shown[name]

    def show(self, name: str, on: bool) -> None:
        """Switch "box", "axes", "marker" or "bar" on or off."""
        self._shown[name] = on
        getattr(self, f"_show_{name}")(on and (self._volume is not None or name == "marker"))
        self._viewport.render()

    def show_change(self, old: LoadedScene, new: LoadedScene) -> None:
        """Stand around another volume, in other colours, before another background."""
        volume, function = new.volume, new.transfer_function
        self._volume, self._function = volume, function
        if volume is not old.volume:
            for name in ("box", "axes", "bar"):
                getattr(self, f"_show_{name}")(False)
                if self._shown[name] and volume is not None:
                    getattr(self, f"_show_{name}")(True)
        elif function != old.transfer_function and self._bar is not None:
            self._bar.SetLookupTable(_table(function, volume))
        color = new.scene.background
        if color != old.scene.background:
            if color is None:
                self._viewport.set_background(BOTTOM, top=TOP)
            else:
                self._viewport.set_background(color)
            self._viewport.render()

    def show_values(self, colors: SurfaceColors | None, words: str = "") -> None:
        """Explain the colours of a surface by a bar, in the place of that of the transfer function.

        Parameters
        ----------
        colors : SurfaceColors or None
            None for no bar.
        words : str
            Title of the bar; without one a line at the lower edge, or nothing.
        """
        if colors is self._values and words == self._words:
            return
        self._values, self._words = colors, words
        if self._values_shown is not None:
            self._viewport.renderer.RemoveViewProp(self._values_shown)
            self._values_shown = None
        if colors is not None:
            self._values_shown = _bar(_value_table(colors), words)
            # also narrow views have room for numbers there
            self._values_shown.SetTextPositionToPrecedeScalarBar()
            self._values_shown.SetPosition(0.78, 0.25)
            self._values_shown.SetWidth(0.2)
            self._values_shown.SetBarRatio(0.12)
            self._values_shown.SetLabelFormat("%.3g")
            for text in (
                self._values_shown.GetLabelTextProperty(),
                self._values_shown.GetTitleTextProperty(),
            ):
                # surfaces are pale
                text.SetBackgroundColor(*pv.Color(BOTTOM).float_rgb)
                text.SetBackgroundOpacity(0.7)
        elif words:
            self._values_shown = _line(words)
        if self._values_shown is not None:
            self._viewport.renderer.AddViewProp(self._values_shown)
        self._show_bar(self._shown["bar"])
        self._viewport.render()

    def _show_box(self, on: bool) -> None:
        if self._box is not None:
            self._viewport.remove_actor(self._box, reset_camera=False, render=False)
            self._box = None
        if on and self._volume is not None:
            lines = np.array([(2, a, b) for a, b in _EDGES]).ravel()
            mesh = pv.PolyData(np.asarray(self._volume.corners, float), lines=lines)
            self._box = self._viewport.add_mesh(
                mesh,
                color="#8b98a5",
                line_width=1.0,
                lighting=False,
                reset_camera=False,
                render=False,
                pickable=False,
            )

    def _show_axes(self, on: bool) -> None:
        if not on or self._volume is None:
            self._viewport.remove_bounds_axes()
            return
        length = str(self._volume.metadata.get("length_unit", "mm"))
        self._viewport.show_bounds(
            bounds=self._volume.bounds,
            location="outer",
            ticks="outside",
            color=FOREGROUND,
            font_size=10,
            xtitle=f"x ({length})",
            ytitle=f"y ({length})",
            ztitle=f"z ({length})",
            fmt="%.4g",
            n_xlabels=4,
            n_ylabels=4,
            n_zlabels=4,
            use_3d_text=False,
            render=False,
        )

    def _show_marker(self, on: bool) -> None:
        on = on and not self._has_letters
        if on and not self._marker:
            self._viewport.add_axes(
                interactive=False,
                line_width=2,
                color=FOREGROUND,
                x_color="#e5604d",
                y_color="#7fbf5a",
                z_color="#4f9df0",
                viewport=(0.0, 0.0, 0.13, 0.17),
            )
            self._marker = True
        elif on:
            self._viewport.show_axes()
        elif self._marker:
            self._viewport.hide_axes()

    def _show_bar(self, on: bool) -> None:
        if self._bar is not None:
            self._viewport.renderer.RemoveViewProp(self._bar)
            self._bar = None
        if on and self._volume is not None and self._function is not None and self._values is None:
            self._bar = _bar(_table(self._function, self._volume), self._volume.unit)
            self._viewport.renderer.AddViewProp(self._bar)


def _bar(table: Any, title: str) -> Any:
    """A bar of colours with numbers, at the right edge."""
    bar = pv._vtk.vtkScalarBarActor()  # noqa: SLF001 - PyVista's own needs a mesh with scalars
    bar.SetLookupTable(table)
    bar.SetTitle(f"{title}\n" if title else "")
    numbers = pv._vtk.vtkDoubleArray()  # noqa: SLF001
    for value in round_values(*table.scalar_range, 5):
        numbers.InsertNextValue(value)
    bar.SetCustomLabels(numbers)
    bar.SetUseCustomLabels(True)
    bar.SetMaximumNumberOfColors(1025)
    bar.SetUnconstrainedFontSize(True)
    for text in (bar.GetLabelTextProperty(), bar.GetTitleTextProperty()):
        _write_plainly(text)
    bar.SetLabelFormat("%.4g")
    bar.SetPosition(0.92, 0.25)
    bar.SetWidth(0.06)
    bar.SetHeight(0.5)
    return bar


def _line(words: str) -> Any:
    """A line of text above the middle of the lower edge."""
    line = pv._vtk.vtkTextActor()  # noqa: SLF001 - PyVista's own has its place in pixels
    line.SetInput(words)
    _write_plainly(line.GetTextProperty())
    line.GetTextProperty().SetJustificationToCentered()
    line.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    line.SetPosition(0.5, 0.03)
    return line


def _write_plainly(text: Any) -> None:
    text.SetColor(*pv.Color(FOREGROUND).float_rgb)
    text.SetFontSize(12)
    text.SetShadow(False)
    text.SetItalic(False)
    text.SetBold(False)


def background_image(color: tuple[float, float, float] | None, size: tuple[int, int]) -> np.ndarray:
    """The background of the viewport as an array of shape (H, W, 3), 0..1: one colour, or the gradient."""
    width, height = size
    if color is not None:
        return np.broadcast_to(np.asarray(color, np.float32), (height, width, 3))
    top, bottom = (np.asarray(pv.Color(c).float_rgb, np.float32) for c in (TOP, BOTTOM))
    t = np.linspace(0.0, 1.0, height, dtype=np.float32)[:, None, None]
    return np.broadcast_to((1 - t) * top + t * bottom, (height, width, 3))


def _table(function: TransferFunction, volume: Volume) -> Any:
    low, high = volume.range
    colors = np.asarray(function.bake((low, high), 256), float)
    table = pv.LookupTable(n_values=256)
    colors[:, 3] = 1.0
    table.values = np.rint(colors * 255).astype(np.uint8)
    table.scalar_range = (low, max(high, low + 1e-9))
    return table


def _value_table(colors: SurfaceColors) -> Any:
    table = pv.LookupTable(n_values=len(colors.table))
    table.values = np.hstack([colors.table, np.full((len(colors.table), 1), 255, np.uint8)])
    table.scalar_range = (colors.low, colors.high)
    return table
