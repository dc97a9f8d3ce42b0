"""Incremental dynamic analysis of a suite, and fragility curves."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Unpack

import numpy as np
import numpy.typing as npt
import xarray as xr

from rwmf._arguments import case_of, checked, dataset_of
from rwmf._numbers import show, to_array, to_number
from rwmf._sweep.axes import name_axes
from rwmf._sweep.computation import SweepOptions, sweep
from rwmf._sweep.intensity import choose_intensity
from rwmf._sweep.kept_quantities import default_quantity, find_quantities
from rwmf._sweep.plan import varied_keys
from rwmf._sweep.record_sets import RecordFile
from rwmf.case import CaseLike
from rwmf.errors import InputError
from rwmf.studies.statistics import with_overturning

__all__ = [
    "annual_frequency",
    "exceedance",
    "fragility",
    "fragility_median",
    "incremental_dynamic_analysis",
]

_ITERATIONS = 100
_CONVERGED = 1e-10
# limits of probabilities near 0 and 1, where the weights of the fit vanish
_FLOOR = 1e-12


@checked
def incremental_dynamic_analysis(
    case: CaseLike,
    levels: Sequence[float],
    records: Sequence[str | RecordFile],
    quantities: str | Sequence[str] | None = None,
    grid: Mapping[str, object] | None = None,
    *,
    intensity: str | None = None,
    period: float | None = None,
    damping: float | None = None,
    periods: Sequence[float] | None = None,
    **how: Unpack[SweepOptions],
) -> xr.Dataset:
    """Scale every record of a suite to common intensities and compute the responses.

    The intensity is the pseudo-spectral acceleration omega^2 u_max of a linear oscillator with the
    given period and damping. The default is those of the frame, for storeys the first period.
    Compare designs at the same period and damping only. The intensity for a wall alone is the peak
    ground acceleration.

    Parameters
    ----------
    case : Case or path
        The structure; its frame, if any, needs a period. The axes of its `&spectrum` are ignored.
    levels : sequence of float
        Intensities over g [-].
    records : sequence of str or RecordFile
        The suite.
    quantities : str or sequence of str, optional
        The stored demands; otherwise the displacement of the frame, or ``theta_max_over_alpha`` for
        a wall alone.
    grid : mapping, optional
        Further axes.
    intensity : str, optional
        A kind of `rwmf.intensity` instead of the scene's default.
    period, damping : float, optional
        Period [s] and damping ratio [-] of the oscillator, both or none; required where further
        axes change the structure.
    periods : sequence of float, optional
        Periods of an ``average_acceleration`` [s].
    **how
        Further arguments of `rwmf.sweep`.

    Returns
    -------
    xarray.Dataset
        The demand over ``record`` and ``scale``, the intensity; the attributes ``intensity``,
        ``intensity_period_s`` and ``intensity_damping`` define it.

    Raises
    ------
    InputError
        When an argument is not acceptable.
    """
    case = case_of(case)
    further = name_axes(grid or {})
    fixed = [name for name in ("scale", "T_s") if name in further]
    if fixed:
        raise InputError(f"incremental dynamic analysis: {fixed[0]} cannot be a further axis")
    axes = {"scale": [float(level) for level in levels]}
    if case.frame is not None:
        own = case.kernel.axes()["T_s"].value
        if own is None:
            raise InputError("incremental dynamic analysis: the case needs &frame T_s")
        axes["T_s"] = [own]
    if "spectrum" in case.groups:
        # one structure is analysed; further structures need further axes
        case = case.without("spectrum")
    varied = varied_keys(case, further, None)
    measure = choose_intensity(case, intensity, period, damping, varied, periods)
    found = sweep(
        case,
        axes | further,
        records,
        quantities=quantities or (default_quantity(case),),
        intensity=measure.kind,
        period=measure.period,
        damping=measure.damping,
        periods=measure.periods or None,
        **how,
    )
    return found.squeeze([name for name in ("T_s", "gamma", "b") if found.sizes.get(name) == 1])


@checked
def fragility(
    analysis: xr.Dataset, limit: float, quantities: str | Sequence[str] | None = None
) -> xr.Dataset:
    """Compute the probability of exceeding a limit, with a lognormal fit.

    Parameters
    ----------
    analysis : xarray.Dataset
        From `incremental_dynamic_analysis`.
    limit : float
        Limit of the demand in its unit; an overturned wall exceeds every limit.
    quantities : str, optional
        The demand; optional for an analysis with one demand.

    Returns
    -------
    xarray.Dataset
        ``fraction`` of the records over ``scale``; ``median`` and ``dispersion`` of the
        maximum-likelihood lognormal distribution, and ``fitted`` over ``scale``.

    Raises
    ------
    InputError
        When the limit is never or always exceeded, so that no fit exists.
    """
    dataset_of(analysis, "rwmf.studies.incremental_dynamic_analysis", "scale", "status")
    if quantities is None:
        kept = [str(name) for name in analysis.data_vars if name != "status"]
        if len(kept) != 1:
            raise InputError(f"fragility: quantities: must be one of {', '.join(kept)}")
        quantities = kept
    requested = find_quantities(tuple(quantities))
    if len(requested) > 1:
        raise InputError(f"fragility: quantities = {', '.join(requested)}: must be one quantity")
    (quantity,) = requested
    if quantity not in analysis:
        raise InputError(f"fragility: {quantity}: is not in the analysis")
    values = with_overturning(analysis, quantity)
    usable = values.notnull().sum("record")
    exceeded = (values > limit).sum("record")
    levels = analysis["scale"].values
    if exceeded.ndim != 1:
        raise InputError(f"fragility: needs record and scale, has also {values.dims}")
    _check_exceeded(quantity, values, limit)
    median, dispersion = _fit(levels, exceeded.values, usable.values)
    fitted = exceedance(levels, median, dispersion)
    return xr.Dataset(
        {
            "fraction": (exceeded / usable).assign_attrs(units="1"),
            "fitted": ("scale", fitted, {"units": "1"}),
            "median": ((), median, {"units": analysis["scale"].attrs.get("units", "1")}),
            "dispersion": ((), dispersion, {"units": "1"}),
            "limit": ((), limit, {"units": values.attrs.get("units", "1")}),
        },
        attrs=analysis.attrs | {"quantity": quantity},
    )


@checked
def fragility_median(
    limit: float, levels: Sequence[float]
) -> Callable[[npt.NDArray[np.float64]], float]:
    """Make the statistic of `rwmf.gradient` for the median of a fragility.

    The capacity of a record is the intensity at which its demand first reaches the limit, between
    two levels by a line in logarithms. The median is the geometric mean of the capacities, a smooth
    function, unlike one fitted to counts.

    Parameters
    ----------
    limit : float
        Limit of the demand in its unit.
    levels : sequence of float
        The values of ``scale`` in the grid.

    Returns
    -------
    callable
        Median intensity of an array over ``record`` and ``scale``.

    Raises
    ------
    InputError
        When a record does not reach the limit between the first and the last level.
    """
    numbers = _levels_of(levels)
    return lambda values: math.exp(float(np.mean(_capacities(values, limit, numbers))))


@checked
def annual_frequency(
    limit: float, levels: Sequence[float], k0: float, k: float
) -> Callable[[npt.NDArray[np.float64]], float]:
    """Make the statistic of `rwmf.gradient` for the mean annual frequency of exceedance.

    With the hazard k0 s^-k and a lognormal fragility the frequency is
    k0 theta^-k exp(k^2 beta^2/2) (Cornell and others 2002).

    Parameters
    ----------
    limit : float
        Limit of the demand in its unit.
    levels : sequence of float
        The values of ``scale`` in the grid.
    k0, k : float
        Annual frequency of the level 1 [1/year], and slope of the hazard [-].

    Returns
    -------
    callable
        Frequency [1/year] of an array over ``record`` and ``scale``.

    Raises
    ------
    InputError
        When a record does not reach the limit between the first and the last level.
    """
    numbers = _levels_of(levels)
    k0, k = to_number("k0", k0, above=0.0), to_number("k", k, above=0.0)

    def frequency(values: npt.NDArray[np.float64]) -> float:
        logarithms = _capacities(values, limit, numbers)
        median, variance = math.exp(float(np.mean(logarithms))), float(np.var(logarithms, ddof=1))
        return float(k0 * median**-k * math.exp(k**2 * variance / 2))

    return frequency


def _levels_of(levels: Sequence[float]) -> npt.NDArray[np.float64]:
    numbers = to_array("levels", levels, above=0.0, least=2)
    if not (np.diff(numbers) > 0).all():
        raise InputError(f"levels = {show(levels)}: must increase")
    return numbers


def _capacities(
    values: npt.NDArray[np.float64], limit: float, levels: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return the logarithms of the intensities at which records first reach the limit."""
    above = values > limit
    if not above.any(axis=1).all() or above[:, 0].any():
        raise InputError(
            f"levels: every record must reach the limit {limit:g} between the first and the last"
        )
    at = above.argmax(axis=1)
    rows = np.arange(len(values))
    low, high = np.log(values[rows, at - 1]), np.log(values[rows, at])
    # beside a collapse the middle of the two levels
    part = np.where(np.isinf(high), 0.5, (math.log(limit) - low) / (high - low))
    logs = np.log(levels)
    capacities: npt.NDArray[np.float64] = logs[at - 1] + part * (logs[at] - logs[at - 1])
    return capacities


