"""Datasets as arguments of public functions; xarray is loaded by the first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rwmf.errors import InputError
from rwmf.kernel.numbers import show

if TYPE_CHECKING:
    import xarray as xr


def dataset_of(value: object, origin: str, *names: str) -> xr.Dataset:
    """Return a dataset after checking that it comes from a function of the package."""
    import xarray as xr

    from rwmf.run.response import as_response

    if not isinstance(value, xr.Dataset):
        raise InputError(f"dataset = {show(value)}: must be the dataset of {origin}")
    missing = [name for name in names if name not in value.variables]
    if missing:
        raise InputError(f"dataset: has no {missing[0]}: must be the dataset of {origin}")
    return as_response(value)
