#!/usr/bin/env python3
"""Describe the package of this checkout to pip, so that ``pip install 'rwmf[suites]'`` works.

checkout-metadata.py SITE_PACKAGES

The package itself is used from its folder; this folder of metadata names its version and optional
dependencies.
"""

import re
import shutil
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def main() -> None:
    """Write the folder of metadata in place of older ones."""
    site = Path(sys.argv[1])
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    build = (ROOT / "meson.build").read_text(encoding="utf-8")
    version = re.search(r"^ +version: '([\d.]+)',$", build, re.MULTILINE)
    assert version
    lines = [
        "Metadata-Version: 2.1",
        f"Name: {project['name']}",
        f"Version: {version[1]}",
        f"Summary: {project['description']}",
        f"Requires-Python: {project['requires-python']}",
        *(f"Requires-Dist: {wanted}" for wanted in project["dependencies"]),
    ]
    for purpose, packages in project["optional-dependencies"].items():
        lines.append(f"Provides-Extra: {purpose}")
        lines += [f'Requires-Dist: {wanted}; extra == "{purpose}"' for wanted in packages]
    for old in site.glob("rwmf-*.dist-info"):
        shutil.rmtree(old)
    folder = site / f"rwmf-{version[1]}.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("\n".join([*lines, ""]), encoding="utf-8")
    (folder / "INSTALLER").write_text("tools/bootstrap\n", encoding="utf-8")


if __name__ == "__main__":
    main()
