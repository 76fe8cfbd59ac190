"""`volviz.render`: a picture of a volume as an array, without any window or display."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from volviz.errors import InputError
from volviz.framing import default_camera
from volviz.model.camera import Camera
from volviz.model.clipping import Clipping
from volviz.model.light import Light
from volviz.model.render_spec import DEFAULT_TECHNIQUE
from volviz.model.transfer_function import TransferFunction
from volviz.model.volume import Volume

if TYPE_CHECKING:
    from volviz.custom_gl.host import VolumeHandle

MAX_SIZE = 16384


def render(
    volume: Volume,
    technique: str = DEFAULT_TECHNIQUE,
    *,
    transfer_function: TransferFunction | None = None,
    size: tuple[int, int] = (800, 600),
    camera: Camera | Sequence[Any] | None = None,
    background: Sequence[float] | str | None = None,
    dtype: Literal["uint8", "float32"] = "uint8",
    settings: Any = None,
    light: Light | None = None,
    clipping: Clipping | None = None,
    classic: bool = False,
    **values: Any,
) -> npt.NDArray[Any]:
    """A picture of a volume, drawn off-screen at full quality.

    Parameters
    ----------
    volume : Volume
        What to show.
    technique : str, default: "raycast"
        Id of a technique (`volviz.techniques`).
    transfer_function : TransferFunction, optional
        The default is made from the volume's histogram.
    size : tuple of 2 ints, default: (800, 600)
        Width and height in pixels, 1..16384.
    camera : Camera or triple, optional
        A `volviz.Camera`, or position, focal point and view up as PyVista writes them (view angle 30
        degrees).
    background : colour, optional
        Three floats 0..1 or a colour name makes the picture opaque; None gives straight alpha.
    dtype : {"uint8", "float32"}
        Values 0..255, or 0..1 without rounding.
    settings, light, clipping, classic, **values
        As for `volviz.add_volume`.

    Returns
    -------
    ndarray of shape (H, W, 4)
        Red, green, blue, alpha (straight, not premultiplied); row 0 at the top.

    Raises
    ------
    VolvizError
        Unusable arguments, or no usable OpenGL.
    """
    if dtype not in ("uint8", "float32"):
        raise InputError(f'dtype of a picture is "uint8" or "float32", got {dtype!r}.')
    width, height = checked_size(size)
    color = background_color(background)
    view = None if camera is None else Camera.coerce(camera)
    premultiplied = _draw(
        volume, technique, (width, height), view,
        dict(
            transfer_function=transfer_function, settings=settings, light=light, clipping=clipping,
            classic=classic, **values,
        ),
    )  # fmt: skip
    return finished(premultiplied, color, dtype)


def finished(
    premultiplied: npt.NDArray[np.float32], background: tuple[float, float, float] | None, dtype: str
) -> npt.NDArray[Any]:
    """A premultiplied float picture over a background (or with straight alpha), as uint8 or float32."""
    alpha = premultiplied[..., 3:]
    if background is not None:
        rgb = premultiplied[..., :3] + (1.0 - alpha) * np.asarray(background, np.float32)
        alpha = np.ones_like(alpha)
    else:
        rgb = np.divide(
            premultiplied[..., :3], alpha, out=np.zeros_like(premultiplied[..., :3]), where=alpha > 1e-6
        )
    picture = np.concatenate([rgb, alpha], axis=-1)
    if dtype == "float32":
        return picture.astype(np.float32)
    pixels: npt.NDArray[np.uint8] = np.rint(np.clip(picture, 0.0, 1.0) * 255.0).astype(np.uint8)
    return pixels


def apply_camera(target: Any, camera: Camera) -> None:
    """Give a `vtkCamera` the values of a `Camera`; the clipping range is left to the renderer."""
    target.SetPosition(*camera.position)
    target.SetFocalPoint(*camera.focal_point)
    target.SetViewUp(*camera.view_up)
    target.SetViewAngle(camera.view_angle)
    target.SetParallelProjection(camera.parallel)
    target.SetParallelScale(camera.scale)


def _draw(
    volume: Volume, technique: str, size: tuple[int, int], camera: Camera | None, arguments: dict[str, Any]
) -> npt.NDArray[np.float32]:
    from volviz.custom_gl.host import add_volume
    from volviz.custom_gl.host.vtk_border import pyvista

    plotter = pyvista.Plotter(
        off_screen=True, window_size=list(size), notebook=False, theme=pyvista.themes.Theme()
    )
    handle: VolumeHandle | None = None
    try:
        window = plotter.render_window
        assert window is not None
        window.SetMultiSamples(0)
        handle = add_volume(plotter, volume, technique, **arguments)
        if camera is None:
            camera = default_camera(volume, size, transfer_function=handle.drawn_function)
        apply_camera(plotter.camera, camera)
        plotter.reset_camera_clipping_range()
        plotter.show(auto_close=False, interactive=False)
        handle.raise_error()
        picture: npt.NDArray[np.float32] = handle.read_picture()
        return picture
    finally:
        if handle is not None:
            handle.remove()
        plotter.close()


def checked_size(size: Sequence[int]) -> tuple[int, int]:
    """Width and height of a picture in pixels.

    Raises
    ------
    InputError
        Not two numbers, or more than `MAX_SIZE`.
    """
    try:
        width, height = (int(n) for n in size)
    except (TypeError, ValueError):
        raise InputError(f"size must be two whole numbers (width, height) in pixels, got {size!r}.") from None
    if not (1 <= width <= MAX_SIZE and 1 <= height <= MAX_SIZE):
        raise InputError(f"size must lie between 1 and {MAX_SIZE} pixels each way, got {width} x {height}.")
    return width, height


def background_color(background: Sequence[float] | str | None) -> tuple[float, float, float] | None:
    """A colour from three floats 0..1, a name or #rrggbb; None stays None.

    Raises
    ------
    InputError
        It is none of these.
    """
    if background is None:
        return None
    if isinstance(background, str):
        from volviz.custom_gl.host.vtk_border import pyvista

        try:
            r, g, b = pyvista.Color(background).float_rgb
        except ValueError:
            raise InputError(
                f"background {background!r} is no colour; use a name, #rrggbb or three floats."
            ) from None
        return r, g, b
    try:
        r, g, b = (float(c) for c in background)
    except (TypeError, ValueError):
        raise InputError(f"background must be three numbers between 0 and 1, got {background!r}.") from None
    if not all(0.0 <= c <= 1.0 for c in (r, g, b)):
        raise InputError(f"background must be three numbers between 0 and 1, got {background!r}.")
    return r, g, b
