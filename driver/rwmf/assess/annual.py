"""Hazard curves, and annual frequencies as integrals of a fragility curve over them."""

from __future__ import annotations

import itertools
import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy.special import log_ndtr

from rwmf.assess.fragility_curves import exceedance
from rwmf.assess.table import read_columns, warnings_of
from rwmf.case.arguments import checked
from rwmf.errors import InputError
from rwmf.kernel.numbers import Array, Truths, Wholes, show, to_array, to_items, to_number
from rwmf.motion.formats import ACCELERATION, ColumnName, convert, known_words, read_column_name

_FORMS = (
    "the path of a CSV file, a mapping with k0 and k, a mapping with intensity and frequency, "
    "or a pair (k0, k)"
)
# the steepest power law; published hazard curves have exponents of 1 to 5
_STEEPEST = 100.0
_INTENSITY = known_words(
    "intensity im ims iml imls level measure x a pga pgv pgd sa psa avgsa t s arias cav ground "
    "motion spectral pseudo peak acceleration velocity displacement average mean median geomean of "
    "at"
)
_OF_INTENSITY = (ACCELERATION, "velocity", "displacement")
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
# hazard curves of the OpenQuake engine: marks of the file, and units of the measures
_OPENQUAKE = ("lon", "lat")
_LEVEL = "poe-"
_STATED = re.compile(r"investigation_time=([\d.eE+-]+).*\bimt=['\"]*(\w+)")
_MEASURES = {"PGA": "g", "SA": "g", "AvgSA": "g", "PGV": "cm/s"}
_POSITIVE = "a finite number > 0"
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
        if set(_OPENQUAKE) <= set(columns):
            return _from_openquake(Path(value), columns, unit)
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
        return _from_columns({"intensity": table[::2], "frequency": table[1::2]}, "hazard", unit)
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
    lines: tuple[int, Wholes] | None = None,
) -> Hazard:
    """Make a curve of two columns by the quantities and units that their names state."""
    head = source if lines is None else f"{source}, line {lines[0]}"
    if len(columns) != 2:
        raise InputError(f"{head}: has {len(columns)} columns: must have two, {_COLUMNS}")
    names = {read_column_name(name): values for name, values in columns.items()}
    for level, rate in itertools.permutations(names, 2):
        if level.consists_of(_INTENSITY, *_OF_INTENSITY) and _quantity(rate):
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
    if len(x) != len(y):
        raise InputError(f"{source}: has {len(x)} intensities and {len(y)} frequencies")
    quantity = _quantity(rate)
    if quantity == "probability":
        return _from_probabilities(x, y, _years(rate, head), source, where)
    if quantity == "period":
        _check(y > 0, source, where, rate.words, y)
        return replace(_through(x, 1 / y, source, where), warnings=())
    return _through(x, y, source, where)


def _from_openquake(path: Path, columns: Mapping[str, Array], unit: str) -> Hazard:
    """Make the curve of a site from a file of the OpenQuake engine, a column for each level."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        stated = _STATED.search(file.readline())
    if stated is None or stated[2] not in _MEASURES:
        raise InputError(
            f"{path}, line 1: must state investigation_time and imt of OpenQuake, with imt one of "
            f"{', '.join(_MEASURES)}"
        )
    sites = len(columns[_OPENQUAKE[0]])
    if sites != 1:
        raise InputError(f"{path}: has {sites} sites: keep the row of one of them")
    levels = {name: values[0] for name, values in columns.items() if name.startswith(_LEVEL)}
    # a probability below the printed digits
    known = {name: value for name, value in levels.items() if value != 0}
    factor = convert(ColumnName(stated[2].lower(), _MEASURES[stated[2]]), unit)
    if factor is None:
        raise InputError(
            f"{path}, line 1: {stated[2]} is in {_MEASURES[stated[2]]}, the intensity of the "
            f"fragility in {unit}: must be one measure"
        )
    x = factor * np.array([_level(name, path) for name in known])
    years = to_number(f"{path}, line 1: investigation_time", float(stated[1]), above=0.0)
    found = _from_probabilities(x, np.array(list(known.values())), years, f"{path}", list(known))
    lost = _left_out(len(levels) - len(known), 0)
    return replace(found, warnings=(*found.warnings, *lost))


def _left_out(lost: int, probability: int) -> tuple[str, ...]:
    """Return the warning about points that give no frequency."""
    points = f"{lost} point{'' if lost == 1 else 's'}"
    return (f"hazard: {points} of probability {probability} left out",) if lost else ()


def _level(name: str, path: Path) -> float:
    """Return the intensity in the name of a column."""
    try:
        return float(name.removeprefix(_LEVEL))
    except ValueError:
        raise InputError(f"{path}, line 2: the column {name} names no intensity") from None


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


def _check(
    is_good: Truths,
    source: str,
    where: Sequence[str],
    name: str,
    values: Array,
    wanted: str = _POSITIVE,
) -> None:
    """Refuse the first point of a curve that is not finite or not good."""
    is_good = is_good & np.isfinite(values)
    if not is_good.all():
        i = int(np.argmin(is_good))
        raise InputError(f"{source}, {where[i]}: {name} = {values[i]:g}: must be {wanted}")


def _from_probabilities(
    x: Array, y: Array, years: float, source: str, where: Sequence[str]
) -> Hazard:
    """Make the curve of probabilities in a number of years, of Poisson's process."""
    wanted = "in (0, 1], or the name has [%]; leave out points of no probability"
    _check((y > 0) & (y <= 1), source, where, "probability", y, wanted)
    # a printed 1 gives a lower bound of the frequency only
    used = y < 1
    found = _through(
        x[used],
        -np.log1p(-y[used]) / years,
        source,
        [place for place, is_used in zip(where, used, strict=True) if is_used],
    )
    return replace(found, warnings=_left_out(int(np.sum(~used)), 1))


