"""Shapes as pixels over a picture, or as lines and words of an SVG or PDF file; Matplotlib draws."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
import numpy.typing as npt

from volviz.annotations.shapes import Area, Line, Ramp, Shape, Text
from volviz.new_files import written_beside

if TYPE_CHECKING:
    from matplotlib.figure import Figure

VECTOR_SUFFIXES = (".svg", ".pdf")
#: Pixels of a screen to an inch, and points of a printer.
SCREEN_DPI, POINTS = 96.0, 72.0
_BASELINES = {"top": "top", "middle": "center", "bottom": "bottom"}
_ALIGNMENTS = {"left": "left", "middle": "center", "right": "right"}
#: Width of the rim around letters, in ems.
RIM = 0.2


def surround(
    picture: npt.NDArray[np.float32],
    shapes: Sequence[Shape],
    origin: tuple[int, int] = (0, 0),
) -> npt.NDArray[np.float32]:
    """A part of a picture with the shapes behind and before it.

    Parameters
    ----------
    picture : ndarray of shape (H, W, 4), float32
        Premultiplied red, green, blue, alpha; row 0 at the top.
    shapes : sequence of Shape
        In pixels of the whole picture.
    origin : tuple of 2 ints
        Left and top of the part.

    Returns
    -------
    ndarray of shape (H, W, 4), float32
        Premultiplied.
    """
    height, width = picture.shape[:2]
    result = picture
    behind = [shape for shape in shapes if shape.behind]
    before = [shape for shape in shapes if not shape.behind]
    if behind:
        result = result + (1.0 - result[..., 3:]) * _pixels(behind, (width, height), origin)
    if before:
        over = _pixels(before, (width, height), origin)
        result = over + (1.0 - over[..., 3:]) * result
    return result


def _pixels(
    shapes: Sequence[Shape], size: tuple[int, int], origin: tuple[int, int]
) -> npt.NDArray[np.float32]:
    """Shapes on nothing, shape (H, W, 4), premultiplied."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    # lines are cut off at the edge of a figure and get their round ends there: the edge lies farther out
    pad = 2 + math.ceil(max((shape.width for shape in shapes if isinstance(shape, Line)), default=0.0))
    size, origin = (size[0] + 2 * pad, size[1] + 2 * pad), (origin[0] - pad, origin[1] - pad)
    figure = _figure(size, 1.0)
    canvas: Any = FigureCanvasAgg(figure)
    _draw(figure, shapes, size, origin, 1.0, rims=True)
    canvas.draw()
    inside = np.asarray(canvas.buffer_rgba())[pad:-pad, pad:-pad]
    pixels = inside.astype(np.float32) / np.float32(255.0)
    pixels[..., :3] *= pixels[..., 3:]
    return pixels


def is_vector(path: Path) -> bool:
    """Whether a file of that name holds lines and words as such."""
    return path.suffix.lower() in VECTOR_SUFFIXES


def write_picture(
    path: Path,
    picture: npt.NDArray[np.uint8],
    shapes: Sequence[Shape] = (),
    background: tuple[float, float, float] | npt.NDArray[np.uint8] | None = None,
    dpi: float = SCREEN_DPI,
    **options: Any,
) -> None:
    """Write a finished picture; in SVG and PDF files what stands around it is lines and words.

    Parameters
    ----------
    path : Path
        The file; its suffix says the format. What was there stays until the new file is complete.
    picture : ndarray of shape (H, W, 3 or 4), uint8
        Straight red, green, blue, alpha; row 0 at the top.
    shapes : sequence of Shape
        In pixels of the picture, for SVG and PDF; pixels hold them already.
    background : colour, ndarray of shape (H, 1, 3) uint8, or None
        What lies behind everything, likewise.
    dpi : float
        Pixels to an inch of paper.
    **options
        For Pillow's `save`.

    Raises
    ------
    VolvizError
        The file cannot be written.
    """
    with written_beside(path) as beside:
        if is_vector(path):
            with beside.open("wb") as file:
                _write_vector(file, path.suffix[1:].lower(), picture, shapes, background, dpi)
            return
        from PIL import Image

        Image.fromarray(picture).save(beside, dpi=(dpi, dpi), **options)


