"""Hazard curves: annual frequencies of exceeding an intensity, linear in logarithms."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from rwmf._numbers import show, to_array, to_items, to_number
from rwmf._risk.table import read_columns
from rwmf.errors import InputError

__all__ = ["Hazard", "hazard_of"]

Array = npt.NDArray[np.float64]
_FORMS = (
    "the path of a CSV file, a mapping with k0 and k, a mapping with intensity and frequency, "
    "or a pair (k0, k)"
)


@dataclass(frozen=True)
class Hazard:
    """Annual frequency of exceedance, a power law between neighbouring knots.

    Attributes
    ----------
    knots : numpy.ndarray, shape (n,)
        Logarithms of the intensities that separate the power laws; none for a single one.
    factors, exponents : numpy.ndarray, shape (n + 1,)
        Logarithm of the frequency at an intensity of 1, and exponent k >= 0, of each power law.
    limits : (float, float)
        Intensities within which the curve is given; outside, its end is continued.
    """

    knots: Array
    factors: Array
    exponents: Array
    limits: tuple[float, float] = (0.0, math.inf)

    def frequency(self, intensity: npt.ArrayLike) -> Array:
        """Compute annual frequencies of exceedance.

        Parameters
        ----------
        intensity : array_like
            Intensities > 0.

        Returns
        -------
        numpy.ndarray, shape (...)
            Frequencies [1/year].
        """
        u = np.log(np.asarray(intensity, dtype=float))
        part = np.searchsorted(self.knots, u, side="right")
        return np.asarray(np.exp(self.factors[part] - self.exponents[part] * u))


def hazard_of(value: Any) -> Hazard:  # noqa: ANN401 (several forms)
    """Make the hazard curve of an argument.

    Parameters
    ----------
    value : path, mapping, pair or Hazard
        Path of a CSV file with the columns intensity and frequency [1/year]. ``{"k0": , "k": }`` or
        a pair (k0, k) for the power law k0 intensity^-k. A mapping of ``intensity`` and
        ``frequency`` to arrays.

    Returns
    -------
    Hazard
        The curve.

    Raises
    ------
    InputError
        When it has none of these forms, or when its frequencies grow with the intensity.
    """
    if isinstance(value, Hazard):
        return value
    if isinstance(value, str | os.PathLike):
        return _from_file(Path(value))
    if isinstance(value, Mapping):
        names = {str(name).lower(): item for name, item in value.items()}
        if set(names) == {"k0", "k"}:
            return _power_law(names["k0"], names["k"])
        if set(names) == {"intensity", "frequency"}:
            columns = (to_array(f"hazard: {word}", names[word]) for word in names)
            found = dict(zip(names, columns, strict=True))
            return _through(found["intensity"], found["frequency"], "hazard")
    if isinstance(value, np.ndarray) and value.ndim == 2 and value.shape[1] == 2:
        table = to_array("hazard", value.ravel())
        return _through(table[::2], table[1::2], "hazard")
    items = to_items(value)
    if items is not None and len(items) == 2 and np.ndim(items[0]) == 0:
        return _power_law(*items)
    raise InputError(f"hazard = {show(value)}: must be {_FORMS}")


def _power_law(k0: object, k: object) -> Hazard:
    k0, k = to_number("hazard: k0", k0, above=0.0), to_number("hazard: k", k, above=0.0)
    return Hazard(np.empty(0), np.array([math.log(k0)]), np.array([k]))


def _from_file(path: Path) -> Hazard:
    columns, lines = read_columns(path, set(), "hazard")
    if len(columns) != 2:
        raise InputError(
            f"{path}: has {len(columns)} columns: must have two, intensity and annual frequency"
        )
    names = {name.lower().split("[")[0].strip(): name for name in columns}
    order = [names.get("intensity"), names.get("frequency", names.get("annual_frequency"))]
    x, y = (
        columns[name or given]
        for name, given in zip(order if all(order) else [None, None], columns, strict=True)
    )
    return _through(x, y, f"{path}", lines)


def _through(x: Array, y: Array, source: str, lines: npt.NDArray[np.int64] | None = None) -> Hazard:
    """Make the curve through points; the two ends are continued."""
    where = [f"row {i}" for i in range(len(x))] if lines is None else [f"line {n}" for n in lines]
    if len(x) != len(y):
        raise InputError(f"{source}: has {len(x)} intensities and {len(y)} frequencies")
    if len(x) < 2:
        raise InputError(f"{source}: has {len(x)} point: must have at least 2")
    for name, values in (("intensity", x), ("frequency", y)):
        wrong = ~(np.isfinite(values) & (values > 0))
        if wrong.any():
            i = int(np.argmax(wrong))
            hint = "; leave out points of no frequency" if values[i] == 0 else ""
            raise InputError(
                f"{source}, {where[i]}: {name} = {values[i]:g}: must be a finite number > 0{hint}"
            )
    order = np.argsort(x, kind="stable")
    u, v = np.log(x[order]), np.log(y[order])
    for i in range(1, len(u)):
        place, value = where[order[i]], x[order[i]]
        if u[i] == u[i - 1]:
            raise InputError(f"{source}, {place}: intensity = {value:g}: is given twice")
        if v[i] > v[i - 1]:
            raise InputError(
                f"{source}, {place}: frequency = {y[order[i]]:g}: must not grow with the intensity "
                f"(it is {y[order[i - 1]]:g} at {x[order[i - 1]]:g})"
            )
    k = -np.diff(v) / np.diff(u)
    return Hazard(u[1:-1], v[:-1] + k * u[:-1], k, (float(x.min()), float(x.max())))
