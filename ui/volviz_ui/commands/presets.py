"""The presets of the transfer function as commands; no menu shows them, the command palette does."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QObject

from volviz.model.transfer.presets import presets
from volviz_ui.commands.command import Command, Menu, has_volume
from volviz_ui.library_words import translated
from volviz_ui.transfer_editor import TransferEditor


class PresetsOfFunction(QObject):
    """Puts presets on the data."""

    def __init__(self, editor: TransferEditor) -> None:
        super().__init__(editor)
        self._editor = editor

    def menu(self) -> Menu:
        """The presets of the user first, then the bundled ones."""
        return Menu(self.tr("Preset"), self._presets)

    def _presets(self) -> list[Command]:
        take = self._editor.commands.take
        own = self._editor.own_presets.all()
        named = [(f"preset.own.{name}", preset) for name, preset in own.items()]
        named += [(f"preset.{name}", preset) for name, preset in presets().items()]
        return [
            Command(
                ident, translated(preset.label).replace("&", "&&"), translated(preset.description or preset.label),
                partial(take, preset),
                enabled=has_volume,
            )
            for ident, preset in named
        ]  # fmt: skip
