"""Writing volumes: `save`, and one table of writers beside that of the readers."""

from volviz.io.writers.saving import check_volume_target, losses, save
from volviz.io.writers.table import WRITERS, Writer

__all__ = ["WRITERS", "Writer", "check_volume_target", "losses", "save"]
