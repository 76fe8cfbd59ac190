"""Which images and arrays a store holds: multiscale images, their labels, plates, series, plain arrays."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from volviz.errors import InputError
from volviz.io.entries import Entry

if TYPE_CHECKING:
    from volviz.io.reader import LoadRequest
    from volviz.io.zarr.store import Node, Store

#: Images and groups that are looked at; plates can have many thousands.
_LOOKED_AT = 500

_DEPTH = 5


@dataclass(frozen=True)
class Found:
    """An image or array in a store."""

    node: Node
    entry: Entry


def find(store: Store, request: LoadRequest) -> list[Found]:
    """All images of a store, at least one.

    Raises
    ------
    LoadError
        It is no store, or holds nothing with three axes.
    InputError
        There is no such image as ``series=`` names.
    """
    root = store.node("")
    if root is None:
        where = "at this address" if request.is_remote else "in it"
        raise request.error(f"there is no Zarr, N5 or precomputed metadata {where}; check the path.")
    wanted = request.hints.series
    if isinstance(wanted, str) and wanted.strip("/") and not wanted.isdecimal():
        # a store may hold too many images to look at all of them
        node = _node_or_none(store, wanted)
        if node is not None and (node.is_array or is_multiscale(node)):
            return [Found(node, _entry(store, node, wanted.strip("/")))]
    found = []
    for node in _images(store, root, request):
        request.check_cancelled()
        entry = _entry(store, node)
        if not entry.sizes or sum(n > 1 for n in entry.sizes) >= 3 or len(entry.sizes) < 3:
            found.append(Found(node, entry))
        if len(found) >= _LOOKED_AT:
            request.note(f"The store holds more than {_LOOKED_AT} images; name others by their path.")
            break
    if not found:
        if wanted is not None:
            raise InputError(f"{request.path.name}: there is no image {wanted!r} in it.")
        if store.children("") is None and store.consolidated() is None and not root.is_array:
            raise request.error(
                "this group does not list what it holds, nor does its server; add the path of an array to it."
            )
        raise request.error("it holds no array with three axes or more; a volume needs x, y and z.")
    return found


def is_multiscale(node: Node) -> bool:
    """Whether a group is an image with levels."""
    return isinstance(node.ome.get("multiscales"), list) and bool(node.ome["multiscales"])


def _images(store: Store, root: Node, request: LoadRequest) -> Iterator[Node]:
    ome = root.ome
    if root.is_array:
        yield root
    elif is_multiscale(root):
        yield root
        yield from _labels(store, root)
    elif isinstance(ome.get("plate"), dict):
        request.note("It is a plate with wells; an image is one field of one well.")
        for path in _paths(ome["plate"].get("wells")):
            well = _node_or_none(store, path)
            if well is not None:
                yield from _fields(store, well)
    elif isinstance(ome.get("well"), dict):
        yield from _fields(store, root)
    elif "bioformats2raw.layout" in ome:
        yield from _series(store)
    else:
        yield from _below(store, root)


def _labels(store: Store, image: Node) -> Iterator[Node]:
    start = f"{image.path}/labels".strip("/")
    group = _node_or_none(store, start)
    for name in (group.ome.get("labels") if group is not None else None) or ():
        node = _node_or_none(store, f"{start}/{name}") if isinstance(name, str) else None
        if node is not None and is_multiscale(node):
            yield node


def _fields(store: Store, well: Node) -> Iterator[Node]:
    described = well.ome.get("well")
    for path in _paths(described.get("images") if isinstance(described, dict) else None):
        node = _node_or_none(store, f"{well.path}/{path}")
        if node is not None and is_multiscale(node):
            yield node


def _series(store: Store) -> Iterator[Node]:
    """Images of a converted file: by their list, else numbered from 0."""
    group = _node_or_none(store, "OME")
    listed = group.ome.get("series") if group is not None else None
    names = [str(name) for name in listed] if isinstance(listed, list) else map(str, range(_LOOKED_AT))
    for name in names:
        node = _node_or_none(store, name)
        if node is None:
            if not isinstance(listed, list):
                return
        elif is_multiscale(node):
            yield node


def _below(store: Store, root: Node) -> Iterator[Node]:
    """Images and arrays of a plain group, breadth first."""
    listed = store.consolidated()
    if listed is not None:
        nodes = (node for path in listed if (node := _node_or_none(store, path)) is not None)
        images: list[str] = []
        for node in nodes:
            if is_multiscale(node):
                images.append(node.path + "/")
            if (node.is_array and not node.path.startswith(tuple(images))) or is_multiscale(node):
                yield node
        return
    waiting = [(root, 0)]
    looked_at = 0
    while waiting:
        group, depth = waiting.pop(0)
        for name in store.children(group.path) or ():
            looked_at += 1
            if looked_at > 20 * _LOOKED_AT:
                return
            node = _node_or_none(store, f"{group.path}/{name}")
            if node is None:
                continue
            if node.is_array or is_multiscale(node):
                yield node
            elif depth < _DEPTH:
                waiting.append((node, depth + 1))


def _paths(listed: Any) -> Iterator[str]:
    for each in listed if isinstance(listed, list) else ():
        path = each.get("path") if isinstance(each, dict) else None
        if isinstance(path, str) and path.strip("/"):
            yield path


def _node_or_none(store: Store, path: str) -> Node | None:
    inside = [part for part in path.split("/") if part]
    return None if ".." in inside else store.node("/".join(inside))


def _entry(store: Store, node: Node, name: str | None = None) -> Entry:
    """What is told of a node where one chooses."""
    name = node.path if name is None else name
    if not is_multiscale(node):
        return Entry(name, node.shape, node.dtype)
    first = node.ome["multiscales"][0]
    datasets = first.get("datasets") if isinstance(first, dict) else None
    path = next(_paths(datasets), None)
    array = _node_or_none(store, f"{node.path}/{path}") if path is not None else None
    title = first.get("name") if isinstance(first, dict) else None
    title = title if isinstance(title, str) and title not in (name, "/") else ""
    labels = "image-label" in node.ome
    if array is None:
        return Entry(name, title=title, is_labels=labels)
    return Entry(name, array.shape, array.dtype, title=title, is_labels=labels)
