"""Hazard curves: annual frequencies of exceeding an intensity, linear in logarithms."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from rwmf._numbers import show, to_array, to_items, to_number
from rwmf._records.column_names import (
    ACCELERATION,
    ColumnName,
    convert,
    known_words,
    read_column_name,
)
from rwmf._risk.table import read_columns
from rwmf.errors import InputError

__all__ = ["Hazard", "hazard_of"]

Array = npt.NDArray[np.float64]
_FORMS = (
    "the path of a CSV file, a mapping with k0 and k, a mapping with intensity and frequency, "
    "or a pair (k0, k)"
)
# the steepest power law; published hazard curves have exponents of 1 to 5
_STEEPEST = 100.0
_INTENSITY = known_words(
    "intensity im ims iml imls level measure x a pga pgv pgd sa psa avgsa t s arias cav"
) | known_words(
    "ground motion spectral pseudo peak acceleration velocity displacement "
    "average mean median geomean of at"
)
# words of a quantity beside the first of these, which one of them is required
_OF = "of exceedance exceeding mean annual yearly hazard"
_QUANTITIES = {
    "period": ("return recurrence rp tr mri", f"period interval {_OF}", ("years",)),
    "probability": (
        "poe probability prob p pe aep apoe",
        f"in year years yr yrs y {_OF}",
        ("number", "share"),
    ),
    "rate": ("frequency frequencies rate rates lambda nu mafe maf afe h", _OF, ("rate",)),
}
_COLUMNS = "intensity with frequency, return_period, or poe_50 (probability in 50 years)"


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
    warnings : tuple of str
        Warnings about its points.
    """

    knots: Array
    factors: Array
    exponents: Array
    limits: tuple[float, float] = (0.0, math.inf)
    warnings: tuple[str, ...] = ()

    def frequency(self, intensity: npt.ArrayLike) -> Array:
        """Compute annual frequencies of exceedance."""
        u = np.log(np.asarray(intensity, dtype=float))
        part = np.searchsorted(self.knots, u, side="right")
        return np.asarray(np.exp(self.factors[part] - self.exponents[part] * u))


def hazard_of(value: Any, unit: str = "g") -> Hazard:  # noqa: ANN401 (several forms)
    """Make the hazard curve of an argument."""
    if isinstance(value, Hazard):
        return value
    if isinstance(value, str | os.PathLike):
        columns, lines = read_columns(Path(value), set(), "hazard")
        at = _line_of_names(Path(value), columns)
        return _from_columns(columns, f"{value}", unit, (at, lines))
    if isinstance(value, Mapping):
        names = {str(name).lower(): item for name, item in value.items()}
        if set(names) == {"k0", "k"}:
            return _power_law(names["k0"], names["k"])
        if len(names) == 2:
            found = {name: to_array(f"hazard: {name}", item) for name, item in names.items()}
            return _from_columns(found, "hazard", unit)
    if isinstance(value, np.ndarray) and value.ndim == 2 and value.shape[1] == 2:
        table = to_array("hazard", value.ravel())
        return _through(table[::2], table[1::2], "hazard")
    items = to_items(value)
    if items is not None and len(items) == 2 and np.ndim(items[0]) == 0:
        return _power_law(*items)
    raise InputError(f"hazard = {show(value)}: must be {_FORMS}")


def _power_law(k0: object, k: object) -> Hazard:
    k0 = to_number("hazard: k0", k0, above=0.0)
    k = to_number("hazard: k", k, above=0.0, below=_STEEPEST)
    return Hazard(np.empty(0), np.array([math.log(k0)]), np.array([k]))


def _line_of_names(path: Path, columns: Mapping[str, Any]) -> int:
    """Return the line of the names; refuse a comment that contradicts a column of frequencies."""
    is_probability = any(_quantity(read_column_name(name)) == "probability" for name in columns)
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        for i, line in enumerate(file, 1):
            stated = re.search(r"poe\b|probabilit\w*|investigation", line.lower())
            if line.startswith("#") and stated is not None and not is_probability:
                raise InputError(
                    f"{path}, line {i}: states {stated[0]}, the columns are {', '.join(columns)}: "
                    f"name them {_COLUMNS}"
                )
            if line.strip() and not line.startswith("#"):
                return i
    return 1


