"""A picture of one or several views, put together tile by tile with what stands around the volume."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from volviz.annotations.background import GROUND, background_image
from volviz.annotations.figure import surround
from volviz.annotations.margins import title
from volviz.annotations.picture import shapes_around
from volviz.annotations.shapes import Shape, moved
from volviz.annotations.style import Style
from volviz.annotations.subject import Subject
from volviz.custom_gl.offscreen import finished
from volviz.model.picture import Picture, PictureContents, PicturePart
from volviz.model.scene import Scene

#: Height of a line above a view in a picture of several, and of a title above all of them, in pixels of a screen.
CAPTION, TITLE = 26, 34


class Composition:
    """Takes tiles of views and gives the picture; tiles may be taken in any order, on any thread.

    Parameters
    ----------
    scene : Scene
        With a camera in each view that is seen.
    picture : Picture
    subjects : sequence of Subject or None
        What annotations tell of, for each part of the picture.
    is_vector : bool
        What stands around is drawn as lines and words by whoever writes the file: the pixels hold the volume alone.
    """

    def __init__(
        self, scene: Scene, picture: Picture, subjects: Sequence[Subject | None], *, is_vector: bool = False
    ) -> None:
        self._scene, self.picture, self._is_vector = scene, picture, is_vector
        self._is_opaque = not picture.transparent
        pairs = zip(picture.parts, subjects, strict=True)
        self._around = [self._shapes(part, subject) for part, subject in pairs]
        width, height = picture.size
        self._column = background_image(scene.background, (1, height))
        self._pixels = np.zeros((height, width, 4), np.uint8)
        if self._has_ground:
            self._pixels[..., :3], self._pixels[..., 3] = np.rint(self._column * 255.0), 255

    @property
    def _has_ground(self) -> bool:
        """Whether the background is among the pixels."""
        return self._is_opaque and not self._is_vector

    @property
    def _ground(self) -> tuple[float, float, float] | None:
        """What lies behind, as far as the colour of letters asks for it."""
        return self._scene.background or GROUND if self._is_opaque else None

    def _shapes(self, part: PicturePart, subject: Subject | None) -> tuple[Shape, ...]:
        """What stands around the volume of a part, in its own pixels."""
        camera = self._scene.view_at(part.view).camera
        if subject is None or camera is None:
            return ()
        contents = self.picture.contents
        if len(self.picture.parts) > 1:
            # one title stands above all of them, and both sides of a wipe would write over one another
            contents = PictureContents(box=contents.box) if part.is_cut else replace(contents, title="")
        return shapes_around(contents, subject, camera, part.size, background=self._ground, scale=part.scale)

    def take(self, number: int, region: tuple[int, int, int, int], pixels: npt.NDArray[np.float32]) -> None:
        """Put a tile where it belongs.

        Parameters
        ----------
        number : int
            Which part of the picture it shows some of.
        region : tuple of 4 ints
            Left, top, width and height within the part.
        pixels : ndarray of shape (height, width, 4), float32
            Premultiplied; row 0 at the top.
        """
        part, x, y = self.picture.parts[number], region[0], region[1]
        top = part.place[1] + y
        first = max(part.seen[0] - part.place[0] - x, 0)
        last = min(part.seen[1] - part.place[0] - x, pixels.shape[1])
        if first >= last:
            return
        left = part.place[0] + x + first
        around = () if self._is_vector else self._around[number]
        shown = (surround(pixels, around, (x, y)) if around else pixels)[:, first:last]
        if self._has_ground:
            behind = self._column[top : top + len(shown)]
            colors = shown[..., :3] + (1.0 - shown[..., 3:]) * behind
            shown = np.concatenate([colors, np.ones_like(shown[..., 3:])], axis=2)
        self._pixels[top : top + len(shown), left : left + last - first] = finished(shown, None, "uint8")

    # ------------------------------------------------------------------ the picture

    def image(self, *, alpha: bool = False) -> npt.NDArray[np.uint8]:
        """The picture.

        Parameters
        ----------
        alpha : bool
            With alpha also where nothing is transparent.

        Returns
        -------
        ndarray of shape (H, W, 3 or 4), uint8
            With alpha where it is asked for or needed; row 0 at the top.
        """
        captions = self._captions()
        shown = self._pixels
        if captions and not self._is_vector:
            whole = shown.astype(np.float32) / np.float32(255.0)
            whole[..., :3] *= whole[..., 3:]
            shown = finished(surround(whole, captions), None, "uint8")
        return shown[..., :3] if self._has_ground and not alpha else shown

    @property
    def shapes(self) -> list[Shape]:
        """What a file of lines and words draws around the pixels; nothing for others."""
        if not self._is_vector:
            return []
        parts = zip(self.picture.parts, self._around, strict=True)
        found = [moved(shape, part.place[0], part.place[1]) for part, around in parts for shape in around]
        return found + self._captions()

    @property
    def ground(self) -> Any:
        """What such a file draws behind them: a colour, the gradient as a column of pixels (H, 1, 3), or None."""
        if not (self._is_vector and self._is_opaque):
            return None
        return self._scene.background or np.rint(self._column * 255.0).astype(np.uint8)

    def _captions(self) -> list[Shape]:
        """Lines above the parts, and the title of all, in pixels of the picture."""
        picture = self.picture
        if len(picture.parts) == 1:
            return []
        scale = picture.parts[0].scale
        style = Style(scale, self._ground)
        shapes: list[Shape] = []
        for part in picture.parts:
            place = ((part.seen[0] + part.seen[1]) / 2, part.place[1] - 0.5 * CAPTION * scale)
            shapes.append(style.text(part.caption, place, across="middle", bold=True))
        if picture.contents.title:
            shapes += title(picture.contents.title, picture.size, style)
        return shapes
