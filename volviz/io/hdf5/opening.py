"""From an HDF5 file to a source."""

from __future__ import annotations

from typing import TYPE_CHECKING

from volviz.io.endings import HDF5
from volviz.io.entries import choose_entry
from volviz.io.hdf5.axes import lattice_of, nexus_default
from volviz.io.hdf5.bigdataviewer import bigdataviewer_source, data_of, is_bigdataviewer, xml_of
from volviz.io.hdf5.finding import candidates
from volviz.io.hdf5.imaris import imaris_source, is_imaris
from volviz.io.hdf5.reading import StoredDataset, on_thread, opened, text
from volviz.io.hdf5.vtkhdf import is_vtkhdf, vtkhdf_source
from volviz.io.pyramid import StoredLevel, pyramid_source
from volviz.io.reader import HEAD_BYTES, stem
from volviz.volume_data.references import content_id

if TYPE_CHECKING:
    from pathlib import Path

    import h5py

    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest


_MAGIC = b"\x89HDF\r\n\x1a\n"
_DESCRIPTION = b"<SpimData"


def sniff(head: bytes, path: Path) -> bool:
    """Whether this is an HDF5 file, or the XML of a BigDataViewer data set.

    The superblock may follow a block of the user's, of MATLAB's for one.
    """
    del path
    return _DESCRIPTION in head or any(head[at : at + len(_MAGIC)] == _MAGIC for at in (0, 512, 1024, 2048))


def open_source(request: LoadRequest) -> FileSource:
    """The data set that is asked for; else the one that NeXus names, or the largest."""
    with request.path.open("rb") as stream:
        if _DESCRIPTION in stream.read(HEAD_BYTES):
            return _open_xml(request)

    def work() -> FileSource:
        with opened(request.path) as file:
            if is_imaris(file):
                return imaris_source(request, file, HDF5)
            if is_vtkhdf(file):
                return vtkhdf_source(request, file, HDF5)
            if is_bigdataviewer(file):
                beside = request.path.with_suffix(".xml")
                xml = xml_of(beside) if beside.is_file() else None
                return bigdataviewer_source(request, request.path, file, xml, HDF5)
            return _dataset_source(request, file)

    return on_thread(request, work)


def _open_xml(request: LoadRequest) -> FileSource:
    """The data set that an XML of BigDataViewer describes."""
    xml = xml_of(request.path)
    data = data_of(xml, request.path)

    def work() -> FileSource:
        with opened(data) as file:
            if not is_bigdataviewer(file):
                raise request.error("this HDF5 file is none of BigDataViewer.", data)
            return bigdataviewer_source(request, data, file, xml, HDF5)

    return on_thread(request, work, data)


def _dataset_source(request: LoadRequest, file: h5py.File) -> FileSource:
    entries = candidates(file)
    if not entries:
        raise request.error(
            "it holds no data set of numbers with three axes or more; a volume needs z, y and x."
        )
    names = [entry.name for entry in entries]
    default = nexus_default(file)
    if request.hints.series is None and default in names:
        chosen = entries[names.index(default)]
        if len(entries) > 1:
            request.note(f"The data set {chosen.words}, which NeXus names as the one to show, is shown.")
    else:
        chosen = entries[choose_entry(request, entries, what="data set")]
    dataset = file[chosen.name]
    lattice = lattice_of(request, dataset)
    stored = StoredDataset(request.path, chosen.name)
    return pyramid_source(
        request,
        lattice.axes,
        [StoredLevel(chosen.sizes, lattice.geometry, stored.read)],
        dataset.dtype,
        colour=lattice.colour,
        unit=_value_unit(dataset),
        length_unit=lattice.length_unit,
        format="HDF5",
        name=stem(request.path, HDF5),
        content=content_id(str(request.path)),
        entries=entries,
    )


def _value_unit(dataset: h5py.Dataset) -> str:
    """Unit of the values, which NeXus writes beside a signal."""
    if "element_size_um" in dataset.attrs or "resolution" in dataset.attrs:
        return ""
    return text(dataset.attrs.get("units", ""))[:20]
