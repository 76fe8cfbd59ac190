"""Which parts of a volume that does not fit are needed, are being read and lie in an atlas; neither Qt nor OpenGL."""
