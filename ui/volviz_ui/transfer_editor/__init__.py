"""The editor of the transfer function: curve over histogram, colours, presets."""

from volviz_ui.transfer_editor.editor import TransferEditor

__all__ = ["TransferEditor"]
