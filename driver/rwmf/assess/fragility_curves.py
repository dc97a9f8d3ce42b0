"""Fragility curves of one or several designs, with bootstrap bands and margins."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy.special import erfcx, log_ndtr, ndtr

from rwmf.assess.loss import shape_factor_of
from rwmf.assess.table import quantities_of, read_table, refuse_least, warnings_of
from rwmf.case.arguments import checked
from rwmf.errors import InputError
from rwmf.kernel.numbers import Array, Truths, Wholes, show, to_array, to_number, to_whole
from rwmf.run.quantities import fallen


def exceedance(intensity: npt.ArrayLike, median: npt.ArrayLike, dispersion: npt.ArrayLike) -> Array:
    """Compute the probability that a lognormal capacity is exceeded."""
    x, median, dispersion = (np.asarray(a, dtype=float) for a in (intensity, median, dispersion))
    with np.errstate(divide="ignore", invalid="ignore"):
        argument = np.log(x / median) / dispersion
    return np.where(dispersion > 0, ndtr(np.nan_to_num(argument, nan=0.0)), x > median) * 1.0


# kinds of observations: of the value itself, of a value above, of a value below
EXACT, OVER, BELOW = 0, -1, 1
_ITERATIONS = 200
_CONVERGED = 1e-13
_HALVINGS = 40


@dataclass(frozen=True)
class Observations:
    """Observations of standard normal variables z = coefficients @ parameters.

    Attributes
    ----------
    coefficients : numpy.ndarray, shape (n, p)
        Linear map from the parameters to z. Where observations are exact, the last parameter is
        the inverse standard deviation.
    kinds : numpy.ndarray of int, shape (n,)
        ``EXACT`` (density of z), ``BELOW`` (probability up to z) or ``OVER`` (above z).
    """

    coefficients: Array
    kinds: Wholes

    def value(self, weights: Array, parameters: Array) -> tuple[Array, Array, Array]:
        """Compute log-likelihoods with gradient and Hessian."""
        p = parameters.shape[1]
        z = parameters @ self.coefficients.T
        exact = self.kinds == EXACT
        value, slope, curvature = -0.5 * z**2, -z, -np.ones_like(z)
        sign = self.kinds[~exact]
        if sign.size:
            argument = sign * z[:, ~exact]
            # density over distribution function
            hazard = math.sqrt(2 / math.pi) / erfcx(-argument / math.sqrt(2))
            value[:, ~exact] = log_ndtr(argument)
            slope[:, ~exact] = sign * hazard
            curvature[:, ~exact] = -hazard * (argument + hazard)
        total = np.sum(weights * value, axis=1)
        gradient = (weights * slope) @ self.coefficients
        squares = np.einsum("np,nq->npq", self.coefficients, self.coefficients).reshape(
            len(z.T), -1
        )
        hessian = ((weights * curvature) @ squares).reshape(-1, p, p)
        if exact.any():
            n = weights[:, exact].sum(axis=1)
            scale = parameters[:, -1]
            with np.errstate(invalid="ignore", divide="ignore"):
                total = np.where(scale > 0, total + n * np.log(scale), -np.inf)
            gradient[:, -1] += n / scale
            hessian[:, -1, -1] -= n / scale**2
        return total, gradient, hessian


def maximise(observations: Observations, weights: Array, start: Array) -> Array:
    """Find the parameters of maximum likelihood of every resample."""
    found = np.tile(start.astype(float), (len(weights), 1))
    value, gradient, hessian = observations.value(weights, found)
    active = np.arange(len(weights))
    for _ in range(_ITERATIONS):
        # pseudo-inverse: a resample may leave one direction undetermined
        inverse = np.linalg.pinv(hessian, rcond=1e-14, hermitian=True)
        step = -np.einsum("bpq,bq->bp", inverse, gradient)
        for _ in range(_HALVINGS):
            trial = found[active] + step
            new = observations.value(weights[active], trial)
            worse = ~(new[0] >= value - 1e-13 * np.abs(value))
            if not worse.any():
                break
            step[worse] *= 0.5
        found[active] = trial
        size = np.abs(step).max(axis=1) / np.abs(trial).max(axis=1)
        kept = size > _CONVERGED
        active = active[kept]
        if not active.size:
            break
        value, gradient, hessian = (part[kept] for part in new)
    return found


# a smaller deviation of logarithms is rounding
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Fit:
    """Fitted distributions of the sample and then of its resamples.

    Attributes
    ----------
    median : numpy.ndarray, shape (b,)
        Medians; infinite where no run exceeds, 0 where every run does, NaN where the probability
        falls or stays constant with intensity.
    dispersion : numpy.ndarray, shape (b,)
        Standard deviations of the logarithm [-]; NaN without a fit, 0 for a step.
    slope : numpy.ndarray, shape (b,), optional
        Exponent of the intensity in the median demand of a cloud.
    scatter : numpy.ndarray, shape (b,), optional
        Standard deviation of the logarithm of its demand [-].
    """

    median: Array
    dispersion: Array
    slope: Array | None = None
    scatter: Array | None = None


def fit_counts(levels: Array, exceeded: Array, runs: Array) -> Fit:
    """Fit counts of exceedance by maximum likelihood (Baker 2015, Earthquake Spectra 31(1))."""
    n = len(exceeded)
    median, dispersion = np.full(n, math.nan), np.full(n, math.nan)
    regular = np.zeros(n, dtype=bool)
    for i in range(n):
        used = runs[i] > 0
        step = _step(levels[used], exceeded[i, used], runs[i, used])
        if step is None:
            regular[i] = True
        else:
            median[i] = step
            dispersion[i] = 0.0 if 0 < step < math.inf else math.nan
    if regular.any():
        x = np.log(levels)
        centre, spread = float(x.mean()), float(x.std())
        rows = np.column_stack([np.ones(x.size), (x - centre) / spread])
        sample = Observations(np.vstack([rows, rows]), np.repeat([BELOW, OVER], x.size))
        weights = np.hstack([exceeded, runs - exceeded])[regular]
        a, b = maximise(sample, weights, np.array([0.0, 1.0])).T
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            grows = b > _ROUNDING
            median[regular] = np.where(grows, np.exp(centre - spread * a / b), math.nan)
            dispersion[regular] = np.where(grows, spread / b, math.nan)
    return Fit(median, dispersion)


def _step(levels: Array, exceeded: Array, runs: Array) -> float | None:
    """Return the median of counts that step from none to all, None for others."""
    if not exceeded.any():
        return math.inf
    if (exceeded == runs).all():
        return 0.0
    none, every = exceeded == 0, exceeded == runs
    last = levels[~every].max()
    first = levels[~none].min()
    if first > last:
        return math.sqrt(first * last)
    if first < last:
        return None
    # a single level between none and all has an ever steeper curve; at an end its median may lie
    # anywhere beyond
    share = float(exceeded[levels == first][0] / runs[levels == first][0])
    if first == levels.max() and share <= 0.5:
        return math.inf
    return 0.0 if first == levels.min() and share >= 0.5 else float(first)


def fit_capacities(logarithms: Array, kinds: Wholes, weights: Array) -> Fit:
    """Fit capacities of records; the dispersion has n - 1 degrees of freedom."""
    n = len(weights)
    mean, scatter = np.full(n, math.nan), np.full(n, math.nan)
    regular = np.zeros(n, dtype=bool)
    for i in range(n):
        y, kind = logarithms[weights[i] > 0], kinds[weights[i] > 0]
        exact = y[kind == EXACT]
        if exact.size == 0:
            mean[i] = math.inf if (kind == OVER).all() else -math.inf
        elif (
            np.ptp(exact) <= _ROUNDING * max(1.0, np.abs(exact).max())
            and (y[kind == OVER] <= exact[0]).all()
            and (y[kind == BELOW] >= exact[0]).all()
        ):
            # one value satisfies all bounds
            mean[i], scatter[i] = exact[0], 0.0
        else:
            regular[i] = True
    if regular.any():
        exact_y = logarithms[kinds == EXACT]
        centre, spread = float(exact_y.mean()), float(exact_y.std()) or 1.0
        y = (logarithms - centre) / spread
        sample = Observations(np.column_stack([-np.ones(y.size), y]), kinds)
        d, g = maximise(sample, weights[regular], np.array([0.0, 1.0])).T
        mean[regular] = centre + spread * d / g
        scatter[regular] = spread / g
    total = weights.sum(axis=1)
    return Fit(np.exp(mean), scatter * np.sqrt(total / np.maximum(total - 1, 1)))


def fit_cloud(
    intensities: Array, demands: Array, kinds: Wholes, weights: Array, limit: float
) -> Fit:
    """Fit a power law of the intensity with lognormal scatter to a cloud of demands."""
    n = len(weights)
    median, scatter, slope = (np.full(n, math.nan) for _ in range(3))
    exact = kinds == EXACT
    line = np.linalg.lstsq(_powers(intensities[exact]), demands[exact])[0]
    rest = demands - _powers(intensities) @ line
    spread = float(rest[exact].std())
    is_line = spread <= _ROUNDING * max(1.0, np.abs(demands[exact]).max())
    if is_line and (rest[~exact] <= _ROUNDING).all():
        scatter[:], slope[:] = 0.0, line[1]
        median[:] = np.exp((limit - line[0]) / line[1])
        return Fit(median, scatter * 0.0, slope, scatter)
    distinct = np.array([np.unique(intensities[exact & (row > 0)]).size for row in weights])
    # three different points determine line and scatter
    regular = distinct > 2
    centre = float(intensities.mean())
    spread = spread if not is_line else 1.0
    x, y = intensities - centre, rest / spread
    sample = Observations(np.column_stack([-np.ones(x.size), -x, y]), kinds)
    d, e, g = maximise(sample, weights[regular], np.array([0.0, 0.0, 1.0])).T
    b = line[1] + spread * e / g
    a = line[0] + line[1] * centre + spread * d / g
    total = weights[regular].sum(axis=1)
    sigma = spread / g * np.sqrt(total / (total - 2))
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        median[regular] = np.where(b > _ROUNDING, np.exp(centre + (limit - a) / b), math.nan)
        slope[regular], scatter[regular] = b, sigma
        dispersion = np.where(np.isnan(median), math.nan, scatter / slope)
    return Fit(median, dispersion, slope, scatter)


def _powers(x: Array) -> Array:
    return np.column_stack([np.ones(x.size), x])


# positions of a curve with counts or capacities, and its fit
_Fitted = tuple[dict[str, Any], Fit]
METHODS = ("counts", "capacities", "cloud")
_OF_ANALYSIS = {"ida": "capacities", "stripes": "counts", "cloud": "cloud"}
COLLAPSE = "collapse"
_RESAMPLES = 1000
_CONFIDENCE = 0.95
# a median this many times beyond the levels is extrapolated
_FAR = 1.5
# a dispersion above this is no property of a structure [-]
_WIDE = 2.0
# positions of curves without given levels
_POSITIONS = 41


@dataclass(frozen=True)
class _Question:
    """Limit of a demand, and options of the fit.

    Attributes
    ----------
    method : str
        ``counts``, ``capacities`` or ``cloud``.
    quantity : str
        Demand, or ``collapse``.
    limit : float
        Limit in the quantity's unit; NaN for collapse.
    further : float
        Dispersion besides that of the records [-].
    confidence : float
        Probability of the bands [-].
    resamples : int
        Bootstrap resamples.
    seed : int
        Seed of their random numbers.
    """

    method: str
    quantity: str
    limit: float
    further: float
    confidence: float
    resamples: int
    seed: int

    @property
    def label(self) -> str:
        """Condition in words."""
        return COLLAPSE if self.quantity == COLLAPSE else f"{self.quantity} > {self.limit:g}"

    def exceeded(self, table: xr.Dataset) -> tuple[Truths, Truths]:
        """Find the runs that exceed the limit, and those with a result."""
        down = fallen(table)
        if self.quantity == COLLAPSE:
            return down, down | (table["status"].values.astype(str) == "ok")
        values = self.demands(table)
        return down | (values > self.limit), down | ~np.isnan(values)

    def demands(self, table: xr.Dataset) -> Array:
        """Return the magnitudes of the demand; residual drifts have a sign."""
        return np.asarray(np.abs(table[self.quantity].values))


@checked
def fragility(
    table: Any = None,  # noqa: ANN401 (several forms)
    limit: float | None = None,
    quantities: str | Sequence[str] | None = None,
    *,
    levels: Sequence[float] | None = None,
    exceeded: Sequence[int] | None = None,
    runs: int | Sequence[int] | None = None,
    method: str | None = None,
    dispersions: float | Sequence[float] = (),
    mce: float | None = None,
    shape_factor: float | tuple[float, float, str] | None = None,
    resamples: int = _RESAMPLES,
    confidence: float = _CONFIDENCE,
    seed: int = 0,
) -> xr.Dataset:
    """Fit lognormal fragility curves: median and dispersion of the capacity, with bands.

    Parameters
    ----------
    table : xarray.Dataset, path, mapping or list, optional
        Table of `rwmf.ida`, `rwmf.stripes` or `rwmf.cloud`, its file, or several of them. A table
        of another program needs the columns ``intensity``, a demand and ``status``. A table
        with ``intensity``, ``exceeded`` and ``runs`` holds counts.
    limit : float, optional
        Limit of the demand's magnitude in its unit; overturned and collapsed runs exceed every
        limit. Without it the curve is that of collapse or overturning.
    quantities : str, optional
        The demand; optional for a table with one demand.
    levels, exceeded, runs : array_like, shape (n,)
        Counts instead of a table: intensities, runs that exceed the limit, and all runs (one number
        for all levels).
    method : str, optional
        ``counts``: maximum likelihood of the counts at each intensity (Baker 2015).
        ``capacities``: intensities at which the records reach the limit; others are censored.
        ``cloud``: power law of the intensity, with collapsed runs censored.
        The default follows the analysis: counts for stripes, capacities for an incremental dynamic
        analysis, cloud for a cloud with a limit.
    dispersions : float or sequence of float
        Further dispersions [-], combined by the root of the sum of squares.
    mce : float, optional
        Intensity of the maximum considered earthquake, for the margin ratio.
    shape_factor : float or (period, ductility, category), optional
        Spectral shape factor [-] of FEMA P-695. A tuple has the arguments of its table for the
        far-field set: period [s], ductility [-] and category (B, C, Dmin, Dmax).
    resamples : int
        Bootstrap resamples of the records for the bands, 0 for none.
    confidence : float
        Probability of the bands [-].
    seed : int
        Seed of the resamples.

    Returns
    -------
    xarray.Dataset
        Over ``design`` if there are several: ``median`` [g], ``dispersion`` of the records and
        ``dispersion_total`` [-], their bands over ``quantile``, and values of all resamples. Over
        ``intensity``: ``fraction`` counted, ``exceeded``, ``runs``, ``fitted`` and
        ``fitted_band``. With ``mce``: ``margin_ratio``, ``probability_at_mce`` and, with a shape
        factor, both adjusted.

    Raises
    ------
    InputError
        When an argument is not acceptable, or when no run or every run exceeds the limit, so that
        no fit exists.
    """
    further = to_array("dispersions", dispersions)
    if (further < 0).any():
        raise InputError(f"dispersions = {show(dispersions)}: must be numbers >= 0")
    if any(item is not None for item in (levels, exceeded, runs)):
        if table is not None:
            raise InputError("fragility: takes a table, or levels with exceeded and runs, not both")
        table = {"intensity": levels, "exceeded": exceeded, "runs": runs}
    if table is None:
        raise InputError("fragility: needs a table, or levels with exceeded and runs")
    rows = _rows_of(table)
    question = _Question(
        *_asked(rows, limit, quantities, method),
        math.hypot(*further),
        to_number("confidence", confidence, above=0.0, below=1.0),
        to_whole("resamples", resamples, 0, 10**6),
        to_whole("seed", seed, 0),
    )
    names = list(dict.fromkeys(rows["design"].values.tolist()))
    parts = []
    notes: list[str] = []
    for name in names:
        own = rows.isel(row=np.flatnonzero(rows["design"].values == name))
        label = f"fragility{f' of {name}' if len(names) > 1 else ''}"
        part, lines = _one(own, question, label)
        parts.append(part)
        notes += [f"{name}: {line}" if len(names) > 1 else line for line in lines]
    found = _together(parts, names)
    found = _with_margins(found, mce, shape_factor)
    kept = ("version", "cases", "records", "analysis")
    attrs = {
        key: value
        for key, value in rows.attrs.items()
        if key in kept or key.startswith("intensity")
    }
    found.attrs = attrs | {
        "quantity": question.quantity,
        "method": question.method,
        "confidence": question.confidence,
        "seed": question.seed,
        "warnings": "\n".join([*warnings_of(rows), *notes]),
    }
    return found.squeeze("design") if len(names) == 1 else found


def _rows_of(table: Any) -> xr.Dataset:  # noqa: ANN401 (several forms)
    """Read a table; the counts of one become columns of whole numbers."""
    if isinstance(table, Mapping) and set(table) == {"intensity", "exceeded", "runs"}:
        lacking = [name for name, values in table.items() if values is None]
        if lacking:
            word = {"intensity": "levels"}.get(lacking[0], lacking[0])
            raise InputError(f"fragility: {word}: is missing: counts have levels, exceeded, runs")
        x = to_array("levels", table["intensity"], above=0.0, least=1)
        counts = {word: to_array(word, table[word], least=1) for word in ("exceeded", "runs")}
        if counts["runs"].size == 1:
            counts["runs"] = np.full(x.size, counts["runs"][0])
        for word, values in counts.items():
            if values.size != x.size:
                raise InputError(f"fragility: {word}: has {values.size} values, levels {x.size}")
        table = {"intensity": x} | counts
    rows = read_table(table)
    if "exceeded" in rows:
        if "runs" not in rows:
            raise InputError("fragility: the table has exceeded, but no column runs")
        k, n = rows["exceeded"].values, rows["runs"].values
        wrong = ~((k >= 0) & (k <= n) & (n >= 1) & (k == np.floor(k)) & (n == np.floor(n)))
        if wrong.any():
            i = int(np.argmax(wrong))
            raise InputError(
                f"fragility: exceeded = {k[i]:g} of runs = {n[i]:g} at intensity "
                f"{rows['intensity'].values[i]:g}: must be whole numbers with "
                "0 <= exceeded <= runs, runs >= 1"
            )
    return rows


def _asked(
    rows: xr.Dataset, limit: float | None, quantities: Sequence[str] | None, method: str | None
) -> tuple[str, str, float]:
    """Return the method, the demand and its limit."""
    if method is not None and not (isinstance(method, str) and method in METHODS):
        raise InputError(f"method = {show(method)}: must be one of {', '.join(METHODS)}")
    if "exceeded" in rows:
        if limit is not None or quantities or method not in (None, "counts"):
            raise InputError("fragility: counts take no limit, no quantity and no other method")
        return "counts", COLLAPSE, math.nan
    quantity = COLLAPSE
    if limit is not None or quantities:
        if limit is None:
            raise InputError("fragility: limit: is missing: the limit of the quantity")
        quantity = _quantity(rows, quantities)
        refuse_least([quantity])
    usual = _OF_ANALYSIS.get(str(rows.attrs.get("analysis")), "counts")
    if quantity == COLLAPSE and "cloud" in (method or usual):
        if method == "cloud":
            raise InputError("fragility: the method cloud needs a limit of a demand")
        usual = "counts"
    return method or usual, quantity, math.nan if limit is None else limit


def _quantity(rows: xr.Dataset, names: Sequence[str] | None) -> str:
    known = quantities_of(rows)
    if names is None:
        if len(known) != 1:
            raise InputError(f"fragility: quantities: must be one of {', '.join(known) or 'none'}")
        return known[0]
    if len(names) != 1:
        raise InputError(f"fragility: quantities = {', '.join(names)}: must be one quantity")
    if names[0] not in known:
        raise InputError(
            f"fragility: {names[0]}: is not in the table, which has {', '.join(known) or 'none'}"
        )
    return names[0]


def _one(rows: xr.Dataset, question: _Question, label: str) -> tuple[xr.Dataset, list[str]]:
    """Fit one design."""
    sample = {"counts": _counts, "capacities": _capacities, "cloud": _cloud}[question.method]
    _check_some(rows, question, label)
    points, fit = sample(rows, question, label)
    median, dispersion = float(fit.median[0]), float(fit.dispersion[0])
    notes = _notes(median, dispersion, points, rows)
    total = math.hypot(dispersion, question.further)
    unit = {"units": str(rows["intensity"].attrs.get("units", "g"))}
    one = {"units": "1"}
    attrs = {} if question.quantity == COLLAPSE else rows[question.quantity].attrs
    found = xr.Dataset(
        {
            "median": ((), median, unit),
            "dispersion": ((), dispersion, one),
            "dispersion_total": ((), total, one),
            "limit": ((), question.limit, {"units": str(attrs.get("units", "1"))}),
            "fitted": ("intensity", exceedance(points["x"], median, total), one),
        },
        coords={"intensity": ("intensity", points["x"], unit)},
    )
    if fit.slope is not None and fit.scatter is not None:
        found = found.assign(demand_slope=fit.slope[0], demand_dispersion=fit.scatter[0])
    if "exceeded" in points:
        with np.errstate(invalid="ignore"):
            share = points["exceeded"] / points["runs"]
        found = found.assign(
            exceeded=("intensity", points["exceeded"]),
            runs=("intensity", points["runs"]),
            fraction=("intensity", share, one),
        )
    if "capacity" in points:
        found = found.assign(capacity=("record", points["capacity"], unit)).assign_coords(
            record=("record", points["record"])
        )
    if question.resamples:
        found = _with_bands(found, fit, question, notes)
    return found, notes


def _with_bands(found: xr.Dataset, fit: Fit, question: _Question, notes: list[str]) -> xr.Dataset:
    """Add quantiles of the resamples by rank, in which infinite medians count."""
    tail, n = 0.5 * (1 - question.confidence), question.resamples
    tails = [tail, 1 - tail]
    median, dispersion = fit.median[1:], fit.dispersion[1:]
    usable = ~np.isnan(median)
    lost = n - int(usable.sum())
    if lost:
        notes.append(f"{lost} of {n} resamples have no growing curve and are left out of the bands")
    total = np.hypot(dispersion, question.further)
    x = found["intensity"].values
    with np.errstate(invalid="ignore"):
        curves = exceedance(x[:, None], median[None, usable], total[None, usable])
    # an infinite median never fails, one of 0 always
    curves[:, np.isinf(median[usable])] = 0.0
    curves[:, median[usable] == 0] = 1.0

    def band(values: Array) -> Array:
        kept = values[..., ~np.isnan(values).reshape(-1, values.shape[-1]).any(axis=0)]
        if not kept.shape[-1]:
            return np.full((*values.shape[:-1], 2), math.nan)
        return np.moveaxis(np.quantile(kept, tails, axis=-1, method="inverted_cdf"), 0, -1)

    one = {"units": "1"}
    return found.assign(
        median_band=("quantile", band(median), found["median"].attrs),
        dispersion_band=("quantile", band(dispersion), one),
        fitted_band=(("intensity", "quantile"), band(curves), one),
        median_resampled=("resample", median),
        dispersion_resampled=("resample", dispersion),
    ).assign_coords(quantile=("quantile", tails))


def _check_some(rows: xr.Dataset, question: _Question, label: str) -> None:
    """Refuse a limit that no run or every run exceeds."""
    x = rows["intensity"].values
    if "exceeded" in rows:
        none, every = not rows["exceeded"].any(), bool((rows["exceeded"] == rows["runs"]).all())
        ends: tuple[str, ...] = ("", "")
    else:
        over, known = question.exceeded(rows)
        if not known.any():
            raise InputError(f"{label}: {question.label}: no run has a result")
        none, every = not over[known].any(), bool(over[known].all())
        values = question.demands(rows)[known] if question.quantity != COLLAPSE else ()
        extremes = {"smallest": np.min, "largest": np.max}
        ends = tuple(
            f": the {word} {question.quantity} is {find(values):.6g}, the limit {question.limit:g}"
            if len(values)
            else ""
            for word, find in extremes.items()
        )
    if question.method == "cloud":
        return
    failure = "collapses" if question.quantity == COLLAPSE else "exceeds the limit"
    if none:
        raise InputError(
            f"{label}: no run {failure}{ends[1]}: the median is above the highest intensity "
            f"{x.max():g}: give higher levels or a lower limit"
        )
    if every:
        raise InputError(
            f"{label}: every run {failure}{ends[0]}: the median is below the lowest intensity "
            f"{x.min():g}: give lower levels or a higher limit"
        )


def _notes(
    median: float, dispersion: float, points: Mapping[str, Any], rows: xr.Dataset
) -> list[str]:
    """Return the warnings about a fit."""
    is_counted = "exceeded" in points and "capacity" not in points
    x = points["x"] if is_counted else rows["intensity"].values
    low, high = float(x.min()), float(x.max())
    notes = []
    if not low / _FAR <= median <= _FAR * high:
        side = f"above the highest intensity {high:.4g}"
        side = side if median > high else f"below the lowest intensity {low:.4g}"
        notes.append(f"the median {median:.4g} is extrapolated far {side}: give more levels")
    if dispersion > _WIDE:
        notes.append(f"the dispersion {dispersion:.4g} is large: the probability hardly grows")
    keys = zip(*(rows[word].values.tolist() for word in ("record", "intensity")), strict=True)
    repeated = rows.sizes["row"] - len(set(keys))
    if repeated:
        notes.append(f"{repeated} rows repeat record and intensity of others; all are counted")
    down, statuses = fallen(rows), rows["status"].values.astype(str)
    failed = sorted(set(statuses[~down].tolist()) - {"ok"})
    if failed:
        lost = int(np.isin(statuses, failed).sum())
        notes.append(f"{lost} of {statuses.size} runs failed ({', '.join(failed)})")
    if dispersion > 0:
        return notes
    if not is_counted:
        return [*notes, "all capacities are equal: the dispersion is 0"]
    k, n = points["exceeded"], points["runs"]
    low, high = float(x[k == 0].max()), float(x[k == n].min())
    return [
        *notes,
        f"the counts step from none to all between {low:g} and {high:g}: the median lies there, "
        "and the dispersion is 0 for want of levels between",
    ]


def _resample(question: _Question, names: npt.NDArray[Any]) -> Array:
    """Return the multiplicity of each record in each resample; the first is the sample itself."""
    n = np.unique(names).size
    chance = np.random.default_rng(question.seed)
    drawn = chance.multinomial(n, np.full(n, 1 / n), size=question.resamples)
    return np.vstack([np.ones((1, n)), drawn.astype(float)])


def _counts(rows: xr.Dataset, question: _Question, label: str) -> _Fitted:
    """Fit the counts at each intensity; resamples draw records, or binomial counts without any."""
    x, which = np.unique(rows["intensity"].values, return_inverse=True)
    if x.size < 2:
        raise InputError(f"{label}: the counts are at one intensity, {x[0]:g}: give at least two")
    if "exceeded" in rows:
        k = np.bincount(which, rows["exceeded"].values)
        n = np.bincount(which, rows["runs"].values).astype(float)
        chance = np.random.default_rng(question.seed)
        drawn = chance.binomial(n.astype(int), k / n, size=(question.resamples, x.size))
        exceeded = np.vstack([k, drawn.astype(float)])
        runs = np.broadcast_to(n, exceeded.shape)
    else:
        over, known = question.exceeded(rows)
        # the levels of a search for capacities belong to single records
        known &= np.isin(which, np.searchsorted(x, rows.attrs.get("levels", x)))
        names, record = np.unique(rows["record"].values.astype(str), return_inverse=True)
        place = record * x.size + which
        shape = (names.size, x.size)
        counted = [
            np.bincount(place[chosen], minlength=names.size * x.size).reshape(shape).astype(float)
            for chosen in (known & over, known)
        ]
        multiplicity = _resample(question, names)
        exceeded, runs = (multiplicity @ counts for counts in counted)
    used = runs[0] > 0
    x, exceeded, runs = x[used], exceeded[:, used], runs[:, used]
    fit = fit_counts(x, exceeded, runs)
    counts = ", ".join(f"{a:g} of {b:g}" for a, b in zip(exceeded[0], runs[0], strict=True))
    if math.isnan(fit.median[0]):
        raise InputError(
            f"{label}: {question.label}: the probability does not grow with the intensity "
            f"({counts})"
        )
    ends = {0.0: "below the lowest", x[0]: "at the lowest", x[-1]: "at the highest",
            math.inf: "above the highest"}  # fmt: skip
    median = float(fit.median[0])
    if median in (0.0, math.inf) or (fit.dispersion[0] == 0 and median in (x[0], x[-1])):
        side = ends[median]
        level = x[0] if side.endswith("lowest") else x[-1]
        raise InputError(
            f"{label}: {question.label}: no finite fit exists ({counts}): the median lies {side} "
            f"intensity {level:g}: give more levels there"
        )
    points = {"x": x, "exceeded": exceeded[0].astype(int), "runs": runs[0].astype(int)}
    return points, fit


def _capacities(rows: xr.Dataset, question: _Question, label: str) -> _Fitted:
    """Fit the intensities at which the records reach the limit."""
    over, known = question.exceeded(rows)
    names = list(dict.fromkeys(rows["record"].values.tolist()))
    demands = None if question.quantity == COLLAPSE else question.demands(rows)
    found = []
    for name in names:
        own = np.flatnonzero((rows["record"].values == name) & known)
        if own.size:
            own = own[np.argsort(rows["intensity"].values[own], kind="stable")]
            down = fallen(rows)[own]
            values = None if demands is None else np.where(down, math.inf, demands[own])
            found.append((name, *_capacity(rows["intensity"].values[own], over[own], values,
                                           question.limit)))  # fmt: skip
    if len(found) < 2:
        raise InputError(
            f"{label}: has {len(found)} record: a dispersion needs at least 2; or take the method "
            "counts"
        )
    kept, logarithms, kinds = (np.array(item) for item in zip(*found, strict=True))
    fit = fit_capacities(logarithms, kinds, _resample(question, kept))
    if not 0 < fit.median[0] < math.inf:
        side = "below their lowest" if fit.median[0] == 0 else "above their highest"
        raise InputError(f"{label}: {question.label}: every capacity is {side} level")
    capacity = np.exp(logarithms)
    capacity = np.where(kinds == OVER, math.inf, np.where(kinds == BELOW, 0.0, capacity))
    points = _points(rows, question) | {"capacity": capacity, "record": kept.astype(object)}
    return points, fit


def _capacity(x: Array, over: Truths, demands: Array | None, limit: float) -> tuple[float, int]:
    """Return the logarithm of a record's capacity, or of its bound, and the kind of both."""
    if not over.any():
        return math.log(x[-1]), OVER
    i = int(np.argmax(over))
    if i == 0:
        return math.log(x[0]), BELOW
    low, high = math.log(x[i - 1]), math.log(x[i])
    share = 0.5
    if demands is not None and math.isfinite(demands[i]) and demands[i - 1] > 0:
        a, b = math.log(demands[i - 1]), math.log(demands[i])
        share = (math.log(limit) - a) / (b - a)
    return low + share * (high - low), EXACT


