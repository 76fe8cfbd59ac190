"""Small public functions that only look things up or open a window."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from volviz.custom_gl.technique import TechniqueInfo
    from volviz.model.transfer.presets import Preset
    from volviz.volume_data.volume import Volume


def techniques() -> dict[str, TechniqueInfo]:
    """All rendering techniques by id.

    Returns
    -------
    dict of str to TechniqueInfo
        In the order in which they are listed. ``label`` and ``summary`` are words for people, ``parameters`` the
        described settings (name, kind, limits, unit, default).
    """
    from volviz.custom_gl.registry import techniques as registered

    return registered()


def presets() -> dict[str, Preset]:
    """All bundled transfer-function presets by id.

    Returns
    -------
    dict of str to Preset
        The values of ``transfer_function`` are in Hounsfield units where ``unit`` is "HU", else fractions 0..1 of the
        data's range; ``window`` says of which range.
    """
    from volviz.model.transfer.presets import presets as bundled

    return bundled()


def show(
    volume: Volume, technique: str | None = None, *, transfer_function: Any = None, **settings: Any
) -> Any:
    """Show a volume: as a PyVista scene in a notebook, in a window elsewhere.

    Parameters
    ----------
    volume : Volume
        What to show.
    technique : str, optional
        Id of the technique.
    transfer_function : TransferFunction, optional
        The default is made from the histogram.
    **settings
        Settings of the technique, light, crop, clip planes and look, as for `volviz.add_volume`.

    Returns
    -------
    object
        What `pyvista.Plotter.show` returns.
    """
    from volviz.custom_gl.vtk import add_volume
    from volviz.custom_gl.vtk.vtk_imports import pyvista

    plotter = pyvista.Plotter()
    add_volume(plotter, volume, technique=technique, transfer_function=transfer_function, **settings)
    return plotter.show()
