#!/usr/bin/env python3
"""Install the compiler's module files of the kernel; meson leaves them behind."""

import os
import shutil
import sys
from pathlib import Path


def main() -> None:
    """Copy ``LIBRARY.p/*.mod`` into the include folder.

    The arguments are the paths of the libraries and the include folder, relative to the prefix;
    meson gives the prefix (with DESTDIR) in the environment.

    Raises
    ------
    SystemExit
        If a library has no module files.
    """
    *libraries, include = sys.argv[1:]
    target = Path(os.environ["MESON_INSTALL_DESTDIR_PREFIX"]) / include
    target.mkdir(parents=True, exist_ok=True)
    for library in libraries:
        modules = sorted(Path(f"{library}.p").glob("*.mod"))
        if not modules:
            raise SystemExit(f"no module files beside {library}")
        for module in modules:
            shutil.copy2(module, target)


if __name__ == "__main__":
    main()