def _through(x: Array, y: Array, source: str, where: Sequence[str]) -> Hazard:
    """Make the curve through points; the two ends are continued."""
    if len(x) < 2:
        raise InputError(f"{source}: has {len(x)} point: must have at least 2")
    _check(x > 0, source, where, "intensity", x)
    hint = "; leave out points of no frequency" if (y == 0).any() else ""
    _check(y > 0, source, where, "frequency", y, _POSITIVE + hint)
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


_YEARS = 50.0
_BINS = 12
# largest dispersion that widens them; exp(3 times more) would leave the range of numbers
_WIDEST = 10.0
# share of the frequency from outside the given hazard curve that a warning mentions
_SHARE = 0.01
_FREQUENCY = {"units": "1/year", "long_name": "mean annual frequency of exceedance"}


@checked
def risk(
    fragility: xr.Dataset | Mapping[str, Any] | Sequence[float],
    hazard: Any,  # noqa: ANN401 (several forms)
    *,
    levels: Sequence[float] | None = None,
) -> xr.Dataset:
    """Compute the mean annual frequency of exceeding a limit, and its deaggregation.

    The frequency is the integral of the hazard over the distribution of the capacity, in closed
    form for each power law (Cornell et al. 2002, Journal of Structural Engineering 128(4)). A
    hazard from a file is linear in logarithms between its points; its two ends are continued.

    Parameters
    ----------
    fragility : xarray.Dataset, mapping or pair
        From `rwmf.fragility`, for one or several designs; or ``{"median": , "dispersion": }`` or
        the pair of both. Fragility and hazard have the same measure of intensity, accelerations
        over g.
    hazard : path, mapping or pair
        CSV file or mapping of two columns: the intensity with ``frequency`` [1/year],
        ``return_period`` [year] or ``poe_50``, a probability p in n = 50 years, which gives the
        frequency -ln(1 - p)/n of Poisson's process. Their names may state units, as
        ``pga [m/s2]``. A CSV file of hazard curves of the OpenQuake engine with one site.
        ``{"k0": , "k": }`` or (k0, k) for the power law k0 intensity^-k.
    levels : sequence of float, optional
        Intensities that separate the bins of the deaggregation; otherwise 11 around the medians.

    Returns
    -------
    xarray.Dataset
        Over ``design`` if there are several: ``annual_frequency`` [1/year], ``closed_form``
        [1/year], ``return_period`` [year], ``probability_50_years`` [-], ``extrapolated`` [-].
        The latter is the share of intensities outside the hazard curve. A fragility with resamples
        gives ``annual_frequency_band``. Over ``bin``: ``contribution`` [-] between
        ``intensity_low`` and ``intensity_high``.

    Raises
    ------
    InputError
        When a fragility has no finite median > 0 or no dispersion >= 0, or when the hazard is not
        acceptable.
    """
    curves, samples = _fragilities(fragility)
    curve = hazard_of(hazard, unit_of(fragility))
    medians, dispersions = curves["median"].values, curves["dispersion"].values
    closed = closed_form(curve, medians, dispersions)
    _check_range(curves, closed)
    edges = _edges(levels, medians, dispersions)
    parts = np.array(
        [integrate(curve, m, b, edges) for m, b in zip(medians, dispersions, strict=True)]
    )
    frequency = parts.sum(axis=1)
    _check_range(curves, frequency)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = parts / frequency[:, None]
        period = 1 / frequency
    found = curves.assign(
        annual_frequency=("design", frequency, _FREQUENCY),
        closed_form=("design", closed, _FREQUENCY),
        return_period=("design", period, {"units": "year"}),
        probability_50_years=("design", -np.expm1(-_YEARS * frequency), {"units": "1"}),
        contribution=(("design", "bin"), shares, {"units": "1"}),
        extrapolated=("design", _outside(curve, medians, dispersions, frequency), {"units": "1"}),
    ).assign_coords(
        intensity_low=("bin", np.concatenate([[0.0], edges])),
        intensity_high=("bin", np.concatenate([edges, [math.inf]])),
    )
    if samples is not None:
        found["annual_frequency_band"] = _band(curve, samples)
    lines = [*warnings_of(curves), *curve.warnings, *_warnings(found)]
    found.attrs["warnings"] = "\n".join(lines)
    return found.squeeze("design") if found.sizes["design"] == 1 else found


