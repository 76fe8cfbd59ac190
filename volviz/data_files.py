"""Where bundled data lie: the same in a checkout, an installed wheel and a frozen program."""

from __future__ import annotations

import os
from importlib.resources import files
from pathlib import Path

from volviz.errors import LoadError

#: Environment variable that names another folder of bundled data.
OVERRIDE = "VOLVIZ_DATA"


def data_folder() -> Path:
    """Folder of the bundled data: the override, else `volviz/data` of a wheel, else `data` of the checkout.

    Raises
    ------
    LoadError
        None of them is there.
    """
    override = os.environ.get(OVERRIDE)
    if override:
        return Path(override)
    package = Path(str(files("volviz")))
    for folder in (package / "data", package.parent / "data"):
        if folder.is_dir():
            return folder
    raise LoadError(
        f"the bundled data of VolViz are missing beside {package}; install it again or set {OVERRIDE} "
        "to their folder."
    )


def data_file(*parts: str) -> Path:
    """Path of a bundled file or folder.

    Parameters
    ----------
    *parts : str
        Path below the data folder, ``data_file("presets", "ct-bone.json")``.

    Raises
    ------
    LoadError
        There is no such file.
    """
    path = data_folder().joinpath(*parts)
    if not path.exists():
        raise LoadError(
            f"the bundled file {'/'.join(parts)} is missing in {data_folder()}; install VolViz again."
        )
    return path
