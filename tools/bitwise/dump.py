"""Datasets and other answers of Python as text, number by number."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import xarray as xr

from bitwise.clean import VOLATILE, without_versions

__all__ = ["dump_dataset", "dump_value"]


def dump_dataset(dataset: xr.Dataset) -> str:
    """Write out a dataset: names, order, units, types and all values.

    Parameters
    ----------
    dataset : xarray.Dataset
        Any of the package.

    Returns
    -------
    str
        A paragraph for each coordinate and variable, then the attributes; times are left out.
    """
    parts = [f"sizes {dict(dataset.sizes)}"]
    for kind, arrays in (("coordinate", dataset.coords), ("variable", dataset.data_vars)):
        for name, array in arrays.items():
            head = f"{kind} {name} {array.dims} {array.dtype.kind}"
            parts += [head, dump_value(dict(array.attrs)), dump_value(array.values)]
    parts.append(dump_value(dict(dataset.attrs)))
    return "\n".join(parts) + "\n"


def dump_value(value: object) -> str:
    """Write out a value; numbers round-trip to the same bits.

    Parameters
    ----------
    value : object
        Numbers, texts, arrays, lists and mappings of them.

    Returns
    -------
    str
        One line a value of an array's last axis or of a mapping; times are left out.
    """
    if isinstance(value, Mapping):
        kept = {key: item for key, item in value.items() if key not in VOLATILE}
        return "\n".join(f"  {key}: {dump_value(item)}" for key, item in kept.items())
    if isinstance(value, np.ndarray):
        return _dump_array(value)
    if isinstance(value, list | tuple):
        return "[" + ", ".join(dump_value(item) for item in value) + "]"
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float):
        return _dump_float(value)
    return without_versions(str(value))


def _dump_array(values: np.ndarray) -> str:
    if values.ndim == 0:
        return dump_value(values.item())
    if values.ndim == 1:
        return ", ".join(dump_value(item) for item in values.tolist())
    return "\n".join(_dump_array(row) for row in values)


def _dump_float(value: float) -> str:
    # all NaNs alike; a zero keeps its sign
    return "nan" if math.isnan(value) else repr(value)
