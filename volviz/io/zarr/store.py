"""A store of keys and bytes (folder, zip file, address): its nodes and their arrays, by tensorstore."""

from __future__ import annotations

import atexit
import hashlib
import json
import os
import shutil
import tempfile
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.errors import LoadError
    from volviz.io.pyramid import Index
    from volviz.io.reader import LoadRequest

#: Bytes of decoded chunks that all stores together keep.
CACHE_BYTES = 256 << 20

#: Bytes that are asked for at once: large enough for whole chunks, small enough to tell the progress.
_PIECE = 16 << 20

#: Pieces that are on their way at the same time.
_AHEAD = 3

#: Metadata longer than this is none.
_METADATA_BYTES = 64 << 20

#: Files that describe a node, in the order in which they count.
_V3, _ARRAY, _ATTRIBUTES, _GROUP, _N5, _INFO = (
    "zarr.json", ".zarray", ".zattrs", ".zgroup", "attributes.json", "info",
)  # fmt: skip
METADATA_FILES = (_V3, _ARRAY, _ATTRIBUTES, _GROUP, _N5, _INFO)

_S3_VARIABLES = ("AWS_ACCESS_KEY_ID", "AWS_PROFILE", "AWS_WEB_IDENTITY_TOKEN_FILE")


@cache
def shared_context() -> Any:
    """The one context of tensorstore: all arrays share its threads and its cache."""
    import tensorstore

    spec: dict[str, Any] = {
        "cache_pool": {"total_bytes_limit": CACHE_BYTES},
        # by itself it tries for minutes before it says that a server does not answer
        "http_request_retries": {"max_retries": 3, "initial_delay": "200ms", "max_delay": "2s"},
        "s3_request_retries": {"max_retries": 3, "initial_delay": "200ms", "max_delay": "2s"},
        "gcs_request_retries": {"max_retries": 3, "initial_delay": "200ms", "max_delay": "2s"},
    }
    if not any(name in os.environ for name in _S3_VARIABLES) and not Path("~/.aws").expanduser().exists():
        spec["aws_credentials"] = {"type": "anonymous"}
    return tensorstore.Context(spec)


