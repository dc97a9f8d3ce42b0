"""Arrays of the kernel as labelled datasets, at little cost beside the computation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

__all__ = ["Labelled", "dataset"]

# dimensions, values and attributes of a variable, as xarray takes them
Labelled = tuple[tuple[str, ...], Any, Mapping[str, Any]]


def dataset(
    variables: Mapping[str, Labelled],
    coordinates: Mapping[str, Labelled],
    attributes: Mapping[str, Any],
) -> xr.Dataset:
    """Put arrays that fit together into a dataset.

    The dataset is the one that ``xarray.Dataset`` makes of the same. That looks for indexes, copies
    and aligns, which takes ten times as long as a short run; here all of it is known.

    Parameters
    ----------
    variables : mapping of str to tuple
        Dimensions, values and attributes of each variable.
    coordinates : mapping of str to tuple
        Likewise; one that is named like its only dimension becomes an index.
    attributes : mapping of str to object
        Of the dataset.

    Returns
    -------
    xarray.Dataset
        The dataset.
    """
    make = _quick_way()
    if make is None:
        return xr.Dataset(dict(variables), dict(coordinates), dict(attributes))
    sizes: dict[str, int] = {}
    indexes: dict[str, xr.indexes.PandasIndex] = {}
    made: dict[str, xr.Variable] = {}
    for name, (dims, values, attrs) in (*variables.items(), *coordinates.items()):
        # the kernel's arrays need no conversion
        variable = xr.Variable(dims, values, attrs, fastpath=isinstance(values, np.ndarray))
        sizes |= zip(dims, variable.shape, strict=True)
        if name in coordinates and dims == (name,):
            # under its name already, the index is not copied once more to get one
            index = pd.Index(variable.values, name=name)
            indexes[name] = xr.indexes.PandasIndex(index, name, coord_dtype=variable.dtype)
            variable = indexes[name].create_variables({name: variable})[name]
        made[name] = variable
    found: xr.Dataset = make(made, set(coordinates), sizes, dict(attributes), indexes)
    return found


def _quick_way() -> Callable[..., xr.Dataset] | None:
    """Find what xarray itself makes datasets of known parts with; a version may lack it."""
    return getattr(xr.Dataset, "_construct_direct", None)
