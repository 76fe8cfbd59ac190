"""OME-Zarr and plain Zarr: levels, axes, channels, labels, choices, chunks, words."""

import json
import shutil
import threading
import time

import numpy as np
import pytest
import tensorstore

import volviz
from tests.unit.io import stores
from volviz.errors import Cancelled, InputError, LoadError
from volviz.io import info
from volviz.io.zarr import store as zarr_store


@pytest.mark.parametrize("version", [2, 3])
def test_levels_lie_where_their_own_transformations_place_them(tmp_path, version):
    fine = stores.small((6, 8, 9))
    coarse = fine[::2, ::2, ::3] // 2
    path = stores.image(
        tmp_path / "v.zarr", [fine, coarse], [(2, 0.5, 0.25), (4, 1, 0.75)], version=version,
        translations=[(10, 20, 30), (11, 20.25, 30.25)], units=dict.fromkeys("zyx", "micrometer"),
    )  # fmt: skip
    source = volviz.open(path)
    assert [level.dimensions for level in source.levels] == [(9, 8, 6), (3, 4, 3)]
    assert [level.spacing for level in source.levels] == [(0.25, 0.5, 2), (0.75, 1, 4)]
    assert [level.origin for level in source.levels] == [(30, 20, 10), (30.25, 20.25, 11)]
    assert source.units == {"z": "µm", "y": "µm", "x": "µm"}
    np.testing.assert_array_equal(source.read().array, fine)
    np.testing.assert_array_equal(source.read(1).array, coarse)
    part = volviz.load(path, level=1, box=(1, 3, 0, 4, 1, 3))
    np.testing.assert_array_equal(part.array, coarse[1:3, 0:4, 1:3])
    assert part.origin == (31, 20.25, 15)
    moved = volviz.open(path, spacing=(0.5, 1, 4), origin=(0, 0, 0)).levels[1]
    assert (moved.spacing, moved.origin) == ((1.5, 2, 8), (0.5, 0.5, 2))


def test_axes_channels_and_times_come_from_the_metadata(tmp_path):
    values = stores.small((3, 2, 4, 5, 6))
    omero = {"channels": [
        {"label": "DAPI", "color": "0000FF", "window": {"start": 10, "end": 900, "min": 0, "max": 65535}},
        {"label": "GFP", "color": "00ff80", "active": False},
    ]}  # fmt: skip
    path = stores.image(
        tmp_path / "v.zarr", [values], [(500, 1, 2, 1000, 1000)], axes="tczyx",
        units={"t": "millisecond", "z": "micrometer", "y": "nanometer", "x": "nanometer"}, extra={"omero": omero},
    )  # fmt: skip
    source = volviz.open(path)
    assert source.sizes == {"t": 3, "c": 2, "z": 4, "y": 5, "x": 6}
    assert source.times == (0.0, 0.5, 1.0)
    first, second = source.channels
    assert (first.name, first.color, first.window) == ("DAPI", (0, 0, 1), (10, 900))
    assert (second.name, second.color) == ("GFP", (0, 1, 128 / 255))
    # one unit for all: that of x
    assert source.units["x"] == "nm"
    np.testing.assert_allclose(source.levels[0].spacing, (1000, 1000, 2000))
    np.testing.assert_array_equal(source.read(time=2, channel=1).array, values[2, 1])
    notes = source.read().metadata["notes"]
    assert any("first of 3 time points" in note for note in notes)
    assert any("first of 2 channels" in note for note in notes)


def test_what_the_metadata_says_and_nobody_understands_is_told(tmp_path):
    values = stores.small((4, 5, 6))
    path = stores.image(
        tmp_path / "v.zarr", [values], [(1, 1, 1)], units={"z": "furlong", "y": "mm", "x": "mm"}
    )
    attributes = json.loads((path / ".zattrs").read_text())
    attributes["multiscales"][0]["coordinateTransformations"] = [{"type": "affine", "affine": [[1]]}]
    (path / ".zattrs").write_text(json.dumps(attributes))
    notes = " ".join(volviz.load(path).metadata["notes"])
    assert "'furlong' of its axis z is not known" in notes
    assert "'affine' is not understood" in notes


