#!/usr/bin/env python3
"""Install the module file of the facade, ``rwmf.mod``; meson leaves it behind.

A module file of gfortran contains everything that its module makes public, of other modules too:
hosts need this one alone.
"""

import os
import shutil
import sys
from pathlib import Path


def main() -> None:
    """Copy ``LIBRARY.p/rwmf.mod`` into the include folder.

    The arguments are the path of the library and the include folder, relative to the prefix; meson
    gives the prefix (with DESTDIR) in the environment.
    """
    library, include = sys.argv[1:]
    module = Path(f"{library}.p") / "rwmf.mod"
    if not module.is_file():
        raise SystemExit(f"no module file {module}")
    target = Path(os.environ["MESON_INSTALL_DESTDIR_PREFIX"]) / include
    target.mkdir(parents=True, exist_ok=True)
    shutil.copy2(module, target)


if __name__ == "__main__":
    main()
