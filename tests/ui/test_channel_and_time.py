"""Channel and time point in the window: chosen in the data panel, read in the background, steps of the history."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import volviz
from volviz.volume_data.array_source import ArraySource
from volviz.volume_data.description import Channel
from volviz_ui.app.main_window import MainWindow
from volviz_ui.session.script import script_of

Wait = Callable[..., None]

pytestmark = pytest.mark.leaks_allowed("the tests share a window, which is searched when the file ends")


@pytest.fixture
def window(same_window: MainWindow) -> MainWindow:
    return same_window


@pytest.fixture
def embryo(tmp_path: Path) -> Path:
    """Three time points and two channels; every value tells which: 10 * time + channel, and a brighter corner."""
    t, c = np.indices((3, 2))
    array = np.broadcast_to((10 * t + c)[..., None, None, None], (3, 2, 6, 8, 9)).astype(np.uint8).copy()
    array[..., 0, 0, 0] = 200
    source = ArraySource(
        array, "tczyx", times=(0.0, 2.5, 5.0), channels=(Channel("DAPI"), Channel("GFP")), name="embryo"
    )
    volviz.save(source, tmp_path / "embryo.ome.tif")
    return tmp_path / "embryo.ome.tif"


def value(window: MainWindow) -> int:
    volume = window.documents.volume
    assert volume is not None
    return int(volume.array[3, 3, 3])


def test_channel_and_time_are_chosen_read_and_undone(
    window: MainWindow, embryo: Path, wait_for: Wait
) -> None:
    window.open(str(embryo))
    wait_for(lambda: window.documents.volume.name == "embryo")
    part, bar = window.data_panel.part, window.time_bar
    assert part.isVisibleTo(window.data_panel)
    assert bar.isVisibleTo(window)
    assert [part.channel.itemText(n) for n in range(part.channel.count())] == ["DAPI (0)", "GFP (1)"]
    assert part.channel.currentIndex() == 0
    assert (bar.slider.maximum(), bar.seconds.text()) == (2, "0.0 s")
    # with a chooser beside it, nobody need be told that there is more
    assert "first of" not in window.data_panel.notes.text()
    function = window.store.scene.layer.transfer_function
    shown = window.documents.shown

    part.channel.setCurrentIndex(1)
    part.channel.activated.emit(1)
    # the old picture stays until the values are there
    assert window.documents.shown is shown
    wait_for(lambda: value(window) == 1)
    bar.number.setValue(2)
    wait_for(lambda: window.player.seen == 2)
    assert value(window) == 21
    assert bar.seconds.text() == "5.0 s"
    assert window.store.scene.layer.transfer_function == function

    script = script_of(window.store.scene, (64, 48))
    assert "channel=1" in script
    assert "time=2" in script

    window.documents.undo()
    wait_for(lambda: value(window) == 1)
    wait_for(lambda: window.player.seen == 0)
    assert bar.slider.value() == 0
    window.documents.undo()
    wait_for(lambda: value(window) == 0)
    assert part.channel.currentIndex() == 0


def test_a_file_of_one_channel_has_nothing_to_choose(window: MainWindow) -> None:
    assert not window.data_panel.part.isVisibleTo(window.data_panel)
    assert not window.time_bar.isVisibleTo(window)
    assert not window.commands["time.play"].isEnabled()


def test_a_channel_that_is_asked_for_by_name_is_opened(
    window: MainWindow, embryo: Path, wait_for: Wait
) -> None:
    window.open(str(embryo), channel="gfp", time=1)
    wait_for(lambda: window.documents.volume.name == "embryo")
    assert value(window) == 11
    assert window.store.scene.layer.channel == 1
    assert window.data_panel.part.channel.currentText() == "GFP (1)"


def test_colours_offer_their_brightness_first(window: MainWindow, tmp_path: Path, wait_for: Wait) -> None:
    np.save(tmp_path / "colours.npy", np.random.default_rng(1).integers(0, 255, (6, 7, 8, 3), np.uint8))
    window.open(str(tmp_path / "colours.npy"))
    wait_for(lambda: window.documents.volume.name == "colours")
    part = window.data_panel.part
    assert [part.channel.itemText(n) for n in range(4)] == ["Brightness", "Red", "Green", "Blue"]
    assert part.channel.currentIndex() == 0
    assert "brightness" in window.data_panel.notes.text()


def test_a_time_point_that_cannot_be_read_leaves_the_old_one(
    window: MainWindow, embryo: Path, wait_for: Wait, monkeypatch: pytest.MonkeyPatch
) -> None:
    window.open(str(embryo))
    wait_for(lambda: window.documents.volume.name == "embryo")
    source = window.documents.source

    def broken(*_arguments: object) -> None:
        raise volviz.VolvizError("the disk is gone.")

    monkeypatch.setattr(source, "read_volume", broken)
    failures: list[str] = []
    monkeypatch.setattr(window.messages, "show_error", lambda title, _error: failures.append(title))
    window.time_bar.number.setValue(1)
    wait_for(lambda: failures == ["Time point 1 was not read"])
    assert window.store.scene.layer.time == 0
    assert value(window) == 0
    assert window.time_bar.number.value() == 0
