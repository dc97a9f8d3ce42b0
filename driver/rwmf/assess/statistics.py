"""Statistics over a suite of records; rocking responses need distributions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from rwmf.case.arguments import array_of, checked
from rwmf.errors import InputError
from rwmf.kernel.numbers import show, to_array, to_items
from rwmf.run.arguments import dataset_of
from rwmf.run.quantities import fallen


def with_overturning(dataset: xr.Dataset, name: str = "u_s_max") -> xr.DataArray:
    """Return a quantity of a sweep, infinite for overturning or collapse."""
    stands = dataset["status"].copy(data=~fallen(dataset))
    return dataset[name].where(stands, np.inf).assign_attrs(dataset[name].attrs)


@checked
def quantile(
    dataset: xr.Dataset,
    quantity: str = "u_s_max",
    q: float | Sequence[float] = (0.16, 0.5, 0.84),
    dim: str = "record",
) -> xr.DataArray:
    """Compute quantiles of a quantity over a suite; overturned and collapsed runs are infinite.

    A quantile is the value of a run, by ranks, because no number lies between a finite and an
    infinite one. It is infinite where too many runs overturned or collapsed; the quantiles of
    xarray would use the last peaks of such runs.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.sweep`, `rwmf.spectrum` or an incremental dynamic analysis.
    quantity : str
        Variable of the dataset.
    q : float or sequence of float
        Shares of the runs at or below the quantile, in [0, 1].
    dim : str
        Dimension of the suite.

    Returns
    -------
    xarray.DataArray
        Quantiles over ``quantile`` (unless `q` is one number) and the other dimensions, without
        failed runs.

    Raises
    ------
    InputError
        When the dataset lacks status, quantity or dimension, or a share is not in [0, 1].

    Examples
    --------
    >>> rwmf.quantile(rwmf.sweep(case, records=suite), "u_s_max", 0.84)  # doctest: +SKIP
    """
    dataset = dataset_of(dataset, "rwmf.sweep, rwmf.spectrum or a study", "status")
    if quantity not in dataset.data_vars or quantity == "status":
        names = ", ".join(str(name) for name in dataset.data_vars if name != "status")
        raise InputError(f"quantity = {show(quantity)}: is not in the dataset, which has {names}")
    is_one = to_items(q) is None
    shares = to_array("q", [q] if is_one else q, least=1)
    if not ((shares >= 0) & (shares <= 1)).all():
        raise InputError(f"q = {show(q)}: must be in [0, 1]")
    values = array_of(with_overturning(dataset, quantity), dim)
    # linear interpolation between a number and infinity would give infinity or NaN
    found = values.quantile(shares, dim, method="inverted_cdf", keep_attrs=True, skipna=True)
    return found.isel(quantile=0) if is_one else found
