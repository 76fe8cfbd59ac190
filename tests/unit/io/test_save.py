"""What `volviz.save` writes is read back equal, by us and by others."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import nibabel
import numpy as np
import pytest
import SimpleITK
import tifffile

import volviz
from tests.unit.io.writers import ORIGIN, SPACING, rotation, scalars
from volviz.cli import main
from volviz.errors import Cancelled, InputError, VolvizError
from volviz.io.writers import WRITERS
from volviz.volume_data.array_source import ArraySource
from volviz.volume_data.description import Channel

TYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8")
CHANNELS = (
    Channel("DAPI", (0.0, 0.0, 1.0), wavelength=461.0),
    Channel("GFP", (0.0, 1.0, 0.0), wavelength=509.0),
)


def volume(dtype: str = "i2", *, shape: tuple[int, int, int] = (5, 7, 9), **more: Any) -> volviz.Volume:
    return volviz.Volume(
        scalars(shape, dtype), SPACING, ORIGIN, name="head", metadata={"length_unit": "mm"}, **more
    )


def five_dimensional(axes: str = "tczyx", dtype: str = "u2") -> ArraySource:
    sizes = {"t": 3, "c": 2, "z": 4, "y": 6, "x": 5}
    array = scalars(tuple(sizes[axis] for axis in axes), dtype)
    return ArraySource(
        array, axes, spacing=SPACING, origin=ORIGIN, name="embryo",
        times=(0.0, 2.5, 5.0) if "t" in axes else None, channels=CHANNELS if "c" in axes else (),
    )  # fmt: skip


def same(first: volviz.Volume, second: volviz.Volume) -> None:
    np.testing.assert_array_equal(first.array, second.array)
    np.testing.assert_allclose(first.index_to_world, second.index_to_world, atol=2e-6)


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("ending", [".nrrd", ".nii", ".mha", ".vti", ".npy"])
def test_values_of_every_type_come_back(tmp_path: Path, ending: str, dtype: str) -> None:
    array = scalars((3, 4, 5), dtype)
    volviz.save(volviz.Volume(array), tmp_path / f"v{ending}")
    again = volviz.load(tmp_path / f"v{ending}").array
    assert again.dtype == array.dtype
    np.testing.assert_array_equal(again, array)


@pytest.mark.parametrize("compress", [True, False])
@pytest.mark.parametrize("name", ["v.nrrd", "v.nii", "v.nii.gz", "v.mha", "v.vti"])
@pytest.mark.parametrize("mirrored", [False, True])
def test_oblique_lattices_come_back_by_us_and_by_others(
    tmp_path: Path, name: str, compress: bool, mirrored: bool
) -> None:
    written = volume(direction=rotation(3, mirrored=mirrored))
    assert volviz.save(written, tmp_path / name, compress=compress) == () or name == "v.vti"
    same(volviz.load(tmp_path / name), written)
    if name == "v.vti":
        from vtkmodules.vtkIOXML import vtkXMLImageDataReader

        reader = vtkXMLImageDataReader()
        reader.SetFileName(str(tmp_path / name))
        reader.Update()
        image = reader.GetOutput()
        assert image.GetScalarComponentAsDouble(8, 6, 4, 0) == written.array[4, 6, 8]
        place = [0.0, 0.0, 0.0]
        image.TransformContinuousIndexToPhysicalPoint((1, 2, 3), place)
    else:
        image = SimpleITK.ReadImage(str(tmp_path / name))
        np.testing.assert_array_equal(SimpleITK.GetArrayFromImage(image), written.array)
        place = image.TransformContinuousIndexToPhysicalPoint((1, 2, 3))
    np.testing.assert_allclose(place, (written.index_to_world @ (1, 2, 3, 1))[:3], atol=1e-5)


def test_nibabel_reads_what_we_write(tmp_path: Path) -> None:
    written = volume("f4", direction=rotation(5))
    volviz.save(written, tmp_path / "v.nii.gz")
    image = nibabel.load(tmp_path / "v.nii.gz")
    np.testing.assert_array_equal(np.asarray(image.dataobj), written.array.T)
    np.testing.assert_allclose(image.affine[:2], -written.index_to_world[:2], atol=1e-5)
    np.testing.assert_allclose(image.get_qform(), image.get_sform(), atol=1e-5)
    assert image.header.get_xyzt_units() == ("mm", "unknown")


@pytest.mark.parametrize("axes", ["tzyx", "czyx", "tczyx"])
@pytest.mark.parametrize("name", ["v.nrrd", "v.nii", "v.mha", "v.tif", "v.ome.tif", "v.npy", "v.ome.zarr"])
def test_time_points_and_channels_come_back(tmp_path: Path, name: str, axes: str) -> None:
    written = five_dimensional(axes)
    notes = volviz.save(written, tmp_path / name)
    if name == "v.npy" and axes == "czyx":
        # nothing in the file says that these four axes are channels
        np.testing.assert_array_equal(np.load(tmp_path / name), written._array)
        return
    again = volviz.open(tmp_path / name)
    assert (again.axes, again.sizes) == (written.axes, written.sizes)
    for time in range(written.sizes.get("t", 1)):
        for channel in range(written.sizes.get("c", 1)):
            first, second = again.read(time=time, channel=channel), written.read(time=time, channel=channel)
            np.testing.assert_array_equal(first.array, second.array)
            if name != "v.npy":
                np.testing.assert_allclose(first.spacing, SPACING, rtol=1e-6)
    keeps_seconds = name not in ("v.mha", "v.npy")
    if "t" in axes:
        assert (again.times is not None) == keeps_seconds
        assert any("seconds" in note for note in notes) != keeps_seconds
        if again.times is not None:
            np.testing.assert_allclose(again.times, written.times)
    if name == "v.ome.tif" and "c" in axes:
        assert again.channels == CHANNELS
    if name == "v.ome.zarr" and "c" in axes:
        assert [(channel.name, channel.color) for channel in again.channels] == [
            (channel.name, channel.color) for channel in CHANNELS
        ]
    if name in ("v.tif", "v.ome.tif"):
        assert any("where the volume lies" in note for note in notes)


def test_tifffile_finds_a_hyperstack_of_imagej_and_an_ome_tiff(tmp_path: Path) -> None:
    written = five_dimensional()
    volviz.save(written, tmp_path / "v.tif")
    with tifffile.TiffFile(tmp_path / "v.tif") as file:
        assert file.is_imagej
        assert file.series[0].axes == "TZCYX"
        assert file.imagej_metadata["spacing"] == SPACING[2]
        assert file.imagej_metadata["finterval"] == 2.5
        np.testing.assert_array_equal(np.moveaxis(file.asarray(), 2, 1), written._array)
    volviz.save(written, tmp_path / "v.ome.tif")
    with tifffile.TiffFile(tmp_path / "v.ome.tif") as file:
        assert file.is_ome
        assert file.series[0].axes == "TCZYX"
        np.testing.assert_array_equal(file.asarray(), written._array)


def test_imagej_gets_ome_for_types_that_it_does_not_know(tmp_path: Path) -> None:
    notes = volviz.save(volume("i2"), tmp_path / "v.tif")
    assert any("int16" in note and "OME-TIFF" in note for note in notes)
    np.testing.assert_array_equal(volviz.load(tmp_path / "v.tif").array, volume("i2").array)
    with pytest.raises(InputError, match="TIFF for ImageJ holds no values of type int16"):
        volviz.save(volume("i2"), tmp_path / "w.tif", format="imagej")


@pytest.mark.parametrize("name", ["v.nrrd", "v.nii", "v.mha", "v.vti", "v.tif", "v.ome.tif", "v.npy"])
def test_colours_stay_colours(tmp_path: Path, name: str) -> None:
    colours = scalars((4, 6, 5, 3), "u1")
    tifffile.imwrite(tmp_path / "colours.tif", colours, photometric="rgb", metadata={"axes": "ZYXS"})
    source = volviz.open(tmp_path / "colours.tif")
    assert source.is_colour
    volviz.save(source, tmp_path / name, overwrite=True)
    again = volviz.open(tmp_path / name)
    assert again.is_colour
    assert [channel.name for channel in again.channels] == ["red", "green", "blue"]
    for channel in range(3):
        np.testing.assert_array_equal(again.read(channel=channel).array, colours[..., channel])
    np.testing.assert_array_equal(again.read().array, source.read().array)


def test_uneven_times_stay_in_ome_and_are_told_elsewhere(tmp_path: Path) -> None:
    source = ArraySource(scalars((3, 4, 6, 5), "u1"), "tzyx", times=(0.0, 1.0, 5.0))
    assert not volviz.save(source, tmp_path / "v.ome.tif")
    assert volviz.open(tmp_path / "v.ome.tif").times == (0.0, 1.0, 5.0)
    assert any("seconds" in note for note in volviz.save(source, tmp_path / "v.nrrd"))


@pytest.mark.parametrize(
    ("unit", "name"), [("µm", "v.nii"), ("nm", "v.mha"), ("µm", "v.nrrd"), ("µm", "v.tif")]
)
def test_the_unit_of_lengths_is_kept_or_converted(tmp_path: Path, unit: str, name: str) -> None:
    volviz.save(volviz.Volume(scalars(dtype="u1"), SPACING, metadata={"length_unit": unit}), tmp_path / name)
    again = volviz.load(tmp_path / name)
    factor = {("mm", "µm"): 1e-3, ("mm", "nm"): 1e-6}.get((again.metadata["length_unit"], unit), 1.0)
    assert again.metadata["length_unit"] in ("mm", unit)
    np.testing.assert_allclose(again.spacing, np.multiply(SPACING, factor), rtol=1e-6)


@pytest.mark.parametrize("kind", ["ome-zarr", "ome-zarr-0.4"])
def test_a_zarr_pyramid_lies_where_the_volume_does(tmp_path: Path, kind: str) -> None:
    array = scalars((9, 150, 301), "u2")
    source = volviz.Volume(array, (1.0, 1.0, 4.0), ORIGIN, metadata={"length_unit": "µm"})
    volviz.save(source, tmp_path / "v.ome.zarr", format=kind)
    if kind == "ome-zarr":
        said = json.loads((tmp_path / "v.ome.zarr/zarr.json").read_text())["attributes"]["ome"]
    else:
        said = json.loads((tmp_path / "v.ome.zarr/.zattrs").read_text())
    (multiscale,) = said["multiscales"]
    assert [axis["name"] for axis in multiscale["axes"]] == ["z", "y", "x"]
    assert {axis["unit"] for axis in multiscale["axes"]} == {"micrometer"}
    np.testing.assert_array_equal(_zarr_level(tmp_path / "v.ome.zarr", 0), array)
    scale, shift = (
        each[key]
        for each, key in zip(
            multiscale["datasets"][1]["coordinateTransformations"], ("scale", "translation"), strict=True
        )
    )
    # the long edge of the voxels waits
    assert scale == [4.0, 2.0, 2.0]
    np.testing.assert_allclose(shift, [ORIGIN[2], ORIGIN[1] + 0.5, ORIGIN[0] + 0.5])
    level = _zarr_level(tmp_path / "v.ome.zarr", 1)
    assert level.shape == (9, 75, 151)
    assert level[3, 4, 5] == np.rint(array[3, 8:10, 10:12].mean())
    again = volviz.open(tmp_path / "v.ome.zarr")
    np.testing.assert_array_equal(again.read().array, array)
    np.testing.assert_array_equal(again.read(1).array, level)
    np.testing.assert_allclose(again.levels[0].origin, ORIGIN)
    np.testing.assert_allclose(again.levels[1].origin, shift[::-1])


def _zarr_level(path: Path, level: int) -> np.ndarray:
    import tensorstore

    driver = "zarr3" if (path / "zarr.json").exists() else "zarr"
    spec = {"driver": driver, "kvstore": {"driver": "file", "path": str(path / str(level))}}
    return np.asarray(tensorstore.open(spec).result().read().result())


def test_a_box_of_one_channel_lies_where_its_voxels_do(tmp_path: Path) -> None:
    source = five_dimensional()
    volviz.save(source, tmp_path / "v.nrrd", time=2, channel=1, box=(1, 4, 0, 6, 1, 3))
    again = volviz.open(tmp_path / "v.nrrd")
    assert again.axes == ("z", "y", "x")
    same(again.read(), source.read(time=2, channel=1, box=(1, 4, 0, 6, 1, 3)))


def test_resampling_keeps_the_middle_and_a_linear_field(tmp_path: Path) -> None:
    z, y, x = np.mgrid[:12, :14, :16].astype(np.float32)
    ramp = volviz.Volume(2 * x + 3 * y - z, (1.0, 1.0, 2.0), (5.0, 6.0, 7.0))
    volviz.save(ramp, tmp_path / "v.nrrd", spacing=(0.8, 0.8, 0.8))
    finer = volviz.load(tmp_path / "v.nrrd")
    assert finer.spacing == (0.8, 0.8, 0.8)
    np.testing.assert_allclose(finer.center, ramp.center)
    index = np.stack(np.meshgrid(*(np.arange(n) for n in finer.dimensions), indexing="ij"), -1)
    world = index @ finer.index_to_world[:3, :3].T + finer.index_to_world[:3, 3]
    i, j, k = np.moveaxis((world - ramp.origin) / ramp.spacing, -1, 0)
    np.testing.assert_allclose(finer.array, (2 * i + 3 * j - k).transpose(2, 1, 0), atol=1e-4)
    notes = volviz.save(ramp, tmp_path / "w.nrrd", spacing=(3.0, 3.0, 3.0))
    assert any("smoothed" in note for note in notes)
    assert volviz.load(tmp_path / "w.nrrd").dimensions == (6, 5, 8)
    with pytest.raises(InputError, match="choose distances nearer"):
        volviz.save(ramp, tmp_path / "x.nrrd", spacing=(100.0, 1.0, 1.0))


def test_labels_are_resampled_to_labels(tmp_path: Path) -> None:
    labels = ArraySource((scalars((6, 6, 6), "u1") % 3) * 100, is_labels=True)
    volviz.save(labels, tmp_path / "v.nii", spacing=(0.7, 0.7, 0.7))
    again = volviz.open(tmp_path / "v.nii")
    assert again.is_labels
    assert set(np.unique(again.read().array)) == {0, 100, 200}


def test_values_that_become_wider_on_the_way_are_written_in_the_wider_type(tmp_path: Path) -> None:
    class Widening(ArraySource):
        def read_volume(self, request: Any) -> volviz.Volume:
            array = super().read_volume(request).array
            return self.placed(
                array.astype(np.int32 if request.time else np.int16) * (1 + 70000 * request.time), request
            )

    source = Widening(np.ones((2, 3, 4, 5), np.int16), "tzyx")
    volviz.save(source, tmp_path / "v.nrrd")
    again = volviz.open(tmp_path / "v.nrrd")
    assert again.read(time=0).array.dtype == np.int32
    assert again.read(time=0).range == (1, 1)
    assert again.read(time=1).range == (70001, 70001)


@pytest.mark.parametrize("writer", WRITERS, ids=lambda writer: writer.id)
def test_nothing_is_replaced_in_silence_and_nothing_stays_of_a_cancel(tmp_path: Path, writer: Any) -> None:
    target = tmp_path / f"v{writer.suffixes[0]}"
    written = volume("u1")
    fractions: list[float] = []
    volviz.save(
        written, target, format=writer.id, progress=lambda fraction, _text: fractions.append(fraction)
    )
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    before = _content(target)
    with pytest.raises(InputError, match="exists already"):
        volviz.save(written, target, format=writer.id)
    with pytest.raises(Cancelled):
        volviz.save(written, target, format=writer.id, overwrite=True, cancel=lambda: True)
    asked: list[bool] = []

    def late() -> bool:
        asked.append(True)
        return len(asked) > 2

    with pytest.raises(Cancelled):
        volviz.save(written, target, format=writer.id, overwrite=True, cancel=late)
    assert _content(target) == before
    assert [path.name for path in tmp_path.iterdir()] == [target.name]
    other = volviz.Volume(255 - written.array)
    volviz.save(other, target, format=writer.id, overwrite=True)
    assert _content(target) != before
    assert [path.name for path in tmp_path.iterdir()] == [target.name]


def _content(path: Path) -> dict[str, bytes]:
    if path.is_file():
        return {"": path.read_bytes()}
    return {
        str(each.relative_to(path)): each.read_bytes() for each in sorted(path.rglob("*")) if each.is_file()
    }


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("v.jpg", "volumes are written as .nrrd"),
        ("v.vti", "holds one time point and there are 3"),
        ("missing/v.nrrd", "does not exist"),
    ],
)
def test_refusals_are_sentences(tmp_path: Path, name: str, words: str) -> None:
    with pytest.raises(VolvizError, match=words):
        volviz.save(five_dimensional(), tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_what_a_format_cannot_say_is_told(tmp_path: Path) -> None:
    notes = volviz.save(volume("u1", direction=rotation(2), unit="HU"), tmp_path / "v.tif")
    assert any("direction of its axes" in note for note in notes)
    assert any("(HU)" in note for note in notes)
    notes = volviz.save(volume("u1"), tmp_path / "v.npy")
    assert any("distance of voxels (0.7 x 1.1 x 2.3 mm)" in note for note in notes)


def test_convert_writes_a_part_and_tells_what_is_lost(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    volviz.save(five_dimensional(), tmp_path / "in.ome.tif")
    box = ["--time", "1", "--channel", "gfp", "--crop", "0,4,0,6,0,4"]
    assert main(["convert", str(tmp_path / "in.ome.tif"), str(tmp_path / "out.mha"), *box]) == 0
    assert "out.mha" in capsys.readouterr().out
    again = volviz.load(tmp_path / "out.mha")
    np.testing.assert_array_equal(
        again.array, five_dimensional().read(time=1, channel=1, box=(0, 4, 0, 6, 0, 4)).array
    )
    assert main(["convert", str(tmp_path / "in.ome.tif"), str(tmp_path / "out.mha"), *box]) == 2
    assert "exists already" in capsys.readouterr().err
    more = [*box, "--overwrite", "--resample", "1,1,1"]
    assert main(["convert", str(tmp_path / "in.ome.tif"), str(tmp_path / "out.mha"), *more]) == 0
    assert "resampled linearly" in capsys.readouterr().out
    assert volviz.load(tmp_path / "out.mha").spacing == (1.0, 1.0, 1.0)
    assert main(["convert", str(tmp_path / "in.ome.tif"), str(tmp_path / "all.npy"), "--crop", "0,4"]) == 2
    assert "--crop takes six numbers" in capsys.readouterr().err