def test_levels_without_transformations_span_what_the_finest_spans(tmp_path):
    fine, coarse = stores.small((4, 8, 8)), stores.small((4, 4, 2))
    path = stores.image(tmp_path / "v.zarr", [fine, coarse], [(1, 1, 1), (1, 1, 1)])
    attributes = json.loads((path / ".zattrs").read_text())
    for dataset in attributes["multiscales"][0]["datasets"]:
        del dataset["coordinateTransformations"]
    (path / ".zattrs").write_text(json.dumps(attributes))
    source = volviz.open(path)
    assert source.levels[1].spacing == (4, 2, 1)
    assert source.levels[1].origin == (1.5, 0.5, 0)
    assert any("cubes of side 1" in note for note in source.metadata["notes"])


def test_labels_are_chosen_by_name_and_know_what_their_numbers_mean(tmp_path):
    values, cells = stores.small((4, 5, 6)), stores.small((4, 5, 6), "uint8") % 4
    path = stores.image(tmp_path / "v.zarr", [values], [(1, 1, 1)])
    stores.group(path / "labels", {"labels": ["cells"]})
    described = {
        "colors": [{"label-value": 1, "rgba": [255, 0, 0, 255]}, {"label-value": 3, "rgba": [0, 51, 0, 255]}],
        "properties": [{"label-value": 1, "area (pixels)": 1200, "class": "nucleus"}],
    }
    stores.image(path / "labels" / "cells", [cells], [(1, 1, 1)], extra={"image-label": described})
    source = volviz.open(path)
    assert not source.is_labels
    np.testing.assert_array_equal(source.read().array, values)
    assert [entry.name for entry in source.entries] == ["", "labels/cells"]
    for chosen in (volviz.open(path, series="labels/cells"), volviz.open(path / "labels" / "cells")):
        assert chosen.is_labels
        assert [(one.number, one.name, one.color) for one in chosen.labels] == [
            (1, "nucleus", (1, 0, 0)), (3, "", (0, 0.2, 0)),
        ]  # fmt: skip
        np.testing.assert_array_equal(chosen.read().array, cells)


@pytest.mark.parametrize("kind", ["plate", "bioformats2raw", "plain group", "plain group in a zip file"])
def test_one_of_several_images_is_chosen_by_its_name(tmp_path, kind):
    path = tmp_path / "v.zarr"
    small, large = stores.small((3, 4, 5)), stores.small((6, 4, 5))
    names = {"plate": ("A/1/0", "B/2/0"), "bioformats2raw": ("0", "1")}.get(kind, ("inner/a", "inner/b"))
    if kind == "plate":
        stores.group(path, {"plate": {"wells": [{"path": "A/1"}, {"path": "B/2"}]}})
        for well in ("A/1", "B/2"):
            stores.group(path / well, {"well": {"images": [{"path": "0"}]}})
    elif kind == "bioformats2raw":
        stores.group(path, {"bioformats2raw.layout": 3})
    else:
        stores.group(path / "inner")
        stores.group(path)
    for name, values in zip(names, (small, large), strict=True):
        if kind.startswith("plain"):
            stores.array(path / name, values)
        else:
            stores.image(path / name, [values], [(1, 1, 1)])
    if kind.endswith("zip file"):
        path = stores.zipped(path, tmp_path / "w.zip", "folder/")
    volume = volviz.load(path)
    np.testing.assert_array_equal(volume.array, large)
    assert any(f"'{names[0]}' (3 x 4 x 5, uint16)" in note for note in volume.metadata["notes"])
    np.testing.assert_array_equal(volviz.load(path, series=names[0]).array, small)
    np.testing.assert_array_equal(volviz.load(path, series=0).array, small)
    with pytest.raises(
        InputError, match=r"there is no image 'Z/9/0'; it holds '\S+' \(3 x 4 x 5, uint16\), "
    ):
        volviz.open(path, series="Z/9/0")


