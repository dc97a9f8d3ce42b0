"""Statistics over a suite of records; rocking responses need distributions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from rwmf._arguments import array_of
from rwmf._numbers import show, to_array
from rwmf.errors import InputError
from rwmf.quantities import ENDINGS

__all__ = ["cumulative_distribution", "percentiles", "with_overturning"]

# median and one standard deviation of a normal distribution on both sides
USUAL_PERCENTILES = (16.0, 50.0, 84.0)


def with_overturning(dataset: xr.Dataset, name: str = "u_s_max") -> xr.DataArray:
    """Return a quantity of a sweep, infinite for overturning or collapse.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.sweep`.
    name : str
        The quantity.

    Returns
    -------
    xarray.DataArray
        The quantity, infinite where the wall overturned or the frame collapsed (failures, whatever
        the earlier peaks), NaN where the run failed.
    """
    names = dataset["status"].attrs["flag_meanings"].split()
    fallen = dataset["status"].isin([names.index(name) for name in ENDINGS if name in names])
    return dataset[name].where(~fallen, np.inf).assign_attrs(dataset[name].attrs)


def percentiles(
    values: xr.DataArray, q: Sequence[float] = USUAL_PERCENTILES, dim: str = "record"
) -> xr.DataArray:
    """Compute percentiles over a suite by ranks, including overturned runs.

    Parameters
    ----------
    values : xarray.DataArray
        A quantity, see `with_overturning`.
    q : sequence of float
        Percentages [%].
    dim : str
        Dimension of the suite.

    Returns
    -------
    xarray.DataArray
        Percentiles over ``percentile`` and the other dimensions, without failed runs.

    Raises
    ------
    InputError
        When an argument has the wrong type.
    """
    array_of(values, dim)
    levels = to_array("q", q, least=1)
    if not ((levels >= 0) & (levels <= 100)).all():
        raise InputError(f"q = {show(q)}: must be in [0, 100] [%]")
    axis = values.get_axis_num(dim)
    # linear interpolation between a number and infinity would give infinity or NaN
    found = np.nanquantile(values.values, levels / 100, axis=axis, method="inverted_cdf")
    kept = values.isel({dim: 0}, drop=True)
    return xr.DataArray(
        found,
        dims=("percentile", *kept.dims),
        coords={"percentile": ("percentile", levels.tolist(), {"units": "%"}), **kept.coords},
        name=values.name,
        attrs=values.attrs,
    )


def cumulative_distribution(values: xr.DataArray, levels: Sequence[float]) -> xr.DataArray:
    """Compute the fraction of a suite at or below each level.

    Parameters
    ----------
    values : xarray.DataArray
        A quantity over ``record`` and other dimensions, see `with_overturning`.
    levels : sequence of float
        Levels in the quantity's unit.

    Returns
    -------
    xarray.DataArray
        Fractions [-] over ``level`` and the other dimensions, without failed runs.
    """
    array_of(values, "record")
    level = xr.DataArray(to_array("levels", levels, least=1), dims="level", attrs=values.attrs)
    below = (values <= level).sum("record") / values.notnull().sum("record")
    found = below.assign_coords(level=level).rename("fraction")
    return found.assign_attrs(units="1", long_name=f"fraction of the suite, {values.name}")