def _from_columns(
    columns: Mapping[str, Array],
    source: str,
    unit: str,
    lines: tuple[int, npt.NDArray[np.int64]] | None = None,
) -> Hazard:
    """Make a curve of two columns by the quantities and units that their names state."""
    head = source if lines is None else f"{source}, line {lines[0]}"
    if len(columns) != 2:
        raise InputError(f"{head}: has {len(columns)} columns: must have two, {_COLUMNS}")
    names = {read_column_name(name): values for name, values in columns.items()}
    for one, other in ((0, 1), (1, 0)):
        level, rate = (list(names)[i] for i in (one, other))
        if level is not rate and _is_intensity(level) and _quantity(rate):
            break
    else:
        raise InputError(f"{head}: the columns are {', '.join(columns)}: must be {_COLUMNS}")
    factor = convert(level, unit)
    if factor is None:
        raise InputError(
            f"{head}: the intensity {level.words} is in {level.unit}, that of the fragility in "
            f"{unit}: must be one measure"
        )
    where = [f"row {i}" for i in range(len(names[level]))] if lines is None else [
        f"line {n}" for n in lines[1]
    ]  # fmt: skip
    x, y = factor * names[level], names[rate] * (rate.factor if rate.dimension == "share" else 1.0)
    quantity = _quantity(rate)
    if quantity == "probability":
        return _from_probabilities(x, y, _years(rate, head), source, where)
    if quantity == "period":
        wrong = ~(np.isfinite(y) & (y > 0))
        if wrong.any():
            i = int(np.argmax(wrong))
            raise InputError(
                f"{source}, {where[i]}: {rate.words} = {y[i]:g}: must be a finite number > 0"
            )
        return replace(_through(x, 1 / y, source, where), warnings=())
    return _through(x, y, source, where)


def _is_intensity(name: ColumnName) -> bool:
    return name.consists_of(_INTENSITY, ACCELERATION, "velocity", "displacement")


def _quantity(name: ColumnName) -> str:
    """Return rate, period or probability of exceedance; '' for another column."""
    for quantity, (own, others, dimensions) in _QUANTITIES.items():
        known = known_words(own)
        if not known.isdisjoint(name.tokens) and name.consists_of(
            known | known_words(others), *dimensions
        ):
            return quantity
    return ""


def _years(name: ColumnName, source: str) -> float:
    """Return the number of years of a probability."""
    is_annual = not {"annual", "yearly", "aep", "apoe"}.isdisjoint(name.tokens)
    years = [*name.numbers, *([1.0] if is_annual else [])]
    if len(years) != 1 or years[0] <= 0:
        raise InputError(f"{source}: the column {name.words} states no years: name it as poe_50")
    return years[0]


def _from_probabilities(
    x: Array, y: Array, years: float, source: str, where: Sequence[str]
) -> Hazard:
    """Make the curve of probabilities in a number of years, of Poisson's process."""
    wrong = ~((y > 0) & (y <= 1))
    if wrong.any():
        i = int(np.argmax(wrong))
        raise InputError(
            f"{source}, {where[i]}: probability = {y[i]:g}: must be in (0, 1], or the name has "
            "[%]; leave out points of no probability"
        )
    # a printed 1 gives a lower bound of the frequency only
    used = y < 1
    found = _through(
        x[used],
        -np.log1p(-y[used]) / years,
        source,
        [place for place, is_used in zip(where, used, strict=True) if is_used],
    )
    lost = int(np.sum(~used))
    text = f"hazard: {lost} point{'' if lost == 1 else 's'} of probability 1 left out"
    return replace(found, warnings=(text,) if lost else ())


def _through(x: Array, y: Array, source: str, places: Sequence[str] | None = None) -> Hazard:
    """Make the curve through points; the two ends are continued."""
    where = [f"row {i}" for i in range(len(x))] if places is None else places
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
    frequent = int(np.sum(y > 1))
    text = (
        f"hazard: annual frequencies above 1 (up to {y.max():.3g} in {frequent} of {y.size} "
        "points): are they frequencies per year?"
    )
    limits = (float(x.min()), float(x.max()))
    return Hazard(u[1:-1], v[:-1] + k * u[:-1], k, limits, (text,) if frequent else ())
