"""The user's own presets: one JSON file each in a folder of the user's settings."""

from __future__ import annotations

import json
import re
import unicodedata
from dataclasses import replace
from pathlib import Path

from volviz.errors import InputError, LoadError
from volviz.model.transfer.presets import Preset, read_preset


class OwnPresets:
    """Saves, renames and deletes presets; every change is on disk when the call returns.

    Parameters
    ----------
    folder : str or Path, optional
        Where the files lie; default: ``presets`` in the user's settings folder of VolViz.
    """

    def __init__(self, folder: str | Path | None = None) -> None:
        if folder is None:
            from platformdirs import user_config_path

            folder = user_config_path("volviz", appauthor=False) / "presets"
        self.folder = Path(folder)

    def all(self) -> dict[str, Preset]:
        """Presets by label, sorted; files that are damaged are left out (see `damaged`)."""
        return dict(sorted(((p.label, p) for p, _ in self._read()[0]), key=lambda pair: pair[0].casefold()))

    def damaged(self) -> list[str]:
        """One sentence for each file that holds no usable preset."""
        return self._read()[1]

    def save(self, preset: Preset, label: str) -> Preset:
        """Store a preset under a label, in place of an older one of that label.

        Returns
        -------
        Preset
            As stored.

        Raises
        ------
        InputError
            The label is empty.
        LoadError
            The folder cannot be written to.
        """
        label = " ".join(label.split())
        if not label:
            raise InputError("a preset needs a name.")
        path = self._path_of(label)
        ident = "own:" + (path.stem if path is not None else self._free_name(label))
        stored = replace(
            preset, id=ident, label=label, transfer_function=replace(preset.transfer_function, name=label)
        )
        self._write(path if path is not None else self.folder / f"{ident[4:]}.json", stored)
        return stored

    def rename(self, label: str, new: str) -> Preset:
        """Give a preset another label.

        Raises
        ------
        InputError
            There is none of the old label, or already one of the new.
        LoadError
            The folder cannot be written to.
        """
        path = self._known(label)
        if new != label and self._path_of(" ".join(new.split())) is not None:
            raise InputError(f"there already is a preset called {new!r}; choose another name.")
        stored = self.save(read_preset(path), new)
        if new != label:
            path.unlink(missing_ok=True)
        return stored

    def delete(self, label: str) -> None:
        """Remove a preset.

        Raises
        ------
        InputError
            There is none of that label.
        LoadError
            The file cannot be removed.
        """
        path = self._known(label)
        try:
            path.unlink()
        except OSError as error:
            raise LoadError(f"{path}: cannot be removed ({error.strerror or error}).") from None

    def _read(self) -> tuple[list[tuple[Preset, Path]], list[str]]:
        found, damaged = [], []
        for path in sorted(self.folder.glob("*.json")) if self.folder.is_dir() else []:
            try:
                found.append((read_preset(path), path))
            except LoadError as error:
                damaged.append(str(error))
        return found, damaged

    def _path_of(self, label: str) -> Path | None:
        return next((path for preset, path in self._read()[0] if preset.label == label), None)

    def _known(self, label: str) -> Path:
        path = self._path_of(label)
        if path is None:
            raise InputError(f"there is no preset of your own called {label!r}.")
        return path

    def _free_name(self, label: str) -> str:
        plain = unicodedata.normalize("NFKD", label).encode("ascii", "ignore").decode().lower()
        stem = re.sub(r"[^a-z0-9]+", "-", plain).strip("-")[:60] or "preset"
        name, number = stem, 2
        while (self.folder / f"{name}.json").exists():
            name, number = f"{stem}-{number}", number + 1
        return name

    def _write(self, path: Path, preset: Preset) -> None:
        text = json.dumps(preset.to_dict(), indent=1, ensure_ascii=False) + "\n"
        partial = path.with_suffix(".partial")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            partial.write_text(text, encoding="utf-8")
            # In one step, so that a crash leaves the old or the new preset, never half of one.
            partial.replace(path)
        except OSError as error:
            raise LoadError(f"{path}: cannot be written ({error.strerror or error}).") from None
