"""Percentiles of demands over the records at each level of intensity."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from rwmf._arguments import checked, texts_of
from rwmf._numbers import show, to_array
from rwmf._risk.table import fallen, quantities_of, read_table
from rwmf.errors import InputError

__all__ = ["demand_percentiles"]

Array = npt.NDArray[np.float64]
# median and one standard deviation of a normal distribution on both sides
_USUAL = (16.0, 50.0, 84.0)


@checked
def demand_percentiles(
    table: Any,  # noqa: ANN401 (several forms)
    quantities: str | Sequence[str] | None = None,
    q: Sequence[float] = _USUAL,
) -> xr.Dataset:
    """Compute percentiles of demands over the records at each level, by ranks.

    The demand of a record between two of its levels is interpolated; above its first overturning or
    collapse it is infinite.

    Parameters
    ----------
    table : xarray.Dataset or path
        Table of `rwmf.ida` or `rwmf.stripes`.
    quantities : str or sequence of str, optional
        Demands; all of the table when absent.
    q : sequence of float
        Percentages [%].

    Returns
    -------
    xarray.Dataset
        Each demand over ``design``, ``intensity`` and ``percentile``, infinite where so many
        records overturned or collapsed; ``collapsed`` and ``runs`` count records.

    Raises
    ------
    InputError
        When an argument is not acceptable, or when the table is a cloud.
    """
    rows = read_table(table)
    if rows.attrs.get("analysis") == "cloud":
        raise InputError("percentiles: the table is a cloud, without common levels of intensity")
    known = quantities_of(rows)
    names = known if quantities is None else texts_of("quantities", quantities)
    unknown = [name for name in names if name not in known]
    if unknown:
        listed = ", ".join(known) or "none"
        raise InputError(f"quantities: {show(unknown[0])}: is not in the table, which has {listed}")
    percent = to_array("q", q, least=1)
    if not ((percent >= 0) & (percent <= 100)).all():
        raise InputError(f"q = {show(q)}: must be in [0, 100] [%]")
    levels = np.unique(rows["intensity"].values)
    designs = list(dict.fromkeys(rows["design"].values.tolist()))
    shape = (len(designs), levels.size)
    found = {name: np.full((*shape, percent.size), math.nan) for name in names}
    counts = np.zeros((2, *shape), dtype=int)
    for i, design in enumerate(designs):
        own = rows.isel(row=np.flatnonzero(rows["design"].values == design))
        for name in names:
            values = _curves(own, name, levels)
            used = ~np.isnan(values).all(axis=0)
            # interpolation between a number and infinity would give infinity
            found[name][i, used] = np.nanquantile(
                values[:, used], percent / 100, axis=0, method="inverted_cdf"
            ).T
        where = np.searchsorted(levels, own["intensity"].values)
        counts[0, i] = np.bincount(where[fallen(own)], minlength=levels.size)
        counts[1, i] = np.bincount(where, minlength=levels.size)
    over = ("design", "intensity")
    return xr.Dataset(
        {name: ((*over, "percentile"), values, rows[name].attrs) for name, values in found.items()}
        | {"collapsed": (over, counts[0]), "runs": (over, counts[1])},
        coords={
            "design": ("design", np.array(designs, dtype=object)),
            "intensity": ("intensity", levels, rows["intensity"].attrs),
            "percentile": ("percentile", percent, {"units": "%"}),
        },
        attrs=rows.attrs,
    )


def _curves(rows: xr.Dataset, name: str, levels: Array) -> Array:
    """Interpolate each record's demand at the levels; NaN above its last run without collapse."""
    found = []
    names = rows["record"].values
    for record in dict.fromkeys(names.tolist()):
        own = rows.isel(row=np.flatnonzero(names == record))
        x, y, down = own["intensity"].values, own[name].values, fallen(own)
        first = x[down].min() if down.any() else math.inf
        upright = (x < first) & ~np.isnan(y)
        order = np.argsort(x[upright], kind="stable")
        px, py = x[upright][order], y[upright][order]
        curve = np.full(levels.size, math.nan)
        if px.size:
            inside = levels <= px[-1]
            # a scaled record of no intensity has no demand
            curve[inside] = np.interp(levels[inside], [0.0, *px], [0.0, *py])
        if down.any():
            curve[levels > (px[-1] if px.size else 0.0)] = math.inf
        found.append(curve)
    return np.array(found)
