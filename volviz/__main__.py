"""``python -m volviz`` is the command ``volviz``."""

import sys

from volviz.cli import main

sys.exit(main())
