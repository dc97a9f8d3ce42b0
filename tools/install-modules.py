#!/usr/bin/env python3
"""Install the compiler's module files of the kernel; meson leaves them behind."""

import os
import shutil
import sys
from pathlib import Path


def main() -> None:
    """Copy ``LIBRARY.p/*.mod`` into the include folder.

    The arguments are the library's path and the include folder, relative to the prefix; meson
    gives the prefix (with DESTDIR) in the environment.

    Raises
    ------
    SystemExit
        If the library has no module files.
    """
    library, include = Path(sys.argv[1]), sys.argv[2]
    modules = sorted(Path(f"{library}.p").glob("*.mod"))
    if not modules:
        raise SystemExit(f"no module files beside {library}")
    target = Path(os.environ["MESON_INSTALL_DESTDIR_PREFIX"]) / include
    target.mkdir(parents=True, exist_ok=True)
    for module in modules:
        shutil.copy2(module, target)


if __name__ == "__main__":
    main()
