"""Measured cost of accuracy: every method and tolerance against a trusted reference."""

from __future__ import annotations

import contextlib
import dataclasses
import math
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from rwmf.case import Case, CaseLike
from rwmf.case.arguments import case_of, checked
from rwmf.errors import InputError, NumericalError
from rwmf.kernel import measure as _measure
from rwmf.kernel.measure import Measurement, Reference
from rwmf.kernel.numbers import Array, Truths
from rwmf.kernel.progress import Progress, Reports, reporting
from rwmf.run.quantities import find_quantities

METHODS = ("adams", "bdf", "taylor", "dop853")
# the procedure of the paper, for its scenes only
PAPER = "paper"
TOLERANCES = tuple(10.0**-k for k in range(2, 14))
# label, name in the kernel, divisor of the procedure's usual interval
PRACTICES = (
    ("RK4, dt", "rk4", 1.0),
    ("RK4, dt/10", "rk4", 10.0),
    ("Newmark, dt", "newmark", 1.0),
    ("Newmark, dt/10", "newmark", 10.0),
)
_QUAD = (1e-18, 1e-20)
_DOUBLE = (1e-12, 1e-13)
# a case that takes longer in quadruple precision gets a reference in double precision
_MOST_REFERENCE_SECONDS = 20.0
# time for the repetitions of one row and of all rows together
_ROW_SECONDS = 0.03
_ALL_SECONDS = 10.0
# flights shorter than this fraction of the longest one count as chatter
_CHATTER = 0.01
_DIGITS_BETTER = 100.0
_ROUND_OFF = float(np.finfo(float).eps) / 2

# settings whose times differ by less than this factor count as equally fast
_SAME_TIME = 1.05
# difference of the times of both rounds above which they are uncertain [-]
_MOST_DISAGREEMENT = 0.2

_Task = tuple[str, float, Callable[[float], Measurement]]


@dataclasses.dataclass(frozen=True)
class Row:
    """One method at one tolerance, or one procedure of current practice.

    Attributes
    ----------
    method : str
        Name of the method, or label of the procedure.
    rtol : float
        Relative tolerance [-], NaN for a procedure with fixed steps.
    relative_error : float
        Error of the peak [-]: of u_s_max, of theta_max without a frame, or of the requested
        quantity. 1 when only the row or only the reference overturns; NaN where a procedure does
        not report the quantity.
    seconds : float
        Processor time of the fastest of all repeats [s].
    steps, rhs_evaluations, impacts : int
        Counts.
    theta_max_relative_error : float
        Of the largest rotation [-]; NaN without a wall.
    impact_time_error_s : float
        Largest time between an impact of the reference and the nearest one of the row, without
        chatter [s]; NaN without impacts.
    end_state_relative_error : float
        Error of the final state over the largest rotation and angular velocity [-].
    overturned : bool
        True when the wall overturned.
    status : str
        'ok', or the reason for a missing result.
    """

    method: str
    rtol: float
    relative_error: float
    seconds: float
    steps: int
    rhs_evaluations: int
    impacts: int
    theta_max_relative_error: float
    impact_time_error_s: float
    end_state_relative_error: float
    overturned: bool
    status: str

    @property
    def largest_error(self) -> float:
        """Largest of the four errors; an impact time counts with its error over 1 s."""
        others = (
            self.theta_max_relative_error,
            self.impact_time_error_s,
            self.end_state_relative_error,
        )
        # NaN where the case has no wall or no impact, but not for the peak
        return max([self.relative_error, *(error for error in others if not math.isnan(error))])


