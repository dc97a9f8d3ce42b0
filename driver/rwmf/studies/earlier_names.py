"""Names of earlier versions for analyses and fragility curves.

They compute nothing: the runs are those of `rwmf.sweep`, the fit is that of `rwmf.fragility`. Use
`rwmf.ida`, `rwmf.stripes` and `rwmf.fragility` instead; the next minor version removes these.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Unpack

import numpy as np
import xarray as xr

from rwmf._arguments import case_of, checked, dataset_of
from rwmf._risk.fragility_curves import fragility as fit
from rwmf._risk.normal import exceedance
from rwmf._sweep.axes import name_axes
from rwmf._sweep.computation import SweepOptions, sweep
from rwmf._sweep.intensity import choose_intensity
from rwmf._sweep.kept_quantities import default_quantity, find_quantities
from rwmf._sweep.plan import varied_keys
from rwmf._sweep.record_sets import RecordFile
from rwmf.case import CaseLike
from rwmf.errors import InputError
from rwmf.studies.statistics import with_overturning

__all__ = ["fragility", "incremental_dynamic_analysis"]


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
    **sweep_options: Unpack[SweepOptions],
) -> xr.Dataset:
    """Scale every record of a suite to common intensities; use `rwmf.stripes` or `rwmf.ida`.

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
    **sweep_options
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
    _warn("incremental_dynamic_analysis: use rwmf.stripes or rwmf.ida")
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
        **sweep_options,
    )
    return found.squeeze([name for name in ("T_s", "gamma", "b") if found.sizes.get(name) == 1])


@checked
def fragility(
    analysis: xr.Dataset, limit: float, quantities: str | Sequence[str] | None = None
) -> xr.Dataset:
    """Compute the probability of exceeding a limit, with a lognormal fit; use `rwmf.fragility`.

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
    _warn("fragility: use rwmf.fragility")
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
    used = usable.values > 0
    counts = [item.values[used].tolist() for item in (exceeded, usable)]
    curve = fit(levels=levels[used].tolist(), exceeded=counts[0], runs=counts[1], resamples=0)
    median, dispersion = float(curve["median"]), float(curve["dispersion"])
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


def _warn(text: str) -> None:
    # level 4: the caller of the checked function
    warnings.warn(f"studies.{text}; it goes with the next version", DeprecationWarning, 4)


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
