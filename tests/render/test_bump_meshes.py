"""Bump mapping on meshes: made in the background, read from files, one sentence for what cannot be read."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import volviz
from volviz.custom_gl.vtk.vtk_imports import pyvista
from volviz.errors import LoadError
from volviz.meshes.reading import read_triangles

SIZE = (120, 90)
FLAT: dict[str, Any] = {
    "surface": "mesh",
    "color_source": "flat",
    "flat_color": (1.0, 1.0, 1.0),
    "bump_strength": 0.0,
    "ambient": 0.0,
    "diffuse": 1.0,
    "normalization": "shader",
}


@pytest.fixture
def of() -> volviz.Volume:
    """A ramp along x in a box of 31 x 31 x 31 world units around the origin."""
    ramp = np.broadcast_to(np.arange(32, dtype=np.float32), (32, 32, 32)).copy()
    return volviz.Volume(ramp, origin=(-15.5, -15.5, -15.5))


def camera() -> volviz.Camera:
    return volviz.Camera((0.0, -80.0, 0.0), (0.0, 0.0, 0.0))


def image(of: volviz.Volume, **values: Any) -> Any:
    grey = volviz.TransferFunction.from_points([(0, (0, 0, 0, 1)), (31, (1, 1, 1, 1))])
    return volviz.render(
        of,
        "bump_mapping",
        transfer_function=grey,
        size=SIZE,
        camera=camera(),
        dtype="float32",
        light_position=(0.0, -1000.0, 0.0),
        **values,
    )


@pytest.mark.parametrize("suffix", ["stl", "ply", "vtp", "obj", "vtk"])
def test_a_ball_from_a_file_is_lit_like_a_ball(of: volviz.Volume, tmp_path: Path, suffix: str) -> None:
    file = tmp_path / f"ball.{suffix}"
    pyvista.Sphere(radius=10.0, theta_resolution=60, phi_resolution=60).save(file)
    drawn = image(of, mesh_file=str(file), **FLAT)
    seen = drawn[..., 3] > 0
    half = 2 * 80 * np.tan(np.radians(15)) / SIZE[1]
    rows, columns = np.indices(seen.shape) - np.array([SIZE[1] - 1, SIZE[0] - 1])[:, None, None] / 2
    # the outline of a ball of radius 10, 80 away
    radius = 10 * 80 / np.sqrt(80**2 - 10**2) / half
    distance = np.hypot(rows, columns)
    assert seen[distance < radius - 1].all()
    assert not seen[distance > radius + 1].any()
    # the light comes from the eye: Lambert's cosine falls from the middle to the rim
    sine = np.clip(distance / radius, 0, 1)
    inner = distance < 0.8 * radius
    assert np.abs(drawn[..., 0] - np.sqrt(1 - sine**2))[inner].max() < 0.08


def test_colours_come_from_the_data_the_mesh_goes_through(of: volviz.Volume, tmp_path: Path) -> None:
    file = tmp_path / "plate.stl"
    pyvista.Plane(center=(0, 0, 0), direction=(0, -1, 0), i_size=20, j_size=20).save(file)
    values = FLAT | {"color_source": "transfer_function", "display": "color"}
    drawn = image(of, mesh_file=str(file), **values)
    row = drawn[SIZE[1] // 2]
    seen = row[:, 3] > 0
    x = (np.arange(SIZE[0]) + 0.5 - SIZE[0] / 2) * 2 * 80 * np.tan(np.radians(15)) / SIZE[1]
    assert 40 < seen.sum() < 50
    assert row[seen, 0] == pytest.approx((x[seen] + 15.5) / 31, abs=0.02)


def test_patterns_follow_the_texture_coordinates_of_the_file(of: volviz.Volume, tmp_path: Path) -> None:
    plate = pyvista.Plane(center=(0, 0, 0), direction=(0, -1, 0), i_size=20, j_size=20).triangulate()
    values = FLAT | {"normal_source": "bumps", "bump_strength": 1.0, "display": "normals"}
    drawn = []
    for repeats in (1, 2):
        plate.active_texture_coordinates = plate.active_texture_coordinates * (1 if repeats == 1 else 2)
        file = tmp_path / f"plate{repeats}.vtp"
        plate.save(file)
        drawn.append(image(of, mesh_file=str(file), **values))
    # the pattern has four bumps a repeat
    waves = []
    for texture in drawn:
        rows, columns = np.nonzero(texture[..., 3])
        plate_only = texture[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1, 1]
        spectrum = np.abs(np.fft.rfft(plate_only - plate_only.mean(), axis=1)).sum(axis=0)
        waves.append(int(np.argmax(spectrum)))
    assert waves == [4, 8]


def test_a_mesh_beside_the_volume_is_told(of: volviz.Volume, tmp_path: Path) -> None:
    file = tmp_path / "far.ply"
    pyvista.Sphere(radius=3.0, center=(100, 0, 0)).save(file)
    window = pyvista.Plotter(off_screen=True, window_size=SIZE)
    try:
        handle = volviz.add_volume(window, of, "bump_mapping", mesh_file=str(file), **FLAT)
        window.show(auto_close=False, interactive=False)
        handle.raise_error()
        assert "far.ply lies outside the volume" in handle.notice
        handle.update(mesh_file=None)
        window.render()
        assert handle.notice == ""
    finally:
        window.close()


def test_what_is_no_mesh_is_refused_in_a_sentence(
    of: volviz.Volume, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "words.stl").write_text("these are words\n")
    (tmp_path / "cut.ply").write_bytes(b"ply\nformat binary_little_endian 1.0\nelement vertex 900\n")
    (tmp_path / "empty.obj").write_bytes(b"")
    (tmp_path / "odd.xyzzy").write_bytes(b"\0\1\2")
    pyvista.PolyData(np.zeros((3, 3))).save(tmp_path / "points.vtp")
    pyvista.ImageData(dimensions=(3, 3, 3)).save(tmp_path / "image.vti")
    for name in ("words.stl", "cut.ply", "empty.obj", "odd.xyzzy", "points.vtp", "image.vti", "none.stl"):
        with pytest.raises(LoadError, match=name) as caught:
            read_triangles(str(tmp_path / name))
        sentence = str(caught.value)
        assert sentence.endswith(".")
        assert "\n" not in sentence
    assert capfd.readouterr().err == ""
    with pytest.raises(LoadError, match=r"none\.stl"):
        image(of, mesh_file=str(tmp_path / "none.stl"), **FLAT)


def test_a_file_that_has_changed_is_read_again(of: volviz.Volume, tmp_path: Path) -> None:
    file = tmp_path / "ball.stl"
    window = pyvista.Plotter(off_screen=True, window_size=SIZE)
    try:
        pyvista.Sphere(radius=4.0).save(file)
        handle = volviz.add_volume(window, of, "bump_mapping", mesh_file=str(file), **FLAT)
        window.camera_position = [(0.0, -80.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
        window.show(auto_close=False, interactive=False)
        small = (handle.read_image()[..., 3] > 0).sum()
        pyvista.Sphere(radius=8.0).save(file)
        handle.invalidate()
        window.render()
        assert (handle.read_image()[..., 3] > 0).sum() > 3 * small
    finally:
        window.close()
