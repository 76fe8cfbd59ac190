"""Computations on plain arrays without state: NumPy and numba, no Qt, no OpenGL, no VTK.

Arrays are (Z, Y, X), geometry is (x, y, z). Compiled functions release the interpreter lock and are cached
on disk; where threads pay, the work is split over z by `volviz.kernels.threads`.
"""
