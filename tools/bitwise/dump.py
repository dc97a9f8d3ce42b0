"""Numbers of datasets and other answers of Python."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import xarray as xr

from bitwise.clean import VOLATILE

__all__ = ["dump_dataset", "dump_value"]


def dump_dataset(dataset: xr.Dataset) -> str:
    """Write out the numbers of a dataset; units, labels and other texts are left out."""
    parts = []
    for name, array in dataset.variables.items():
        parts += [f"{name} {dict(array.sizes)}", dump_value(array.values)]
    return "\n".join([*parts, dump_value(dict(dataset.attrs))]) + "\n"


def dump_value(value: object) -> str:
    """Write out numbers; they round-trip to the same bits."""
    if isinstance(value, Mapping):
        shown = {key: dump_value(item) for key, item in value.items() if key not in VOLATILE}
        return "\n".join(f"  {key}: {text}" for key, text in shown.items() if text)
    if isinstance(value, np.ndarray) and value.ndim > 1:
        return "\n".join(map(dump_value, value))
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return ", ".join(map(dump_value, value))
    if isinstance(value, float) and math.isnan(value):
        return "nan"
    # the zero of a number keeps its sign
    return "" if isinstance(value, str | bytes) else repr(value)