def exceedance(scale: npt.ArrayLike, median: float, dispersion: float) -> np.ndarray:
    """Compute the probability that a lognormal capacity is exceeded.

    Parameters
    ----------
    scale : array_like, shape (n,)
        Intensities, in the unit of the median.
    median, dispersion : float
        Median, and standard deviation of the logarithm [-].

    Returns
    -------
    numpy.ndarray, shape (n,)
        Probabilities [-].
    """
    return np.array([_normal(math.log(x / median) / dispersion) for x in np.asarray(scale)])


def _check_exceeded(quantity: str, values: xr.DataArray, limit: float) -> None:
    """Refuse a limit that no run or every run exceeds, because no fit exists."""
    known = values.values[~np.isnan(values.values)]
    if known.size == 0:
        raise InputError(f"fragility: {quantity}: no run has a result")
    if not (known > limit).any():
        raise InputError(
            f"fragility: no run exceeds the limit: the largest {quantity} is {known.max():.6g}, "
            f"the limit {limit:g}: give higher levels or a lower limit"
        )
    if (known > limit).all():
        raise InputError(
            f"fragility: every run exceeds the limit: the smallest {quantity} is "
            f"{known.min():.6g}, the limit {limit:g}: give lower levels or a higher limit"
        )


def _fit(
    levels: npt.NDArray[np.float64],
    exceeded: npt.NDArray[np.int64],
    of: npt.NDArray[np.int64],
) -> tuple[float, float]:
    """Return the maximum-likelihood median and dispersion: probit regression by Fisher scoring."""
    if levels.size < 2 or not (levels > 0).all():
        raise InputError("fragility: the fit needs two levels of intensity at least, all > 0")
    x = np.column_stack([np.ones(levels.size), np.log(levels)])
    share = (exceeded + 0.5) / (of + 1.0)
    # initial line through the levels
    spread = max(float(np.std(x[:, 1])), 0.1)
    centre = float(np.interp(0.5, np.sort(share), np.sort(x[:, 1])))
    beta = np.array([-centre / spread, 1 / spread])
    for _ in range(_ITERATIONS):
        eta = np.clip(x @ beta, -8, 8)
        p = np.clip(np.array([_normal(float(value)) for value in eta]), _FLOOR, 1 - _FLOOR)
        density = np.exp(-0.5 * eta**2) / math.sqrt(2 * math.pi)
        weight = of * density**2 / (p * (1 - p))
        score = (exceeded - of * p) * density / (p * (1 - p))
        step = np.linalg.solve(x.T @ (weight[:, None] * x), x.T @ score)
        # for separable data the slope grows without bound: limited steps keep it finite
        step *= min(1.0, 1.0 / float(np.abs(step).max()))
        beta = beta + step
        if float(np.abs(step).max()) < _CONVERGED * float(np.abs(beta).max()):
            break
    if beta[1] <= 0:
        raise InputError("fragility: the demand does not grow with the intensity")
    return math.exp(-beta[0] / beta[1]), 1 / float(beta[1])


def _normal(x: float) -> float:
    return 0.5 * math.erfc(-x / math.sqrt(2))
