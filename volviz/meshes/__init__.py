"""Triangle meshes: extraction from a volume, filters, figures, files."""
