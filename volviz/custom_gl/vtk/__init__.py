"""The border to VTK: our images inside VTK's window."""

from __future__ import annotations

from volviz.custom_gl.vtk.adding import add_spec, add_volume
from volviz.custom_gl.vtk.frame_scheduling import FrameScheduler, FrameStatus, Quality
from volviz.custom_gl.vtk.handle import VolumeHandle, handles_of

__all__ = [
    "FrameStatus",
    "FrameScheduler",
    "Quality",
    "VolumeHandle",
    "add_spec",
    "add_volume",
    "handles_of",
]
