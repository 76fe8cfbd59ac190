"""Bundled presets: transfer functions with a name, what they are for, and how they adapt to other data."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from volviz.data_files import data_file
from volviz.errors import InputError, LoadError
from volviz.model.transfer.function import TransferFunction

if TYPE_CHECKING:
    from volviz.volume_data.volume import Volume

#: Version of the preset files that this program writes.
SCHEMA_VERSION = 1

#: What a HU preset spans: air, and the densest bone that still matters.
HU_AIR, HU_BONE = -1000.0, 1500.0
#: Stored values of CT without its rescale intercept lie this much above HU.
HU_OFFSET = 1024.0

Window = Literal["full", "robust"]


@dataclass(frozen=True)
class Preset:
    """A transfer function with a label, what it is for, and optionally how to draw it.

    Attributes
    ----------
    id : str
        Key of `volviz.presets`, name of the file.
    label, description : str
        For people: two or three words, and one sentence.
    transfer_function : TransferFunction
        In HU when `unit` is "HU", otherwise relative to the range of the data.
    modality : str
        "CT", "MRI", "microscopy", "any".
    unit : str
        "HU", or empty for relative functions.
    window : {"full", "robust"}
        What a relative function is spread over: the whole range, or the range without outliers.
    technique : str or None
        Id of the technique that the preset was made for.
    settings : mapping or None
        Settings of that technique; without one, settings for those techniques that light what they draw.
    """

    id: str
    label: str
    description: str
    transfer_function: TransferFunction
    modality: str = "any"
    unit: str = ""
    window: Window = "full"
    technique: str | None = None
    settings: Mapping[str, Any] | None = None

    def to_dict(self) -> dict[str, Any]:
        """Plain data for a preset file."""
        return {
            "schema": "volviz-preset",
            "version": SCHEMA_VERSION,
            "id": self.id,
            "label": self.label,
            "description": self.description,
            "modality": self.modality,
            "unit": self.unit,
            "window": self.window,
            "technique": self.technique,
            "settings": None if self.settings is None else dict(self.settings),
            "transfer_function": self.transfer_function.to_dict(),
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any], where: str = "preset") -> Preset:
        """The preset that `to_dict` described.

        Raises
        ------
        LoadError
            It is not a preset, was written by a newer program, or its function is unusable.
        """
        if "transfer_function" not in data:
            raise LoadError(f'{where}: not a preset of VolViz: it has no "transfer_function".')
        version = data.get("version", SCHEMA_VERSION)
        if not isinstance(version, int) or version > SCHEMA_VERSION:
            raise LoadError(
                f"{where}: preset version {version!r} is newer than this program knows ({SCHEMA_VERSION}); "
                "update VolViz."
            )
        try:
            function = TransferFunction.from_dict(data["transfer_function"])
        except InputError as error:
            raise LoadError(f"{where}: {error}") from None
        ident = str(data.get("id") or function.name or "preset")
        settings = data.get("settings")
        return cls(
            id=ident,
            label=str(data.get("label") or ident),
            description=str(data.get("description", "")),
            transfer_function=replace(function, name=function.name or ident),
            modality=str(data.get("modality", "any")),
            unit=str(data.get("unit", "")),
            window="robust" if data.get("window") == "robust" else "full",
            technique=None if data.get("technique") is None else str(data["technique"]),
            settings=dict(settings) if isinstance(settings, Mapping) else None,
        )


def read_preset(path: str | Path) -> Preset:
    """The preset in a file.

    Raises
    ------
    LoadError
        The file cannot be read or holds no preset.
    """
    path = Path(path)
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise LoadError(f"{path}: cannot be read ({error.strerror or error}).") from None
    except ValueError:
        raise LoadError(f"{path}: not a preset of VolViz: it is not JSON.") from None
    if not isinstance(data, dict):
        raise LoadError(f"{path}: not a preset of VolViz: it is a {type(data).__name__}, not an object.")
    return Preset.from_dict(data, str(path))


@lru_cache(maxsize=1)
def _bundled() -> dict[str, Preset]:
    folder = data_file("presets")
    loaded = []
    for path in sorted(folder.glob("*.json")):
        order = json.loads(path.read_text(encoding="utf-8")).get("order", 1000)
        loaded.append((order, read_preset(path)))
    loaded.sort(key=lambda pair: (pair[0], pair[1].id))
    return {preset.id: preset for _, preset in loaded}


def presets() -> dict[str, Preset]:
    """The bundled presets by id, in the order in which to show them."""
    return dict(_bundled())


def preset(ident: str) -> Preset:
    """The bundled preset of that id.

    Raises
    ------
    InputError
        There is none; near names are suggested.
    """
    known = _bundled()
    if ident in known:
        return known[ident]
    from difflib import get_close_matches

    near = get_close_matches(ident, known, n=3)
    hint = f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(known)}."
    raise InputError(f"there is no preset called {ident!r}; {hint}")


def preset_for(chosen: Preset | str, volume: Volume) -> TransferFunction:
    """The function of a preset in the data units of a volume.

    HU presets keep their values where the data are in HU, or look so; on CT whose rescale intercept is
    missing they are moved by 1024; on anything else air and bone are spread over the range of the data
    without outliers. Relative presets are spread over the range of the data.

    Parameters
    ----------
    chosen : Preset or str
        A preset or the id of a bundled one.
    volume : Volume
        The data to show.

    Returns
    -------
    TransferFunction
        With the domain "data" and the preset's name.
    """
    if isinstance(chosen, str):
        chosen = preset(chosen)
    function = chosen.transfer_function
    if function.domain == "relative":
        return function.resolved(_window(volume, chosen.window))
    if chosen.unit != "HU" or looks_like_hu(volume):
        return function
    if looks_like_shifted_hu(volume):
        return function.shifted(HU_OFFSET)
    low, high = _window(volume, "robust")
    factor = (high - low) / (HU_BONE - HU_AIR)
    return function.stretched(factor, HU_AIR).shifted(low - HU_AIR)


def looks_like_hu(volume: Volume) -> bool:
    """Whether the values are Hounsfield units: the unit says so, or the range is that of air to bone."""
    if volume.unit:
        return volume.unit.strip().upper() == "HU"
    low, high = volume.data_range
    return -3100.0 <= low <= -700.0 and 300.0 <= high <= 40000.0


def looks_like_shifted_hu(volume: Volume) -> bool:
    """Whether the values are CT stored with an offset of 1024: most of what is not air lies near there."""
    low, high = volume.data_range
    if volume.unit or volume.array.dtype.kind not in "iu" or low < -200.0 or not 1500.0 <= high <= 5000.0:
        return False
    from volviz.model.transfer.first_look import sample_values

    values = sample_values(volume)
    dense = values[values > 500.0]
    if len(dense) < 0.02 * len(values):
        return False
    return float(((dense > 900.0) & (dense < 1200.0)).mean()) > 0.4


def offset_of_hu(volume: Volume) -> float | None:
    """What is added to HU in the data, None when they are no CT."""
    if looks_like_hu(volume):
        return 0.0
    return HU_OFFSET if looks_like_shifted_hu(volume) else None


def _window(volume: Volume, window: Window) -> tuple[float, float]:
    low, high = volume.data_range
    if window == "robust":
        from volviz.model.transfer.first_look import robust_range

        low, high = robust_range(volume)
    return (low, high) if low < high else (low, low + 1.0)
