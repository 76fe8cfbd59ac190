"""Files that appear complete or not at all, and never in the place of another one in silence.

What is written lies beside its place under another name and is moved there at the end, so that a full disk, an error
or a cancel leave what was there before.
"""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from volviz.errors import InputError, VolvizError


def check_target(path: str | os.PathLike[str], *, overwrite: bool, folder: bool = False) -> Path:
    """The path, if something can be written there; asked before long work as well.

    Parameters
    ----------
    path : str or path
    overwrite : bool
        Whether what is there may be replaced; an empty file always may.
    folder : bool
        A folder is to be written, not a file.

    Raises
    ------
    InputError
        Something is there that is not to be replaced.
    VolvizError
        There is no such folder, or it cannot be written to.
    """
    target = Path(path)
    if not target.parent.is_dir():
        raise VolvizError(f"{target}: the folder {target.parent} does not exist; create it first.")
    if target.is_dir() and not folder:
        raise VolvizError(f"{target}: this is a folder; choose the name of a file.")
    if target.exists():
        holds_something = any(target.iterdir()) if target.is_dir() else target.stat().st_size > 0
        if not overwrite and holds_something:
            raise InputError(
                f"{target}: the {'folder' if target.is_dir() else 'file'} exists already; choose another name, or "
                "have it replaced (overwrite=True, --overwrite)."
            )
        if not os.access(target, os.W_OK):
            raise VolvizError(f"{target}: the file is protected; choose another name.")
    if not os.access(target.parent, os.W_OK):
        raise VolvizError(f"{target}: nothing can be written into this folder; choose another one.")
    return target


@contextmanager
def written_beside(target: Path, *, folder: bool = False) -> Iterator[Path]:
    """A new, empty file (or a name for a folder) beside its place, moved there at the end; nothing stays of a failure.

    Raises
    ------
    VolvizError
        The file cannot be written.
    """
    # writers choose the format by the ending
    part = target.with_name(f".{secrets.token_hex(4)}-{target.stem}{target.suffix.lower()}")
    try:
        if not folder:
            # not tempfile: its files are the user's alone, these get the rights that a new file of the user has
            part.open("xb").close()
            if target.exists():
                part.chmod(target.stat().st_mode & 0o777)
        yield part
        if folder and target.exists():
            _replace_folder(part, target)
        else:
            part.replace(target)
    except OSError as error:
        reason = (error.strerror or "unknown reason").lower()
        raise VolvizError(f"{target}: it cannot be written ({reason}); check the free space.") from None
    finally:
        if folder:
            shutil.rmtree(part, ignore_errors=True)
        else:
            with suppress(OSError):
                part.unlink(missing_ok=True)


def _replace_folder(part: Path, target: Path) -> None:
    """What was there goes when the new one is in its place."""
    old = target.with_name(f".{secrets.token_hex(4)}-{target.name}")
    target.rename(old)
    try:
        part.rename(target)
    except OSError:
        old.rename(target)
        raise
    if old.is_dir():
        shutil.rmtree(old, ignore_errors=True)
    else:
        old.unlink()
