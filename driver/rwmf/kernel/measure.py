"""Measurements by the kernel: methods, fixed steps, quadruple-precision reference."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_cost as _cost
from rwmf._reference import rwmf_bindings_python_reference as _reference
from rwmf.errors import InputError
from rwmf.kernel.kernel_thread import wait_for
from rwmf.kernel.marshalling import encode, fetch_text, message_buffer

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
    impact_times: npt.NDArray[np.float64]
    steps: int
    rhs_evaluations: int
    impacts: int
    overturned: bool
    seconds: float
    dt: float = float("nan")

    def close(self) -> None:
        """Do nothing: all data have been copied."""


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
    requested: str | None = getattr(case.solver, "accuracy_of", None)
    return requested


def measure_method(case: Case, method: str, rtol: float, budget: float) -> Measurement:
    """Measure repeated runs of a case with a method and a tolerance."""

    def call(
        control: npt.NDArray[np.int64], buffers: _Buffers, message: npt.NDArray[np.int8]
    ) -> tuple[dict[str, Any], int, int]:
        seconds, counts, status, n = _cost.measure(
            case.kernel.handle,
            encode(method),
            rtol,
            budget,
            control,
            buffers.values,
            buffers.impact_times,
            message,
        )
        return {"seconds": seconds} | _counts(counts), status, n

    found, buffers = _run(call, case)
    return Measurement(**buffers.content(found["impacts"], case), **found)


def measure_fixed_steps(case: Case, name: str, divisor: float, budget: float) -> Measurement:
    """Measure repeated runs of a case with fixed steps."""

    def call(
        _: npt.NDArray[np.int64], buffers: _Buffers, message: npt.NDArray[np.int8]
    ) -> tuple[dict[str, Any], int, int]:
        seconds, dt, counts, status, n = _cost.measure_fixed_steps(
            case.kernel.handle,
            name == "newmark",
            divisor,
            budget,
            buffers.values,
            buffers.impact_times,
            message,
        )
        return {"seconds": seconds, "dt": dt} | _counts(counts), status, n

    found, buffers = _run(call, case)
    return Measurement(**buffers.content(found["impacts"], case), **found)


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
    differences = np.full(_n_values(), np.nan)

    def call(
        control: npt.NDArray[np.int64], buffers: _Buffers, message: npt.NDArray[np.int8]
    ) -> tuple[dict[str, Any], int, int]:
        seconds, counts, status, n = _reference.solve(
            encode(case.text),
            encode(case.kernel_source()),
            rtol_loose,
            rtol,
            control,
            buffers.values,
            differences,
            buffers.impact_times,
            message,
        )
        return {"seconds": seconds} | _counts(counts), status, n

    found, buffers = _run(call, case, progress)
    return Reference(
        **buffers.content(found["impacts"], case),
        **found,
        differences=_by_name(differences, case),
    )


class _Buffers:
    """Arrays filled by the kernel."""

    def __init__(self) -> None:
        self.values = np.full(_n_values(), np.nan)
        self.impact_times = np.zeros(_MOST_IMPACTS)

    def content(self, impacts: int, case: Case) -> dict[str, Any]:
        return {
            "values": _by_name(self.values, case),
            "impact_times": self.impact_times[:impacts].copy(),
        }


_Call = Callable[
    [npt.NDArray[np.int64], _Buffers, npt.NDArray[np.int8]], tuple[dict[str, Any], int, int]
]


class _Found(dict[str, Any]):
    """Copied data of a run, independent of the kernel's memory."""

    def close(self) -> None:
        """Do nothing: there is no memory to release."""


def _run(
    call: _Call, case: Case, progress: Callable[[int], None] | None = None
) -> tuple[dict[str, Any], _Buffers]:
    """Wait for the kernel, interruptible by Ctrl-C."""
    buffers = _Buffers()
    message = message_buffer()
    found = _Found()

    def work(control: npt.NDArray[np.int64]) -> tuple[int, int, int]:
        facts, status, n = call(control, buffers, message)
        found.update(facts)
        return 0, status, n

    wait_for(work, message, case.kernel_source(), lambda _: found, progress)
    return found, buffers


def _counts(counts: npt.NDArray[np.int64]) -> dict[str, Any]:
    steps, rhs_evaluations, impacts, overturned = (int(count) for count in counts)
    return {
        "steps": steps,
        "rhs_evaluations": rhs_evaluations,
        "impacts": impacts,
        "overturned": bool(overturned),
    }


def _names() -> list[str]:
    return fetch_text(_cost.value_names).split()


def _n_values() -> int:
    return len(_names())


def _by_name(values: npt.NDArray[np.float64], case: Case) -> dict[str, float]:
    named = dict(zip(_names(), values.tolist(), strict=True))
    peak = named.pop("peak")
    requested = requested_peak(case)
    if requested is not None:
        named[requested] = peak
    return named
