"""Movies in files: frames that are those of the renderer, work that goes on after a kill, films that others play."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import volviz
from tests.render.scenes import function, volume
from volviz.cli import main
from volviz.custom_gl.scene_techniques import drawn_spec
from volviz.errors import Cancelled, InputError
from volviz.model.layers import ImageLayer
from volviz.model.movie import Movie, Step
from volviz.model.movies.moves import Cut, Play, Turn
from volviz.model.movies.timeline import Timeline
from volviz.model.render_spec import View
from volviz.model.scene import Scene
from volviz.model.transfer.function import TransferFunction
from volviz.movies.drawing import MovieFile, write_movie
from volviz.scene_volumes import SceneVolumes, framed, holds_scene, load_scene
from volviz.volume_data.array_source import ArraySource
from volviz.volume_data.references import reference_to

SIZE = (64, 48)
TURN = Movie((Step((Turn(360.0, "z"),), 0.5, "even"),), fps=12)


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    of = volume()
    volviz.save(of, tmp_path / "field.nrrd")
    layer = ImageLayer(reference_to(tmp_path / "field.nrrd", {}), function(of))
    return Scene((layer,), background=(0.0, 0.0, 0.0), movie=TURN)


def pixels(path: Path) -> np.ndarray:
    with Image.open(path) as picture:
        return np.asarray(picture.convert("RGB"))


def test_numbered_frames_are_what_the_renderer_draws(scene: Scene, tmp_path: Path) -> None:
    movie = MovieFile(scene, tmp_path / "frames" / "%02d.png", SIZE)
    assert write_movie(movie) == 6
    volumes = SceneVolumes()
    start = framed(scene, volumes.of(scene), SIZE)
    now = Timeline(start, volumes.surroundings(start)).frame(2)
    with volviz.Renderer(SIZE) as renderer:
        image = renderer.draw(drawn_spec(now), View(now.view.camera, SIZE, (0.0, 0.0, 0.0)), volumes.of(now))
    np.testing.assert_array_equal(pixels(tmp_path / "frames" / "02.png"), image[..., :3])
    assert not np.array_equal(pixels(tmp_path / "frames" / "00.png"), image[..., :3])


def test_a_frame_carries_its_moment_and_the_movie(scene: Scene, tmp_path: Path) -> None:
    write_movie(MovieFile(scene, tmp_path / "%d.png", SIZE))
    found = load_scene(tmp_path / "3.png")
    assert found.movie == TURN
    volumes = SceneVolumes()
    start = framed(scene, volumes.of(scene), SIZE)
    assert found == Timeline(start, volumes.surroundings(start)).frame(3)
    assert main(["reproduce", str(tmp_path / "3.png"), "-o", str(tmp_path / "again.png")]) == 0
    np.testing.assert_array_equal(pixels(tmp_path / "again.png"), pixels(tmp_path / "3.png"))
    write_movie(MovieFile(scene, tmp_path / "bare%d.png", SIZE, keep_session=False))
    assert not holds_scene(tmp_path / "bare3.png")


def test_a_movie_that_was_stopped_goes_on_to_the_same_bytes(scene: Scene, tmp_path: Path) -> None:
    whole, again = (MovieFile(scene, tmp_path / name / "%d.png", SIZE) for name in ("whole", "again"))
    write_movie(whole)
    asked = iter([False] * 12 + [True] * 100)
    with pytest.raises(Cancelled, match="of 6 frames are kept"):
        write_movie(again, cancel=lambda: next(asked))
    there = [path for path in again.frames if path.exists()]
    assert 0 < len(there) < 6
    half = again.folder / ".0123abcd-4.png"
    half.write_bytes(b"half a frame, of a process that was killed")
    with pytest.raises(InputError, match="frames are there already"):
        write_movie(again)
    assert write_movie(again, resume=True) == 6 - len(there)
    assert not half.exists()
    for one, other in zip(whole.frames, again.frames, strict=True):
        # the session in a frame says where its volume lies, seen from the frame
        assert one.read_bytes() == other.read_bytes()


def test_frames_of_another_movie_are_not_taken(scene: Scene, tmp_path: Path) -> None:
    movie = MovieFile(scene, tmp_path / "%d.png", SIZE)
    write_movie(movie)
    with pytest.raises(InputError, match="another movie or size"):
        write_movie(replace(movie, size=(32, 32)), resume=True)
    assert write_movie(replace(movie, size=(32, 32)), overwrite=True) == 6
    assert pixels(movie.frame(0)).shape == (32, 32, 3)


@pytest.mark.parametrize("name", ["film.gif", "film.apng"])
def test_films_of_pillow_have_all_frames(scene: Scene, tmp_path: Path, name: str) -> None:
    movie = MovieFile(scene, tmp_path / name, SIZE)
    write_movie(movie)
    with Image.open(movie.output) as film:
        assert film.n_frames == 6
        shown = []
        for number in range(6):
            film.seek(number)
            shown.append(np.asarray(film.convert("RGB")).astype(int))
        assert film.info["duration"] == pytest.approx(1000 / 12, abs=5)
    frames = MovieFile(scene, tmp_path / "frames" / "%d.png", SIZE)
    write_movie(frames)
    for image, path in zip(shown, frames.frames, strict=True):
        # a palette has 256 colours
        assert np.abs(image - pixels(path)).mean() < (4 if name.endswith("gif") else 1e-9)
    assert not movie.folder.exists()


@pytest.mark.parametrize("name", ["film.mp4", "film.webm"])
def test_films_are_played_by_others(scene: Scene, tmp_path: Path, name: str) -> None:
    av = pytest.importorskip("av", reason="PyAV (volviz[movie]) is not installed")
    movie = MovieFile(scene, tmp_path / name, SIZE)
    write_movie(movie)
    with av.open(str(movie.output)) as film:
        stream = film.streams.video[0]
        assert (stream.width, stream.height, stream.average_rate) == (*SIZE, 12)
        told = {key.lower(): text for key, text in film.metadata.items()}
        shown = [frame.to_ndarray(format="rgb24").astype(int) for frame in film.decode(stream)]
    assert '"kind": "volviz session"' in told["comment"]
    frames = MovieFile(scene, tmp_path / "frames" / "%d.png", SIZE)
    write_movie(frames)
    assert len(shown) == 6
    for image, path in zip(shown, frames.frames, strict=True):
        # colours are stored at half the resolution
        assert np.abs(image - pixels(path)).mean() < 3


def test_a_transparent_film_keeps_its_holes(scene: Scene, tmp_path: Path) -> None:
    write_movie(MovieFile(scene, tmp_path / "film.apng", SIZE, transparent=True))
    with Image.open(tmp_path / "film.apng") as film:
        film.seek(3)
        alpha = np.asarray(film.convert("RGBA"))[..., 3]
    assert alpha.min() == 0
    assert alpha.max() > 200
    with pytest.raises(InputError, match="no transparent background"):
        write_movie(MovieFile(scene, tmp_path / "film.gif", SIZE, transparent=True))


def test_what_cannot_be_is_refused_before_anything_is_drawn(scene: Scene, tmp_path: Path) -> None:
    pytest.importorskip("av", reason="PyAV (volviz[movie]) is not installed")
    with pytest.raises(InputError, match="even width"):
        write_movie(MovieFile(scene, tmp_path / "film.mp4", (65, 48)))
    with pytest.raises(InputError, match="movies end in"):
        write_movie(MovieFile(scene, tmp_path / "film.avi", SIZE))
    with pytest.raises(InputError, match="numbered frames"):
        write_movie(MovieFile(scene, tmp_path / "film%s%d.png", SIZE))
    with pytest.raises(InputError, match="nothing happens"):
        write_movie(MovieFile(replace(scene, movie=Movie()), tmp_path / "film.gif", SIZE))
    with pytest.raises(InputError, match="one time point"):
        write_movie(MovieFile(replace(scene, movie=Movie((Step((Play(),)),))), tmp_path / "film.gif", SIZE))
    assert sorted(path.name for path in tmp_path.iterdir() if path.suffix == ".gif") == []


def test_the_command_reads_a_file_once(scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_values: object, **_options: object) -> None:
        raise AssertionError("read a second time")

    monkeypatch.setattr("volviz.scene_volumes.read_key", refuse)
    command = ["movie", scene.layers[0].key.ref.source, "--turn", "360", "--frames", "2", "--size", "64x48"]
    assert main([*command, "-o", str(tmp_path / "film.gif")]) == 0


def test_a_cut_and_captions_are_seen(scene: Scene, tmp_path: Path) -> None:
    cut = Movie((Step((Cut("x"),), 0.5, "even"),), fps=4, title="A cut", stamp=True)
    movie = MovieFile(replace(scene, movie=cut), tmp_path / "%d.png", (160, 120))
    write_movie(movie)
    first, last = (pixels(path).astype(int) for path in movie.frames)
    bare = MovieFile(
        replace(scene, movie=replace(cut, title="", stamp=False)), tmp_path / "bare%d.png", (160, 120)
    )
    write_movie(bare)
    without = [pixels(path).astype(int) for path in bare.frames]
    assert np.abs(first - without[0])[:24].max() > 150, "the title"
    assert np.abs(last - without[1])[96:].max() > 150, "the moment"
    np.testing.assert_array_equal(first[30:90], without[0][30:90])
    middle = (slice(40, 80), slice(40, 120))
    assert first[middle].mean() > 5
    assert last[middle].mean() < 1, "all is cut away at the end"


def test_every_frame_shows_its_own_time_point(tmp_path: Path) -> None:
    count = 5
    array = np.empty((count, 12, 12, 12), np.uint8)
    array[:] = np.array([30 + 40 * n for n in range(count)], np.uint8)[:, None, None, None]
    volviz.save(
        ArraySource(array, times=tuple(float(n) for n in range(count)), name="film"),
        tmp_path / "film.ome.tif",
    )
    grey = TransferFunction.from_points([(0.0, (0.0, 0.0, 0.0, 1.0)), (255.0, (1.0, 1.0, 1.0, 1.0))])
    layer = ImageLayer(reference_to(tmp_path / "film.ome.tif", {}), grey)
    movie = Movie((Step((Play(0, count - 1),), 1.0, "even"),), fps=count)
    write_movie(MovieFile(Scene((layer,), movie=movie), tmp_path / "%d.png", SIZE))
    middles = [int(pixels(tmp_path / f"{n}.png")[SIZE[1] // 2, SIZE[0] // 2, 0]) for n in range(count)]
    np.testing.assert_allclose(middles, [30 + 40 * n for n in range(count)], atol=1)