def unit_of(fragility: object) -> str:
    """Return the unit of the intensities of a fragility; g for a pair."""
    if isinstance(fragility, xr.Dataset) and "median" in fragility:
        return str(fragility["median"].attrs.get("units", "g"))
    return "g"


def _check_range(curves: xr.Dataset, frequencies: Array) -> None:
    """Refuse frequencies that double precision cannot represent."""
    wrong = ~(np.isfinite(frequencies) & (frequencies > 0))
    if wrong.any():
        i = int(np.argmax(wrong))
        median, dispersion = (float(curves[name][i]) for name in ("median", "dispersion"))
        raise InputError(
            f"risk: the annual frequency is {frequencies[i]:g} for median = {median:g}, "
            f"dispersion = {dispersion:g}: the hazard there is outside the range of numbers; "
            "check the units of both"
        )


def integrate(hazard: Hazard, median: float, dispersion: float, edges: Array) -> Array:
    """Integrate a lognormal fragility over a hazard curve, between edges."""
    held = exceedance(edges, median, dispersion) * hazard.frequency(edges)
    # by parts: the integral of P over -dH is that of H over dP, and P H at the edges
    held = np.concatenate([[0.0], held, [0.0]])
    if dispersion == 0:
        inside = np.zeros(edges.size + 1)
        # the step is above the median: one at an edge belongs to the bin above it
        inside[np.searchsorted(edges, median, side="right")] = hazard.frequency(median)
    else:
        ends = itertools.pairwise([0.0, *edges.tolist(), math.inf])
        inside = np.array([closed_form(hazard, median, dispersion, *pair) for pair in ends])
    return inside + held[:-1] - held[1:]


def closed_form(
    hazard: Hazard,
    median: npt.ArrayLike,
    dispersion: npt.ArrayLike,
    above: float = 0.0,
    below: float = math.inf,
) -> Array:
    """Integrate a hazard over a lognormal capacity by the closed forms of its power laws."""
    median, dispersion = np.broadcast_arrays(*map(np.asarray, (median, dispersion)))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        centre = np.log(median)[..., None]
        beta = np.asarray(dispersion, dtype=float)[..., None]
        ends = np.concatenate([[-math.inf], hazard.knots, [math.inf]])
        ends = np.clip(ends, *np.log([above, below]))
        k = hazard.exponents
        # exp(k^2 beta^2 / 2) turns the density into one whose mean is lower by k beta
        cuts = np.where(beta > 0, (ends - centre) / beta, np.where(ends >= centre, 1, -1) * 1e9)
        a, b = cuts[..., :-1] + k * beta, cuts[..., 1:] + k * beta
        # the tail with the smaller numbers keeps the digits of the difference
        low, high = np.where(a > 0, -b, a), np.where(a > 0, -a, b)
        least, most = log_ndtr(low), log_ndtr(high)
        share = most + np.log1p(-np.exp(np.where(high > low, least - most, 0.0)))
        terms = np.exp(hazard.factors - k * centre + 0.5 * (k * beta) ** 2 + share)
    return np.asarray(np.sum(np.where(high > low, terms, 0.0), axis=-1))


def _outside(hazard: Hazard, medians: Array, dispersions: Array, total: Array) -> Array:
    """Return the share of the frequency from capacities outside the hazard's points."""
    low, high = hazard.limits
    if low == 0.0:
        return np.zeros(medians.size)
    inside = closed_form(hazard, medians, dispersions, low, high)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.clip(1 - inside / total, 0.0, 1.0)


