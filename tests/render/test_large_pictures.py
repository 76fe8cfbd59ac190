"""Pictures drawn in turns and in parts are the pictures drawn at once."""

from __future__ import annotations

import numpy as np
import pytest

import volviz
from tests.render.scenes import camera, function, volume
from volviz.errors import InputError, SettingError
from volviz.large_pictures import PictureInPieces

SIZE = (120, 90)


def drawn(pieces: PictureInPieces) -> tuple[np.ndarray, list[float], int]:
    """The picture, what was told of progress, and the number of parts."""
    width, height = pieces.size
    picture = np.full((height, width, 4), np.nan, np.float32)
    told, parts = [pieces.progress], 0
    try:
        while pieces.progress < 1.0:
            ready = pieces.advance(0.005)
            told.append(pieces.progress)
            if ready is not None:
                (x, y, w, h), pixels = ready
                assert pixels.shape == (h, w, 4)
                picture[y : y + h, x : x + w] = pixels
                parts += 1
        assert pieces.advance() is None
    finally:
        pieces.close()
        pieces.close()
    return picture, told, parts


def at_once(technique: str, parallel: bool) -> np.ndarray:
    of = volume()
    picture = volviz.render(
        of,
        technique,
        transfer_function=function(of),
        size=SIZE,
        camera=camera(of, parallel=parallel),
        dtype="float32",
    )
    picture[..., :3] *= picture[..., 3:]
    return picture


@pytest.mark.parametrize("technique", ["raycast", "slicing"])
@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("part", [None, 50])
def test_the_parts_are_those_of_the_picture_drawn_at_once(
    technique: str, parallel: bool, part: int | None
) -> None:
    of = volume()
    cut = {} if part is None else {"whole": part, "part": part}
    pieces = PictureInPieces(
        of, technique, SIZE, camera(of, parallel=parallel), transfer_function=function(of), **cut
    )
    picture, told, parts = drawn(pieces)
    assert parts == (1 if part is None else 3 * 2)
    assert told == sorted(told)
    assert (told[0], told[-1]) == (0.0, 1.0)
    np.testing.assert_allclose(picture, at_once(technique, parallel), atol=2e-3)
    assert picture[..., 3].max() > 0.3


def test_a_picture_that_is_given_up_leaves_nothing_behind() -> None:
    of = volume()
    pieces = PictureInPieces(of, "raycast", SIZE, camera(of), transfer_function=function(of))
    assert pieces.advance() is None
    pieces.close()


@pytest.mark.parametrize("size", [(0, 10), (10, 16385)])
def test_impossible_sizes_are_refused(size: tuple[int, int]) -> None:
    of = volume()
    with pytest.raises(InputError, match="between 1 and 16384"):
        PictureInPieces(of, "raycast", size, camera(of))


def test_unusable_settings_are_refused_and_nothing_stays_open() -> None:
    of = volume()
    with pytest.raises(SettingError):
        PictureInPieces(of, "raycast", SIZE, camera(of), step=-1.0)
