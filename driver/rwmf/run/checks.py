"""Demands over the limits of `&limits` in runs, suites and static curves, and their tables."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np
import xarray as xr

from rwmf.case import Case, CaseLike
from rwmf.case.arguments import case_of
from rwmf.case.elements import heights_of_floors
from rwmf.errors import InputError
from rwmf.kernel import files
from rwmf.kernel.numbers import Array, Truths, show
from rwmf.run.arguments import dataset_of
from rwmf.run.quantities import Quantity, ending_of, fallen, find_numbered, names_by_key
from rwmf.run.response import Response, columns_by_key

# a protocol often ends at a limit: round-off does not exceed it
_ROUND_OFF = 1e-12


def crossings_of(case: Case, curve: xr.Dataset) -> list[tuple[str, int, float]]:
    """Find where a curve first exceeds the limits of a case."""
    columns = columns_by_key(curve)
    found = []
    for limit in limits_of(case):
        demand = demand_along(case, columns, limit.key)
        if demand is None:
            continue
        ratios = ratios_of(limit, demand)
        drift = drift_at_limit(ratios, columns["roof_drift"])
        if not math.isnan(drift):
            found.append((f"limit_{limit.key}", int(np.argmax(ratios > 1)), drift))
    return found


def drift_at_limit(ratios: Array, drift: Array) -> float:
    """Return the drift of the roof at which a ratio first exceeds 1."""
    above = np.flatnonzero(ratios > 1)
    if not above.size:
        return math.nan
    step = above[0]
    if step == 0:
        return float(drift[0])
    before, after = ratios[step - 1], ratios[step]
    share = (1 - before) / (after - before) if math.isfinite(after) else 0.0
    return float(drift[step - 1] + share * (drift[step] - drift[step - 1]))


def ratios_of(limit: Limit, demand: Array) -> Array:
    """Return the ratio of demand over limit at every step; round-off does not exceed a limit."""
    ratios = np.asarray(limit.ratio(demand), dtype=np.float64)
    return np.where(np.abs(ratios - 1) < _ROUND_OFF, 1.0, ratios)


def demand_along(case: Case, columns: Mapping[str, Array], key: str) -> Array | None:
    """Return a demand at every step."""
    name = key.replace("_max", "").replace("_min", "")
    if name in columns:
        return columns[name]
    if name == "storey_drift":
        storeys = [
            values for item, values in columns.items() if re.fullmatch(r"storey_\w*_drift", item)
        ]
        return np.asarray(np.max(np.abs(storeys), axis=0)) if storeys else None
    if name == "theta_over_alpha":
        return columns["theta_rad"] / math.atan2(case.wall.b, case.wall.h)
    for beginning in ("tendon_force", "cable_force_increment"):
        if name.startswith(beginning):
            force = columns.get(name.replace(beginning, "cable_force"))
            if force is None or beginning == "tendon_force":
                return force
            # without load the wall stands and the cable has its prestress
            return np.asarray(force - force[0])
    return None


# median, one standard deviation of a normal distribution on both sides, and the largest [%]
PERCENTILES = (16.0, 50.0, 84.0, 100.0)
# dimensions whose runs are a suite, in this order
_SUITES = ("record", "point", "row")
# demands whose smallest value counts
_SMALLEST = ("contact_length_min_m",)


@dataclass(frozen=True)
class Limit:
    """A limit of a demand.

    Attributes
    ----------
    key : str
        Key of the demand in ``rwmf run --json``.
    quantity : Quantity
        Its row of the table of quantities.
    number : int
        Number of the floor or storey, 0 for none.
    value : float
        The limit in the unit of the demand.
    """

    key: str
    quantity: Quantity
    number: int
    value: float

    @property
    def is_least(self) -> bool:
        """True when the demand must not be smaller than the limit."""
        return self.key in _SMALLEST

    def ratio(self, demand: Any) -> Any:  # noqa: ANN401 (a number or an array)
        """Return demand over limit, or limit over demand where the smallest demand counts."""
        if not self.is_least:
            return np.abs(demand) / self.value
        with np.errstate(divide="ignore"):
            return self.value / np.asarray(demand)


@dataclass(frozen=True)
class LimitCheck:
    """A demand and its limit.

    Attributes
    ----------
    key : str
        Key of the demand in ``rwmf run --json``.
    meaning, unit : str
        Its definition and unit.
    number : int
        Number of the floor or storey, 0 for none.
    height : float
        Height of this floor, or of the top of this storey [m]; NaN without one.
    limit : float
        The limit.
    demand : float
        Demand of the run, the worst one of a suite; NaN where the run has none.
    ratio : float
        Demand over limit; limit over demand for the smallest contact length.
    demands, ratios : dict of float to float
        Counted percentiles of a suite by percentage; empty for a run.
    share_above : float
        Share of the runs that exceed the limit; runs that overturn or collapse count.
    at : dict of str to float or str
        Coordinates in a grid; axes with one value are left out.
    drift_at_limit : float, optional
        Drift of the roof at which a static curve reaches the limit; NaN when it does not. None for
        a run.
    """

    key: str
    meaning: str
    unit: str
    number: int
    height: float
    limit: float
    demand: float
    ratio: float
    demands: dict[float, float]
    ratios: dict[float, float]
    share_above: float
    at: dict[str, Any]
    drift_at_limit: float | None = None

    @property
    def is_met(self) -> bool:
        """True when no run exceeds the limit."""
        return self.share_above <= 0

    def to_dict(self) -> dict[str, Any]:
        """Return the check as an object for JSON.

        Returns
        -------
        dict
            Attributes by name; percentiles with names such as ``demand_p84``, ``ratio_max``.
        """
        row = {name: getattr(self, name) for name in ("key", "number", "height", "unit", "limit")}
        row |= {"demand": self.demand, "ratio": self.ratio}
        for q in self.demands:
            name = "max" if q == PERCENTILES[-1] else f"p{q:g}"
            row |= {f"demand_{name}": self.demands[q], f"ratio_{name}": self.ratios[q]}
        if self.drift_at_limit is not None:
            row["drift_at_limit"] = self.drift_at_limit
        return row | {"share_above": self.share_above, "is_met": self.is_met} | self.at


@dataclass(frozen=True)
class Checks:
    """All checks of a run, a suite or a grid.

    Attributes
    ----------
    rows : tuple of LimitCheck
        In the order of the table of quantities, from the ground up.
    runs : int
        Number of runs of each check: 1, or the records of the suite.
    ended : int
        Number of runs, over the whole grid, that overturned or collapsed.
    failed : int
        Number of runs without a result; they are not counted.
    absent : tuple of str
        Keys of demands that a static curve does not have, such as accelerations.
    """

    rows: tuple[LimitCheck, ...]
    runs: int
    ended: int
    failed: int
    absent: tuple[str, ...] = ()

    @property
    def is_met(self) -> bool:
        """True when all runs end as planned and meet all limits."""
        return not self.ended and not self.failed and all(row.is_met for row in self.rows)

    @property
    def worst(self) -> LimitCheck:
        """The check with the largest ratio."""
        return max(self.rows, key=lambda row: -1.0 if math.isnan(row.ratio) else row.ratio)

    def to_dict(self) -> dict[str, Any]:
        """Return the checks as an object for JSON.

        Returns
        -------
        dict
            ``is_met``, counts of runs, and ``rows``.
        """
        counts = {name: getattr(self, name) for name in ("is_met", "runs", "ended", "failed")}
        if self.absent:
            counts["absent"] = list(self.absent)
        return counts | {"rows": [row.to_dict() for row in self.rows]}

    def __str__(self) -> str:
        """Return the table as text, with the governing floor or storey of each demand."""
        return text_of(self)


def checks(case: CaseLike, result: xr.Dataset | Mapping[str, Any]) -> Checks:
    """Compare the demands of runs with the limits of a case.

    Parameters
    ----------
    case : Case or path
        The case, with ``&limits``.
    result : xarray.Dataset or mapping
        Dataset of `rwmf.simulate`, `rwmf.pushover`, `rwmf.sweep`, `rwmf.spectrum` or of an analysis
        of a suite; or scalars with the keys of ``rwmf run --json``.

    Returns
    -------
    Checks
        Demand, limit and ratio of every limit. A suite (dimension ``record``, ``point`` or ``row``)
        has counted percentiles, and the share of its runs above the limit. Runs that overturn or
        collapse count as above. Each point of the other dimensions has separate checks. A static
        curve has its largest demands over the steps; limits of demands that it does not have, such
        as accelerations, have no row.

    Raises
    ------
    InputError
        When the case has no limits, or the dataset lacks a demand.

    Examples
    --------
    >>> print(rwmf.checks(case, rwmf.simulate(case)))  # doctest: +SKIP
    """
    case = case_of(case)
    limits = limits_of(case)
    if not limits:
        raise InputError("&limits: is missing or empty: a check needs limits of demands")
    if isinstance(result, xr.Dataset):
        if "status" in result.data_vars:
            return _checks_of_grid(case, limits, result)
        if "mark_step" in result.coords:
            return _checks_of_curve(case, limits, result)
        scalars: Mapping[str, Any]
        scalars = Response(result.data_vars, result.coords, result.attrs).flat()
    elif isinstance(result, Mapping):
        scalars = {str(key): value for key, value in result.items()}
    else:
        raise InputError(f"result = {show(result)}: must be a dataset or the scalars of a run")
    if not any(limit.key in scalars for limit in limits):
        raise InputError(f"result: has none of the demands: {', '.join(x.key for x in limits)}")
    has_ended = ending_of(scalars) != "ok"
    heights = heights_of_floors(case)
    rows = [
        _check(limit, heights, np.array([float(scalars.get(limit.key, math.nan))]))
        for limit in limits
    ]
    return Checks(tuple(rows), 1, int(has_ended), 0)


def limits_of(case: Case) -> list[Limit]:
    """Return the limits of a case, one for each floor or storey."""
    found = []
    for key in case.kernel.limited_demands():
        quantity, number = find_numbered(key)
        value = case.limits[quantity.limit_key]
        if isinstance(value, tuple):
            value = value[number - 1] if len(value) > 1 else value[0]
        found.append(Limit(key, quantity, number, float(value)))
    return found


def _check(
    limit: Limit,
    heights: list[float],
    demands: Array,
    down: Truths | None = None,
    at: dict[str, Any] | None = None,
    *,
    is_suite: bool = False,
) -> LimitCheck:
    """Count the demands of runs; those of a grid come with the runs that ended early."""
    ratios = limit.ratio(demands)
    if down is not None:
        demands = np.where(down, 0.0 if limit.is_least else math.inf, demands)
        ratios = np.where(down, math.inf, ratios)
    counted = ~np.isnan(ratios)
    order = np.argsort(ratios[counted], kind="stable")
    ranked, sorted_ratios = demands[counted][order], ratios[counted][order]
    n = order.size
    # the smallest rank whose share of the runs reaches the percentage
    places = {q: max(math.ceil(q / 100 * n - 1e-9), 1) - 1 for q in PERCENTILES} if n else {}
    return LimitCheck(
        limit.key,
        limit.quantity.meaning.replace("{i}", str(limit.number)),
        limit.quantity.unit,
        limit.number,
        heights[limit.number - 1] if 0 < limit.number <= len(heights) else math.nan,
        limit.value,
        float(ranked[-1]) if n else math.nan,
        float(sorted_ratios[-1]) if n else math.nan,
        {q: float(ranked[i]) for q, i in places.items()} if is_suite else {},
        {q: float(sorted_ratios[i]) for q, i in places.items()} if is_suite else {},
        float(np.mean(sorted_ratios > 1)) if n else math.nan,
        at or {},
    )


def _checks_of_curve(case: Case, limits: list[Limit], curve: xr.Dataset) -> Checks:
    """Check the largest demands of a static curve."""
    columns = columns_by_key(dataset_of(curve, "rwmf.pushover", "roof_drift"))
    heights = heights_of_floors(case)
    rows, absent = [], []
    for limit in limits:
        demand = demand_along(case, columns, limit.key)
        if demand is None:
            absent.append(limit.key)
            continue
        ratios = ratios_of(limit, demand)
        step = int(np.argmax(ratios))
        row = _check(limit, heights, np.abs(demand[[step]]))
        drift = drift_at_limit(ratios, columns["roof_drift"])
        above = float(ratios[step] > 1)
        rows.append(replace(row, share_above=above, drift_at_limit=drift))
    if not rows:
        raise InputError(f"result: a static curve has none of the demands: {', '.join(absent)}")
    has_ended = curve.attrs.get("ending") != "complete"
    return Checks(tuple(rows), 1, int(has_ended), 0, tuple(absent))


def _checks_of_grid(case: Case, limits: list[Limit], dataset: xr.Dataset) -> Checks:
    """Check each suite of a grid."""
    names = names_by_key(dataset.data_vars)
    missing = [limit.key for limit in limits if limit.key not in names]
    if missing:
        raise InputError(f"result: has no {missing[0]}: request it with quantities")
    status = dataset["status"]
    words = str(status.attrs.get("flag_meanings", "")).split()
    is_fallen = status.copy(data=fallen(dataset))
    is_failed = ~is_fallen & ~status.isin([words.index("ok") if "ok" in words else "ok"])
    suite = next((dim for dim in _SUITES if dim in status.dims), None)
    heights = heights_of_floors(case)
    rows = []
    for at, where in _points(dataset, [dim for dim in status.dims if dim != suite]):
        down = np.atleast_1d(is_fallen.isel(where).values)
        lost = np.atleast_1d(is_failed.isel(where).values)
        for limit in limits:
            values = np.atleast_1d(dataset[names[limit.key]].isel(where).values).astype(float)
            values[lost] = math.nan
            rows.append(_check(limit, heights, values, down, at, is_suite=suite is not None))
    runs = 1 if suite is None else dataset.sizes[suite]
    return Checks(tuple(rows), runs, int(is_fallen.sum()), int(is_failed.sum()))


def _points(
    dataset: xr.Dataset, dims: list[Any]
) -> Iterator[tuple[dict[str, Any], dict[Any, int]]]:
    """Iterate over a grid: coordinates and places of each point."""
    for places in np.ndindex(*(dataset.sizes[dim] for dim in dims)):
        where = dict(zip(dims, places, strict=True))
        at = {
            str(dim): dataset[dim].values[i].item() if dim in dataset.coords else i
            for dim, i in where.items()
            if dataset.sizes[dim] > 1
        }
        yield at, where


# ratios from here on have four digits
_LONG = 1e4


def text_of(found: Checks, *, is_all: bool = False) -> str:
    """Return checks as a table."""
    rows = [_title_row(found)]
    for at, part in groupby(found.rows, key=lambda row: row.at):
        if at:
            rows.append([", ".join(f"{name} = {_show(value)}" for name, value in at.items())])
        rows += [_cells(row, number) for row, number in _shown(part, is_all=is_all)]
    widths = [max(len(row[i]) for row in rows if len(row) > 1) for i in range(len(rows[0]))]
    lines = [
        row[0]
        if len(row) == 1
        else "  ".join(
            [f"{row[0]:{widths[0]}s}"]
            + [f"{cell:>{width}s}" for cell, width in zip(row[1:], widths[1:], strict=True)]
        ).rstrip()
        for row in rows
    ]
    return "\n".join([*lines, _verdict(found)])


def _title_row(found: Checks) -> list[str]:
    if found.rows[0].demands:
        ends = ["max" if q == PERCENTILES[-1] else f"{q:g} %" for q in PERCENTILES]
        return ["ratios over limits", "limit", *ends, "above", ""]
    drift = [] if found.rows[0].drift_at_limit is None else ["reached at"]
    return ["checks", "demand", "limit", "ratio", *drift, ""]


def _shown(rows: Iterable[LimitCheck], *, is_all: bool) -> list[tuple[LimitCheck, str]]:
    """Choose the rows of a table, each with a note on its floor or storey."""
    shown = []
    for quantity, part in groupby(rows, key=lambda row: find_numbered(row.key)[0]):
        members = list(part)
        key, level = quantity.limit_key, quantity.level
        if is_all or not level:
            shown += [(row, "") for row in members]
            continue
        worst = max(members, key=lambda row: -1.0 if math.isnan(row.ratio) else row.ratio)
        note = f" ({level} {worst.number})" if len(members) > 1 else ""
        shown.append((worst, f"{key}{note}"))
    return shown


def _cells(row: LimitCheck, label: str) -> list[str]:
    name = label or row.key
    verdict = "" if row.is_met else ("no demand" if math.isnan(row.ratio) else "EXCEEDED")
    if not row.demands:
        drift = []
        if row.drift_at_limit is not None:
            is_reached = not math.isnan(row.drift_at_limit)
            drift = [f"{100 * row.drift_at_limit:.4g} %" if is_reached else ""]
        return [name, f"{row.demand:.5g}", f"{row.limit:.5g}", _ratio(row.ratio), *drift, verdict]
    ratios = [_ratio(row.ratios[q]) for q in PERCENTILES]
    above = f"{100 * row.share_above:.3g} %"
    return [name, f"{row.limit:.5g}", *ratios, above, verdict]


def _verdict(found: Checks) -> str:
    """Summarise all checks in one line."""
    worst = found.worst
    missed = sum(not row.is_met for row in found.rows)
    text = f"all {len(found.rows)} limits are met" if not missed else (
        f"{missed} of {len(found.rows)} limits are not met"
    )  # fmt: skip
    text += f"; largest ratio {_ratio(worst.ratio)} of {worst.key}"
    if found.ended and worst.drift_at_limit is not None:
        text += "; THE CURVE ENDS EARLY, demands are those until then"
    elif found.ended:
        text += f"; {found.ended} runs overturned or collapsed" if found.runs > 1 else (
            "; THE RUN OVERTURNED OR COLLAPSED, demands are those until then"
        )  # fmt: skip
    if found.absent:
        text += f"\nno demand of a static curve: {', '.join(found.absent)}"
    return text + (f"; {found.failed} runs failed and are not counted" if found.failed else "")


def _ratio(ratio: float) -> str:
    return f"{ratio:.3f}" if not abs(ratio) >= _LONG else f"{ratio:.4g}"


def _show(value: Any) -> str:  # noqa: ANN401 (a number or a text)
    return f"{value:g}" if isinstance(value, float) else str(value)


def write_csv(found: Checks, path: str | os.PathLike[str]) -> None:
    """Write checks as CSV, one row for each limit, floor, storey and point of a grid."""
    rows = [row.to_dict() for row in found.rows]
    names = list(dict.fromkeys(key for row in rows for key in row))
    cells = ([row.get(name, "") for name in names] for row in rows)
    files.write_bytes(path, files.csv_text([names, *cells], "\r\n").encode())
