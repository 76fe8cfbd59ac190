"""Triangle meshes: extraction from a volume, filters, metrics, files."""