def test_shards_missing_chunks_and_named_axes_of_a_plain_array(tmp_path):
    values = stores.small((5, 6, 8))
    values[:, 0:3, 0:4] = 7
    path = stores.array(
        tmp_path / "v.zarr", values, version=3, chunks=(1, 3, 4), shards=(5, 6, 8), fill_value=7, names="xyz"
    )
    volume = volviz.load(path)
    np.testing.assert_array_equal(volume.array, values.transpose(2, 1, 0))
    bare = stores.array(tmp_path / "w.zarr", values, version=2, chunks=(5, 3, 4), fill_value=7)
    assert not (bare / "0" / "0" / "0").exists()
    np.testing.assert_array_equal(volviz.load(bare).array, values)


def test_a_box_reads_the_chunks_that_it_touches_alone(tmp_path):
    values = stores.small((8, 8, 8))
    path = stores.array(tmp_path / "v.zarr", values, chunks=(2, 4, 4))
    shutil.rmtree(path / "3")
    (path / "0" / "0" / "0").write_bytes(b"damaged")
    np.testing.assert_array_equal(volviz.load(path, box=(4, 8, 0, 4, 1, 6)).array, values[1:6, 0:4, 4:8])
    with pytest.raises(LoadError, match=r"^v.zarr: a chunk of the array is damaged or cut off"):
        volviz.load(path)


def test_n5_and_precomputed_count_x_first(tmp_path):
    values = stores.small((4, 5, 6))
    spec = {"driver": "n5", "kvstore": {"driver": "file", "path": f"{tmp_path}/v.n5/"}, "metadata": {
        "dimensions": [6, 5, 4], "blockSize": [3, 5, 4], "dataType": "uint16", "compression": {"type": "gzip"},
        "pixelResolution": {"unit": "um", "dimensions": [0.5, 0.5, 2.0]},
    }}  # fmt: skip
    try:
        written = tensorstore.open(spec, create=True).result()
    except ValueError:
        del spec["metadata"]["pixelResolution"]
        written = tensorstore.open(spec, create=True).result()
    written.write(values.T).result()
    np.testing.assert_array_equal(volviz.load(tmp_path / "v.n5").array, values)
    spec = {"driver": "neuroglancer_precomputed", "kvstore": {"driver": "file", "path": f"{tmp_path}/pre/"},
            "multiscale_metadata": {"data_type": "uint16", "num_channels": 1, "type": "image"},
            "scale_metadata": {"size": [6, 5, 4], "voxel_offset": [10, 0, 0], "resolution": [4, 4, 40],
                               "encoding": "raw", "chunk_size": [3, 5, 4]}}  # fmt: skip
    tensorstore.open(spec, create=True).result()[..., 0].write(values.T).result()
    volume = volviz.load(tmp_path / "pre")
    np.testing.assert_array_equal(volume.array, values)
    assert (volume.spacing, volume.origin) == ((4, 4, 40), (42, 2, 20))
    assert volume.metadata["length_unit"] == "nm"


def test_the_finest_level_that_fits_is_shown_and_told(tmp_path, monkeypatch):
    levels = [stores.small((16, 16, 16)), stores.small((8, 8, 8)), stores.small((4, 4, 4))]
    path = stores.image(tmp_path / "v.zarr", levels, [(1, 1, 1), (2, 2, 2), (4, 4, 4)])
    for module in ("pyramid", "file_source"):
        monkeypatch.setattr(f"volviz.io.{module}.free_bytes", lambda: 4096)
    volume = volviz.load(path)
    assert volume.dimensions == (8, 8, 8)
    (note,) = volume.metadata["notes"]
    assert note.startswith("Level 1 is shown, of 0 (finest) to 2: level 0 needs")
    assert note in info(path)["notes"]
    with pytest.raises(
        LoadError, match=r"^v.zarr: level 0 needs \S+ GiB of memory and \S+ GiB are free; read level 1"
    ):
        volviz.load(path, level=0)
    assert volviz.load(path, box=(0, 8, 0, 8, 0, 8)).spacing == (1, 1, 1)


