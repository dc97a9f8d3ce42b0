"""Derivatives of a run as text and by name."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr


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