def _points(rows: xr.Dataset, question: _Question) -> dict[str, Any]:
    """Return positions of the curve: the levels of all records with their counts, or a range."""
    values = rows["intensity"].values
    levels = rows.attrs.get("levels")
    if levels is None:
        return {"x": np.geomspace(values.min(), values.max(), _POSITIONS)}
    x = np.atleast_1d(np.asarray(levels, dtype=float))
    over, known = question.exceeded(rows)
    return {
        "x": x,
        "exceeded": np.array([np.sum((values == level) & over & known) for level in x]),
        "runs": np.array([np.sum((values == level) & known) for level in x]),
    }


def _cloud(rows: xr.Dataset, question: _Question, label: str) -> _Fitted:
    """Fit a power law; the demand of a collapsed run lies above the limit and above its maximum."""
    _, known = question.exceeded(rows)
    demands = question.demands(rows)
    down = fallen(rows) | np.isposinf(demands)
    if question.limit <= 0:
        raise InputError(f"{label}: limit = {question.limit:g}: must be > 0 in a cloud")
    bound = np.where(np.isfinite(demands), np.fmax(demands, question.limit), question.limit)
    y = np.where(down, bound, demands)
    used = known & (y > 0)
    x = np.log(rows["intensity"].values[used])
    exact = ~down[used]
    if np.unique(x[exact]).size < 3:
        raise InputError(
            f"{label}: {question.label}: has {np.unique(x[exact]).size} different intensities "
            "without collapse: a cloud needs at least 3"
        )
    names, record = np.unique(rows["record"].values.astype(str)[used], return_inverse=True)
    weights = _resample(question, names)[:, record]
    kinds = np.where(exact, EXACT, OVER)
    fit = fit_cloud(x, np.log(y[used]), kinds, weights, math.log(question.limit))
    if not 0 < fit.median[0] < math.inf:
        raise InputError(f"{label}: {question.quantity}: does not grow with the intensity")
    values = np.exp(x)
    return {"x": np.geomspace(values.min(), values.max(), _POSITIONS)}, fit


