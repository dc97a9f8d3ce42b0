#!/usr/bin/env python3
"""Join source files, so that the compiler can put their procedures into each other."""

import sys
from pathlib import Path


def main() -> None:
    """Write the files one after the other; messages of the compiler still name them.

    The arguments are the file to be written and those to be joined, in the order in which one
    module uses another.
    """
    target, *sources = sys.argv[1:]
    parts = [f'# 1 "{name}"\n{Path(name).read_text(encoding="utf-8")}\n' for name in sources]
    Path(target).write_text("".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
