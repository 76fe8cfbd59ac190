"""What this program is, and with what it runs here."""

from __future__ import annotations

import platform

from PySide6.QtCore import Qt, qVersion
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QHBoxLayout, QLabel, QWidget

from volviz_ui.style.app_icon import app_icon
from volviz_ui.widgets.dialog_layout import lay_out


class AboutDialog(QDialog):
    """Version, licence, and the versions of what matters for a report."""

    def __init__(self, opengl: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("About VolViz"))
        import pyvista
        import vtk

        import volviz

        image = QLabel(self)
        image.setPixmap(app_icon().pixmap(72, 72))
        image.setAlignment(Qt.AlignmentFlag.AlignTop)
        words = QLabel(self)
        words.setTextFormat(Qt.TextFormat.RichText)
        words.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        words.setWordWrap(True)
        words.setMinimumWidth(380)
        head = self.tr("Look into volumes, and see how volume rendering works.")
        rows = {
            "Python": platform.python_version(),
            "Qt": qVersion(),
            "VTK": vtk.vtkVersion.GetVTKVersion(),
            "PyVista": pyvista.__version__,
            "OpenGL": opengl or "–",
        }
        table = "".join(f"<tr><td>{key}&nbsp;&nbsp;</td><td>{value}</td></tr>" for key, value in rows.items())
        words.setText(
            f"<h3>VolViz {volviz.__version__}</h3><p>{head}</p><table>{table}</table>"
            f"<p>{self.tr('MIT licence. Not a medical device: not for diagnosis.')}</p>"
        )
        top = QHBoxLayout()
        top.setSpacing(20)
        top.addWidget(image)
        top.addWidget(words, 1)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close, self)
        buttons.rejected.connect(self.reject)
        lay_out(self, top, buttons, spacing=16)
