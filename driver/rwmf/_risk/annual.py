"""Annual frequency of exceeding a limit: integral of a fragility curve over a hazard curve."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from rwmf._arguments import checked
from rwmf._numbers import show, to_array, to_items, to_number
from rwmf._risk.hazard import Hazard, hazard_of
from rwmf._risk.normal import exceedance, log_normal_cdf
from rwmf._risk.table import warnings_of
from rwmf.errors import InputError

__all__ = ["closed_form", "integrate", "risk", "unit_of"]

Array = npt.NDArray[np.float64]
# beyond these standard deviations from its peak, the integrand is below rounding
_REACH = 12.0
# nodes of each interval: at most one standard deviation, or a decay of the hazard by exp(8)
_STEEP = 8.0
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
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

    The frequency is the integral of the hazard over the distribution of the capacity, by
    Gauss-Legendre quadrature. The result includes the closed form for power laws (Cornell et al.
    2002, Journal of Structural Engineering 128(4)). A hazard from a file is
    linear in logarithms between its points; its two ends are continued.

    Parameters
    ----------
    fragility : xarray.Dataset, mapping or pair
        From `rwmf.fragility`, for one or several designs; or ``{"median": , "dispersion": }`` or
        the pair of both. Fragility and hazard have the same measure of intensity, accelerations
        over g.
    hazard : path, mapping or pair
        CSV file or mapping of two columns: the intensity with ``frequency`` [1/year],
        ``return_period`` [year] or ``poe_50`` (probability in 50 years). Their names may state
        units, as ``pga [m/s2]``. ``{"k0": , "k": }`` or (k0, k) for the power law
        k0 intensity^-k.
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
    closed = np.array([closed_form(curve, m, b) for m, b in zip(medians, dispersions, strict=True)])
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
    """Integrate a lognormal fragility over a hazard curve, between edges, by quadrature."""
    held = exceedance(edges, median, dispersion) * hazard.frequency(edges)
    # by parts: the integral of P over -dH is that of H over dP, and P H at the edges
    held = np.concatenate([[0.0], held, [0.0]])
    if dispersion == 0:
        inside = np.zeros(edges.size + 1)
        # the step is above the median: one at an edge belongs to the bin above it
        inside[np.searchsorted(edges, median, side="right")] = hazard.frequency(median)
        return inside + held[:-1] - held[1:]
    centre = math.log(median)
    cuts = (np.log(edges) - centre) / dispersion
    low = -float(hazard.exponents.max()) * dispersion - _REACH
    cuts = np.clip(np.concatenate([[low], cuts, [_REACH]]), low, _REACH).tolist()
    knots = (hazard.knots - centre) / dispersion
    inside = np.array(
        [_quadrature(hazard, centre, dispersion, ends, knots) for ends in itertools.pairwise(cuts)]
    )
    return inside + held[:-1] - held[1:]


def _quadrature(
    hazard: Hazard, centre: float, dispersion: float, ends: tuple[float, float], knots: Array
) -> float:
    """Integrate the hazard over the capacity's distribution between two standard deviations."""
    a, b = ends
    if b <= a:
        return 0.0
    breaks = np.unique(np.concatenate([[a, b], knots[(knots > a) & (knots < b)]]))
    total = 0.0
    for left, right in itertools.pairwise(breaks.tolist()):
        part = np.searchsorted(hazard.knots, centre + dispersion * 0.5 * (left + right))
        steepness = max(1.0, float(hazard.exponents[part]) * dispersion / _STEEP)
        n = max(1, math.ceil((right - left) * steepness))
        points = np.linspace(left, right, n + 1)
        half = 0.5 * np.diff(points)[:, None]
        z = 0.5 * (points[:-1] + points[1:])[:, None] + half * _NODES
        u = centre + dispersion * z
        # one exponential: the hazard alone may overflow where the density vanishes
        values = np.exp(hazard.factors[part] - hazard.exponents[part] * u - 0.5 * z**2)
        total += float(np.sum(half * _WEIGHTS * values))
    return total / math.sqrt(2 * math.pi)


