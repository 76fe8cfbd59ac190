"""Which looks suit a volume, the best one first."""

from __future__ import annotations

from threading import Lock
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from volviz.errors import InputError
from volviz.model.looks.ct import looks_of_ct
from volviz.model.looks.evidence import Evidence
from volviz.model.looks.fields import looks_of_distances, looks_of_field
from volviz.model.looks.labels import looks_of_labels
from volviz.model.looks.look import Look
from volviz.model.looks.scans import looks_of_scan
from volviz.model.transfer.automatic import auto_transfer_function

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

_lock = Lock()
_known: WeakKeyDictionary[Volume, dict[str, Look]] = WeakKeyDictionary()


def looks(volume: Volume) -> dict[str, Look]:
    """Ways of showing a volume, chosen from its values.

    Parameters
    ----------
    volume : Volume
        Any data: CT, MRI, microscopy, industrial CT, simulation, distances, labels.

    Returns
    -------
    dict of str to Look
        Four to six by id, the best one first; one for a volume that is the same everywhere.
    """
    with _lock:
        known = _known.get(volume)
    if known is None:
        known = {look.id: look for look in _chosen(volume)}
        with _lock:
            _known[volume] = known
    return dict(known)


def best_look(volume: Volume) -> Look:
    """The first of its `looks`."""
    return next(iter(looks(volume).values()))


def look_named(volume: Volume, name: str) -> Look:
    """The look of that id, or the best one for "best".

    Raises
    ------
    InputError
        The volume has no such look.
    """
    known = looks(volume)
    if name == "best":
        return best_look(volume)
    if name not in known:
        raise InputError(f"{volume.name} has no look {name!r}; there are best, {', '.join(known)}.")
    return known[name]


def _chosen(volume: Volume) -> list[Look]:
    evidence = Evidence.of(volume)
    if evidence is None:
        return [Look("tissue", "Tissue", "The only value.", auto_transfer_function(volume))]
    if evidence.hu_offset is not None:
        return looks_of_ct(evidence, evidence.hu_offset)
    if evidence.labels is not None:
        return looks_of_labels(evidence, evidence.labels)
    if evidence.is_distance:
        return looks_of_distances(evidence)
    if evidence.is_field and not evidence.is_mirrored:
        return looks_of_field(evidence)
    return looks_of_scan(evidence)
