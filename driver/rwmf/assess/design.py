"""Designs that meet their targets at the smallest cost, and the search for them."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from rwmf.case import Case, CaseLike, Motion
from rwmf.case.arguments import case_of, checked
from rwmf.errors import InputError, placed, warn
from rwmf.kernel.numbers import Array, Truths, show, to_array, to_items, to_number, to_whole
from rwmf.kernel.progress import Progress, Reports, reporting
from rwmf.motion.record_sets import RecordFile, find_records
from rwmf.run.checks import Limit, limits_of
from rwmf.run.quantities import default_quantity, fallen, find_quantities, refuse_missing
from rwmf.sweeps.axes import PAIRS, SCALE, SETTINGS, column_in, key_of_column, kind_of
from rwmf.sweeps.computation import sweep
from rwmf.sweeps.plan import united
from rwmf.sweeps.sweep_file import located

# designs of the first stage without the group
DESIGNS = 300
_PERCENTILE = 84.0


def request_of(case: Case) -> dict[str, Any]:
    """Return the arguments of `rwmf.design` that `&design` of a case gives."""
    group = case.design
    found: dict[str, Any] = {"bounds": {}, "targets": (), "cost": {}, "records": ()}
    found |= {"left_out": None, "unit": None, "designs": DESIGNS}
    if group is None:
        return found
    names = group.parameters
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise InputError(f"parameters: {twice[0]}: is given twice")
    targets: list[dict[str, Any]] = []
    if case.limits is not None:
        share: dict[str, Any] = {"percentile": group.get("percentile", _PERCENTILE)}
        if "probability" in group:
            share = {"probability": group.probability}
        targets.append({"quantity": "limits"} | share)
    if "collapse_probability" in group:
        targets.append(
            {"quantity": "collapse", "probability": group.collapse_probability}
            | {"scale": group.collapse_scale}
        )
    folder = Path(case.source or "").parent
    # files or patterns of records, as seen from the current folder
    for name in ("records", "left_out"):
        if name in group:
            found[name] = tuple(located(folder, word) for word in getattr(group, name))
    return found | {
        "bounds": dict(zip(names, zip(group.low, group.high, strict=True), strict=True)),
        "targets": targets,
        "cost": dict(zip(names, group.cost, strict=True)),
        "unit": group.unit if "unit" in group else None,
        "designs": group.designs,
    }


Cost = Mapping[str, float] | Callable[[dict[str, float]], float]
# word for overturning or collapse as the quantity of a target
COLLAPSE = "collapse"
# word for all limits of the case as the quantity of a target
_LIMITS = "limits"
_ALLOWED = ("quantity", "limit", "percentile", "probability", "scale")


@dataclass(frozen=True)
class Variable:
    """A number that the design chooses.

    Attributes
    ----------
    name : str
        Name in the request.
    column : str
        Column of a table of points.
    low, high : float
        Bounds, included.
    is_whole : bool
        True for whole numbers.
    """

    name: str
    column: str
    low: float
    high: float
    is_whole: bool


@dataclass(frozen=True)
class Target:
    """A limit of a design.

    Attributes
    ----------
    quantity : str
        Quantity of a sweep, or 'collapse'.
    limit : float
        Limit in its unit; NaN for a collapse.
    share : float
        Share of the records that must stay below the limit.
    scale : float
        Factor on the motions.
    is_least : bool
        True when the quantity must not be smaller than the limit.
    """

    quantity: str
    limit: float
    share: float
    scale: float
    is_least: bool = False

    @property
    def text(self) -> str:
        """The target in words."""
        sign = ">=" if self.is_least else "<="
        goal = f"{self.quantity} {sign} {self.limit:g}"
        goal = goal if self.quantity != COLLAPSE else "no collapse"
        factor = f", motions times {self.scale:g}" if self.scale != 1 else ""
        return f"{goal} in {100 * self.share:g} % of the motions{factor}"

    def value_of(self, values: Array, down: Truths) -> float:
        """Return the quantile that the limit is for, or the share of collapses."""
        if self.quantity == COLLAPSE:
            return float(down.mean())
        # larger is worse; residuals have a sign
        ranked = np.where(down, np.inf, -values if self.is_least else np.abs(values))
        # a rank that round-off moves past the next whole number
        share = max(self.share - 1e-12, 0.0)
        worst = float(np.quantile(ranked, share, method="inverted_cdf"))
        return max(-worst, 0.0) if self.is_least else worst

    def utilisation(self, value: float) -> float:
        """Return value over limit: the target is met up to 1."""
        if self.quantity == COLLAPSE:
            return 1.0 + value - (1.0 - self.share) - 1e-12
        if self.is_least:
            return np.inf if value <= 0 else self.limit / value
        return value / self.limit


def variables_of(
    bounds: Mapping[str, Sequence[float]], case: Case, has_records: bool = False
) -> list[Variable]:
    """Look up the variables of a design."""
    if not isinstance(bounds, Mapping) or not bounds:
        raise InputError(
            f"bounds = {show(bounds)}: must be keys with (low, high); the default is &design"
        )
    columns = [column_in(case.groups, name, "bounds") for name in bounds]
    named = dict(zip(columns, bounds, strict=True))
    for name, column in zip(bounds, columns, strict=True):
        if named[column] != name:
            raise InputError(f"bounds: {name} and {named[column]}: are the same number")
    found = []
    for (name, ends), column in zip(bounds.items(), columns, strict=True):
        if column in PAIRS:
            raise InputError(f"bounds: {name}: is two keys; give {' and '.join(PAIRS[column])}")
        group, _ = key_of_column(column)
        if group in SETTINGS:
            raise InputError(
                f"bounds: {name}: {SETTINGS[group]}, no number of the structure or the motion"
            )
        if column == SCALE:
            raise InputError(f"bounds: {name}: is the factor on the motions, which targets have")
        if has_records and group == "motion":
            raise InputError(f"bounds: {name}: the records replace &motion")
        kind = kind_of(column)
        if kind not in ("real", "integer", "real list"):
            raise InputError(f"bounds: {name}: is a {kind}: a design chooses numbers")
        low, high = (float(end) for end in _two(name, ends))
        is_whole = kind == "integer"
        if not low < high or (is_whole and not (low.is_integer() and high.is_integer())):
            wanted = "two increasing whole numbers" if is_whole else "two increasing numbers"
            raise InputError(f"bounds: {name} = {show(ends)}: must be {wanted}")
        found.append(Variable(name, column, low, high, is_whole))
    return found


def _two(name: str, ends: object) -> Array:
    items = to_array(f"bounds: {name}", ends)
    if items.size != 2:
        raise InputError(f"bounds: {name} = {show(ends)}: must be (low, high)")
    return items


def targets_of(targets: Sequence[Mapping[str, Any]], case: Case) -> list[Target]:
    """Read the targets of a design."""
    items = [targets] if isinstance(targets, Mapping) else to_items(targets)
    if items is not None and not items:
        raise InputError(
            "targets: none is given: give quantity and limit; the default are &limits and &design"
        )
    if not items or not all(isinstance(item, Mapping) for item in items):
        raise InputError(f"targets = {show(targets)}: must be mappings with quantity and limit")
    limits = limits_of(case)
    return [target for item in items for target in _targets(item, limits)]


def _targets(item: Mapping[str, Any], limits: Sequence[Limit]) -> list[Target]:
    """Read one entry; that of all limits gives a target for each."""
    if item.get("quantity") != _LIMITS:
        return [_target(item)]
    if "limit" in item:
        raise InputError("targets: limits: has no limit; those of &limits apply")
    if not limits:
        raise InputError("targets: limits: the case has no &limits")
    found = [_target({**item, "quantity": x.key, "limit": x.value}) for x in limits]
    return [replace(target, is_least=x.is_least) for target, x in zip(found, limits, strict=True)]


def _target(item: Mapping[str, Any]) -> Target:
    unknown = [str(key) for key in item if key not in _ALLOWED]
    if unknown:
        raise InputError(f"targets: {unknown[0]}: unknown; allowed are {', '.join(_ALLOWED)}")
    quantity = item.get("quantity")
    if not isinstance(quantity, str):
        raise InputError(f"targets: quantity = {show(quantity)}: must be a text")
    if quantity == COLLAPSE and ("limit" in item or "percentile" in item):
        raise InputError("targets: collapse: has a probability only, no limit and no percentile")
    if ("percentile" in item) == ("probability" in item):
        raise InputError(f"targets: {quantity}: give one of percentile and probability")
    if "percentile" in item:
        share = to_number("targets: percentile", item["percentile"], above=0.0) / 100
    else:
        share = 1 - to_number("targets: probability", item["probability"], below=1.0)
    if not 0 < share <= 1:
        raise InputError(f"targets: {quantity}: percentile in (0, 100], probability in [0, 1)")
    scale = to_number("targets: scale", item.get("scale", 1.0), above=0.0)
    if quantity == COLLAPSE:
        return Target(COLLAPSE, math.nan, share, scale)
    name = next(iter(find_quantities((quantity,))))
    limit = to_number(f"targets: {quantity}: limit", item.get("limit"), above=0.0)
    return Target(name, limit, share, scale)


def cost_of(cost: Cost, variables: Sequence[Variable]) -> Callable[[Array], float]:
    """Make the cost of a design a function of its numbers."""
    names = [item.name for item in variables]
    if isinstance(cost, Mapping):
        unknown = [str(key) for key in cost if key not in names]
        if not cost:
            raise InputError(f"cost: has no weights; known: {', '.join(names)}")
        if unknown:
            raise InputError(
                f"cost: {', '.join(unknown)}: has no bounds; known: {', '.join(names)}"
            )
        weights = np.array([to_number(f"cost: {name}", cost.get(name, 0.0)) for name in names])
        return lambda x: float(weights @ x)
    if not callable(cost):
        raise InputError(f"cost = {show(cost)}: must be weights by key or a function")
    function = cost
    return lambda x: to_number("cost", function(dict(zip(names, x.tolist(), strict=True))))


# utilisation above which its logarithm counts, and that of a design that collapses
_LARGE, _COLLAPSED = 10.0, 1e3


class SuiteRuns:
    """Values of the targets for designs; each design is computed once.

    Attributes
    ----------
    values : dict of tuple to numpy.ndarray, each shape (targets,)
        Values of the targets by design.
    """

    def __init__(
        self,
        case: Case,
        variables: Sequence[Variable],
        targets: Sequence[Target],
        records: Sequence[RecordFile],
        threads: int,
        progress: Progress | None = None,
    ) -> None:
        self._progress = progress
        self._case = case.without("spectrum") if "spectrum" in case.groups else case
        self._variables, self._targets = variables, targets
        self._records, self._threads = records, threads
        names = [item.quantity for item in targets if item.quantity != COLLAPSE]
        self._names = list(dict.fromkeys(names)) or [default_quantity(case)]
        self.values: dict[tuple[float, ...], Array] = {}
        self.warnings: list[str] = []

    def utilisations(self, designs: Array) -> Array:
        """Compute values over limits."""
        found = self.compute(designs)
        rows = np.array([
            [item.utilisation(float(x)) for item, x in zip(self._targets, row, strict=True)]
            for row in found
        ])  # fmt: skip
        larger = np.where(np.isfinite(rows), np.maximum(rows, _LARGE), _LARGE)
        limited: Array = np.minimum(rows, _LARGE) + np.log(larger / _LARGE)
        return np.where(np.isfinite(rows), limited, _COLLAPSED)

    def compute(self, designs: Array) -> Array:
        """Compute the values of the targets."""
        rows = [tuple(float(x) for x in row) for row in designs]
        missing = list(dict.fromkeys(row for row in rows if row not in self.values))
        if missing:
            for row, values in zip(missing, self._run(missing), strict=True):
                self.values[row] = values
        return np.array([self.values[row] for row in rows])

    def _run(self, designs: Sequence[tuple[float, ...]]) -> Array:
        scales = list(dict.fromkeys(item.scale for item in self._targets))
        table: dict[str, Any] = {
            item.column: [int(row[i]) if item.is_whole else row[i] for row in designs] * len(scales)
            for i, item in enumerate(self._variables)
        }
        table["scale"] = [scale for scale in scales for _ in designs]

        def report(done: int, total: int) -> None:
            if self._progress is not None:
                known = len(self.values)
                self._progress(known + len(designs) * done // total, known + len(designs))

        found = sweep(
            self._case,
            None,
            self._records,
            points=table,
            quantities=self._names,
            threads=self._threads,
            progress=report,
        )
        refuse_missing(found, self._names, "targets")
        self.warnings = united([*self.warnings, *str(found.attrs["warnings"]).splitlines()])
        shape = (-1, len(scales), len(designs))
        down = fallen(found).reshape(shape)
        values = {name: found[name].values.reshape(shape) for name in self._names}
        results = np.empty((len(designs), len(self._targets)))
        for j, item in enumerate(self._targets):
            k = scales.index(item.scale)
            of = values.get(item.quantity, down.astype(float))
            for i in range(len(designs)):
                results[i, j] = item.value_of(of[:, k, i], down[:, k, i])
        return results


# designs of a generation for each variable, and the fewest
_GENERATION = (8, 16)
# designs from which gradients are followed, and the largest number of their steps
_STARTS, _STEPS = 3, 12
# step of the differences of a statistic over the range of a variable
_STEP = 5e-3
_SEED = 1963
_AT_BOUND = 1e-9


def cheapest(
    runs: SuiteRuns,
    variables: Sequence[Variable],
    cost: Callable[[Array], float],
    designs: int,
    guess: Array | None = None,
) -> Array:
    """Find the cheapest design that meets all targets, or else the one nearest to them."""
    from scipy.optimize import Bounds, NonlinearConstraint, differential_evolution

    low = np.array([item.low for item in variables])
    high = np.array([item.high for item in variables])
    n = max(_GENERATION[0] * len(variables), _GENERATION[1])

    def excess(x: Array) -> Array:
        columns = x.reshape(len(variables), -1)
        found = runs.utilisations(columns.T).T - 1
        return found if x.ndim > 1 else found[:, 0]

    differential_evolution(
        lambda x: np.array([cost(column) for column in x.reshape(len(variables), -1).T]),
        Bounds(low, high),
        constraints=NonlinearConstraint(excess, -np.inf, 0.0),
        integrality=[item.is_whole for item in variables],
        init=_first_generation(low, high, n, guess),
        maxiter=max(1, designs // n - 1),
        tol=1e-3,
        vectorized=True,
        updating="deferred",
        polish=False,
        seed=_SEED,
    )
    for start in _best(runs, cost, _STARTS):
        _descend(runs, variables, cost, start)
    return _best(runs, cost, 1)[0]


def _first_generation(low: Array, high: Array, n: int, guess: Array | None) -> Array:
    from scipy.stats import qmc

    random = qmc.LatinHypercube(len(low), seed=_SEED)
    found: Array = low + (high - low) * random.random(n)
    # the corner of the largest numbers is often the one that meets the targets
    found[0], found[1] = high, low
    if guess is not None:
        found[2] = np.clip(guess, low, high)
    return found


def _best(runs: SuiteRuns, cost: Callable[[Array], float], n: int) -> list[Array]:
    """Order the computed designs: cheapest first, those that miss a target by their excess."""
    rows = [np.array(row) for row in runs.values]
    worst = runs.utilisations(np.array(rows)).max(axis=1)
    costs = np.array([cost(row) for row in rows])
    misses = np.maximum(worst, 1.0)
    return [rows[i] for i in np.lexsort((costs, misses))[:n]]


def _descend(
    runs: SuiteRuns, variables: Sequence[Variable], cost: Callable[[Array], float], start: Array
) -> None:
    """Follow gradients of cost and targets; every design on the way is kept in `runs`."""
    from scipy.optimize import minimize

    real = np.array([not item.is_whole for item in variables])
    if not real.any():
        return
    low = np.array([item.low for item in variables])
    span = np.array([item.high for item in variables]) - low
    size = max(abs(cost(start)), 1e-300)

    def design(x: Array) -> Array:
        full = start.copy()
        # the optimiser stops a rounding error away from a bound
        near = np.where(x < _AT_BOUND, 0.0, np.where(x > 1 - _AT_BOUND, 1.0, x))
        full[real] = low[real] + near * span[real]
        return full

    def neighbours(x: Array) -> list[tuple[Array, Array, float]]:
        steps = _STEP * np.eye(len(x))
        ups, downs = np.minimum(x + steps, 1.0), np.maximum(x - steps, 0.0)
        widths = np.diag(ups - downs).tolist()
        return list(zip(map(design, ups), map(design, downs), widths, strict=True))

    def slope_of_cost(x: Array) -> Array:
        return np.array(
            [(cost(up) - cost(down)) / (step * size) for up, down, step in neighbours(x)]
        )

    def slopes(x: Array) -> Array:
        near = neighbours(x)
        both = runs.utilisations(np.array([item for pair in near for item in pair[:2]]))
        steps = np.array([step for *_, step in near])
        return np.asarray(-((both[::2] - both[1::2]) / steps[:, None]).T)

    minimize(
        lambda x: cost(design(x)) / size,
        (start[real] - low[real]) / span[real],
        jac=slope_of_cost,
        method="SLSQP",
        bounds=[(0.0, 1.0)] * int(real.sum()),
        constraints={
            "type": "ineq",
            "fun": lambda x: 1 - runs.utilisations(design(x)[None])[0],
            "jac": slopes,
        },
        options={"maxiter": _STEPS, "ftol": 1e-4},
    )


_FEWEST_RECORDS = 4


@dataclass(frozen=True)
class Check:
    """A target of a design and its value.

    Attributes
    ----------
    target : str
        The target in words.
    quantity : str
        Quantity of the target, or 'collapse'.
    limit : float
        Limit of the quantity, of collapses the allowed share.
    value : float
        Value over the suite of the design; infinite when too many motions end in collapse.
    value_left_out : float
        Value over the records that were left out; NaN without any.
    utilisation, utilisation_left_out : float
        Value over limit; up to 1 where the target is met.
    is_least : bool
        True when the quantity must not be smaller than the limit.
    """

    target: str
    quantity: str
    limit: float
    value: float
    value_left_out: float
    utilisation: float
    utilisation_left_out: float
    is_least: bool = False

    @property
    def is_met(self) -> bool:
        """True when the suite of the design meets the target."""
        return self.utilisation <= 1.0

    @property
    def excess(self) -> str:
        """The target and the distance from it in words."""
        if np.isnan(self.value):
            return f"{self.target}: runs without a result"
        if np.isinf(self.value):
            return f"{self.target}: too many motions end in collapse"
        if self.quantity == COLLAPSE:
            return (
                f"{self.target}: {100 * self.value:.1f} % collapse, more than "
                f"{100 * self.limit:.4g} %"
            )
        word = "falls below" if self.is_least else "exceeds"
        return (
            f"{self.target}: {self.value:.4g} {word} {self.limit:.4g} by "
            f"{100 * abs(self.value / self.limit - 1):.1f} % of the limit"
        )


@dataclass(frozen=True)
class Design:
    """Result of `design`.

    Attributes
    ----------
    case : Case
        The case with the numbers of the design.
    values : dict of str to float
        Numbers of the design by key.
    cost : float
        Their cost.
    checks : tuple of Check
        All targets.
    designs : int
        Number of computed designs.
    records, left_out : tuple of str
        Names of the records of the design, and of those left out.
    warnings : tuple of str
        Warnings about the runs of the design.
    """

    case: Case
    values: dict[str, float]
    cost: float
    checks: tuple[Check, ...]
    designs: int
    records: tuple[str, ...]
    left_out: tuple[str, ...]
    warnings: tuple[str, ...] = ()

    @property
    def is_feasible(self) -> bool:
        """True when all targets are met over the suite of the design."""
        return all(check.is_met for check in self.checks)

    @property
    def missed(self) -> tuple[str, ...]:
        """Targets that no computed design meets together with the others, with their excess."""
        return tuple(check.excess for check in self.checks if not check.is_met)

    def to_dict(self) -> dict[str, Any]:
        """Return the result as an object for JSON.

        Returns
        -------
        dict
            Values, cost, checks, missed targets, number of designs, names of records, warnings.
        """
        return {
            "values": dict(self.values),
            "cost": self.cost,
            "is_feasible": self.is_feasible,
            "missed": list(self.missed),
            "checks": [vars(check) | {"is_met": check.is_met} for check in self.checks],
            "designs": self.designs,
            "records": list(self.records),
            "left_out": list(self.left_out),
            "warnings": list(self.warnings),
        }


@checked
def design(
    case: CaseLike,
    bounds: Mapping[str, Sequence[float]] | None = None,
    targets: Sequence[Mapping[str, Any]] | None = None,
    cost: Cost | None = None,
    records: Sequence[str | os.PathLike[str] | RecordFile | Motion] | None = None,
    *,
    left_out: Sequence[str | os.PathLike[str] | RecordFile | Motion] | None = None,
    guess: Mapping[str, float] | None = None,
    designs: int | None = None,
    threads: int = 0,
    progress: Reports = None,
    unit: str | None = None,
    dt: float | None = None,
) -> Design:
    """Find the cheapest design whose suite meets all targets.

    Absent arguments are those of the case's `&design`.

    SciPy's differential evolution visits the bounds, with all designs of a generation in one sweep.
    Then sequential quadratic programming follows gradients of the counted percentiles from the best
    three designs. The result is the cheapest computed design that meets all targets.

    Parameters
    ----------
    case : Case or path
        Settings common to all designs.
    bounds : mapping, optional
        Lower and upper bound by key; whole numbers for keys such as ``strands``. All numbers of a
        list become equal.
    targets : sequence of mapping, optional
        Each has ``quantity`` and ``limit`` in its unit, with ``percentile`` [%] or ``probability``
        of exceedance. ``quantity='collapse'`` has a ``probability`` only, ``quantity='limits'``
        (every limit of the case's ``&limits``) no ``limit``. ``scale`` is a factor on the motions.
    cost : mapping or callable, optional
        Weights by key, or a function of the values by key.
    records : sequence of str, path or Motion, optional
        The suite; otherwise the motion of the case.
    left_out : sequence of str, path or Motion, optional
        Records that judge the design; by default every fourth record of the suite is left out.
    guess : mapping, optional
        A design to begin with; it is
        moved to the bounds.
    designs : int, optional
        Number of designs that the first stage may visit; 300 without `&design`.
    threads, progress, unit, dt
        As in `rwmf.sweep`; progress counts designs, and their number grows during the search.

    Returns
    -------
    Design
        The design; when the targets cannot be met together, the design nearest to them.

    Raises
    ------
    InputError
        When an argument is not acceptable, or SciPy is not installed.
    """
    case = case_of(case)
    asked = request_of(case)
    bounds = asked["bounds"] if bounds is None else bounds
    targets = asked["targets"] if targets is None else targets
    cost = asked["cost"] if cost is None else cost
    if records is None:
        records, unit = asked["records"], unit or asked["unit"]
        left_out = asked["left_out"] if left_out is None else left_out
    designs = asked["designs"] if designs is None else designs
    to_whole("designs", designs, 1)
    suite, judges = _split(records, left_out, unit, dt)
    variables, limits = variables_of(bounds, case, bool(suite)), targets_of(targets, case)
    low = _check_ends(case, variables)
    price = cost_of(cost, variables)
    price(low)
    start = None if guess is None else _start(guess, variables)
    with reporting(progress, "design") as report:
        # the first stage visits about `designs`, the second follows gradients
        def at_least(done: int, total: int) -> None:
            if report is not None:
                report(done, max(total, designs))

        runs = SuiteRuns(case, variables, limits, suite, threads, at_least)
        best = cheapest(runs, variables, price, designs, start)
    # the runs of the best design alone, without the warnings of others
    final = SuiteRuns(case, variables, limits, suite, threads)
    found = final.compute(best[None])[0]
    others, lines = np.full(len(limits), np.nan), final.warnings
    if judges:
        judging = SuiteRuns(case, variables, limits, judges, threads)
        others = judging.compute(best[None])[0]
        lines = united([*lines, *judging.warnings])
    warn(lines)
    checks = tuple(map(_check, limits, found.tolist(), others.tolist()))
    return Design(
        _with_values(case, variables, best),
        {
            item.name: int(x) if item.is_whole else float(x)
            for item, x in zip(variables, best.tolist(), strict=True)
        },
        price(best),
        checks,
        len(runs.values),
        tuple(record.name for record in suite),
        tuple(record.name for record in judges),
        tuple(lines),
    )


def _check(item: Target, value: float, other: float) -> Check:
    limit = 1 - item.share if item.quantity == COLLAPSE else item.limit
    return Check(
        item.text,
        item.quantity,
        limit,
        value,
        other,
        item.utilisation(value),
        item.utilisation(other),
        item.is_least,
    )


def _split(
    records: Sequence[str | os.PathLike[str] | RecordFile | Motion],
    left_out: Sequence[str | os.PathLike[str] | RecordFile | Motion] | None,
    unit: str | None,
    dt: float | None,
) -> tuple[Sequence[RecordFile], Sequence[RecordFile]]:
    """Divide the records into those of the design and those that judge it."""
    if not len(records):
        if left_out is not None:
            raise InputError("left_out: needs records")
        return (), ()
    suite = find_records(records, unit=unit, dt=dt)
    if left_out is not None:
        judges = find_records(left_out, unit=unit, dt=dt) if len(left_out) else ()
        same = {record.crc32 for record in suite} & {record.crc32 for record in judges}
        if same:
            raise InputError("left_out: has records of the suite")
        return suite, judges
    if len(suite) < _FEWEST_RECORDS:
        return suite, ()
    judges = tuple(suite[_FEWEST_RECORDS - 1 :: _FEWEST_RECORDS])
    return tuple(record for record in suite if record not in judges), judges


def _start(guess: Mapping[str, float], variables: Sequence[Variable]) -> Array:
    names = [item.name for item in variables]
    if not isinstance(guess, Mapping) or set(guess) != set(names):
        raise InputError(f"guess = {show(guess)}: must have the keys of bounds: {', '.join(names)}")
    return np.array([to_number(f"guess: {name}", guess[name]) for name in names])


def _check_ends(case: Case, variables: Sequence[Variable]) -> Array:
    """Refuse bounds that no case may have; return the lower ones."""
    ends = {"lower": [item.low for item in variables], "upper": [item.high for item in variables]}
    for word, values in ends.items():
        with placed(f"bounds, {word} ends: "):
            _with_values(case, variables, np.array(values))
    return np.array(ends["lower"])


def _with_values(case: Case, variables: Sequence[Variable], values: Array) -> Case:
    """Put the numbers of a design into the case."""
    changes: dict[str, dict[str, object]] = {}
    for item, value in zip(variables, values.tolist(), strict=True):
        group, key = key_of_column(item.column)
        if item.column in ("T_s", "gamma") and "storeys" in case.groups:
            raise InputError(f"{item.name}: no case states it beside &storeys; vary T_1, m")
        changes.setdefault(group, {})[key] = int(value) if item.is_whole else value
    return case.replace(**changes)