def _write_vector(
    file: BinaryIO,
    kind: str,
    picture: npt.NDArray[np.uint8],
    shapes: Sequence[Shape],
    background: tuple[float, float, float] | npt.NDArray[np.uint8] | None,
    dpi: float,
) -> None:
    from matplotlib import rc_context

    height, width = picture.shape[:2]
    unit = POINTS / dpi
    # words stay words; the same picture gives the same file
    with rc_context({"svg.fonttype": "none", "pdf.fonttype": 42, "svg.hashsalt": "volviz"}):
        figure = _figure((width, height), unit)
        if isinstance(background, tuple):
            figure.patch.set_visible(True)
            figure.patch.set_facecolor(background)
        elif background is not None:
            _place_image(figure, background, zorder=-1)
        behind = [shape for shape in shapes if shape.behind]
        before = [shape for shape in shapes if not shape.behind]
        _draw(figure, behind, (width, height), (0, 0), unit)
        _place_image(figure, picture, zorder=len(shapes))
        _draw(figure, before, (width, height), (0, 0), unit, first=len(shapes) + 1)
        date = {"Date": None} if kind == "svg" else {"CreationDate": None}
        # what is asked for here says whether the ground of the figure is seen
        figure.savefig(
            file, format=kind, dpi=POINTS, facecolor="auto", transparent=not figure.patch.get_visible(),
            metadata={"Creator": "VolViz", **date},
        )  # fmt: skip


def _figure(size: tuple[int, int], unit: float) -> Figure:
    """An empty figure, one of whose points is a pixel times the unit."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(size[0] * unit / POINTS, size[1] * unit / POINTS), dpi=POINTS)
    figure.patch.set_visible(False)
    return figure


def _place_image(figure: Figure, pixels: npt.NDArray[np.uint8], zorder: float) -> None:
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), zorder=zorder)
    axes.set_axis_off()
    axes.imshow(pixels, aspect="auto", interpolation="none")


def _draw(
    figure: Figure,
    shapes: Sequence[Shape],
    size: tuple[int, int],
    origin: tuple[int, int],
    unit: float,
    first: int = 0,
    *,
    rims: bool = False,
) -> None:
    """Add shapes to a figure; coordinates of Matplotlib go upwards from the lower left corner.

    Letters with rims are outlines and no words any more, so files with words have none.
    """
    from matplotlib.transforms import IdentityTransform

    def placed(points: Sequence[tuple[float, float]]) -> npt.NDArray[np.float64]:
        across, down = (np.asarray(points, float) - origin).T
        return np.stack([across, size[1] - down], axis=1) * unit

    for order, shape in enumerate(shapes, first):
        for artist in _artists(shape, placed, unit, rims):
            artist.set_transform(IdentityTransform())
            artist.set_zorder(order)
            figure.add_artist(artist)


def _artists(shape: Shape, placed: Any, unit: float, rims: bool) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Polygon
    from matplotlib.patheffects import withStroke
    from matplotlib.text import Text as Words

    if isinstance(shape, Line):
        across, upwards = placed(shape.points).T
        return [
            Line2D(across, upwards, color=shape.color, linewidth=shape.width * unit, solid_capstyle="round")
        ]
    if isinstance(shape, Area):
        return [Polygon(placed(shape.points), closed=True, facecolor=shape.color, linewidth=0)]
    if isinstance(shape, Ramp):
        edges = shape.top + shape.height * (1.0 - np.linspace(0.0, 1.0, len(shape.colors) + 1))
        strips = []
        for color, bottom in zip(shape.colors, edges[:-1], strict=True):
            # each reaches to the top, so that no seam is left between two
            corners = [
                (shape.left, bottom), (shape.left + shape.width, bottom),
                (shape.left + shape.width, shape.top), (shape.left, shape.top),
            ]  # fmt: skip
            strips.append(Polygon(placed(corners), closed=True, facecolor=color, linewidth=0))
        return strips
    assert isinstance(shape, Text)
    ((across, upwards),) = placed([shape.place])
    rim = [withStroke(linewidth=RIM * shape.size * unit, foreground=shape.rim)] if rims else None
    return [
        Words(
            across, upwards, shape.words, fontsize=shape.size * unit, color=shape.color,
            fontweight="bold" if shape.bold else "normal", ha=_ALIGNMENTS[shape.across],
            va=_BASELINES[shape.upright], parse_math=False,
            path_effects=rim,
        )
    ]  # fmt: skip
