"""Marching cubes and marching tetrahedra, with tables generated from the geometry of the cell."""

from __future__ import annotations

from volviz.kernels.marching.components import face_components, keep_components
from volviz.kernels.marching.extract import marching_cubes, warm_up

__all__ = ["marching_cubes", "face_components", "keep_components", "warm_up"]
