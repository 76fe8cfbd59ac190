"""The difference of two views over both of them, with a bar that says what the colours mean."""

from __future__ import annotations

from PySide6.QtCore import QRectF, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from volviz.model.comparison import Comparison
from volviz_ui.views.difference_image import (
    Bytes,
    array_of,
    bar_colors,
    coloured,
    differences,
    image_of,
    largest,
    quick_similarity,
)

BAR_WIDTH, BAR_MARGIN, BAR_SHARE = 14, 16, 0.55


class DifferenceView(QWidget):
    """Shows what B has that A has not; lets the mouse through to the views below."""

    shown = Signal()
    """Another difference is to be seen."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setAccessibleName(self.tr("Difference of the two views"))
        self.comparison = Comparison(mode="difference")
        self.limit = 1.0
        self._sides: list[Bytes | None] = [None, None]
        self._exact = False
        self._similarity: Bytes | None = None
        self._image: QImage | None = None
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(0)
        self._timer.timeout.connect(self._compose)
        self.hide()

    # ------------------------------------------------------------------ what comes in

    def set_comparison(self, comparison: Comparison) -> None:
        """Show another map, channel or scale."""
        if comparison != self.comparison:
            self.comparison = comparison
            self._timer.start()

    def set_drawn(self, side: int, image: QImage) -> None:
        """A view was drawn anew: 0 the first, 1 the second."""
        self._sides[side] = array_of(image)
        self._exact = False
        self._similarity = None
        self._timer.start()

    def set_complete(self, first: Bytes, second: Bytes) -> None:
        """Both images are complete: as they would be exported, without what stands around the volume."""
        self._sides = [first, second]
        self._exact = True
        self._similarity = None
        self._compose()

    def set_similarity(self, image: Bytes) -> None:
        """The map of structural similarity of the complete images, shape (H, W, 3)."""
        self._similarity = image
        if self._exact and self.comparison.map == "ssim":
            self._compose()

    def clear(self) -> None:
        """Forget the images: other views are compared, or none."""
        self._timer.stop()
        self._sides = [None, None]
        self._image = self._similarity = None
        self._exact = False

    @property
    def is_exact(self) -> bool:
        """Whether the complete images are subtracted, not those of a drag."""
        return self._exact and self._image is not None

    @property
    def image(self) -> QImage | None:
        """The difference as it is shown, None before there is one."""
        return self._image

    # ------------------------------------------------------------------ what is shown

    def _compose(self) -> None:
        first, second = self._sides
        if first is None or second is None or first.shape != second.shape:
            return  # one of them has still its former size
        if self.comparison.map == "ssim":
            image = self._similarity if self._similarity is not None else quick_similarity(first, second)
        else:
            values = differences(first, second, self.comparison.channel)
            if self.comparison.limit is not None:
                self.limit = self.comparison.limit
            elif self._exact:
                # while something moves the colours keep their meaning
                self.limit = largest(values)
            image = coloured(values, self.comparison.map, self.limit)
        self._image = image_of(image, self.devicePixelRatioF())
        self.update()
        self.shown.emit()

    def labels(self) -> tuple[str, str, str]:
        """The numbers at the lower end, in the middle and at the upper end of the bar."""
        if self.comparison.map == "ssim":
            return "0", "0.5", "1"
        high = f"{self.limit:.3g}"
        if self.comparison.map == "signed":
            return f"\N{MINUS SIGN}{high}", "0", f"+{high}"
        return "0", f"{self.limit / 2:.3g}", high

    def caption(self) -> str:
        """What the bar counts, in two lines."""
        if self.comparison.map == "ssim":
            return self.tr("A and B") + "\n" + self.tr("similarity")
        signed = self.comparison.map == "signed"
        words = self.tr("B \N{MINUS SIGN} A") if signed else self.tr("|B \N{MINUS SIGN} A|")
        return words + "\n" + self.tr("levels of 255")

    def paintEvent(self, _event: QPaintEvent) -> None:
        """The difference, and the bar with its numbers on a dark ground."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor("#14171b"))
        if self._image is not None:
            painter.drawImage(self.rect(), self._image)
        self._paint_bar(painter)
        painter.end()

    def _paint_bar(self, painter: QPainter) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        metrics = painter.fontMetrics()
        labels, line = self.labels(), metrics.height()
        widest = max(metrics.horizontalAdvance(text) for text in (*labels, "\N{MINUS SIGN}00.0"))
        words = max(metrics.horizontalAdvance(text) for text in self.caption().splitlines())
        width = max(BAR_WIDTH + 8 + widest, words) + 16
        height = min(BAR_SHARE * self.height(), 320.0)
        ground = QRectF(
            self.width() - BAR_MARGIN - width,
            (self.height() - height) / 2 - 1.5 * line,
            width,
            height + 3 * line + 8,
        )
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(20, 23, 27, 205))
        painter.drawRoundedRect(ground, 5, 5)
        painter.setPen(QColor("#dfe3e7"))
        painter.drawText(
            QRectF(ground.left() + 8, ground.top() + 3, width - 16, 2 * line),
            Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter,
            self.caption(),
        )
        bar = QRectF(
            ground.left() + 8, ground.top() + 2 * line + 10, BAR_WIDTH, ground.height() - 3 * line - 12
        )
        painter.drawImage(bar, image_of(bar_colors(self.comparison)[::-1, None, :]))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(QColor("#8b98a5"), 1))
        painter.drawRect(bar)
        painter.setPen(QColor("#dfe3e7"))
        for text, share in zip(labels, (1.0, 0.5, 0.0), strict=True):
            at = bar.top() + share * bar.height()
            painter.drawLine(bar.topRight().toPoint().x(), round(at), round(bar.right()) + 4, round(at))
            painter.drawText(
                QRectF(bar.right() + 8, at - line / 2, widest, line),
                Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter,
                text,
            )
