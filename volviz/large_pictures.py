"""Pictures drawn a little at a time, so that a window stays alive meanwhile; large ones in parts."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.model.camera import Camera
from volviz.model.surface_values import SurfaceColors
from volviz.model.volume import Volume
from volviz.offscreen import apply_camera, checked_size

#: Pictures up to this edge are one part; larger ones are cut into parts of `PART` pixels an edge. A part is held as
#: 32-bit floats with depth, which a whole picture of 16384 x 16384 pixels would need 5 GB for.
WHOLE = 2048
PART = 1024

Region = tuple[int, int, int, int]


class PictureInPieces:
    """Draws a volume off-screen in short turns.

    Parameters
    ----------
    volume : Volume
        What to show.
    technique : str
        Id of a technique.
    size : tuple of 2 ints
        Width and height in pixels, 1..16384.
    camera : Camera
        Where to look from.
    whole, part : int
        Largest edge of a picture that is not cut, and edge of a part otherwise, in pixels.
    surface_colors : SurfaceColors, optional
        Values that the surface is coloured by (`VolumeHandle.color_surface`).
    **arguments
        As for `volviz.add_volume`.

    Raises
    ------
    VolvizError
        Unusable arguments, or no usable OpenGL.
    """

    def __init__(
        self,
        volume: Volume,
        technique: str,
        size: tuple[int, int],
        camera: Camera,
        *,
        whole: int = WHOLE,
        part: int = PART,
        surface_colors: SurfaceColors | None = None,
        **arguments: Any,
    ) -> None:
        from volviz.custom_gl.host import add_volume
        from volviz.custom_gl.host.vtk_border import pyvista

        self.size = width, height = checked_size(size)
        edge = (width, height) if max(size) <= whole else (min(part, width), min(part, height))
        self._edge = edge
        self._corners = [(x, y) for y in range(0, height, edge[1]) for x in range(0, width, edge[0])]
        self._done = 0
        self._begun = False
        self._handle: Any = None
        self._plotter: Any = pyvista.Plotter(
            off_screen=True, window_size=list(edge), notebook=False, theme=pyvista.themes.Theme()
        )
        try:
            window: Any = self._plotter.render_window
            window.SetMultiSamples(0)
            self._handle = add_volume(self._plotter, volume, technique, pacer=_Patience(), **arguments)
            self._handle.color_surface(surface_colors)
            apply_camera(self._plotter.camera, camera)
            self._plotter.reset_camera_clipping_range()
        except BaseException:
            self.close()
            raise
        view = self._plotter.camera
        matrix = view.GetProjectionTransformMatrix(width / height, -1, 1)
        self._projection = np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])

    @property
    def progress(self) -> float:
        """Part that is ready, 0..1."""
        if self._done == len(self._corners):
            return 1.0
        within = self._handle.status.progress if self._begun else 0.0
        # 1 is said of the coarse picture too with which each part begins
        return (self._done + (within if within < 1.0 else 0.0)) / len(self._corners)

    def advance(self, seconds: float = 0.03) -> tuple[Region, npt.NDArray[np.float32]] | None:
        """Draw for about that long; a part of the picture when one is ready.

        Returns
        -------
        tuple or None
            Left, top, width and height of the part in the picture, and its pixels, shape (height, width, 4),
            float32, premultiplied, row 0 at the top. None when no part is ready yet; call again until `progress` is 1.

        Raises
        ------
        VolvizError
            Whatever drawing raised.
        """
        if self._done == len(self._corners):
            return None
        if not self._begun:
            self._begin()
            return None
        ready = self._handle.refine(budget=seconds)
        self._handle.raise_error()
        if not ready:
            return None
        pixels = self._handle.read_picture()
        x, y = self._corners[self._done]
        width, height = (min(e, n - c) for e, n, c in zip(self._edge, self.size, (x, y), strict=True))
        self._done += 1
        self._begun = False
        return (x, y, width, height), pixels[:height, :width]

    def _begin(self) -> None:
        """Look at the next part."""
        self._begun = True
        x, y = self._corners[self._done]
        if self._edge != self.size:
            self._look_at(x, y)
        if self._done == 0:
            self._plotter.show(auto_close=False, interactive=False)
        else:
            self._plotter.render()
        self._handle.raise_error()

    def _look_at(self, x: int, y: int) -> None:
        """Let the projection be that of a part, with the pixels of the whole picture."""
        from volviz.custom_gl.host.vtk_border import vtkMatrix4x4

        (width, height), (part_width, part_height) = self.size, self._edge
        scale = np.array([width / part_width, height / part_height])
        # middle of the part in normalised device coordinates of the whole picture
        middle = np.array([2 * (x + part_width / 2) / width - 1, 1 - 2 * (y + part_height / 2) / height])
        cut = np.eye(4)
        cut[0, 0], cut[1, 1] = scale
        cut[:2, 3] = -scale * middle
        values = cut @ self._projection
        matrix = vtkMatrix4x4()
        for i in range(4):
            for j in range(4):
                matrix.SetElement(i, j, float(values[i, j]))
        camera = self._plotter.camera
        camera.SetExplicitProjectionTransformMatrix(matrix)
        camera.UseExplicitProjectionTransformMatrixOn()

    def close(self) -> None:
        """Release everything; a second call does nothing."""
        handle, self._handle = self._handle, None
        if handle is not None:
            handle.remove()
        plotter, self._plotter = self._plotter, None
        if plotter is not None:
            plotter.close()


class _Patience:
    """The pacer of pictures that are asked for piece by piece anyway."""

    def request(self, handle: object) -> None:
        """`PictureInPieces.advance` comes back by itself."""

    def wake(self, handle: object) -> None:
        """The same holds when work in the background has ended."""
