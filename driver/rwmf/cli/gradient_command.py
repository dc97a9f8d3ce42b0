"""Subcommand ``rwmf gradient``."""

from __future__ import annotations

import argparse
import math

import xarray as xr

from rwmf._gradient.gradient import gradient
from rwmf.case import Case
from rwmf.cli.output import print_json

__all__ = ["print_gradient", "run"]

_WIDTH = 14


def run(options: argparse.Namespace) -> int:
    """Print derivatives (``rwmf gradient``).

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
    InputError, NumericalError, Interrupted
        As the computation.
    """
    case = Case.from_namelist(options.case)
    found = gradient(
        case,
        _words(options.parameters) or None,
        _words(options.quantities) or None,
        records=options.records,
        statistic=options.statistic,
        unit=options.unit,
        threads=options.threads,
    )
    if options.json:
        names = [*found.data_vars, "parameter_value", "parameter_scale"]
        print_json(
            {"quantity": found["quantity"].values.tolist()}
            | {"parameter": found["parameter"].values.tolist()}
            | {str(name): found[name].values for name in names}
            | ({"record": found["record"].values.tolist()} if "record" in found.dims else {})
            | {"runs": int(found.attrs["runs"])}
        )
    else:
        print_gradient(found)
    return 0


def _words(items: list[str] | None) -> list[str]:
    return [word for item in items or [] for word in item.split(",") if word]


def print_gradient(found: xr.Dataset) -> None:
    """Print derivatives as tables, one for each record and quantity.

    Parameters
    ----------
    found : xarray.Dataset
        From `rwmf.gradient`.
    """
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
    relative = slope * float(cell["parameter_scale"])
    numbers = [
        f"{float(cell['parameter_value']):.6g}",
        f"{slope:.8g}",
        f"{float(cell['error']):.1e}",
        f"{relative:.6g}",
        _share(float(cell["valid_within"])),
    ]
    text = "".join(f"{'-' if number == 'nan' else number:>{_WIDTH}s}" for number in numbers)
    return text + ("  kink" if bool(cell["is_kink"]) else "")


def _share(value: float) -> str:
    return "-" if math.isnan(value) else f"{100 * value:.3g} %"
