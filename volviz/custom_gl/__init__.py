"""Drawing with our own GLSL inside VTK's window: the border to VTK, the GPU layer and the techniques."""
