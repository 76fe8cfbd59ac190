"""Small public functions that only look things up or open a window."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from volviz.model.render_spec import DEFAULT_TECHNIQUE

if TYPE_CHECKING:
    from volviz.custom_gl.technique import TechniqueInfo
    from volviz.model.transfer.presets import Preset
    from volviz.volume_data.volume import Volume


def techniques() -> dict[str, TechniqueInfo]:
    """All rendering techniques by id, with label, summary and described settings."""
    from volviz.custom_gl.registry import techniques as registered

    return registered()


def presets() -> dict[str, Preset]:
    """All bundled transfer-function presets by id."""
    from volviz.model.transfer.presets import presets as bundled

    return bundled()


def show(
    volume: Volume, technique: str = DEFAULT_TECHNIQUE, *, transfer_function: Any = None, **settings: Any
) -> Any:
    """Show a volume: as a PyVista scene in a notebook, in a window elsewhere.

    Parameters
    ----------
    volume : Volume
        What to show.
    technique : str
        Id of the technique.
    transfer_function : TransferFunction, optional
        The default is made from the histogram.
    **settings
        Settings of the technique, light, crop and clip planes.

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
