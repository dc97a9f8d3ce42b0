"""What ``rwmf check`` does."""

from __future__ import annotations

import argparse

from rwmf import _library
from rwmf.case import Case

__all__ = ["run"]

# lines of `rwmf check`: word of the kernel's inventory, how it is shown, and when there is none
_INVENTORY = (
    ("effects", "effects", "none"),
    ("absent", "not simulated", "nothing is left out"),
    ("states", "states", "none"),
    ("events", "events", "none"),
    ("scalars", "outputs", "none"),
    ("columns", "history", "none (&output dt)"),
)


def run(options: argparse.Namespace) -> int:
    """Validate a case and say what it holds (``rwmf check``).

    Parameters
    ----------
    options : argparse.Namespace
        As the parser of the command line makes them.

    Returns
    -------
    int
        Exit status.

    Raises
    ------
    InputError, NumericalError, OutputError, Interrupted
        As the computation and the writers of files.
    """
    case = Case.from_namelist(options.case)
    found = case.kernel.inventory()
    print(f"{options.case}: valid")
    for word, shown, nothing in _INVENTORY:
        print(f"{shown}: {', '.join(found.get(word, [])) or nothing}")
    n = case.kernel.ordinates()
    if n > 0:
        print(f"spectrum: {n} simulations")
    warning = _library.law_warning(case.kernel.broken_laws())
    for kind, lines in (("note", found["notes"]), ("warning", warning.splitlines())):
        print("".join(f"{kind}: {line}\n" for line in lines), end="")
    print("values, those that the case does not give in parentheses:")
    for name, group in case.groups.items():
        print(f"  {name:8s} {group!r}")
    return 0
