"""Edits of a layer of labels: what is changed of it, as keywords of `dataclasses.replace`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from volviz.model.layers import Color, LabelLayer
from volviz.volume_data.description import Label


def hiding(layer: LabelLayer, labels: Iterable[int], *, hidden: bool) -> dict[str, Any]:
    """Some labels hidden, or shown again."""
    chosen = set(labels)
    before = set(layer.hidden)
    return {"hidden": before | chosen if hidden else before - chosen}


def alone(labels: Iterable[int], every: Iterable[int]) -> dict[str, Any]:
    """All but some labels hidden."""
    return {"hidden": set(every) - set(labels)}


def coloring(layer: LabelLayer, labels: Iterable[int], color: Color) -> dict[str, Any]:
    """Some labels in another colour."""
    return {"colors": {**dict(layer.colors), **dict.fromkeys(labels, color)}}


def naming(layer: LabelLayer, label: int, name: str) -> dict[str, Any]:
    """A label with another name; an empty one takes it away."""
    names = {**dict(layer.names), label: name.strip()}
    return {"names": {number: text for number, text in names.items() if text}}


def fading(layer: LabelLayer, labels: Iterable[int], opacity: float) -> dict[str, Any]:
    """Some labels with another opacity; 1 leaves no entry."""
    found = {**dict(layer.opacities), **dict.fromkeys(labels, opacity)}
    return {"opacities": {label: factor for label, factor in found.items() if factor < 1.0}}


def described(layer: LabelLayer, table: Iterable[Label]) -> dict[str, Any]:
    """Names and colours of a table for the labels that it knows; the others keep theirs."""
    names: Mapping[int, str] = {label.number: label.name for label in table if label.name}
    colors = {label.number: label.color for label in table if label.color is not None}
    return {"names": {**dict(layer.names), **names}, "colors": {**dict(layer.colors), **colors}}