def _fragilities(value: Any) -> tuple[xr.Dataset, xr.Dataset | None]:  # noqa: ANN401
    """Return medians and total dispersions over designs, and their resamples."""
    if not isinstance(value, xr.Dataset):
        items = to_items(value)
        if isinstance(value, Mapping) and {"median", "dispersion"} <= set(value):
            items = [value["median"], value["dispersion"]]
        if items is None or len(items) != 2:
            raise InputError(
                f"fragility = {show(value)}: must be a dataset of rwmf.fragility, a mapping with "
                "median and dispersion, or the pair of both"
            )
        pair = [
            to_array(f"fragility: {name}", item, least=1, is_finite=False)
            for name, item in zip(("median", "dispersion"), items, strict=True)
        ]
        if len(pair[0]) != len(pair[1]):
            raise InputError("fragility: median and dispersion differ in their length")
        numbers = [str(i + 1) for i in range(len(pair[0]))]
        columns = {"median": ("design", pair[0]), "dispersion": ("design", pair[1])}
        value = xr.Dataset(columns, {"design": numbers})
    if "median" not in value or "dispersion" not in value:
        raise InputError("fragility: has no median and dispersion: must be of rwmf.fragility")
    dataset = value if "design" in value.dims else value.expand_dims("design")
    total = dataset["dispersion_total" if "dispersion_total" in dataset else "dispersion"]
    names = dataset["design"].values if "design" in dataset.coords else [""]
    medians, dispersions = dataset["median"].values.astype(float), total.values.astype(float)
    for name, median, dispersion in zip(names, medians, dispersions, strict=True):
        label = f"fragility{f' of {name}' if len(names) > 1 else ''}"
        to_number(f"{label}: median", median, above=0.0)
        if to_number(f"{label}: dispersion", dispersion) < 0:
            raise InputError(f"{label}: dispersion = {dispersion:g}: must be >= 0")
    curves = xr.Dataset(
        {"median": ("design", medians), "dispersion": ("design", dispersions)},
        coords={"design": ("design", np.asarray(names, dtype=object))},
        attrs=dataset.attrs,
    )
    if "median_resampled" not in dataset:
        return curves, None
    further = total**2 - dataset["dispersion"] ** 2
    spread = np.sqrt(dataset["dispersion_resampled"] ** 2 + further)
    samples = xr.Dataset(
        {"median": dataset["median_resampled"], "dispersion": spread},
        attrs={"confidence": dataset.attrs.get("confidence", 0.95)},
    )
    return curves, samples


def _edges(levels: Sequence[float] | None, medians: Array, dispersions: Array) -> Array:
    """Return the given edges of the bins, or round ones around all medians."""
    if levels is not None:
        edges = np.array(levels)
        if (np.diff(edges) <= 0).any():
            raise InputError(f"levels = {show(levels)}: must ascend")
        return edges
    spread = min(max(0.2, float(dispersions.max())), _WIDEST)
    low = math.log(float(medians.min())) - 3 * spread
    high = math.log(float(medians.max())) + 2 * spread
    edges = np.exp(np.linspace(low, high, _BINS - 1))
    # two digits are enough for a bin, and are read more easily
    return np.unique([float(f"{edge:.2g}") for edge in edges])


def _band(hazard: Hazard, samples: xr.Dataset) -> xr.DataArray:
    """Return quantiles of the frequencies of all resamples."""
    tail = 0.5 * (1 - float(samples.attrs["confidence"]))
    values = closed_form(hazard, samples["median"].values, samples["dispersion"].values)
    # a resample without any exceedance has no fragility, and no frequency
    values = np.where(np.isinf(samples["median"].values), 0.0, values)
    values = np.where(np.isnan(samples["median"].values), np.nan, values)
    found = np.nanquantile(values, [tail, 1 - tail], axis=1).T
    return xr.DataArray(
        found, dims=("design", "quantile"), coords={"quantile": [tail, 1 - tail]}, attrs=_FREQUENCY
    )


def _warnings(found: xr.Dataset) -> list[str]:
    warnings = []
    worst = float(found["extrapolated"].max())
    if worst > _SHARE:
        text = "of the annual frequency is from outside the hazard's points"
        warnings.append(f"{100 * worst:.3g} % {text}")
    most = float(found["annual_frequency"].max())
    if most > 1:
        warnings.append(f"the annual frequency {most:.3g} is above 1: check the units")
    return warnings
