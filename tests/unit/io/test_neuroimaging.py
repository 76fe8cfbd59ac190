"""MGH, MINC, AFNI and PAR/REC against nibabel, GIPL against SimpleITK, MRC against mrcfile; Interfile."""

from __future__ import annotations

from pathlib import Path

import h5py
import mrcfile
import nibabel
import numpy as np
import pytest

import volviz
from tests.unit.io.writers import ORIGIN, SPACING, gzipped, itk, rotation, scalars
from volviz.errors import LoadError

# nibabel itself leaves files open
pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]

RAS_TO_LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


def oblique() -> np.ndarray:
    affine = np.eye(4)
    affine[:3, :3] = rotation(4) * SPACING
    affine[:3, 3] = ORIGIN
    return affine


def same_as_nibabel(path: Path, image: object, time: int | None = None) -> None:
    """Every voxel has nibabel's value, at nibabel's place."""
    volume = volviz.load(path, time=time)
    values = np.asarray(image.dataobj)
    values = values if values.ndim == 3 else values[..., time or 0]
    for index in ((0, 0, 0), (1, 2, 3), tuple(n - 1 for n in values.shape)):
        world = RAS_TO_LPS @ image.affine @ (*index, 1)
        assert volume.value_at(world[:3]) == pytest.approx(values[index], rel=1e-6)
    assert sorted(volume.dimensions) == sorted(values.shape)
    np.testing.assert_allclose(np.sort(volume.array, axis=None), np.sort(values, axis=None), rtol=1e-6)
    assert volume.metadata["length_unit"] == "mm"


@pytest.mark.parametrize("dtype", ["uint8", "int16", "int32", "float32"])
@pytest.mark.parametrize("name", ["v.mgh", "v.mgz"])
def test_mgh_files_of_every_type(tmp_path: Path, name: str, dtype: str) -> None:
    image = nibabel.MGHImage(scalars((4, 5, 6), dtype), oblique())
    nibabel.save(image, tmp_path / name)
    same_as_nibabel(tmp_path / name, nibabel.load(tmp_path / name))
    part = volviz.load(tmp_path / name, box=(1, 4, 0, 5, 2, 5))
    np.testing.assert_array_equal(part.array, volviz.load(tmp_path / name).array[2:5, 0:5, 1:4])


def test_frames_of_an_mgh_file_are_time_points_with_seconds(tmp_path: Path) -> None:
    image = nibabel.MGHImage(scalars((4, 5, 6, 3)), oblique())
    image.header["tr"] = 2500.0
    nibabel.save(image, tmp_path / "v.mgz")
    assert volviz.open(tmp_path / "v.mgz").times == (0.0, 2.5, 5.0)
    same_as_nibabel(tmp_path / "v.mgz", nibabel.load(tmp_path / "v.mgz"), 2)


def minc2(path: Path, array: np.ndarray) -> Path:
    """A MINC 2 file whose slices have ranges of their own."""
    with h5py.File(path, "w") as file:
        image = file.create_group("minc-2.0/image/0")
        stored = image.create_dataset("image", data=array)
        stored.attrs["dimorder"] = np.bytes_("zspace,yspace,xspace")
        stored.attrs["valid_range"] = np.array([-32768.0, 32767.0])
        for name, values in (
            ("image-min", np.arange(len(array))),
            ("image-max", 10.0 + np.arange(len(array))),
        ):
            limits = image.create_dataset(name, data=values.astype(float))
            limits.attrs["dimorder"] = np.bytes_("zspace")
        dimensions = file.create_group("minc-2.0/dimensions")
        for axis, (name, length) in enumerate(
            zip(("xspace", "yspace", "zspace"), array.shape[::-1], strict=True)
        ):
            dimension = dimensions.create_dataset(name, data=0)
            dimension.attrs["step"] = SPACING[axis]
            dimension.attrs["start"] = ORIGIN[axis]
            dimension.attrs["length"] = length
            dimension.attrs["spacing"] = np.bytes_("regular__")
            dimension.attrs["direction_cosines"] = np.eye(3)[axis]
    return path


def test_minc_2_with_a_range_for_each_slice(tmp_path: Path) -> None:
    path = minc2(tmp_path / "v.mnc", scalars((4, 5, 6)))
    volume = volviz.load(path)
    assert volume.metadata["format"] == "MINC"
    # the fastest axis of the file is that of the volume, too
    assert volume.dimensions == (6, 5, 4)
    same_as_nibabel(path, nibabel.load(path))
    part = volviz.load(path, box=(0, 6, 1, 4, 1, 3))
    np.testing.assert_array_equal(part.array, volume.array[1:3, 1:4])


