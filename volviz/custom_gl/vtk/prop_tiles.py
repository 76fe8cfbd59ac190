"""Pieces of an image that VTK draws in about the same short time, whatever a pixel costs."""

from __future__ import annotations

import math

from volviz.custom_gl.technique import Tile

#: Seconds that a piece may take: less than a turn of the event loop.
PIECE_SECONDS = 0.025
#: Pieces are not made smaller than this many pixels: each costs some milliseconds by itself.
FEWEST_PIXELS = 96
#: Share of the pieces of the last image that were as quick as the estimate.
QUICK_SHARE = 0.85
#: Width below which pieces are not cut.
NARROW = 64


class TileSizes:
    """Cuts tiles by what pixels cost in the last image.

    Parameters
    ----------
    seconds_per_pixel : float
        Guess before anything was measured.
    """

    def __init__(self, seconds_per_pixel: float) -> None:
        self.seconds_per_pixel = seconds_per_pixel
        self._costs: list[float] = []

    def begin(self) -> None:
        """A new image: what was measured of the last one counts from now on."""
        if len(self._costs) >= 4:
            # the slowest are those with a shader to compile or a volume to upload
            self.seconds_per_pixel = sorted(self._costs)[int(QUICK_SHARE * len(self._costs))]
        self._costs.clear()

    def note(self, piece: Tile, seconds: float) -> None:
        """A piece took so long."""
        self._costs.append(seconds / max(piece[2] * piece[3], 1))

    def cut(self, tiles: tuple[Tile, ...]) -> list[Tile]:
        """The tiles in pieces that should take `PIECE_SECONDS`; from the bottom of each tile upwards."""
        pixels = max(PIECE_SECONDS / max(self.seconds_per_pixel, 1e-12), FEWEST_PIXELS)
        pieces: list[Tile] = []
        for x, y, width, height in tiles:
            columns = 1 if pixels >= 4 * width else max(math.ceil(width / NARROW), 1)
            rows = max(min(int(pixels * columns / width), height), 1)
            across = math.ceil(width / columns)
            pieces += [
                (left, low, min(across, x + width - left), min(rows, y + height - low))
                for low in range(y, y + height, rows)
                for left in range(x, x + width, across)
            ]
        return pieces
