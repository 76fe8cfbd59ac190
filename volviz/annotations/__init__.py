"""What stands around the volume in a picture, as shapes in pixels, and how they are drawn into files."""