def _together(parts: list[xr.Dataset], names: list[str]) -> xr.Dataset:
    """Join the designs over one dimension."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = xr.concat(parts, dim="design", join="outer", data_vars="all", coords="minimal",
                          compat="override")  # fmt: skip
    found = found.assign_coords(design=("design", np.array(names, dtype=object)))
    if len(parts) > 1:
        # curves of all designs at all positions
        x = found["intensity"].values
        median, total = found["median"].values[:, None], found["dispersion_total"].values[:, None]
        found["fitted"] = (("design", "intensity"), exceedance(x, median, total), {"units": "1"})
    return found


def _with_margins(
    found: xr.Dataset, mce: float | None, shape_factor: float | tuple[float, float, str] | None
) -> xr.Dataset:
    """Add the margin ratio over the maximum considered earthquake, and its adjustment."""
    if mce is None:
        if shape_factor is not None:
            raise InputError("shape_factor: needs mce, whose margin ratio it adjusts")
        return found
    level = to_number("mce", mce, above=0.0)
    median, total = found["median"].values, found["dispersion_total"].values
    one = {"units": "1"}
    found = found.assign(
        mce=((), level, found["median"].attrs),
        margin_ratio=("design", median / level, one),
        probability_at_mce=("design", exceedance(level, median, total), one),
    )
    if shape_factor is None:
        return found
    factor = shape_factor_of(shape_factor)
    return found.assign(
        shape_factor=((), factor, one),
        margin_ratio_adjusted=("design", factor * median / level, one),
        probability_at_mce_adjusted=("design", exceedance(level, factor * median, total), one),
    )
