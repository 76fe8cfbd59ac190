"""Opening from a URL: stores are read where they are, any other file is downloaded first."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit
from urllib.request import url2pathname

from volviz.errors import LoadError
from volviz.io import zarr
from volviz.io.download import downloaded
from volviz.io.file_source import told_in_a_sentence

if TYPE_CHECKING:
    from volviz.io.file_source import FileSource
    from volviz.io.reader import LoadRequest


def name_in(address: str) -> str:
    """What the last part of a URL calls the data; the server where there is none."""
    parts = urlsplit(address)
    # separators that were written as codes are none of a path on this machine
    name = unquote(parts.path.rstrip("/").rpartition("/")[2]).replace("/", "_").replace("\\", "_")
    return name if name.strip(". ") else parts.netloc or "download"


def open_address(
    request: LoadRequest, opening: Callable[[LoadRequest], FileSource], suffixes: tuple[str, ...]
) -> FileSource:
    """What lies at a URL.

    Parameters
    ----------
    request : LoadRequest
        With an address.
    opening : callable(LoadRequest) -> FileSource
        Opens a file on this machine.
    suffixes : tuple of str
        Endings of single files: what ends otherwise may be a store.

    Raises
    ------
    LoadError, Cancelled
    """
    address = request.address
    if address.lower().startswith("file:"):
        return opening(replace(request, path=Path(url2pathname(urlsplit(address).path)), address=""))
    name = request.path.name.lower()
    if zarr.is_store_address(address):
        with told_in_a_sentence(request):
            return zarr.open_source(request)
    if not name.endswith(suffixes):
        try:
            with told_in_a_sentence(request):
                return zarr.open_source(request)
        except LoadError:
            # no store: a file without an ending that is known; if there is nothing at all, the download says so
            request.notes.clear()
    return opening(replace(request, path=downloaded(request)))