def closed_form(
    hazard: Hazard, median: npt.ArrayLike, dispersion: npt.ArrayLike, below: float = math.inf
) -> Array:
    """Sum the closed forms of the power laws of a hazard curve."""
    median, dispersion = np.broadcast_arrays(*map(np.asarray, (median, dispersion)))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        centre = np.log(median)[..., None]
        beta = np.asarray(dispersion, dtype=float)[..., None]
        ends = np.minimum(np.concatenate([[-math.inf], hazard.knots, [math.inf]]), math.log(below))
        k = hazard.exponents
        # exp(k^2 beta^2 / 2) turns the density into one whose mean is lower by k beta
        cuts = np.where(beta > 0, (ends - centre) / beta, np.where(ends >= centre, 1, -1) * 1e9)
        a, b = cuts[..., :-1] + k * beta, cuts[..., 1:] + k * beta
        # the tail with the smaller numbers keeps the digits of the difference
        low, high = np.where(a > 0, -b, a), np.where(a > 0, -a, b)
        least, most = log_normal_cdf(low)[0], log_normal_cdf(high)[0]
        share = most + np.log1p(-np.exp(np.where(high > low, least - most, 0.0)))
        terms = np.exp(hazard.factors - k * centre + 0.5 * (k * beta) ** 2 + share)
    return np.asarray(np.sum(np.where(high > low, terms, 0.0), axis=-1))


def _outside(hazard: Hazard, medians: Array, dispersions: Array, total: Array) -> Array:
    """Return the share of the frequency from capacities outside the hazard's points."""
    low, high = hazard.limits
    if low == 0.0:
        return np.zeros(medians.size)
    inside = closed_form(hazard, medians, dispersions, high)
    inside -= closed_form(hazard, medians, dispersions, low)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.clip(1 - inside / total, 0.0, 1.0)


def _fragilities(value: Any) -> tuple[xr.Dataset, xr.Dataset | None]:  # noqa: ANN401
    """Return medians and total dispersions over designs, and their resamples."""
    if isinstance(value, xr.Dataset):
        if "median" not in value or "dispersion" not in value:
            raise InputError("fragility: has no median and dispersion: must be of rwmf.fragility")
        dataset = value if "design" in value.dims else value.expand_dims("design")
        total = dataset["dispersion_total" if "dispersion_total" in dataset else "dispersion"]
        found = {"median": dataset["median"].values, "dispersion": total.values}
        names = dataset["design"].values if "design" in dataset.coords else [""]
        attrs = dict(dataset.attrs)
        samples = None
        if "median_resampled" in dataset:
            further = total**2 - dataset["dispersion"] ** 2
            spread = np.sqrt(dataset["dispersion_resampled"] ** 2 + further)
            samples = xr.Dataset(
                {"median": dataset["median_resampled"], "dispersion": spread},
                attrs={"confidence": dataset.attrs.get("confidence", 0.95)},
            )
    else:
        items = to_items(value)
        if isinstance(value, Mapping) and {"median", "dispersion"} <= set(value):
            items = [value["median"], value["dispersion"]]
        if items is None or len(items) != 2:
            raise InputError(
                f"fragility = {show(value)}: must be a dataset of rwmf.fragility, a mapping with "
                "median and dispersion, or the pair of both"
            )
        found = {
            name: to_array(f"fragility: {name}", item, least=1, is_finite=False)
            for name, item in zip(("median", "dispersion"), items, strict=True)
        }
        if len(found["median"]) != len(found["dispersion"]):
            raise InputError("fragility: median and dispersion differ in their length")
        names, attrs, samples = [str(i + 1) for i in range(len(found["median"]))], {}, None
    for name, design in zip(names, range(len(names)), strict=True):
        label = f"fragility{f' of {name}' if len(names) > 1 else ''}"
        to_number(f"{label}: median", found["median"][design], above=0.0)
        if to_number(f"{label}: dispersion", found["dispersion"][design]) < 0:
            raise InputError(f"{label}: dispersion = {found['dispersion'][design]:g}: must be >= 0")
    curves = xr.Dataset(
        {name: ("design", np.asarray(item, dtype=float)) for name, item in found.items()},
        coords={"design": ("design", np.asarray(names, dtype=object))},
        attrs=attrs,
    )
    return curves, samples


def _edges(levels: Sequence[float] | None, medians: Array, dispersions: Array) -> Array:
    """Return the given edges of the bins, or round ones around all medians."""
    if levels is not None:
        edges = to_array("levels", levels, above=0.0, least=1)
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
