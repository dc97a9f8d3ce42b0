"""``python -m rwmf`` is the command ``rwmf``."""

import sys

from rwmf.cli import main

__all__ = ["main"]

if __name__ == "__main__":
    sys.exit(main())
