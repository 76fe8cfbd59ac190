"""What the editor works on: the function in the store and the chosen points."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from shiboken6 import isValid

from volviz.model.store import Store
from volviz.model.transfer import edits
from volviz.model.transfer.channels import Channel, merged, split

if TYPE_CHECKING:
    from volviz.model.transfer.function import TransferFunction
    from volviz.volume_data.volume import Volume
    from volviz_ui.session.documents import Documents
    from volviz_ui.session.loaded_scene import LoadedScene

GESTURE = "transfer function"
"""Key of the gestures of the editor, of which one runs at a time."""


class EditorModel(QObject):
    """Reads the transfer function from the store and writes it there; keeps what is selected.

    Values are in data units: a relative function is resolved with the range of the volume as soon as it is
    shown, and stored resolved once it is edited.

    Parameters
    ----------
    store : Store
        Where edits go.
    documents : Documents
        Gives the function with the volume that it colours.
    parent : QObject
        Owner.
    """

    function_changed = Signal()
    selection_changed = Signal()
    range_changed = Signal()

    def __init__(self, store: Store, documents: Documents, parent: QObject) -> None:
        super().__init__(parent)
        self.store = store
        self.documents = documents
        self._selection: frozenset[int] = frozenset()
        self._color_point: int | None = None
        self._selection_before: frozenset[int] = frozenset()
        self._color_point_before: int | None = None
        self._writing = False
        self._shown: TransferFunction | None = None
        self._cached_channels: tuple[TransferFunction, tuple[Channel, Channel]] | None = None
        self._read()
        documents.changed.connect(self._on_shown_changed)

    # ------------------------------------------------------------------ what there is

    @property
    def function(self) -> TransferFunction | None:
        """The function in data units; None when there is no layer."""
        return self._shown

    @property
    def volume(self) -> Volume | None:
        """The volume that the function colours."""
        return self.documents.volume

    @property
    def data_range(self) -> tuple[float, float]:
        """Range of the data; of the function's points while no volume is there."""
        if self.volume is not None:
            low, high = self.volume.range
        elif self._shown is not None:
            low, high = self._shown.points[0].value, self._shown.points[-1].value
        else:
            low, high = 0.0, 1.0
        return (low, high) if low < high else (low, low + 1.0)

    @property
    def unit(self) -> str:
        """Unit of the values."""
        return "" if self.volume is None else self.volume.unit

    @property
    def selection(self) -> frozenset[int]:
        """Indices of the chosen points."""
        return self._selection

    @property
    def color_point(self) -> int | None:
        """Index of the chosen stop of the colour ramp."""
        return self._color_point

    @property
    def channels(self) -> tuple[Channel, Channel]:
        """Colours and opacities of the function, each with the stops it needs."""
        if self._shown is None:
            return (), ()
        if self._cached_channels is None or self._cached_channels[0] != self._shown:
            self._cached_channels = (self._shown, split(self._shown))
        return self._cached_channels[1]

    @property
    def in_gesture(self) -> bool:
        """Whether a drag is going on."""
        return self.store.has_gesture(GESTURE)

    def select(self, indices: Iterable[int]) -> None:
        """Choose points, and no stop of the ramp."""
        last = 0 if self._shown is None else len(self._shown.points)
        chosen = frozenset(i for i in indices if 0 <= i < last)
        if chosen != self._selection or self._color_point is not None:
            self._selection, self._color_point = chosen, None
            self.selection_changed.emit()

    def select_color_point(self, index: int | None) -> None:
        """Choose a stop of the colour ramp, and no points."""
        if index != self._color_point or self._selection:
            self._selection, self._color_point = frozenset(), index
            self.selection_changed.emit()

    # ------------------------------------------------------------------ changing it

    def apply(self, function: TransferFunction, label: str, selection: Iterable[int] | None = None) -> None:
        """One change, one step of the history (or part of the running gesture)."""
        self._write(function, label, selection)

    def begin(self) -> None:
        """A gesture starts: what follows until `finish` is one step of the history."""
        self.finish()
        self._selection_before, self._color_point_before = self._selection, self._color_point
        self.store.begin_gesture(GESTURE)

    def finish(self) -> None:
        """The gesture is over."""
        self.store.end_gesture(GESTURE)

    def cancel(self) -> None:
        """Take back what the gesture has changed."""
        if self.in_gesture:
            self._writing = True
            try:
                self.store.cancel_gesture(GESTURE)
            finally:
                self._writing = False
            self._read()
            self._selection, self._color_point = self._selection_before, self._color_point_before
            self.function_changed.emit()
            self.selection_changed.emit()

    def apply_channels(
        self, colors: Channel, opacities: Channel, label: str, color_point: int | None = None
    ) -> None:
        """Colours and opacities put together and stored; the channels keep stops that lie on a straight line.

        Parameters
        ----------
        colors, opacities : tuple of ChannelPoint
            The channels.
        label : str
            What happened.
        color_point : int, optional
            Point of the colours to choose; default: the one that is chosen.
        """
        if self._shown is None:
            return
        function = merged(colors, opacities, self._shown)
        self._selection, self._color_point = (
            frozenset(),
            self._color_point if color_point is None else color_point,
        )
        self._cached_channels = (function, (colors, opacities))
        self._write(function, label)
        self.selection_changed.emit()

    # ------------------------------------------------------------------ edits of the chosen points

    def delete_selected(self) -> None:
        """Remove the chosen points; one always stays."""
        if self._shown is not None and self._selection:
            self.apply(self._shown.without_points(self._selection), self.tr("Delete points"), ())

    def duplicate_selected(self, offset: float) -> None:
        """Copy the chosen points and choose the copies."""
        if self._shown is not None and self._selection:
            function, copies = edits.duplicated(self._shown, self._selection, offset)
            self.apply(function, self.tr("Duplicate points"), copies)

    def nudge(self, value: float, opacity: float) -> None:
        """Move the chosen points by a small step."""
        if self._shown is not None and self._selection:
            moved = edits.moved(self._shown, self._selection, value, opacity)
            self.apply(moved, self.tr("Move points"))

    def color_selected(self, color: tuple[float, float, float]) -> None:
        """Give the chosen points, or the chosen stop of the ramp, a colour."""
        if self._shown is None:
            return
        if self._color_point is not None:
            from volviz.model.transfer.channels import with_level

            colors, opacities = self.channels
            self.apply_channels(
                with_level(colors, self._color_point, color), opacities, self.tr("Change colour")
            )
            return
        function = self._shown
        for i in self._selection:
            function = function.with_changed_point(i, color=color)
        self.apply(function, self.tr("Change colour"))

    # ------------------------------------------------------------------ the store

    def _write(self, function: TransferFunction, label: str, selection: Iterable[int] | None = None) -> None:
        if self.store.scene.layer is None or not self.documents.is_current:
            return  # another function is awaited together with its volume
        self._writing = True
        try:
            self.store.update(
                lambda scene: scene.with_layer(transfer_function=function), label=label, gesture=GESTURE
            )
        finally:
            self._writing = False
        changed = self._read()
        # Before anybody hears of the new function, no index may point beyond it.
        wanted = self._selection if selection is None else frozenset(selection)
        chosen = frozenset(i for i in wanted if self._shown is not None and i < len(self._shown.points))
        color_point = self._color_point if selection is None else None
        new_choice = (chosen, color_point) != (self._selection, self._color_point)
        self._selection, self._color_point = chosen, color_point
        if changed:
            self.function_changed.emit()
        if new_choice:
            self.selection_changed.emit()

    def _read(self) -> bool:
        function = self.documents.shown.transfer_function
        if function is not None and function.domain == "relative":
            low, high = (0.0, 1.0) if self.volume is None else self.volume.range
            function = function.resolved((low, high) if low < high else (low, low + 1.0))
        if function == self._shown:
            return False
        self._shown = function
        return True

    def _on_shown_changed(self, old: LoadedScene, new: LoadedScene) -> None:
        if self._writing or not isValid(self):
            return
        before = self._shown
        is_other = self._read()
        if not _is_same_data(old, new):
            self.range_changed.emit()
        elif not is_other:
            return
        if self._shown is None or before is None or len(before.points) != len(self._shown.points):
            self._selection = frozenset()
        if self._color_point is not None and self._color_point >= len(self.channels[0]):
            self._color_point = None
        self.function_changed.emit()
        self.selection_changed.emit()


def _is_same_data(old: LoadedScene, new: LoadedScene) -> bool:
    """Whether the values are those of before, or of another time point, which leaves the axis as it is."""
    before, after = old.scene.layer, new.scene.layer
    if before is None or after is None:
        return before is after
    return before.key.ref == after.key.ref and before.channel == after.channel
