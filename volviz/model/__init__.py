"""What is shown, as plain immutable values: no Qt, no OpenGL, no VTK."""
