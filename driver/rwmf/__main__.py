"""``python -m rwmf`` is the command ``rwmf``."""

import sys

from rwmf.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
