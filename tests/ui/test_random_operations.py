"""Many operations in random order: nothing raises, nothing grows, the image stays right."""

from __future__ import annotations

import gc
import os
import random
from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from tests.ui.conftest import drag, foreground, is_complete, save_ball, turn_wheel
from volviz.custom_gl.scene_techniques import (
    change_setting,
    choose_technique,
    current_technique,
    drawing_techniques,
)
from volviz.kernels.warm_up import warm_up
from volviz.model.parameters import Cost, Parameter
from volviz_ui.app.main_window import MainWindow
from volviz_ui.session.memory import return_freed_memory

Wait = Callable[..., None]
OPERATIONS = int(os.environ.get("VOLVIZ_RANDOM_OPERATIONS", "120"))
GROWTH_MEGABYTES = 50


def resident_megabytes() -> float:
    """Memory of this process that is in use."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024
    pytest.skip("/proc tells no memory here")


def settled_megabytes() -> float:
    """Memory in use once the program has given back what it had freed, as it does after opening a file."""
    gc.collect()
    return_freed_memory()
    return resident_megabytes()


class Monkey:
    """Does one thing after another, chosen by a seeded generator."""

    def __init__(self, window: MainWindow, files: list[str], seed: int, wait_for: Wait) -> None:
        self.window = window
        self.files = files
        self.wait_for = wait_for
        self.random = random.Random(seed)
        self.errors: list[object] = []
        self.log: list[str] = []
        window.controller.failed.connect(self.errors.append)
        window.documents.failed.connect(lambda name, error: self.errors.append(error))

    def warm_up(self) -> None:
        """Do everything once that leaves something behind on purpose: compiled programs, read files, styles."""
        for path in self.files:
            self.window.open(path)
            QTest.qWait(150)
        middle = self.window.viewport.rect().center()
        for info in drawing_techniques():
            choose_technique(self.window.store, info.id)
            for _ in range(2):
                # enlarged and complete images, with opaque things beside the volume and without
                self.window.commands["view.box"].trigger()
                drag(self.window.viewport, middle, middle + QPoint(20, 10), steps=3)
                self.wait_for(lambda: is_complete(self.window))
        for _ in range(2):
            for dock in self.window.docks.all:
                dock.setFloating(True)
                QTest.qWait(30)
                dock.setFloating(False)
                QTest.qWait(30)
        for size in ((1200, 860), (900, 640), (1100, 760)):
            self.window.resize(*size)
            QTest.qWait(60)
        names = [n for n in dir(self) if n.startswith("do_")]
        for name in names * 3:
            getattr(self, name)()
            QTest.qWait(10)
        # compiled kernels stay for as long as the process lives
        warm_up(["uint8"])
        self.wait_for(lambda: self.window.gate.is_open and not self.window.compilers.is_busy)

    def step(self) -> None:
        name = self.random.choice([n for n in dir(self) if n.startswith("do_")])
        self.log.append(name)
        getattr(self, name)()
        QTest.qWait(self.random.choice([0, 5, 30]))

    def do_rotate(self) -> None:
        middle = self.window.viewport.rect().center()
        offset = QPoint(self.random.randint(-90, 90), self.random.randint(-90, 90))
        buttons = (Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton, Qt.MouseButton.RightButton)
        drag(self.window.viewport, middle, middle + offset, button=self.random.choice(buttons), steps=4)

    def do_zoom(self) -> None:
        turn_wheel(self.window.viewport, self.random.choice([-1, 1]))

    def do_look_along_an_axis(self) -> None:
        self.window.commands[f"view.from.{self.random.choice('APLRSI')}"].trigger()

    def do_technique(self) -> None:
        choose_technique(self.window.store, self.random.choice(drawing_techniques()).id)

    def do_setting(self) -> None:
        # those that compile another program leave it behind for the next time, which is no leak
        cheap = [p for p in current_technique(self.window.store.scene).parameters if p.cost <= Cost.TEXTURE]
        parameter = self.random.choice(cheap)
        value = self._value(parameter)
        if value is not None:
            change_setting(self.window.store, parameter, value)

    def do_transfer_function(self) -> None:
        layer = self.window.store.scene.layer
        function = layer.transfer_function
        changed = self.random.choice(
            [
                lambda: function.shifted(self.random.uniform(-5, 5)),
                lambda: function.stretched(self.random.uniform(0.8, 1.25), 100.0),
                lambda: function.with_opacity(self.random.uniform(0.2, 1.0)),
            ]
        )()
        self.window.store.update(lambda scene: scene.with_layer(transfer_function=changed), label="Colours")

    def do_crop(self) -> None:
        field = self.random.choice(self.window.data_panel.crop.fields)[self.random.randint(0, 1)]
        field.setValue(self.random.randint(field.minimum(), field.maximum()))

    def do_plane(self) -> None:
        planes = self.window.data_panel.planes
        if planes.rows and self.random.random() < 0.6:
            planes.rows[0].removed.emit()
        else:
            planes.add_plane(self.random.choice([(1.0, 0.0, 0.0), (0.0, 0.6, 0.8), (0.0, 0.0, -1.0)]))

    def do_open(self) -> None:
        self.window.open(self.random.choice(self.files))
        if self.random.random() < 0.7:
            QTest.qWait(120)

    def do_undo(self) -> None:
        for _ in range(self.random.randint(1, 4)):
            self.window.commands["edit.undo"].trigger()

    def do_redo(self) -> None:
        for _ in range(self.random.randint(1, 3)):
            self.window.commands["edit.redo"].trigger()

    def do_resize(self) -> None:
        self.window.resize(self.random.randint(900, 1200), self.random.randint(640, 860))

    def do_float_a_panel(self) -> None:
        dock = self.random.choice(self.window.docks.all)
        dock.setFloating(not dock.isFloating())

    def do_annotations(self) -> None:
        self.window.commands[f"view.{self.random.choice(['box', 'axes', 'marker', 'bar'])}"].trigger()

    def do_forget_volumes(self) -> None:
        self.window.documents.cache.clear()

    def _value(self, parameter: Parameter) -> object:
        if parameter.kind == "bool":
            return self.random.random() < 0.5
        if parameter.kind == "choice":
            return self.random.choice(parameter.choices)[0]
        if parameter.kind == "float":
            low = parameter.soft_minimum if parameter.soft_minimum is not None else parameter.minimum
            high = parameter.soft_maximum if parameter.soft_maximum is not None else parameter.maximum
            if low is not None and high is not None:
                return self.random.uniform(low, high)
        return None


@pytest.mark.slow
def test_random_operations_raise_nothing_and_keep_the_memory(
    window: MainWindow, tmp_path: Path, wait_for: Wait
) -> None:
    files = [str(save_ball(tmp_path / f"ball{n}.npy", 80 + 40 * n, size=24 + 8 * n)) for n in range(3)]
    monkey = Monkey(window, files, seed=20260, wait_for=wait_for)
    monkey.warm_up()
    memory = settled_megabytes()
    for _ in range(OPERATIONS):
        monkey.step()
        assert not monkey.errors, (monkey.errors, monkey.log[-6:])
    grown = settled_megabytes() - memory
    assert grown < GROWTH_MEGABYTES, f"{grown:.0f} MB more after {OPERATIONS} operations"

    wait_for(lambda: not window.documents.is_loading)
    window.docks.reset()
    window.open(files[1])
    wait_for(lambda: window.documents.volume.dimensions == (32, 32, 32) and not window.documents.is_loading)
    choose_technique(window.store, "raycast")
    window.technique_commands.reset_settings()
    window.view_commands.reset_camera()
    wait_for(lambda: is_complete(window))
    assert foreground(window).mean() > 0.02
    assert window.controller.handle.error is None
