"""Time points one after the other: read ahead in the background, shown one by one, never faster than they are drawn."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal
from weakref import WeakKeyDictionary

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.layer_edits import at_time
from volviz.model.layers import ImageLayer, LabelLayer, Layer
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.model.time_range import TimeRange, look_like, refitted
from volviz.model.transfer.first_look import robust_range
from volviz.volume_data.references import VolumeKey, VolumeRef
from volviz.volume_data.scalars import held_bytes
from volviz.volume_data.source import VolumeSource
from volviz.volume_data.volume import Volume
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.session.opening import read_volume
from volviz_ui.session.workers import Gate, Task, Workers

GESTURE = "time point"
#: Time points that are read at once; the rest of the processor draws.
AT_ONCE = 2
#: Time points ahead that are read while time runs, as far as the memory for them goes, and to either side at rest.
AHEAD, BESIDE = 24, 2
#: Frames a second of data that does not say how fast it was measured, and limits of what is taken from it.
USUAL_SPEED, SLOWEST, FASTEST = 10.0, 1.0, 60.0
#: Steps that follow one another this fast are one step of the history.
REST_MS = 300

Range = tuple[float, float]
Repeat = Literal["loop", "ping-pong", "once"]
Preparation = Callable[[Sequence[Volume], Sequence[Volume]], None]


class TimePlayer(QObject):
    """Moves the scene from one time point to the next.

    The scene changes when the values of a time point have been read and prepared for drawing; until then the picture
    and the time beside it stay. Reading never holds up the window: of many requests the newest is met first.

    Parameters
    ----------
    store : Store
        Where the scene is.
    documents : Documents
        What it shows.
    gate : Gate
        Kept shut while time runs: histograms wait.

    Attributes
    ----------
    preparation : callable() -> list of callables
        Gives what computes, on a thread, what the views need of image volumes and labels that they are going to draw.
    repeat : {"loop", "ping-pong", "once"}
        What follows the last time point.
    speed : float
        Frames a second that are wanted.
    rate : float or None
        Frames a second that are shown while time runs; None before the second one.
    """

    changed = Signal()
    """Another time point is wanted or seen, time runs or stands still, or there is other data."""
    failed = Signal(int, object)
    """A time point that was wanted could not be read, and the error."""

    def __init__(self, store: Store, documents: Documents, gate: Gate, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._store, self._documents, self._gate = store, documents, gate
        self._workers = Workers(self)
        #: Range of the values of a time point, and that to which the function of a layer belongs now.
        self._ranges: WeakKeyDictionary[Volume, Range] = WeakKeyDictionary()
        self._bases: dict[tuple[VolumeRef, int | None], Range] = {}
        self.preparation: Callable[[], list[Preparation]] = list
        self.repeat: Repeat = "loop"
        self.speed = USUAL_SPEED
        self.rate: float | None = None
        self._refs: frozenset[VolumeRef] = frozenset()
        self.count = 1
        self.times: tuple[float, ...] | None = None
        self.wanted = 0
        self.seen = 0
        self._asked = 0
        self._playing = False
        self._direction = 1
        self._is_drawn = True
        self._due = self._last_seen = 0.0
        self._reading: dict[int, Task] = {}
        self._urgent: set[int] = set()
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._go_on)
        self._rest = QTimer(self)
        self._rest.setSingleShot(True)
        self._rest.setInterval(REST_MS)
        self._rest.timeout.connect(self._end_steps)
        documents.changed.connect(self._on_shown)
        self._on_shown(LoadedScene(), documents.shown)

    # ------------------------------------------------------------------ what there is

    @property
    def is_playing(self) -> bool:
        """Whether time runs."""
        return self._playing

    @property
    def is_waiting(self) -> bool:
        """Whether the picture of the wanted time point is not there yet."""
        return self.seen != self.wanted

    def _on_shown(self, old: LoadedScene, new: LoadedScene) -> None:
        """The scene is another one: its data, perhaps, or by undo its time point."""
        refs, count, times = _moving(new.scene, self._documents.source_of)
        if (refs, count) != (self._refs, self.count):
            self._stop()
            for task in self._reading.values():
                task.cancel()
            self._documents.frames.clear()
            self._bases.clear()
            self._refs, self.count, self.times = refs, count, times
            self.speed = _usual_speed(times)
        shown = self._time_of(new.scene)
        if shown != self._time_of(old.scene) or old.volume is not new.volume:
            self._is_drawn = False
            if shown not in (self.wanted, self._asked):
                # undo, a session, another file: not what was asked for here
                self._stop()
                self.wanted = shown
                self._bases.clear()
            self._asked = shown
        if new.volume is None:
            self.wanted = self.seen = 0
        self.changed.emit()

    def _time_of(self, scene: Scene) -> int:
        return next((layer.time for layer in scene.layers if layer.volume in self._refs), 0)

    def note_drawn(self) -> None:
        """The views have drawn the scene that is shown now."""
        shown = self._time_of(self._documents.shown.scene)
        if self._is_drawn and shown == self.seen:
            return
        self._is_drawn = True
        if shown != self.seen:
            now = time.perf_counter()
            if self._playing and self._last_seen:
                rate = 1.0 / max(now - self._last_seen, 1e-3)
                self.rate = rate if self.rate is None else 0.8 * self.rate + 0.2 * rate
            self._last_seen = now
            self.seen = shown
            self.changed.emit()
        if self._playing:
            self._go_on()

    # ------------------------------------------------------------------ choosing

    def show(self, number: int) -> None:
        """Show a time point, from 0, as soon as its values are there."""
        self.pause()
        self._begin_steps()
        self._want(min(max(number, 0), self.count - 1))

    def step(self, direction: int) -> None:
        """The next time point (1) or the one before (-1); beyond the last one comes the first."""
        if self.count > 1:
            self.show((self.wanted + direction) % self.count)

    def begin_drag(self) -> None:
        """The slider is taken hold of: what follows is one step of the history."""
        self.pause()
        self._rest.stop()
        self._store.begin_gesture(GESTURE)

    def end_drag(self) -> None:
        """It is let go."""
        self._rest.start()

    def _begin_steps(self) -> None:
        if not self._store.has_gesture(GESTURE):
            self._store.begin_gesture(GESTURE)
            self._rest.start()
        elif self._rest.isActive():
            self._rest.start()

    def _end_steps(self) -> None:
        if self.wanted in self._reading or self._playing:
            # its picture belongs to the same step
            self._rest.start()
        else:
            self._store.end_gesture(GESTURE)

    # ------------------------------------------------------------------ playing

    def play(self) -> None:
        """Let time run, from the beginning where it stands at the end and does not repeat."""
        if self._playing or self.count < 2:
            return
        self._rest.stop()
        self._playing, self.rate, self._last_seen = True, None, 0.0
        self._store.begin_gesture(GESTURE)
        self._gate.hold()
        self._due = time.perf_counter()
        if self.repeat == "once" and self.wanted == self.count - 1:
            self._want(0)
        self.changed.emit()
        self._go_on()

    def pause(self) -> None:
        """Let time stand still at what is shown."""
        if self._playing:
            self.wanted = self._time_of(self._store.scene)
            self._stop()
            self.changed.emit()

    def toggle(self) -> None:
        """Play or pause."""
        (self.pause if self._playing else self.play)()

    def _stop(self) -> None:
        if self._playing:
            self._playing = False
            self._timer.stop()
            self._gate.release()
            self._store.end_gesture(GESTURE)

    def _go_on(self) -> None:
        """Show the next time point if it is due, read, and the one before it has been drawn."""
        if not self._playing or not self._is_drawn or self._timer.isActive():
            return
        shown = self._time_of(self._documents.shown.scene)
        if self.wanted == shown:
            following = self._following(shown)
            if following is None:
                self._stop()
                self.changed.emit()
                return
            self.wanted = following
        if not self._is_at_hand(self.wanted):
            self._fill()
            return
        now = time.perf_counter()
        if now < self._due:
            self._timer.start(max(1, round(1000 * (self._due - now))))
            return
        period = 1.0 / self.speed
        self._due = max(self._due + period, now)
        self._show_wanted()
        self._fill()

    def _following(self, number: int) -> int | None:
        """The time point after another one while time runs; None at the end."""
        after = number + self._direction
        if 0 <= after < self.count:
            return after
        if self.repeat == "ping-pong":
            self._direction = -self._direction
            return number + self._direction
        self._direction = 1
        return 0 if self.repeat == "loop" else None

    def set_speed(self, speed: float) -> None:
        """So many frames a second from now on."""
        self.speed, self.rate, self._last_seen = speed, None, 0.0
        self.changed.emit()

    # ------------------------------------------------------------------ reading

    def _want(self, number: int) -> None:
        self.wanted = number
        if self._is_at_hand(number):
            self._show_wanted()
        self._fill()
        self.changed.emit()

    def _show_wanted(self) -> None:
        self._show(self.wanted)

    def _show(self, number: int) -> None:
        refs = self._refs
        if self._time_of(self._store.scene) != number:
            self._is_drawn = False
            self._asked = number
            self._store.update(
                lambda scene: self._recolored(scene, at_time(scene, number, refs)),
                label=self.tr("Time point"), gesture=GESTURE,
            )  # fmt: skip

    # ------------------------------------------------------------------ colours through time

    @property
    def time_range(self) -> TimeRange:
        """How colours follow the values."""
        return self._store.scene.time_range

    def set_time_range(self, choice: TimeRange) -> None:
        """How colours follow the values from now on; the picture that is seen keeps them."""
        self._bases.clear()
        if self._store.update(
            lambda scene: replace(scene, time_range=choice), label=self.tr("Colours through time")
        ):
            # what was chosen of the values of time points belongs to the former way
            self._documents.frames.clear()
            self._fill()

    def _recolored(self, before: Scene, scene: Scene) -> Scene:
        """The scene of another time point with functions that follow its values, where they are to."""
        if scene.time_range == "fixed":
            return scene
        layers = list(scene.layers)
        for number, (old, layer) in enumerate(zip(before.layers, layers, strict=True)):
            if not isinstance(layer, ImageLayer) or layer.transfer_function is None or layer == old:
                continue
            place = layer.key.ref, layer.channel
            base = self._bases.get(place) or self._range_of(old.key)
            values = self._range_of(layer.key)
            if base is None or values is None or not values[0] < values[1]:
                continue
            if scene.time_range == "widest":
                values = min(values[0], base[0]), max(values[1], base[1])
            self._bases[place] = values
            layers[number] = replace(layer, transfer_function=refitted(layer.transfer_function, base, values))
        return replace(scene, layers=tuple(layers))

    def _range_of(self, key: VolumeKey) -> Range | None:
        """Range of values without outliers; None of what is not in memory."""
        volume = self._documents.at_hand(key)
        if volume is None:
            return None
        if volume not in self._ranges:
            self._ranges[volume] = robust_range(volume)
        return self._ranges[volume]

    def _is_at_hand(self, number: int) -> bool:
        return all(self._documents.at_hand(key) for _, key in self._layers_at(number))

    def _layers_at(self, number: int) -> list[tuple[Layer, VolumeKey]]:
        """Layers that move, and what they show at a time point."""
        scene = at_time(self._store.scene, number, self._refs)
        return [(layer, layer.key) for layer in scene.layers if layer.volume in self._refs]

    def _fill(self) -> None:
        """Read what is wanted, and what is likely to be wanted next."""
        order = [self.wanted, *self._ahead()]
        for number, task in self._reading.items():
            if number not in order and number not in self._urgent:
                task.cancel()
        for number in order:
            running = sum(not task.is_cancelled for task in self._reading.values())
            if running >= AT_ONCE:
                return
            if number not in self._reading and not self._is_at_hand(number):
                self._read(number)

    def _ahead(self) -> list[int]:
        """Time points that may be wanted next, the nearest first."""
        shown = self._documents.shown.volumes
        each = sum(held_bytes(shown[key]) for _, key in self._layers_at(self.seen) if key in shown)
        room = max(self._documents.frames.budget // max(each, 1) - 2, 1)
        if not self._playing:
            near = [self.wanted + side * n for n in range(1, BESIDE + 1) for side in (1, -1)]
            return [number for number in near if 0 <= number < self.count][:room]
        found: list[int] = []
        kept, number = self._direction, self.wanted
        while len(found) < min(AHEAD, room, self.count - 1):
            after = self._following(number)
            if after is None:
                break
            found.append(after)
            number = after
        self._direction = kept
        return list(dict.fromkeys(found))

    def _read(self, number: int) -> None:
        jobs = []
        shown = self._documents.shown.volumes
        fixed = self._store.scene.time_range == "fixed"
        for (layer, key), (_, now) in zip(self._layers_at(number), self._layers_at(self._asked), strict=True):
            source = self._documents.source_of(key.ref)
            if source is not None and not self._documents.at_hand(key):
                is_labels = isinstance(layer, LabelLayer)
                like = shown.get(now) if fixed and not is_labels else None
                jobs.append(_Job(source, key, is_labels, like))
        preparations = self.preparation()
        task = self._workers.start(lambda task: _read_and_prepared(jobs, preparations, task))
        self._reading[number] = task
        if number == self.wanted:
            self._urgent.add(number)
        task.succeeded.connect(lambda read: self._on_read(number, read))
        task.failed.connect(lambda error: self._on_failed(number, error))
        task.ended.connect(lambda: self._on_ended(number, task))

    def _on_read(self, number: int, read: dict[VolumeKey, tuple[Volume, Range | None]]) -> None:
        for key, (volume, values) in read.items():
            self._documents.frames.put(key, volume)
            if values is not None:
                self._ranges[volume] = values
        if self._playing:
            return
        # while a slider is dragged faster than files are read, what has been read is shown, and the newest follows
        if number == self.wanted or (
            number in self._urgent and self.wanted != self._time_of(self._store.scene)
        ):
            self._show(number)

    def _on_failed(self, number: int, error: BaseException) -> None:
        if number == self.wanted:
            self._stop()
            self.wanted = self._time_of(self._store.scene)
            self.failed.emit(number, error)

    def _on_ended(self, number: int, task: Task) -> None:
        if self._reading.get(number) is task:
            del self._reading[number]
            self._urgent.discard(number)
        if self.count > 1:
            self._fill()
            self._go_on()
        self.changed.emit()

    def close(self) -> None:
        """Stop reading: the window closes."""
        self._documents.changed.disconnect(self._on_shown, missing_ok=True)
        self._timer.stop()
        self._rest.stop()
        self._playing = False
        self.count = 1
        self._workers.close()


def _moving(
    scene: Scene, source_of: Callable[[VolumeRef], VolumeSource | None]
) -> tuple[frozenset[VolumeRef], int, tuple[float, ...] | None]:
    """Data that moves in time together, its number of time points and their seconds.

    That is the file of the active layer, or the longest where it stands still, and all that have as many time points.
    """
    counts: dict[VolumeRef, int] = {}
    times: dict[VolumeRef, Any] = {}
    for layer in scene.layers:
        source = source_of(layer.key.ref)
        if source is not None:
            counts[layer.key.ref] = source.sizes.get("t", 1)
            times[layer.key.ref] = source.times
    active = 1 if scene.layer is None else counts.get(scene.layer.key.ref, 1)
    count = active if active > 1 else max(counts.values(), default=1)
    if count < 2:
        return frozenset(), 1, None
    refs = frozenset(ref for ref, number in counts.items() if number == count)
    return refs, count, next((times[ref] for ref in counts if ref in refs and times[ref] is not None), None)


def _usual_speed(times: tuple[float, ...] | None) -> float:
    """Frames a second as they were measured, where that can be watched."""
    if times is None or len(times) < 2 or not times[-1] > times[0]:
        return USUAL_SPEED
    speed = (len(times) - 1) / (times[-1] - times[0])
    return speed if SLOWEST <= speed <= FASTEST else USUAL_SPEED


@dataclass(frozen=True)
class _Job:
    """A volume to be read for a time point.

    Attributes
    ----------
    source : VolumeSource
    key : VolumeKey
    is_labels : bool
    like : Volume or None
        The time point whose automatic values it gets; None where it has its own.
    """

    source: VolumeSource
    key: VolumeKey
    is_labels: bool
    like: Volume | None


def _read_and_prepared(
    jobs: Collection[_Job], preparations: Sequence[Preparation], task: Task
) -> dict[VolumeKey, tuple[Volume, Range | None]]:
    """Volumes of a time point, with all that showing them needs, and their ranges where these count. On a worker."""
    read: dict[VolumeKey, tuple[Volume, Range | None]] = {}
    for job in jobs:
        volume = read_volume(job.source, job.key, task)
        for prepare in preparations:
            task.report(-1.0)
            prepare([] if job.is_labels else [volume], [volume] if job.is_labels else [])
        values = None
        if job.like is not None:
            look_like(volume, job.like)
        elif not job.is_labels:
            values = robust_range(volume)
            auto_isovalue(volume)
        read[job.key] = volume, values
    return read
