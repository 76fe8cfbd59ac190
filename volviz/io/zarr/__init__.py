"""OME-Zarr 0.1 to 0.5, plain Zarr (v2, v3), N5 and Neuroglancer precomputed, from folders, zip files and addresses.

Sources: "OME-Zarr specification" 0.4 and 0.5 (ngff.openmicroscopy.org), "Zarr core specification" v2 and v3
(zarr-specs.readthedocs.io), N5 (github.com/saalfeldlab/n5), "Neuroglancer precomputed format"
(neuroglancer-docs.web.app). The arrays themselves are read by tensorstore.
"""

from volviz.io.zarr.opening import is_store_address, open_source, sniff

__all__ = ["is_store_address", "open_source", "sniff"]
