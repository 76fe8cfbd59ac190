"""The border to VTK: our pictures inside VTK's window."""

from __future__ import annotations

from volviz.custom_gl.host.adding import add_spec, add_volume
from volviz.custom_gl.host.handle import VolumeHandle, handles_of
from volviz.custom_gl.host.pacing import FrameStatus, Pacer, Quality

__all__ = [
    "FrameStatus",
    "Pacer",
    "Quality",
    "VolumeHandle",
    "add_spec",
    "add_volume",
    "handles_of",
]
