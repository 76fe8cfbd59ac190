"""The middle of the window: views of the scene, each a viewport with what stands around the volume."""
