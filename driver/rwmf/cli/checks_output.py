"""Checks against `&limits` in the output of the commands.

A case without limits imports nothing for them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rwmf.case import Case
from rwmf.errors import InputError
from rwmf.plotting import image_files as figures

if TYPE_CHECKING:
    import xarray as xr

    from rwmf._checks.checks import Checks

__all__ = ["check_words", "checks_if_limited", "print_checks", "write_checks"]


def check_words(case: Case, paths: Sequence[str] | None) -> None:
    """Check the option ``--checks`` before a computation."""
    if paths and not case.kernel.limited_demands():
        raise InputError("--checks: the case has no &limits: a check needs limits of demands")
    figures.check_formats(*(path for path in paths or () if not _is_csv(path)))


def checks_if_limited(case: Case, result: xr.Dataset | Mapping[str, Any]) -> Checks | None:
    """Compare demands with the limits of a case."""
    if not case.kernel.limited_demands():
        return None
    from rwmf._checks.checks import checks

    return checks(case, result)


def print_checks(found: Checks | None, *, is_all: bool = False) -> None:
    """Print a table of checks."""
    if found is not None:
        from rwmf._checks.check_table import text_of

        print(text_of(found, is_all=is_all))


def write_checks(found: Checks | None, paths: Sequence[str] | None) -> None:
    """Write checks as CSV or figure, by the endings of the files."""
    if found is None or not paths:
        return
    from rwmf._checks.check_table import write_csv
    from rwmf.plotting.checks_figure import save_checks

    for path in paths:
        if _is_csv(path):
            write_csv(found, path)
        else:
            save_checks(found, path)


def _is_csv(path: str) -> bool:
    return Path(path).suffix.lower() == ".csv"
