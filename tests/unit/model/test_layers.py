"""Layers take colours, windows and matrices in the forms people write, and refuse the rest in a sentence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import volviz
from volviz.errors import InputError
from volviz.model.layers import ImageLayer, LabelLayer, volume_of
from volviz.model.scene import Scene
from volviz.model.transfer.function import TransferFunction
from volviz.volume_data.array_source import ArraySource
from volviz.volume_data.references import VolumeKey, VolumeRef
from volviz.volume_data.volume import Volume

VOLUME = Volume(np.arange(24, dtype=np.int16).reshape(2, 3, 4))
FUNCTION = TransferFunction.from_points([(0, (1, 0, 0, 0.5))])
SHIFT = np.array([[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]])


@pytest.mark.parametrize(
    ("color", "parts"),
    [
        ("green", (0, 1, 0)),
        (" Magenta", (1, 0, 1)),
        ("#ff8000", (1, 128 / 255, 0)),
        ("orange", (1, 165 / 255, 0)),
        (np.array([0.25, 0.5, 1]), (0.25, 0.5, 1)),
        ([1, 0, 0], (1, 0, 0)),
    ],
)
def test_a_colour_may_be_a_name_digits_or_parts(color, parts):
    assert volviz.ImageLayer(VOLUME, color=color).color == pytest.approx(parts)
    assert volviz.LabelLayer(VOLUME, {3: color}).colors == ((3, pytest.approx(parts)),)


def test_layers_are_values_whatever_they_are_written_with():
    one = ImageLayer(VOLUME, color="red", window=np.array([1, 5]), transform=SHIFT)
    assert one == ImageLayer(VOLUME, color=(1.0, 0.0, 0.0), window=(1.0, 5.0), transform=SHIFT.tolist())
    assert hash(one) == hash(replace(one, opacity=1.0))
    assert one.transform is not None
    assert one.transform[1] == (0.0, 1.0, 0.0, 6.0)
    labels = LabelLayer(VOLUME, {7: "red", np.uint8(3): "#00ff00"}, names={7: "b", 3: "a"}, hidden=[2, 1, 2])
    assert labels.colors == ((3, (0.0, 1.0, 0.0)), (7, (1.0, 0.0, 0.0)))
    assert (labels.names, labels.hidden) == (((3, "a"), (7, "b")), (1, 2))
    assert replace(labels, smooth=False) == replace(replace(labels, smooth=False), name="")
    assert hash(labels) == hash(replace(labels))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"volume": np.zeros((2, 2, 2))}, "got ndarray; make a volume"),
        ({"volume": "a.nii"}, "got str"),
        ({"color": "greeen"}, "no colour 'greeen'"),
        ({"color": (1, 2, 0)}, "parts from 0 to 1"),
        ({"color": (1, 0)}, "three finite numbers"),
        ({"window": (5, 5)}, "low < high"),
        ({"window": 3}, "low < high"),
        ({"window": (0, float("nan"))}, "low < high"),
        ({"opacity": 1.5}, "from 0 to 1"),
        ({"opacity": "half"}, "from 0 to 1"),
        ({"opacity": None}, "from 0 to 1"),
        ({"channel": -1}, "channel of a layer"),
        ({"channel": 1.0}, "channel of a layer"),
        ({"time": True}, "time of a layer"),
        ({"time": None}, "time of a layer"),
        ({"transform": np.eye(3)}, "4 x 4"),
        ({"transform": np.full((4, 4), np.nan)}, "4 x 4"),
        ({"transform": np.diag([1, 1, 0, 1])}, "three-dimensional"),
        ({"transform": np.diag([1, 1, 1, 2])}, "the row 0, 0, 0, 1"),
        ({"mode": "over"}, "add, mask, modulate"),
        ({"transfer_function": "viridis"}, "must be a TransferFunction"),
        ({"transfer_function": FUNCTION, "color": "red"}, "not both"),
        ({"transfer_function": FUNCTION, "window": (0, 1)}, "not both"),
    ],
)
def test_what_no_image_layer_can_be_is_refused(given, words):
    with pytest.raises(InputError, match=words) as caught:
        ImageLayer(**{"volume": VOLUME, **given})
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"colors": {"3": "red"}}, "by integers"),
        ({"colors": {3: "reed"}}, "colour of label 3"),
        ({"colors": "red"}, "mapping"),
        ({"names": 5}, "mapping"),
        ({"hidden": (1.5,)}, "by integers"),
        ({"opacity": -0.1}, "from 0 to 1"),
        ({"transform": 3}, "4 x 4"),
    ],
)
def test_what_no_label_layer_can_be_is_refused(given, words):
    with pytest.raises(InputError, match=words) as caught:
        LabelLayer(**{"volume": VOLUME, **given})
    assert "\n" not in str(caught.value)


def test_the_values_of_a_layer_come_from_wherever_they_lie():
    array = np.arange(2 * 3 * 24).reshape(2, 3, 2, 3, 4)
    source = ArraySource(array)
    assert volume_of(ImageLayer(VOLUME)) is VOLUME
    layer = LabelLayer(source, time=1, channel=2)
    np.testing.assert_array_equal(volume_of(layer).array, array[1, 2])
    ref = VolumeRef("sample:engine")
    shown = ImageLayer(ref, channel=1, time=4)
    assert volume_of(shown, {VolumeKey(ref, 1, 4): VOLUME}) is VOLUME
    for wrong, words in (
        (ImageLayer(VOLUME, time=1), "one time point"),
        (ImageLayer(source, channel=3), r"channel must lie in 0\.\.2, got 3"),
        (shown, "has not been read"),
    ):
        with pytest.raises(InputError, match=words):
            volume_of(wrong)
    with pytest.raises(InputError, match="no reference"):
        _ = ImageLayer(VOLUME).key


def test_a_function_takes_the_place_of_a_colour_and_window():
    scene = Scene((LabelLayer(VOLUME), ImageLayer(VOLUME, color="red", window=(0, 1), opacity=0.5)))
    assert scene.with_layer(opacity=0.25).layers[1] == ImageLayer(
        VOLUME, color="red", window=(0, 1), opacity=0.25
    )
    edited = scene.with_layer(transfer_function=FUNCTION)
    assert edited.layers == (LabelLayer(VOLUME), ImageLayer(VOLUME, FUNCTION, opacity=0.5))
