"""Comparison with VTK: matching of settings, metrics of pictures and meshes, timing, reports."""
