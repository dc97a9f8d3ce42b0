"""Results as JSON, checks against `&limits`, warnings on the error output."""

from __future__ import annotations

import argparse
import json
import math
import sys
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rwmf.case import Case
from rwmf.errors import InputError, RwmfWarning
from rwmf.kernel import files
from rwmf.kernel.numbers import to_json

if TYPE_CHECKING:
    import xarray as xr

    from rwmf.run.checks import Checks


def check_words(case: Case, paths: Sequence[str] | None) -> None:
    """Check the option ``--checks`` before a computation."""
    if paths and not case.kernel.limited_demands():
        raise InputError("--checks: the case has no &limits: a check needs limits of demands")
    if paths:
        from rwmf.figures.image_files import check_formats

        check_formats(*(path for path in paths if not _is_csv(path)))


def check_files(
    options: argparse.Namespace, inputs: Iterable[str | Path], case: Case | None = None
) -> list[str | None]:
    """List the files that a command writes; refuse impossible ones before its computation."""
    from rwmf.figures.image_files import check_formats

    out = options.out if isinstance(options.out, list) else [options.out]
    found = [*out, options.plot, *(getattr(options, "checks", None) or ())]
    files.check_outputs(found, inputs)
    check_formats(options.plot)
    if case is not None:
        check_words(case, options.checks)
    return found


def chosen(options: argparse.Namespace, *names: str) -> dict[str, Any]:
    """Return options as arguments of the same names."""
    return {name: getattr(options, name) for name in names}


def compare(
    case: Case, result: xr.Dataset | Mapping[str, Any], paths: Sequence[str] | None
) -> Checks | None:
    """Compare demands with the limits of a case; write CSV or figure, by the endings of files."""
    if not case.kernel.limited_demands():
        return None
    from rwmf.run.checks import checks, write_csv

    found = checks(case, result)
    for path in paths or ():
        if _is_csv(path):
            write_csv(found, path)
        else:
            from rwmf.figures.results import save_checks

            save_checks(found, path)
    return found


def print_checks(found: Checks | None, *, is_all: bool = False) -> None:
    """Print a table of checks."""
    if found is not None:
        from rwmf.run.checks import text_of

        print(text_of(found, is_all=is_all))


def _is_csv(path: str) -> bool:
    return Path(path).suffix.lower() == ".csv"


def print_json(value: dict[str, Any], checks: Checks | None = None) -> None:
    """Print an object as JSON, with checks if there are any."""
    value = value if checks is None else value | {"checks": checks.to_dict()}
    print(json.dumps(to_json(value), indent=1, allow_nan=False))


def print_warnings(path: str, lines: Iterable[str]) -> None:
    """Print the warnings about the results of a file on the error output."""
    for line in lines:
        print(f"rwmf: {path}: warning: {line}", file=sys.stderr)


@contextmanager
def printed_warnings(path: str) -> Iterator[None]:
    """Print the warnings about the inputs that a block reads, each once."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RwmfWarning)
        yield
    print_warnings(path, dict.fromkeys(str(item.message) for item in caught))


def print_written(paths: Iterable[str | Path | None], *, is_json: bool = False) -> None:
    """Print the paths of written files."""
    for path in filter(None, paths):
        print(f"written: {path}", file=sys.stderr if is_json else sys.stdout)


# columns of a table of derivatives
_WIDTH = 14


def derivatives_by_name(found: xr.Dataset) -> dict[str, Any]:
    """Name the derivatives as the summary of a run does."""
    summary: dict[str, Any] = {}
    for quantity in found["quantity"].values:
        for parameter in found["parameter"].values:
            cell = found.sel(quantity=quantity, parameter=parameter)
            name = f"d_{quantity}_d_{parameter}"
            summary[name] = cell["derivative"].item()
            for end in ("error", "valid_within", "is_kink"):
                summary[f"{name}_{end}"] = cell[end].item()
    return summary


def print_gradient(found: xr.Dataset) -> None:
    """Print derivatives as tables, one for each record and quantity."""
    if "record" in found.dims:
        for record in found["record"].values:
            print(f"{record}:")
            _print_one(found.sel(record=record))
    else:
        _print_one(found)


def _print_one(found: xr.Dataset) -> None:
    """Print a table for each quantity: one line per parameter."""
    for name in found["quantity"].values:
        row = found.sel(quantity=name)
        unit = str(row["quantity_unit"].values)
        print(f"{name} = {float(row['value']):.9g}{'' if unit == '1' else ' ' + unit}")
        words = ("parameter", "value", "derivative", "error", "|p| dq/dp", "valid within")
        names = [str(item) for item in row["parameter"].values]
        first = max(map(len, (words[0], *names)))
        print("  " + words[0].ljust(first) + "".join(f"{word:>{_WIDTH}s}" for word in words[1:]))
        for parameter in names:
            print("  " + parameter.ljust(first) + _line(row.sel(parameter=parameter)))


def _line(cell: xr.Dataset) -> str:
    """Return the numbers of a line; a kink is named."""
    slope = float(cell["derivative"])
    relative, reach = slope * float(cell["parameter_scale"]), float(cell["valid_within"])
    numbers = [
        f"{float(cell['parameter_value']):.6g}",
        f"{slope:.8g}",
        f"{float(cell['error']):.1e}",
        f"{relative:.6g}",
        "nan" if math.isnan(reach) else f"{100 * reach:.3g} %",
    ]
    text = "".join(f"{'-' if number == 'nan' else number:>{_WIDTH}s}" for number in numbers)
    return text + ("  kink" if bool(cell["is_kink"]) else "")
