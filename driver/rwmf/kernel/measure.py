"""Measurements by the kernel: methods, fixed steps, quadruple-precision reference."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from rwmf._kernel import rwmf_bindings_python_cost as _cost
from rwmf._reference import rwmf_bindings_python_reference as _reference
from rwmf.errors import InputError
from rwmf.kernel.marshalling import encode, fetch_text, wait_for
from rwmf.kernel.numbers import Array

if TYPE_CHECKING:
    from rwmf.case import Case


# number of stored impact times; only chatter exceeds it
_MOST_IMPACTS = 20000


@dataclasses.dataclass(frozen=True)
class Measurement:
    """Results and cost of one computation of a case.

    Attributes
    ----------
    values : dict
        Numbers by the kernel's names, unit included, and the quantity of `accuracy_of`; NaN where
        the scene or the procedure does not have the quantity.
    impact_times : numpy.ndarray, shape (impacts,)
        Times of the impacts [s].
    steps, rhs_evaluations, impacts : int
        Counts.
    overturned : bool
        True when the wall overturned.
    seconds : float
        Fastest of all repetitions, measured inside the kernel [s].
    dt : float
        Step of a procedure with fixed steps [s], else NaN.
    """

    values: dict[str, float]
    impact_times: Array
    steps: int
    rhs_evaluations: int
    impacts: int
    overturned: bool
    seconds: float
    dt: float = float("nan")


@dataclasses.dataclass(frozen=True)
class Reference(Measurement):
    """Results in quadruple precision.

    Attributes
    ----------
    differences : dict
        Difference of each value from that at a looser tolerance.
    """

    differences: dict[str, float] = dataclasses.field(default_factory=dict)


def requested_peak(case: Case) -> str | None:
    """Return the quantity whose accuracy a case requests."""
    return getattr(case.solver, "accuracy_of", None)


def measure_method(case: Case, method: str, rtol: float, budget: float) -> Measurement:
    """Measure repeated runs of a case with a method and a tolerance."""
    asked = (case.kernel.handle, encode(method), rtol, budget)
    return _measured(case, lambda control, *buffers: _cost.measure(*asked, control, *buffers))


def measure_fixed_steps(case: Case, name: str, divisor: float, budget: float) -> Measurement:
    """Measure repeated runs of a case with fixed steps."""
    asked = (case.kernel.handle, name == "newmark", divisor, budget)
    return _measured(case, lambda _, *buffers: _cost.measure_fixed_steps(*asked, *buffers))


def solve_reference(
    case: Case,
    rtol_loose: float,
    rtol: float,
    progress: Callable[[int], None] | None = None,
) -> Reference:
    """Run a case in quadruple precision at two tolerances.

    The quadruple kernel is a separate library, which cannot use a case of the double kernel: it
    reads the text and the records again.
    """
    if case.motions:
        raise InputError("the quadruple kernel reads records from files: case.to_namelist(path)")
    differences = np.full(len(_names()), np.nan)
    asked = (encode(case.text), encode(case.kernel_source()), rtol_loose, rtol)
    found = _measured(
        case,
        lambda control, values, *buffers: _reference.solve(
            *asked, control, values, differences, *buffers
        ),
        progress,
    )
    return Reference(**vars(found), differences=_by_name(differences, case))


def _measured(
    case: Case, call: Callable[..., Any], progress: Callable[[int], None] | None = None
) -> Measurement:
    """Wait for a procedure with flags, values, times of impacts and message as last arguments."""
    values, impact_times = np.full(len(_names()), np.nan), np.zeros(_MOST_IMPACTS)
    seconds, *dt, counts = wait_for(
        lambda control, message: call(control, values, impact_times, message),
        case.kernel_source(),
        lambda *found: found,
        progress,
    )
    steps, evaluations, impacts, overturned = map(int, counts)
    return Measurement(
        _by_name(values, case),
        impact_times[:impacts].copy(),
        steps,
        evaluations,
        impacts,
        bool(overturned),
        seconds,
        *dt,
    )


def _names() -> list[str]:
    return fetch_text(_cost.value_names).split()


def _by_name(values: Array, case: Case) -> dict[str, float]:
    named = dict(zip(_names(), values.tolist(), strict=True))
    peak = named.pop("peak")
    requested = requested_peak(case)
    return named if requested is None else named | {requested: peak}
