"""Derivatives that `&sensitivity` adds to the summary of a run."""

from __future__ import annotations

from typing import Any

import xarray as xr

from rwmf._gradient.gradient import gradient
from rwmf.case import Case
from rwmf.errors import InputError

__all__ = ["derivatives_of", "gradient_of_run"]


def gradient_of_run(case: Case, source: str) -> xr.Dataset:
    """Compute the derivatives that the case requests.

    Parameters
    ----------
    case : Case
        A case with `&sensitivity`.
    source : str
        Name of its file in messages.

    Returns
    -------
    xarray.Dataset
        As `rwmf.gradient`.

    Raises
    ------
    InputError
        When a parameter or quantity of the group is not acceptable.
    """
    try:
        return gradient(case)
    except InputError as error:
        raise InputError(f"{source}, &sensitivity: {error}") from None


def derivatives_of(found: xr.Dataset) -> dict[str, Any]:
    """Name the derivatives as the summary of a run does.

    Parameters
    ----------
    found : xarray.Dataset
        From `gradient_of_run`.

    Returns
    -------
    dict
        ``d_<quantity>_d_<key>``, and with the ends ``_error``, ``_valid_within`` and ``_is_kink``
        the variables of `rwmf.gradient`.
    """
    summary: dict[str, Any] = {}
    for quantity in found["quantity"].values:
        for parameter in found["parameter"].values:
            cell = found.sel(quantity=quantity, parameter=parameter)
            name = f"d_{quantity}_d_{parameter}"
            summary[name] = cell["derivative"].item()
            for end in ("error", "valid_within", "is_kink"):
                summary[f"{name}_{end}"] = cell[end].item()
    return summary
