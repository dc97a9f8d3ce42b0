#!/usr/bin/env python3
"""Make one static library of the kernel and the parts of SUNDIALS that it uses.

All objects are linked into one object, in which only the kernel's public names are visible. A host
needs no further library of ours on its link line, and may use another SUNDIALS.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

# Fortran module procedures and data, and the C binding.
VISIBLE = ["__rwmf*", "rwmf_*"]


def main() -> None:
    """Link ``KERNEL [ARCHIVE ...]`` into ``OUTPUT``.

    The arguments are the output, the kernel's archive and the archives that it may take objects
    from.
    """
    output, kernel, *archives = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        joined = Path(folder) / "rwmf.o"
        link = ["ld", "-r", "-o", str(joined), "--whole-archive", kernel, "--no-whole-archive"]
        subprocess.run([*link, "--start-group", *archives, "--end-group"], check=True)
        names = [f"--keep-global-symbol={name}" for name in VISIBLE]
        subprocess.run(["objcopy", "--wildcard", *names, str(joined)], check=True)
        Path(output).unlink(missing_ok=True)
        subprocess.run(["ar", "rcs", output, str(joined)], check=True)


if __name__ == "__main__":
    main()
