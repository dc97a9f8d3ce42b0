"""Designs that meet their targets at the smallest cost, and the search for them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from rwmf.assess.targets import (
    COLLAPSE,
    Cost,
    SuiteRuns,
    Target,
    Variable,
    cost_of,
    request_of,
    targets_of,
    variables_of,
)
from rwmf.case import Case, CaseLike, Motion
from rwmf.case.arguments import case_of, checked
from rwmf.errors import InputError, warn
from rwmf.kernel.numbers import show, to_items, to_number, to_whole
from rwmf.kernel.progress import Reports, reporting
from rwmf.motion.record_sets import RecordFile, find_records
from rwmf.sweeps.axes import key_of_column
from rwmf.sweeps.plan import united

Array = npt.NDArray[np.float64]
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
        found = []
        for i in range(len(x)):
            up, down = x.copy(), x.copy()
            up[i], down[i] = min(x[i] + _STEP, 1.0), max(x[i] - _STEP, 0.0)
            found.append((design(up), design(down), up[i] - down[i]))
        return found

    def slope_of_cost(x: Array) -> Array:
        return np.array(
            [(cost(up) - cost(down)) / (step * size) for up, down, step in neighbours(x)]
        )

    def slopes(x: Array) -> Array:
        near = neighbours(x)
        both = runs.utilisations(np.array([item for pair in near for item in pair[:2]]))
        steps = np.array([step for *_, step in near])
        found: Array = -((both[::2] - both[1::2]) / steps[:, None]).T
        return found

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
    if left_out is not None:
        left_out = _listed("left_out", left_out)
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


def _listed(name: str, value: object) -> list[Any]:
    """Return the items of a list of records."""
    one = isinstance(value, str | os.PathLike | Motion | RecordFile)
    items = [value] if one else to_items(value)
    if items is None:
        raise InputError(f"{name} = {show(value)}: must be a list")
    return items


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
        try:
            _with_values(case, variables, np.array(values))
        except InputError as error:
            raise InputError(f"bounds, {word} ends: {error}") from None
    return np.array(ends["lower"])


def _with_values(case: Case, variables: Sequence[Variable], values: Array) -> Case:
    """Put the numbers of a design into the case."""
    changes: dict[str, dict[str, object]] = {}
    for item, value in zip(variables, values.tolist(), strict=True):
        group, key = key_of_column(item.column)
        if item.column == "scale":
            group, key = "motion", "scale"
        elif item.column in ("T_s", "gamma") and "storeys" in case.groups:
            raise InputError(f"{item.name}: no case states it beside &storeys; vary T_1, m")
        changes.setdefault(group, {})[key] = int(value) if item.is_whole else value
    return case.replace(**changes)
