"""HDF5 and what is built on it: Imaris, BigDataViewer, NeXus, ilastik, ITK, MATLAB 7.3, by h5py."""

from volviz.io.hdf5.opening import open_source, sniff

__all__ = ["open_source", "sniff"]