@dataclasses.dataclass(frozen=True)
class Cost:
    """Work and precision of a case.

    Attributes
    ----------
    reference : dict
        Method of the reference, its results and its error.
    rows : list of Row
        Methods and tolerances.
    practices : list of Row
        Procedures that practitioners use.
    target : float
        Requested relative error [-].
    recommended : Row or None
        The fastest row all of whose errors meet the target, as in all tighter tolerances of its
        method.
    disagreement : float
        Difference of the times of both rounds over the smaller one that a tenth of the rows
        exceeds [-]; NaN without a second round.
    """

    reference: dict[str, Any]
    rows: list[Row]
    practices: list[Row]
    target: float
    recommended: Row | None
    disagreement: float = math.nan

    @property
    def note(self) -> str:
        """Warning when the repeats disagree or are missing; '' when they agree."""
        if self.disagreement <= _MOST_DISAGREEMENT:
            return ""
        what = f"a tenth of the times changes by {100 * self.disagreement:.0f} % or more"
        if math.isnan(self.disagreement):
            what = f"{_ALL_SECONDS:g} s are spent before a second round"
        return (
            f"times are uncertain: {what}, as when other programs load the machine; compare the "
            "evaluations (rhs), or measure again"
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the values as the keys of ``rwmf cost --json``.

        Returns
        -------
        dict
            Values by key; rows as dictionaries.
        """
        return dataclasses.asdict(self) | {"note": self.note}


@checked
def cost(
    case: CaseLike,
    target: float = 1e-6,
    progress: Reports = None,
    quantities: str | Sequence[str] | None = None,
) -> Cost:
    """Measure the time of each method for a given accuracy.

    Every method runs at tolerances from 1e-2 to 1e-13; the procedures of current practice run once.
    Errors are relative to a run in quadruple precision. The method, tolerances and output of the
    case are ignored.

    Parameters
    ----------
    case : Case or path
        The case.
    target : float
        Relative error for which a method is recommended: of peak, rotation and final state [-], and
        the error of impact times [s].
    progress : callable or bool, optional
        True for a bar in a notebook or terminal. A function is called with the numbers of finished
        and of all units of work. During the reference it is called about 20 times a second; an
        exception that it raises stops the kernel.
    quantities : str, optional
        Peak whose error is compared, by its key or its name in a dataset. The default is the
        largest displacement of the frame, or without a frame the largest rotation. The time
        includes finding it.

    Returns
    -------
    Cost
        Reference, rows, procedures of current practice and recommendation.

    Raises
    ------
    InputError
        When the case, the target or the quantity is not acceptable.
    NumericalError
        When no reference can be computed.
    Interrupted
        After Ctrl-C.
    """
    if not 0 < target < 1:
        raise InputError(f"target = {target}: must be in (0, 1)")
    if quantities is not None and len(quantities) != 1:
        raise InputError(f"cost: quantities = {', '.join(quantities)}: must be one quantity")
    case = _asked(case_of(case), None if quantities is None else quantities[0])
    with reporting(progress, "step") as report:
        return _compared(case, target, report or (lambda done, total: None))


def _compared(case: Case, target: float, report: Progress) -> Cost:
    """Measure all methods and current practices beside the reference."""
    tasks = _tasks(case)
    # the reference and two rounds of all rows
    total = 2 * len(tasks) + 1
    report(0, total)
    reference, facts = _reference(case, lambda: report(0, total))
    report(1, total)
    started = time.monotonic()

    def budget() -> float:
        """Return the time for the repetitions of the next row, 0 for a single run [s]."""
        return _ROW_SECONDS if time.monotonic() - started < _ALL_SECONDS else 0.0

    rows: list[Row] = []
    for label, rtol, measure in tasks:
        rows.append(_row((label, rtol, measure), budget(), reference, facts["peak"]))
        report(len(rows) + 1, total)
    # a second round, because the load of the machine varies
    differences: list[float] = []
    for i, (_, _, measure) in enumerate(tasks):
        if rows[i].status == "ok" and budget() > 0:
            one, other = rows[i].seconds, measure(budget()).seconds
            rows[i] = dataclasses.replace(rows[i], seconds=min(one, other))
            differences.append(_ratio(abs(one - other), min(one, other)))
        report(len(rows) + i + 2, total)
    practices, rows = rows[: len(PRACTICES)], rows[len(PRACTICES) :]
    disagreement = float(np.quantile(differences, 0.9)) if differences else math.nan
    best = cheapest(rows, target)
    # the reference is two digits better than the best row (or at round-off)
    errors = [row.relative_error for row in rows if row.status == "ok"]
    most = max(min(errors, default=0.0), _ROUND_OFF)
    facts["good_enough"] = facts["relative_error"] * _DIGITS_BETTER <= most
    return Cost(facts, rows, practices, target, best, disagreement)


def _asked(case: Case, quantity: str | None) -> Case:
    """Return the case with the output that measuring a quantity needs."""
    if quantity is None:
        unasked = {"accuracy_of": None}
        return case if _measure.requested_peak(case) is None else case.replace(solver=unasked)
    (found,) = find_quantities((quantity,)).values()
    # the accuracy of the case does not matter: each row sets a tolerance
    return case.replace(solver={"rtol": None, "accuracy": 1e-6, "accuracy_of": found.key})


def _tasks(case: Case) -> list[_Task]:
    """List procedures of current practice, then methods at all tolerances."""
    methods: tuple[str, ...] = METHODS
    with contextlib.suppress(InputError):
        case.replace(solver={"method": PAPER})
        methods += (PAPER,)
    practices: list[_Task] = [
        (label, math.nan, partial(_measure.measure_fixed_steps, case, name, divisor))
        for label, name, divisor in PRACTICES
    ]
    return practices + [
        (method, rtol, partial(_measure.measure_method, case, method, rtol))
        for method in methods
        for rtol in TOLERANCES
    ]


class _TooSlowError(Exception):
    """Quadruple precision takes too long."""


def _reference(case: Case, report: Callable[[], None]) -> tuple[Reference, dict[str, Any]]:
    """Compute the reference results and describe their method."""
    started = time.monotonic()

    def poll(_: int) -> None:
        report()
        if time.monotonic() - started > _MOST_REFERENCE_SECONDS:
            raise _TooSlowError

    method = "Taylor series in quadruple precision"
    tolerances = _QUAD
    try:
        found = _measure.solve_reference(case, *_QUAD, poll)
    except (_TooSlowError, NumericalError) as error:
        cause = "takes too long" if isinstance(error, _TooSlowError) else f"failed ({error})"
        method = f"Taylor series in double precision: quadruple precision {cause}"
        tolerances = _DOUBLE
        loose, tight = (_measure.measure_method(case, "taylor", rtol, 0.0) for rtol in _DOUBLE)
        apart = {name: abs(tight.values[name] - loose.values[name]) for name in tight.values}
        found = Reference(**vars(tight), differences=apart)
    peak = _peak_name(case, found)
    facts = {
        "method": method,
        "rtol": tolerances[1],
        "relative_error": _ratio(found.differences[peak], found.values[peak]),
        "error_estimate": f"difference from a run at rtol {tolerances[0]:.0e}",
        "peak": peak,
        **found.values,
        "overturned": found.overturned,
        "impacts": found.impacts,
        "seconds": found.seconds,
    }
    return found, facts


def _row(task: _Task, budget: float, reference: Reference, peak: str) -> Row:
    """Measure a row and compare it with the reference."""
    label, rtol, measure = task
    try:
        found = measure(budget)
    except NumericalError as error:
        nan = math.nan
        return Row(label, rtol, nan, nan, 0, 0, 0, nan, nan, nan, False, str(error))
    same_fate = found.overturned == reference.overturned
    return Row(
        method=label,
        rtol=rtol,
        relative_error=_relative(found, reference, peak) if same_fate else 1.0,
        seconds=found.seconds,
        steps=found.steps,
        rhs_evaluations=found.rhs_evaluations,
        impacts=found.impacts,
        theta_max_relative_error=_relative(found, reference, "theta_max_rad"),
        impact_time_error_s=_impact_error(found.impact_times, reference.impact_times),
        end_state_relative_error=_end_error(found, reference),
        overturned=found.overturned,
        status="ok",
    )


def _peak_name(case: Case, reference: Measurement) -> str:
    requested = _measure.requested_peak(case)
    if requested is not None:
        return requested
    return "theta_max_rad" if math.isnan(reference.values["u_s_max_m"]) else "u_s_max_m"


def _relative(found: Measurement, reference: Measurement, name: str) -> float:
    return _ratio(abs(found.values[name] - reference.values[name]), reference.values[name])


def _ratio(difference: float, value: float) -> float:
    if difference == 0:
        return 0.0
    return difference / abs(value) if value != 0 else math.inf


def _end_error(found: Measurement, reference: Measurement) -> float:
    """Return the error of the final state over the largest rotation and angular velocity."""
    scales = [reference.values["theta_max_rad"], reference.values["theta_dot_max_rad_s"]]
    names = ("theta_end_rad", "theta_dot_end_rad_s")
    errors = [abs(found.values[name] - reference.values[name]) for name in names]
    if math.isnan(scales[0]):
        # bare frame: displacement and velocity over the peak and the speed at the end or there
        scales = [reference.values["u_s_max_m"]]
        errors = errors[:1]
    return max(_ratio(error, scale) for error, scale in zip(errors, scales, strict=True))


def _impact_error(found: Array, reference: Array) -> float:
    """Largest distance of a clear impact of the reference from the nearest one found [s]."""
    clear = reference[_clear_impacts(reference)]
    if clear.size == 0:
        return math.nan
    if found.size == 0:
        return math.inf
    right = np.clip(np.searchsorted(found, clear), 0, found.size - 1)
    left = np.maximum(right - 1, 0)
    return float(np.minimum(abs(found[right] - clear), abs(found[left] - clear)).max())


def _clear_impacts(times: Array) -> Truths:
    """Return the impacts between flights that are long enough to differ from chatter."""
    if times.size == 0:
        return np.zeros(0, dtype=bool)
    flights = np.diff(times, prepend=0.0, append=np.inf)
    limit = _CHATTER * flights[:-1].max()
    return np.asarray((flights[:-1] >= limit) & (flights[1:] >= limit))


def cheapest(rows: list[Row], target: float) -> Row | None:
    """Find the cheapest row whose errors, with those of all tighter tolerances, meet the target."""
    good: list[Row] = []
    for method in METHODS:
        mine = sorted((row for row in rows if row.method == method), key=lambda row: row.rtol)
        for row in mine:
            if not row.largest_error <= target:
                break
            good.append(row)
    fastest = min((row.seconds for row in good), default=0.0)
    # where a record's samples determine the steps, many tolerances take the same time
    return max(
        (row for row in good if row.seconds <= _SAME_TIME * fastest),
        key=lambda row: row.rtol,
        default=None,
    )
