"""Overturning maps: pulses that overturn the wall, and the number of impacts before.

The collapse of a frame counts as overturning of the wall.

Axes are omega_p/p and a_p/(alpha g), with p = sqrt(3 g/(4 R)) of the wall. The amplitudes are
scanned at each frequency, and every change of the outcome is bisected.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import xarray as xr

from rwmf import _simulation as simulation
from rwmf._arguments import case_of, checked
from rwmf._progress import Reports, reporting
from rwmf._sweep.executors import count_threads
from rwmf.case import Case, CaseLike
from rwmf.errors import InputError
from rwmf.quantities import ending_of
from rwmf.studies.pulse import Pulse, origin_of

# outcome without overturning; other outcomes are numbers of impacts before overturning
SURVIVES = -1
# simulated time after the pulse in 1/p; a shorter time would move the boundaries
_FOLLOW = 25.0


@dataclass(frozen=True)
class Wall:
    """Reference quantities of a map.

    Attributes
    ----------
    alpha : float
        Slenderness atan(b/h) [rad].
    p : float
        Frequency parameter [rad/s].
    """

    alpha: float
    p: float

    @classmethod
    def of(cls, case: Case) -> Wall:
        """Return the wall of a case."""
        if case.wall is None:
            raise InputError("overturning: the case has no &wall")
        if case.wall.get("base") == "pinned":
            raise InputError("overturning: a hinged wall does not rock")
        h, b = float(case.wall.h), float(case.wall.b)
        return cls(math.atan2(b, h), math.sqrt(0.75 * float(case.model.g) / math.hypot(h, b)))


@dataclass(frozen=True)
class _Boundary:
    """A change of the outcome along the amplitude axis."""

    omega: float
    amplitude: float
    below: int
    above: int


@checked
def overturning_map(
    case: CaseLike,
    omega_over_p: Sequence[float],
    amplitude: Sequence[float],
    tolerance: float = 1e-6,
    threads: int = 0,
    progress: Reports = None,
) -> xr.Dataset:
    """Compute an overturning map.

    Parameters
    ----------
    case : Case or path
        Wall, impact, pulse and other effects; amplitude, frequency and end time are replaced.
    omega_over_p : sequence of float
        Frequencies of the pulse over p [-].
    amplitude : sequence of float
        Amplitudes a_p/(alpha g) [-] to scan, in increasing order; regions between two neighbouring
        amplitudes are missed.
    tolerance : float
        Width of the bisected boundaries [-].
    threads : int
        Threads, 0 for all.
    progress : callable or bool, optional
        True for a bar in a notebook or terminal, or a function that is called with the numbers of
        finished and of all frequencies.

    Returns
    -------
    xarray.Dataset
        ``outcome`` over (omega_over_p, amplitude): impacts before overturning or collapse, -1
        without overturning. Over ``boundary``: its frequency, its amplitude (also over g
        tan(alpha)), and the outcomes below and above. ``alpha``, ``p`` and, for a constant factor,
        ``e`` are those of the wall; the attribute ``pulse`` is the kind of the motion.

    Raises
    ------
    InputError
        When the case is not acceptable.
    NumericalError
        When a run fails.
    """
    case = case_of(case)
    wall = Wall.of(case)
    pulse = Pulse.of(case, "overturning")
    levels = [float(value) for value in amplitude]
    if not np.isfinite(levels).all() or levels != sorted(set(levels)):
        raise InputError("overturning: the amplitudes must be finite and increase")
    frequencies = [float(value) for value in omega_over_p]
    if not all(0 < value < math.inf for value in frequencies):
        raise InputError("overturning: the frequencies omega_over_p must be finite and > 0")
    if not tolerance > 0:
        raise InputError(f"overturning: tolerance = {tolerance:g}: must be > 0")

    def follow(omega: float) -> tuple[list[int], list[_Boundary]]:
        return _scan(pulse, wall, omega, levels, tolerance)

    results = []
    with (
        reporting(progress, "scan") as report,
        ThreadPoolExecutor(count_threads(threads)) as executor,
    ):
        try:
            for result in executor.map(follow, frequencies):
                results.append(result)
                if report is not None:
                    report(len(results), len(frequencies))
        except BaseException:
            executor.shutdown(wait=False, cancel_futures=True)
            raise
    outcomes = [outcome for outcome, _ in results]
    boundaries = [item for _, found in results for item in found]
    found = _to_dataset(wall, frequencies, levels, outcomes, boundaries)
    return found.assign(_factor(pulse, wall)).assign_attrs(origin_of(case), pulse=case.motion.kind)


def _factor(pulse: Pulse, wall: Wall) -> dict[str, tuple[tuple[()], float, dict[str, str]]]:
    """Return the velocity factor at impact, if it is constant."""
    with simulation.start(pulse.resized(wall.alpha, 1 / wall.p, 0.0)) as run:
        e = run.summary().get("e")
    text = {"units": "1", "long_name": "velocity factor at impact"}
    return {} if e is None else {"e": ((), float(e), text)}


def _scan(
    pulse: Pulse, wall: Wall, omega: float, levels: list[float], tolerance: float
) -> tuple[list[int], list[_Boundary]]:
    """Compute the outcomes at one frequency, and the boundaries between them."""

    def outcome_at(amplitude: float) -> int:
        return _outcome(pulse, wall, omega, amplitude)

    outcomes = [outcome_at(level) for level in levels]
    found: list[_Boundary] = []
    for i in range(len(levels) - 1):
        ends = (levels[i], outcomes[i]), (levels[i + 1], outcomes[i + 1])
        found += _bisect(outcome_at, omega, *ends, tolerance)
    return outcomes, found


def _bisect(
    outcome_at: Callable[[float], int],
    omega: float,
    low: tuple[float, int],
    high: tuple[float, int],
    tolerance: float,
) -> list[_Boundary]:
    """Find all changes between two amplitudes; a third outcome splits the search."""
    if low[1] == high[1]:
        return []
    middle = 0.5 * (low[0] + high[0])
    if high[0] - low[0] <= tolerance or middle in (low[0], high[0]):
        return [_Boundary(omega, middle, low[1], high[1])]
    centre = (middle, outcome_at(middle))
    return _bisect(outcome_at, omega, low, centre, tolerance) + _bisect(
        outcome_at, omega, centre, high, tolerance
    )


def _outcome(pulse: Pulse, wall: Wall, omega: float, amplitude: float) -> int:
    T_p = 2 * math.pi / (omega * wall.p)
    changed = pulse.resized(amplitude * wall.alpha, T_p, _FOLLOW / wall.p)
    with simulation.start(changed) as run:
        summary = run.summary()
    return SURVIVES if ending_of(summary) == "ok" else int(summary.get("impacts", 0))


def _to_dataset(
    wall: Wall,
    frequencies: list[float],
    levels: list[float],
    outcomes: list[list[int]],
    boundaries: list[_Boundary],
) -> xr.Dataset:
    amplitudes = np.array([item.amplitude for item in boundaries])
    texts = {
        "omega_over_p": "frequency of the pulse over p",
        "amplitude": "a_p/(alpha g)",
        "outcome": "impacts before overturning, -1: the wall stays",
        "boundary_omega_over_p": "frequency of the pulse over p at the boundary",
        "boundary_amplitude": "a_p/(alpha g) at the boundary",
        "boundary_amplitude_over_g_tan_alpha": "a_p/(g tan(alpha)) at the boundary",
        "below": "outcome below the boundary",
        "above": "outcome above the boundary",
    }
    values = {
        "omega_over_p": ("omega_over_p", frequencies),
        "amplitude": ("amplitude", levels),
        "outcome": (("omega_over_p", "amplitude"), np.array(outcomes, dtype="i4")),
        "boundary_omega_over_p": ("boundary", [item.omega for item in boundaries]),
        "boundary_amplitude": ("boundary", amplitudes),
        "boundary_amplitude_over_g_tan_alpha": (
            "boundary",
            amplitudes * wall.alpha / math.tan(wall.alpha),
        ),
        "below": ("boundary", np.array([item.below for item in boundaries], dtype="i4")),
        "above": ("boundary", np.array([item.above for item in boundaries], dtype="i4")),
    }
    labelled = {
        name: (*value, {"units": "1", "long_name": texts[name]}) for name, value in values.items()
    }
    axes = {name: labelled.pop(name) for name in ("omega_over_p", "amplitude")}
    labelled["alpha"] = ((), wall.alpha, {"units": "rad", "long_name": "slenderness atan(b/h)"})
    labelled["p"] = ((), wall.p, {"units": "rad/s", "long_name": "frequency parameter of the wall"})
    return xr.Dataset(labelled, axes)
