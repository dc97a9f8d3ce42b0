"""Command of ``tools/docs``, which installs the requirements and calls it."""

from __future__ import annotations

import sys

from pages.steps import main

if __name__ == "__main__":
    sys.exit(main())
