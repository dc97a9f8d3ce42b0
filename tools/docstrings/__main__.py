"""The command: count what docstrings lack, and show it with file and line when it is too much.

``PYTHONPATH=tools python -m docstrings --all`` shows what is known as well.
"""

from __future__ import annotations

import sys
from pathlib import Path

from docstrings import of_fortran, of_python

ROOT = Path(__file__).resolve().parents[2]
_PYTHON = ("driver", "plots", "tools")
# what is accepted as missing: as much as is known, to be lowered with what is mended
_KNOWN = {"Python": 0, "Fortran": 287}


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
        is_worse = len(findings) > _KNOWN[kind]
        for item in findings if is_worse or "--all" in sys.argv[1:] else ():
            print(f"{item.path.relative_to(ROOT)}:{item.line}: {item.text}")
        known = f" of {_KNOWN[kind]} known" if _KNOWN[kind] else ""
        print(f"docstrings of {kind}: {total}, missing: {len(findings)}{known}")
        status = status or int(is_worse)
    return status


if __name__ == "__main__":
    sys.exit(main())
