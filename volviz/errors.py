"""One family of errors: every message is a single sentence that says what, where and what to do."""

from __future__ import annotations


class VolvizError(Exception):
    """Something the user can understand and mend; the command line prints it and exits with status 2."""


class LoadError(VolvizError):
    """A file, folder or array cannot become a volume."""


class InputError(VolvizError, ValueError):
    """An argument is outside what is accepted (a ``ValueError`` as well, for callers that expect one)."""


class SettingError(InputError):
    """A technique has no such setting, or the value does not fit it."""


class RenderError(VolvizError):
    """Drawing failed: no usable OpenGL, a shader that does not compile, an image that does not fit."""


class ShaderError(RenderError):
    """A shader does not compile or link.

    Parameters
    ----------
    message : str
        One sentence that names file and line.
    file : str
        Name of the GLSL file in which the first error lies.
    line : int
        Line in that file, counted from 1; 0 when the driver names none.
    log : str
        The driver's own words.
    """

    def __init__(self, message: str, *, file: str = "", line: int = 0, log: str = "") -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.log = log


class Cancelled(VolvizError):
    """Long work was cancelled by the user; nothing was changed."""