@dataclass(frozen=True)
class Node:
    """A group or an array of a store.

    Attributes
    ----------
    path : str
        Inside the store, without slashes at its ends; empty for the root.
    driver : str
        Of tensorstore ("zarr", "zarr3", "n5", "neuroglancer_precomputed"); empty for a group.
    metadata : dict
        Of the array.
    attributes : dict
        What the user says about it.
    """

    path: str
    driver: str = ""
    metadata: dict[str, Any] = field(default_factory=dict)
    attributes: dict[str, Any] = field(default_factory=dict)

    @property
    def is_array(self) -> bool:
        """Whether it is an array."""
        return bool(self.driver)

    @property
    def ome(self) -> dict[str, Any]:
        """Metadata of OME: under a name of its own since version 0.5."""
        own = self.attributes.get("ome")
        return own if isinstance(own, dict) else self.attributes

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes as stored, as far as they are readable."""
        found = self.metadata.get("dimensions" if self.driver == "n5" else "shape")
        whole = isinstance(found, list) and all(isinstance(n, int) and n >= 0 for n in found)
        return tuple(found) if whole and found else ()

    @property
    def dtype(self) -> str:
        """Name of the type of its values; empty for what is no number."""
        key = {"zarr": "dtype", "n5": "dataType"}.get(self.driver, "data_type")
        try:
            kind = np.dtype(self.metadata.get(key))
        except (TypeError, ValueError):
            return ""
        return kind.name if kind.kind in "buifc" and self.metadata.get(key) is not None else ""


class Store:
    """What a request names, as a store.

    Parameters
    ----------
    request : LoadRequest
    base : dict
        Spec of a key-value store of tensorstore.
    folder, archive : Path, optional
        Where it lies on this machine, for what only a list of names tells.
    """

    def __init__(
        self,
        request: LoadRequest,
        base: dict[str, Any],
        *,
        folder: Path | None = None,
        names: Sequence[str] | None = None,
        prefix: str = "",
    ) -> None:
        import tensorstore

        self.request = request
        self._base = base
        self._folder = folder
        self._names = names
        self._prefix = prefix
        self._digest = hashlib.sha1(usedforsecurity=False)
        try:
            self._keys = request.wait(tensorstore.KvStore.open(base, context=shared_context()))
        except ValueError as error:
            raise sentence(request, error, "the store") from None

    @classmethod
    def of(cls, request: LoadRequest) -> Store:
        """The store of a request: its folder, zip file or address."""
        if request.is_remote:
            return cls(request, _remote(request))
        path = _readable(request.path.resolve())
        if path.is_dir():
            return cls(request, {"driver": "file", "path": f"{path}/"}, folder=path)
        try:
            with zipfile.ZipFile(path) as archive:
                names = archive.namelist()
        except (zipfile.BadZipFile, ValueError, NotImplementedError):
            raise request.error("this zip file is damaged or cut off; get it again.") from None
        return cls(
            request,
            {"driver": "zip", "base": {"driver": "file", "path": str(path)}},
            names=names,
            prefix=root_in_zip(names) or "",
        )

    @property
    def content(self) -> str:
        """What changes when metadata that was read changes."""
        return self._digest.hexdigest()

    def node(self, path: str) -> Node | None:
        """The node at a path; None where there is none.

        Raises
        ------
        LoadError
            Its metadata is unreadable.
        """
        path = path.strip("/")
        found = self._metadata(path)
        if (own := found.get(_V3)) is not None:
            attributes = own.get("attributes")
            return Node(
                path, "zarr3" if own.get("node_type") == "array" else "", own,
                attributes if isinstance(attributes, dict) else {},
            )  # fmt: skip
        attributes = found.get(_ATTRIBUTES) or {}
        if (own := found.get(_ARRAY)) is not None:
            return Node(path, "zarr", own, attributes)
        if _GROUP in found or _ATTRIBUTES in found:
            return Node(path, "", found.get(_GROUP) or {}, attributes)
        if (own := found.get(_N5)) is not None:
            return Node(path, "n5" if "dimensions" in own else "", own, own)
        if (own := found.get(_INFO)) is not None and isinstance(own.get("scales"), list):
            return Node(path, "neuroglancer_precomputed", own)
        return None

    def children(self, path: str) -> list[str] | None:
        """Names of the nodes in a group, None where the store cannot list them."""
        path = path.strip("/")
        if self._folder is not None:
            with os.scandir(self._folder / path) as entries:
                return sorted(entry.name for entry in entries if entry.is_dir())
        if self._names is not None:
            start = f"{self._prefix}{path}/" if path else self._prefix
            inside = [name[len(start) :] for name in self._names if name.startswith(start)]
            return sorted({name.split("/")[0] for name in inside if "/" in name})
        return None

    def consolidated(self) -> list[str] | None:
        """Paths of all nodes of the store, where its root keeps a list."""
        found = self._metadata("", (".zmetadata", _V3))
        listed = (found.get(".zmetadata") or {}).get("metadata")
        if isinstance(listed, dict):
            return sorted({str(key).rpartition("/")[0] for key in listed} - {""})
        inline = (found.get(_V3) or {}).get("consolidated_metadata")
        listed = inline.get("metadata") if isinstance(inline, dict) else None
        return sorted(map(str, listed)) if isinstance(listed, dict) else None

    def array(self, node: Node, **extra: Any) -> StoredArray:
        """The array of a node.

        Raises
        ------
        LoadError
            It cannot be opened.
        """
        import tensorstore

        inside = f"{self._prefix}{node.path}/" if node.path else self._prefix
        kvstore = {**self._base, "path": self._base.get("path", "") + inside}
        spec = {
            "driver": node.driver,
            "kvstore": kvstore,
            # what has changed since the cache was filled is read again; asking a server each time takes too long
            "recheck_cached_data": "open" if self.request.is_remote else True,
            **extra,
        }
        if node.driver == "zarr":
            spec |= {"assume_metadata": True, "metadata": _as_specified(node.metadata)}
        what = f"the array '{node.path}'" if node.path else "the array"
        try:
            opened = self.request.wait(tensorstore.open(spec, context=shared_context(), read=True))
        except (ValueError, OverflowError, TypeError) as error:
            raise sentence(self.request, error, what) from None
        return StoredArray(opened, what)

    def _metadata(self, path: str, names: Sequence[str] = METADATA_FILES) -> dict[str, dict[str, Any]]:
        """What the metadata files of a node hold, those alone that are there."""
        start = self._prefix + (f"{path}/" if path else "")
        reads = {name: self._keys.read(start + name) for name in names}
        found: dict[str, dict[str, Any]] = {}
        for name, future in reads.items():
            try:
                result = self.request.wait(future)
            except ValueError as error:
                # a server may refuse what is not there, or answer with something else
                if self.request.is_remote and name != names[0]:
                    continue
                raise sentence(self.request, error, f"'{start}{name}'") from None
            if result.state != "value":
                continue
            own = _parsed(result.value)
            if own is None:
                if name in (_INFO, _N5) or self.request.is_remote:
                    # any file may be called so; a server may have a page for everything
                    continue
                raise self.request.error(f"its metadata '{start}{name}' is unreadable; the store is damaged.")
            self._digest.update(result.value)
            found[name] = own
        return found


class StoredArray:
    """An array of a store, of which parts are read."""

    def __init__(self, opened: Any, what: str) -> None:
        self._array = opened
        self._what = what

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes as they are stored."""
        return tuple(int(n) for n in self._array.shape)

    @property
    def dtype(self) -> np.dtype[Any]:
        """Of the values."""
        kind: np.dtype[Any] = np.dtype(self._array.dtype.numpy_dtype)
        return kind

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the axes as far as the array has them."""
        return tuple(str(label) for label in self._array.domain.labels)

    @property
    def opened(self) -> Any:
        """Tensorstore's own object."""
        return self._array

    def read(self, index: Index, request: LoadRequest) -> npt.NDArray[Any]:
        """Values of a number or slice along each axis, chunk by chunk: only those chunks are read that it touches."""
        first = np.asarray(self._array.domain.origin)
        shape = tuple(i.stop - i.start for i in index if isinstance(i, slice))
        values: npt.NDArray[Any] = np.empty(shape, self.dtype)
        # the pieces follow one another along the first axis that is not a number
        at = next(n for n, i in enumerate(index) if isinstance(i, slice))
        whole = index[at]
        assert isinstance(whole, slice)
        step = self._step(at, values.nbytes // max(shape[0], 1))
        edges = sorted({whole.start, *range((whole.start // step + 1) * step, whole.stop, step), whole.stop})
        pending: list[tuple[int, int, Any]] = []
        try:
            for low, high in zip(edges, [*edges[1:], None], strict=True):
                if high is not None:
                    part = list(index)
                    part[at] = slice(low, high)
                    moved = tuple(
                        slice(i.start + int(o), i.stop + int(o)) if isinstance(i, slice) else i + int(o)
                        for i, o in zip(part, first, strict=True)
                    )
                    pending.append((low, high, self._array[moved].read()))
                while pending and (high is None or len(pending) >= _AHEAD):
                    begin, end, future = pending.pop(0)
                    request.report((begin - whole.start) / len(values), "reading")
                    values[begin - whole.start : end - whole.start] = request.wait(future)
        except ValueError as error:
            raise sentence(request, error, self._what) from None
        finally:
            for _, _, future in pending:
                future.cancel()
        return values

    def _step(self, axis: int, bytes_each: int) -> int:
        """Entries along an axis that are asked for at once: whole chunks, some megabytes."""
        chunk = max(int(self._array.chunk_layout.read_chunk.shape[axis]), 1)
        return chunk * max(_PIECE // max(chunk * bytes_each, 1), 1)


def root_in_zip(names: Sequence[str]) -> str | None:
    """The folder in a zip file that is a store, with a slash at its end; None where there is none."""
    found = [name for name in names if name.rpartition("/")[2] in METADATA_FILES[:5]]
    if not found:
        return None
    shortest = min(found, key=lambda name: name.count("/"))
    folder, slash, _ = shortest.rpartition("/")
    return folder + slash


def _remote(request: LoadRequest) -> dict[str, Any]:
    scheme, _, rest = request.address.partition("://")
    rest = rest.rstrip("/") + "/"
    if scheme in ("http", "https"):
        return {"driver": "http", "base_url": f"{scheme}://{rest}"}
    bucket, _, path = rest.partition("/")
    return {"driver": {"gs": "gcs"}.get(scheme, scheme), "bucket": bucket, "path": path}


def _readable(path: Path) -> Path:
    """The path, or a link to it where its name is no text: tensorstore takes text alone."""
    try:
        str(path).encode()
    except UnicodeEncodeError:
        link = Path(tempfile.mkdtemp(prefix="volviz-")) / "store"
        link.symlink_to(path)
        atexit.register(shutil.rmtree, link.parent, ignore_errors=True)
        return link
    return path


def _as_specified(metadata: dict[str, Any]) -> dict[str, Any]:
    """Metadata of a Zarr v2 array without what some programs write and tensorstore refuses."""
    known = ("zarr_format", "shape", "chunks", "dtype", "compressor", "fill_value", "order", "filters")
    found = {name: metadata[name] for name in known if name in metadata}
    found["dimension_separator"] = metadata.get("dimension_separator", ".")
    found["filters"] = found.get("filters") or None
    compressor = found.get("compressor")
    if isinstance(compressor, dict) and compressor.get("level") == -1:
        # "as the library likes": it matters to who writes
        found["compressor"] = {name: value for name, value in compressor.items() if name != "level"}
    return found


def _parsed(text: bytes) -> dict[str, Any] | None:
    if len(text) > _METADATA_BYTES:
        return None
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return None
    return found if isinstance(found, dict) else None


def sentence(request: LoadRequest, error: Exception, what: str) -> LoadError:
    """One sentence for what tensorstore complains about."""
    # behind the reason stands a description of the array with words of its own
    words = str(error).partition("[tensorstore_spec=")[0] if isinstance(error, ValueError) else "metadata"
    lower = words.lower()
    if "curl error" in lower or words.startswith(("UNAVAILABLE", "DEADLINE_EXCEEDED", "ABORTED")):
        told = "the server does not answer; check the address and the network."
    elif "permission" in lower or " 401" in lower or " 403" in lower:
        told = f"you may not read {what}; check its permissions."
    elif words.startswith("NOT_FOUND"):
        told = f"{what} is not there, though its metadata names it; the store is incomplete, copy it again."
    elif words.startswith("RESOURCE_EXHAUSTED"):
        told = f"{what} does not fit into memory; read a smaller box."
    elif "dtype" in lower or "data_type" in lower or "data type" in lower:
        told = f"{what} holds values of a type that cannot be shown; save them as integers or real numbers."
    elif any(
        word in lower for word in ("compressor", "codec", "filters", "unsupported", "not supported")
    ) and (not words.startswith(("DATA_LOSS", "OUT_OF_RANGE")) and "decod" not in lower):
        told = (
            f"{what} is packed in a way that cannot be read; save it again as Zarr with zstd, blosc or gzip."
        )
    elif "metadata" in lower or "parsing" in lower or "json" in lower:
        told = f"the metadata of {what} cannot be understood; the store is damaged or of an unusual kind."
    else:
        told = f"a chunk of {what} is damaged or cut off; copy the store again."
    return request.error(told)