def test_reading_is_cancelled_at_once(tmp_path, monkeypatch):
    path = stores.array(tmp_path / "v.zarr", stores.small((4, 4, 4)))
    never = threading.Event()

    class Waiting:
        def result(self, timeout=None):
            never.wait(timeout)
            raise TimeoutError

        def done(self):
            return False

        def cancel(self):
            return True

    monkeypatch.setattr(zarr_store.StoredArray, "read", lambda self, index, request: request.wait(Waiting()))
    source = volviz.open(path)
    begun = time.monotonic()
    with pytest.raises(Cancelled):
        source.read(cancel=lambda: time.monotonic() > begun + 0.1)
    assert time.monotonic() - begun < 0.3


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda p: (p / ".zattrs").write_text("{"), "its metadata '.zattrs' is unreadable"),
        (lambda p: shutil.rmtree(p / "s0"), "the array 's0', which its metadata names, is not there"),
        (lambda p: (p / ".zattrs").write_text('{"multiscales": [{"datasets": 3}]}'), "lists no levels"),
        (
            lambda p: (p / ".zattrs").write_text(
                '{"multiscales": [{"datasets": [{"path": "s0", "coordinateTransformations":'
                ' [{"type": "scale", "scale": [1, 0, 1]}]}]}]}'
            ),
            "a scale of its metadata is unusable",
        ),
        (
            lambda p: (p / ".zattrs").write_text('{"multiscales": [{"datasets": [{"path": "../x"}]}]}'),
            "is not there",
        ),
        (lambda p: _change(p, "compressor", {"id": "lzma"}), "packed in a way that cannot be read"),
        (lambda p: _change(p, "dtype", "|O"), "values of a type that cannot be shown"),
        (lambda p: _change(p, "shape", [1, 2]), "metadata of the array 's0' cannot be understood"),
    ],
)
def test_what_is_damaged_is_told_in_one_sentence(tmp_path, spoil, words):
    path = stores.image(tmp_path / "v.zarr", [stores.small((4, 5, 6))], [(1, 1, 1)])
    spoil(path)
    with pytest.raises(LoadError, match=words) as caught:
        volviz.load(path)
    assert str(caught.value).startswith("v.zarr: ")


def _change(path, key, value):
    file = path / "s0" / ".zarray"
    file.write_text(json.dumps({**json.loads(file.read_text()), key: value}))


def test_metadata_that_is_mutated_ends_in_a_volume_or_a_sentence(tmp_path):
    path = stores.image(
        tmp_path / "v.zarr", [stores.small((4, 5, 6)), stores.small((2, 3, 3))], [(1, 1, 1), (2, 2, 2)],
        units={"x": "mm"}, extra={"omero": {"channels": [{"label": "a", "color": "FF0000", "window": {"start": 1}}]}},
    )  # fmt: skip
    rng = np.random.default_rng(4)
    for file in (path / ".zattrs", path / "s0" / ".zarray"):
        whole = json.loads(file.read_text())
        for _ in range(60):
            file.write_text(json.dumps(_mutated(whole, rng)))
            try:
                volviz.load(path)
            except (LoadError, InputError) as error:
                assert "\n" not in str(error)  # noqa: PT017
        file.write_text(json.dumps(whole))


def _mutated(value, rng):
    """The same JSON with one of its values replaced."""
    strange = [None, -1, 0, 1e400, "x", [], {}, [None], True, 10**30, {"path": ["a"]}]
    if isinstance(value, dict | list) and len(value) and rng.random() < 0.9:
        copy = value.copy()
        key = rng.choice(list(value)) if isinstance(value, dict) else int(rng.integers(len(value)))
        copy[key] = _mutated(value[key], rng)
        return copy
    return strange[rng.integers(len(strange))]
