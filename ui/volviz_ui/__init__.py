"""The desktop program: a window on the library `volviz`."""