AFNI_HEAD = """
type = string-attribute
name = TYPESTRING
count = 15
'3DIM_HEAD_ANAT~

type = integer-attribute
name = DATASET_RANK
count = 8
 3 2 0 0 0 0 0 0

type = integer-attribute
name = DATASET_DIMENSIONS
count = 5
 6 5 4 0 0

type = integer-attribute
name = BRICK_TYPES
count = 2
 1 1

type = float-attribute
name = BRICK_FLOAT_FACS
count = 2
 0.5 2

type = string-attribute
name = BYTEORDER_STRING
count = 10
'LSB_FIRST~

type = string-attribute
name = IDCODE_STRING
count = 4
'ABC~

type = integer-attribute
name = SCENE_DATA
count = 8
 0 2 0 -999 -999 -999 -999 -999

type = integer-attribute
name = ORIENT_SPECIFIC
count = 3
 0 3 4

type = float-attribute
name = ORIGIN
count = 3
 -12.5 30.25 7

type = float-attribute
name = DELTA
count = 3
 0.7 1.1 2.3

type = float-attribute
name = IJK_TO_DICOM_REAL
count = 12
 0.7 0 0 -12.5 0 1.1 0 30.25 0 0 2.3 7
"""


@pytest.mark.parametrize("ending", [".HEAD", ".BRIK", ".BRIK.gz"])
def test_afni_with_a_factor_for_each_brick(tmp_path: Path, ending: str) -> None:
    (tmp_path / "v+orig.HEAD").write_text(AFNI_HEAD)
    (tmp_path / "v+orig.BRIK").write_bytes(scalars((2, 4, 5, 6)).astype("<i2").tobytes())
    image = nibabel.load(tmp_path / "v+orig.HEAD")
    values = np.asarray(image.dataobj)
    if ending.endswith(".gz"):
        gzipped(tmp_path / "v+orig.BRIK")
        (tmp_path / "v+orig.BRIK").unlink()
    volume = volviz.load(tmp_path / f"v+orig{ending}", time=1)
    np.testing.assert_allclose(volume.array, values[..., 1].T)
    np.testing.assert_allclose(volume.index_to_world, RAS_TO_LPS @ image.affine, atol=1e-5)
    np.testing.assert_allclose(volume.origin, ORIGIN)


def example(name: str) -> Path:
    """One of the files that nibabel brings for its own tests."""
    path = Path(nibabel.__file__).parent / "tests" / "data" / name
    if not path.exists():
        pytest.skip("nibabel is installed without its examples")
    return path


@pytest.mark.parametrize("name", ["minc1_1_scale.mnc", "minc2_1_scale.mnc", "minc1_4d.mnc", "minc2_4d.mnc"])
def test_minc_of_nibabel(name: str) -> None:
    path = example(name)
    image = nibabel.load(path)
    values = np.asarray(image.dataobj)
    for time in range(len(values) if values.ndim == 4 else 1):
        volume = volviz.load(path, time=time)
        np.testing.assert_allclose(volume.array, values[time] if values.ndim == 4 else values, rtol=1e-6)
        corner = RAS_TO_LPS @ image.affine @ (1, 2, 3, 1)
        np.testing.assert_allclose((volume.index_to_world @ (3, 2, 1, 1))[:3], corner[:3], atol=1e-5)


@pytest.mark.parametrize("name", ["Phantom_EPI_3mm_tra_SENSE_6_1", "T2-interleaved"])
@pytest.mark.parametrize("ending", [".PAR", ".REC"])
def test_par_and_rec_of_philips(tmp_path: Path, name: str, ending: str) -> None:
    header = example(f"{name}.PAR")
    (tmp_path / f"{name}.PAR").write_bytes(header.read_bytes())
    shape = nibabel.parrec.PARRECHeader.from_fileobj(header.open()).get_data_shape()
    (tmp_path / f"{name}.REC").write_bytes(scalars(shape, "uint16").astype("<u2").tobytes())
    same_as_nibabel(tmp_path / f"{name}{ending}", nibabel.load(tmp_path / f"{name}.PAR"))
    if ending == ".PAR":
        (tmp_path / f"{name}.REC").unlink()
        with pytest.raises(LoadError, match="are not there"):
            volviz.load(tmp_path / f"{name}.PAR")


@pytest.mark.parametrize("packed", [False, True])
def test_gipl_by_itk(tmp_path: Path, packed: bool) -> None:
    path = itk(tmp_path / ("v.gipl.gz" if packed else "v.gipl"), scalars())
    volume = volviz.load(path)
    np.testing.assert_array_equal(volume.array, scalars())
    np.testing.assert_allclose(volume.spacing, SPACING, rtol=1e-6)
    np.testing.assert_allclose(volume.origin, ORIGIN)


