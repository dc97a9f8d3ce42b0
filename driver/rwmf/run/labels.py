"""Labelled datasets from arrays of the kernel, faster than the constructor of xarray."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np
import pandas as pd
import xarray as xr

_Made = TypeVar("_Made", bound=xr.Dataset)
# dimensions, values and attributes of a variable, as xarray takes them
Labelled = tuple[tuple[str, ...], Any, Mapping[str, Any]]


def dataset(
    variables: Mapping[str, Labelled],
    coordinates: Mapping[str, Labelled],
    attributes: Mapping[str, Any],
    kind: type[_Made] = xr.Dataset,  # type: ignore[assignment]
) -> _Made:
    """Assemble arrays of matching dimensions into a dataset."""
    make = _quick_way(kind)
    if make is None:
        return kind(dict(variables), dict(coordinates), dict(attributes))
    sizes: dict[str, int] = {}
    indexes: dict[str, xr.indexes.PandasIndex] = {}
    made: dict[str, xr.Variable] = {}
    for name, (dims, values, attrs) in (*variables.items(), *coordinates.items()):
        # arrays need no conversion by xarray, which would import dask and SciPy where they exist
        variable = xr.Variable(dims, np.asarray(values), attrs, fastpath=True)
        sizes |= zip(dims, variable.shape, strict=True)
        if name in coordinates and dims == (name,):
            # the index already has this name and need not be copied to get one
            index = pd.Index(variable.values, name=name)
            indexes[name] = xr.indexes.PandasIndex(index, name, coord_dtype=variable.dtype)
            variable = indexes[name].create_variables({name: variable})[name]
        made[name] = variable
    found: _Made = make(made, set(coordinates), sizes, dict(attributes), indexes)
    return found


def _quick_way(kind: type[_Made]) -> Callable[..., _Made] | None:
    """Return xarray's constructor from known parts, or None in versions without it."""
    return getattr(kind, "_construct_direct", None)
