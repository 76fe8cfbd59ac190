"""How the program looks: Qt's Fusion style, a light and a dark palette of our own, one accent."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QApplication

from volviz_ui.style import icons

Choice = Literal["system", "light", "dark"]

RESOURCES = Path(__file__).parent / "resources"


@dataclass(frozen=True)
class Colors:
    """The colours of one theme, as ``#rrggbb``, and the image of a check mark on the accent colour."""

    window: str
    panel: str
    base: str
    button: str
    border: str
    text: str
    quiet: str
    disabled: str
    accent: str
    accent_text: str
    check: str
    tooltip: str
    tooltip_text: str


LIGHT = Colors(
    window="#eceef1",
    panel="#f6f7f9",
    base="#ffffff",
    button="#fbfcfd",
    border="#d0d5db",
    text="#1d2329",
    quiet="#66717d",
    disabled="#a3acb5",
    accent="#1f6fd0",
    accent_text="#ffffff",
    check="check-light.svg",
    tooltip="#22282f",
    tooltip_text="#f2f4f6",
)
DARK = Colors(
    window="#1c2025",
    panel="#23282e",
    base="#2b3138",
    button="#343b43",
    border="#3f4750",
    text="#dfe3e7",
    quiet="#8d98a3",
    disabled="#5c656e",
    accent="#4795ee",
    accent_text="#0c1118",
    check="check-dark.svg",
    tooltip="#3a424b",
    tooltip_text="#f2f4f6",
)


def palette_of(colors: Colors) -> QPalette:
    """A Qt palette from the colours of a theme."""
    palette = QPalette()
    role = QPalette.ColorRole
    for key, value in {
        role.Window: colors.panel,
        role.WindowText: colors.text,
        role.Base: colors.base,
        role.AlternateBase: colors.panel,
        role.Text: colors.text,
        role.PlaceholderText: colors.quiet,
        role.Button: colors.button,
        role.ButtonText: colors.text,
        role.BrightText: "#ffffff",
        role.Light: QColor(colors.button).lighter(108).name(),
        role.Midlight: colors.button,
        role.Mid: colors.border,
        role.Dark: QColor(colors.border).darker(115).name(),
        role.Shadow: "#000000",
        role.Highlight: colors.accent,
        role.HighlightedText: colors.accent_text,
        role.Accent: colors.accent,
        role.Link: colors.accent,
        role.LinkVisited: colors.accent,
        role.ToolTipBase: colors.tooltip,
        role.ToolTipText: colors.tooltip_text,
    }.items():
        palette.setColor(key, QColor(value))
    for key in (role.WindowText, role.Text, role.ButtonText, role.PlaceholderText):
        palette.setColor(QPalette.ColorGroup.Disabled, key, QColor(colors.disabled))
    palette.setColor(QPalette.ColorGroup.Disabled, role.Highlight, QColor(colors.border))
    palette.setColor(QPalette.ColorGroup.Disabled, role.HighlightedText, QColor(colors.disabled))
    return palette