@pytest.mark.parametrize("order", ["LITTLEENDIAN", "BIGENDIAN"])
def test_interfile(tmp_path: Path, order: str) -> None:
    array = scalars(dtype="float32")
    (tmp_path / "v.v").write_bytes(array.astype("<f4" if order[0] == "L" else ">f4").tobytes())
    (tmp_path / "v.hv").write_text(
        f"""!INTERFILE  :=
name of data file := v.v
!GENERAL IMAGE DATA :=
!imagedata byte order := {order}
!number format := float
!number of bytes per pixel := 4
number of dimensions := 3
!matrix size [1] := 9
scaling factor (mm/pixel) [1] := 0.7
!matrix size[2] := 7
scaling factor (mm/pixel) [2] := 1.1 ; a remark
!matrix size [3] := 5
scaling factor (mm/pixel) [3] := 2.3
!END OF INTERFILE :=
"""
    )
    volume = volviz.load(tmp_path / "v.hv")
    np.testing.assert_array_equal(volume.array, array)
    assert volume.spacing == SPACING


@pytest.mark.parametrize("dtype", ["int8", "int16", "uint16", "float32"])
def test_mrc_of_every_type(tmp_path: Path, dtype: str) -> None:
    with mrcfile.new(tmp_path / "v.mrc", scalars((5, 7, 9), dtype)) as file:
        file.voxel_size = SPACING
        file.header.origin = ORIGIN
    volume = volviz.load(tmp_path / "v.mrc")
    np.testing.assert_array_equal(volume.array, scalars((5, 7, 9), dtype))
    np.testing.assert_allclose(volume.spacing, SPACING, rtol=1e-6)
    np.testing.assert_allclose(volume.origin, ORIGIN)
    assert volume.metadata["length_unit"] == "Å"
    assert volviz.load(gzipped(tmp_path / "v.mrc")).dimensions == (9, 7, 5)


def test_axes_of_a_map_follow_its_header(tmp_path: Path) -> None:
    array = scalars((5, 7, 9), "float32")
    with mrcfile.new(tmp_path / "v.map", array) as file:
        # columns along z, rows along x, sections along y
        file.header.mapc, file.header.mapr, file.header.maps = 3, 1, 2
        file.header.mx, file.header.my, file.header.mz = 7, 5, 9
        file.header.cella = (7 * 2.0, 5 * 3.0, 9 * 4.0)
        file.header.nxstart, file.header.nystart, file.header.nzstart = 10, 20, 30
    volume = volviz.load(tmp_path / "v.map")
    np.testing.assert_array_equal(volume.array, array.transpose(2, 0, 1))
    assert volume.spacing == (2.0, 3.0, 4.0)
    # starts are those of columns, rows and sections
    assert volume.origin == (20 * 2.0, 30 * 3.0, 10 * 4.0)


def test_a_cell_that_is_no_box_is_resampled_with_a_note(tmp_path: Path) -> None:
    with mrcfile.new(tmp_path / "v.map", scalars((6, 7, 9), "float32")) as file:
        file.voxel_size = 1.0
        file.header.cellb = (90.0, 90.0, 120.0)
    volume = volviz.load(tmp_path / "v.map")
    assert any("sheared by 30.0 degrees" in note for note in volume.metadata["notes"])
    with mrcfile.new(tmp_path / "w.map", scalars((6, 7, 9), "float32")) as file:
        file.voxel_size = 1.0
        file.header.cellb = (90.0, 90.0, 93.0)
    direction = volviz.load(tmp_path / "w.map").direction
    np.testing.assert_allclose(
        direction[:, 1], (np.cos(np.radians(93)), np.sin(np.radians(93)), 0), atol=1e-6
    )


def test_a_stack_of_maps_is_one_of_time_points(tmp_path: Path) -> None:
    array = scalars((2, 4, 5, 6), "int16")
    with mrcfile.new(tmp_path / "v.mrc", array) as file:
        assert file.is_volume_stack()
    assert volviz.open(tmp_path / "v.mrc").sizes == {"t": 2, "z": 4, "y": 5, "x": 6}
    np.testing.assert_array_equal(volviz.load(tmp_path / "v.mrc", time=1).array, array[1])


@pytest.mark.parametrize("name", ["v.mrc", "v.mgh", "v.hv", "v.gipl", "v.HEAD", "v.PAR", "v.mnc"])
def test_other_files_with_these_names_are_refused_in_words(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"nothing of the kind" * 100)
    with pytest.raises(LoadError) as caught:
        volviz.load(tmp_path / name)
    assert "damaged" in str(caught.value) or "no " in str(caught.value)


def test_maps_that_are_cut_off_are_refused(tmp_path: Path) -> None:
    with mrcfile.new(tmp_path / "v.mrc", scalars((5, 7, 9))):
        pass
    (tmp_path / "v.mrc").write_bytes((tmp_path / "v.mrc").read_bytes()[:-100])
    with pytest.raises(LoadError, match="cut off"):
        volviz.load(tmp_path / "v.mrc")
