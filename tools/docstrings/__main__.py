"""Command: count incomplete docstrings, and list them with file and line."""

from __future__ import annotations

import sys
from pathlib import Path

from docstrings import of_fortran, of_python

ROOT = Path(__file__).resolve().parents[2]
_PYTHON = ("driver", "plots", "tools")


def main() -> int:
    """Look at all sources.

    Returns
    -------
    int
        Exit status: 1 when something is missing.
    """
    status = 0
    kinds = {
        "Python": ([p for name in _PYTHON for p in (ROOT / name).rglob("*.py")], of_python.check),
        "Fortran": ((ROOT / "src").rglob("*.[fF]90"), of_fortran.check),
    }
    for kind, (paths, check) in kinds.items():
        total, findings = 0, []
        for path in sorted(paths):
            n, found = check(path)
            total += n
            findings += found
        for item in findings:
            print(f"{item.path.relative_to(ROOT)}:{item.line}: {item.text}")
        print(f"docstrings of {kind}: {total}, missing: {len(findings)}")
        status = status or int(bool(findings))
    return status


if __name__ == "__main__":
    sys.exit(main())