def style_sheet(colors: Colors) -> str:
    """The few things that a palette cannot say."""
    c = colors
    check = (RESOURCES / c.check).as_posix()
    return f"""
    QMainWindow {{ background: {c.window}; }}
    QMainWindow::separator {{ background: {c.window}; width: 5px; height: 5px; }}
    QMainWindow::separator:hover {{ background: {c.accent}; }}
    QMenuBar {{ background: {c.window}; padding: 2px 4px; }}
    QMenuBar::item {{ background: transparent; padding: 4px 9px; border-radius: 4px; }}
    QMenuBar::item:selected {{ background: {c.button}; }}
    QMenu {{ background: {c.panel}; border: 1px solid {c.border}; padding: 4px 0; }}
    QMenu::item {{ padding: 5px 28px 5px 10px; }}
    QMenu::item:selected {{ background: {c.accent}; color: {c.accent_text}; }}
    QMenu::item:disabled {{ color: {c.disabled}; }}
    QMenu::icon {{ padding-left: 8px; }}
    QMenu::separator {{ height: 1px; background: {c.border}; margin: 4px 8px; }}
    QToolBar {{ background: {c.window}; border: none; padding: 3px 8px 5px 8px; spacing: 4px; }}
    QToolBar::separator {{ background: {c.border}; width: 1px; margin: 5px 5px; }}
    QToolBar QToolButton {{ border: 1px solid transparent; border-radius: 5px; padding: 4px; }}
    QToolBar QToolButton:hover {{ background: {c.button}; border-color: {c.border}; }}
    QToolBar QToolButton:pressed, QToolBar QToolButton:checked {{ background: {c.border}; }}
    QToolBar QToolButton:focus {{ border-color: {c.accent}; }}
    QToolButton#qt_toolbar_ext_button {{ padding: 0; min-width: 16px; }}
    QToolBar QToolButton[popupMode="2"] {{ padding-right: 16px; }}
    QToolBar QToolButton::menu-indicator {{
        subcontrol-origin: padding; subcontrol-position: center right; right: 3px;
    }}
    QCheckBox::indicator {{
        width: 13px; height: 13px; border: 1px solid {c.disabled}; border-radius: 3px; background: {c.base};
    }}
    QCheckBox::indicator:hover, QCheckBox::indicator:focus {{ border-color: {c.accent}; }}
    QCheckBox::indicator:checked {{
        background: {c.accent}; border-color: {c.accent}; image: url("{check}");
    }}
    QCheckBox::indicator:disabled {{ border-color: {c.border}; background: {c.panel}; }}
    QCheckBox::indicator:checked:disabled {{ background: {c.disabled}; }}
    QStatusBar {{ background: {c.window}; color: {c.quiet}; }}
    QStatusBar::item {{ border: none; }}
    QStatusBar QLabel {{ color: {c.quiet}; }}
    QDialogButtonBox, QMessageBox {{ dialogbuttonbox-buttons-have-icons: 0; }}
    QWidget#dock_title {{ background: {c.window}; }}
    QLabel#dock_caption {{ color: {c.quiet}; font-weight: 600; }}
    QToolButton#dock_button {{ border: none; border-radius: 4px; padding: 2px; }}
    QToolButton#dock_button:hover {{ background: {c.border}; }}
    QScrollBar:vertical {{ background: transparent; width: 10px; margin: 0; }}
    QScrollBar:horizontal {{ background: transparent; height: 10px; margin: 0; }}
    QScrollBar::handle {{ background: {c.border}; border-radius: 3px; margin: 2px; }}
    QScrollBar::handle:vertical {{ min-height: 28px; }}
    QScrollBar::handle:horizontal {{ min-width: 28px; }}
    QScrollBar::handle:hover {{ background: {c.disabled}; }}
    QScrollBar::add-line, QScrollBar::sub-line {{ width: 0; height: 0; }}
    QScrollBar::add-page, QScrollBar::sub-page {{ background: transparent; }}
    QScrollArea#panel_scroll, QWidget#panel_body {{ background: {c.panel}; border: none; }}
    QToolButton#section_header {{ border: none; text-align: left; font-weight: 600; padding: 4px 2px; }}
    QToolButton#section_header:hover {{ color: {c.accent}; }}
    QToolButton#section_header:focus {{ color: {c.accent}; }}
    QFrame#section_line {{ background: {c.border}; border: none; max-height: 1px; }}
    QLabel[quiet="true"] {{ color: {c.quiet}; }}
    QToolButton#reset_button {{ border: none; border-radius: 4px; padding: 1px; }}
    QToolButton#reset_button:hover {{ background: {c.border}; }}
    QToolButton#reset_button:focus {{ background: {c.border}; }}
    QToolTip {{
        background: {c.tooltip}; color: {c.tooltip_text}; border: 1px solid {c.border}; padding: 4px 6px;
    }}
    QFrame#palette {{ background: {c.panel}; border: 1px solid {c.border}; }}
    QFrame#palette QListView {{ background: {c.panel}; }}
    QLineEdit#palette_line {{
        background: {c.base}; border: 1px solid {c.border}; border-radius: 5px; padding: 5px 6px;
    }}
    QLineEdit#palette_line:focus {{ border-color: {c.accent}; }}
    QFrame#banner, QFrame#look_strip {{ background: {c.panel}; border: 1px solid {c.border}; border-radius: 6px; }}
    """


class Theme(QObject):
    """Puts a theme on the application and keeps following the system when asked to.

    Parameters
    ----------
    application : QApplication
        What is dressed.
    choice : {"system", "light", "dark"}
        Which theme.
    """

    about_to_change = Signal()
    """Emitted before all widgets get a new style sheet; hidden ones that can be made again may be deleted."""
    changed = Signal()

    def __init__(self, application: QApplication, choice: Choice = "system") -> None:
        super().__init__(application)
        self._application = application
        self._choice: Choice = choice
        self._shown: Colors | None = None
        application.setStyle("Fusion")
        application.styleHints().colorSchemeChanged.connect(self._on_scheme_changed)
        self._show()

    @property
    def choice(self) -> Choice:
        """What was chosen: a theme, or the system's."""
        return self._choice

    @choice.setter
    def choice(self, choice: Choice) -> None:
        if choice != self._choice:
            self._choice = choice
            self._show()

    @property
    def colors(self) -> Colors:
        """The colours that are shown now."""
        if self._choice == "system":
            scheme = self._application.styleHints().colorScheme()
            return DARK if scheme == Qt.ColorScheme.Dark else LIGHT
        return DARK if self._choice == "dark" else LIGHT

    def _on_scheme_changed(self) -> None:
        if self._choice == "system":
            self._show()

    def _show(self) -> None:
        if self.colors is self._shown:
            return
        self._shown = self.colors
        self.about_to_change.emit()
        self._application.setPalette(palette_of(self.colors))
        self._application.setStyleSheet(style_sheet(self.colors))
        icons.refresh()
        self.changed.emit()


def is_palette_change(event: QEvent) -> bool:
    """Whether a widget that paints itself must take other colours."""
    return event.type() in (QEvent.Type.PaletteChange, QEvent.Type.ApplicationPaletteChange)
