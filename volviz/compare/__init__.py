"""Comparison with VTK: matching of settings, metrics of images and meshes, timing, reports."""
