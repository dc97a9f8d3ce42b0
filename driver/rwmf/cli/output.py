"""Results as JSON, checks against `&limits`, warnings on the error output."""

from __future__ import annotations

import json
import math
import sys
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rwmf.case import Case
from rwmf.errors import InputError, RwmfWarning

if TYPE_CHECKING:
    import xarray as xr

    from rwmf._checks.checks import Checks


def check_words(case: Case, paths: Sequence[str] | None) -> None:
    """Check the option ``--checks`` before a computation."""
    if paths and not case.kernel.limited_demands():
        raise InputError("--checks: the case has no &limits: a check needs limits of demands")
    if paths:
        from rwmf.plotting.image_files import check_formats

        check_formats(*(path for path in paths if not _is_csv(path)))


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


def print_json(value: dict[str, Any]) -> None:
    """Print an object as JSON."""
    print(json.dumps(plain(value), indent=1, allow_nan=False))


def print_warnings(path: str, lines: Iterable[str]) -> None:
    """Print the warnings about the results of a file on the error output."""
    for line in lines:
        print(f"rwmf: {path}: warning: {line}", file=sys.stderr)


@contextmanager
def printed_warnings(path: str) -> Iterator[None]:
    """Print the warnings about the inputs that a block reads."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RwmfWarning)
        yield
    print_warnings(path, (str(item.message) for item in caught))


def print_written(paths: Iterable[str | Path | None], *, is_json: bool = False) -> None:
    """Print the paths of written files."""
    for path in filter(None, paths):
        print(f"written: {path}", file=sys.stderr if is_json else sys.stdout)


def plain(value: object) -> object:
    """Convert to JSON types; values that are not finite become null."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
