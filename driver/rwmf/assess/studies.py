"""Studies: pulses that overturn, pulses of equal response, effect of the wall, restitution.

The collapse of a frame counts as overturning of the wall. Axes of the map are omega_p/p and
a_p/(alpha g), with p = sqrt(3 g/(4 R)) of the wall. The amplitudes are scanned at each frequency,
and every change of the outcome is bisected.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple, Self, TypeVar, Unpack

import numpy as np
import xarray as xr

from rwmf.assess.table import with_overturning
from rwmf.case import Case, CaseLike
from rwmf.case.arguments import case_of, checked
from rwmf.case.case import groups_of_wall
from rwmf.errors import InputError
from rwmf.kernel import tables
from rwmf.kernel.names import readable
from rwmf.kernel.numbers import to_number
from rwmf.kernel.progress import Reports, reporting
from rwmf.motion.record_sets import RecordFile
from rwmf.run import simulation
from rwmf.run.quantities import ORDINATES, Quantity, ending_of, find_quantities, find_quantity
from rwmf.sweeps.axes import keys_of_axis, name_axes
from rwmf.sweeps.computation import SweepOptions, sweep
from rwmf.sweeps.executors import count_threads

_T = TypeVar("_T")


def origin_of(case: Case) -> dict[str, str]:
    """Return the attributes that a study shares with a sweep."""
    return {
        "version": tables.version(),
        "case": readable(case.to_namelist()),
        "warnings": "\n".join(case.kernel.motion_warnings()),
    }


@dataclass(frozen=True)
class Pulse:
    """The pulse of a case.

    Attributes
    ----------
    case : Case
        The case.
    t_0 : float
        Beginning of the pulse [s].
    periods : float
        Duration of the pulse over its period T_p [-]; the shape is independent of T_p.
    """

    case: Case
    t_0: float
    periods: float

    @classmethod
    def of(cls, case: Case, study: str) -> Self:
        """Return the pulse of a case."""
        motion = case.motion
        if motion is None or motion.kind in ("record", "none"):
            raise InputError(f"{study}: the case needs a pulse in &motion")
        t_0 = float(motion.t_0)
        T_p = float(motion.T_p) if "T_p" in motion else 2 * math.pi / float(motion.omega_p)
        end = case.kernel.end_of_motion()
        return cls(case, t_0, (end - t_0) / T_p)

    def resized(self, a_max_g: float, T_p: float, follow: float) -> Case:
        """Return the case with another amplitude and period."""
        pulse = {"a_max_g": a_max_g, "v_p": None, "omega_p": None, "T_p": T_p}
        t_end = self.t_0 + self.periods * T_p + follow
        return self.case.replace(
            motion=pulse, solver={"t_end": t_end}, output={"conditioning": False}
        )


def _in_threads(
    work: Callable[[float], _T],
    items: Sequence[float],
    threads: int,
    progress: Reports,
    unit: str,
) -> list[_T]:
    """Compute the results of all items, in their order."""
    found: list[_T] = []
    with (
        reporting(progress, unit) as report,
        ThreadPoolExecutor(count_threads(threads)) as executor,
    ):
        try:
            for result in executor.map(work, items):
                found.append(result)
                if report is not None:
                    report(len(found), len(items))
        except BaseException:
            executor.shutdown(wait=False, cancel_futures=True)
            raise
    return found


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


class _Boundary(NamedTuple):
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
    if list(amplitude) != sorted(set(amplitude)):
        raise InputError("overturning: the amplitudes must increase")

    follow = partial(_scan, pulse, wall, amplitude, tolerance)
    scans = _in_threads(follow, omega_over_p, threads, progress, "scan")
    outcomes = [outcome for outcome, _ in scans]
    boundaries = [item for _, found in scans for item in found]
    found = _to_dataset(wall, omega_over_p, amplitude, outcomes, boundaries)
    return found.assign(_factor(pulse, wall)).assign_attrs(origin_of(case), pulse=case.motion.kind)


def _factor(pulse: Pulse, wall: Wall) -> dict[str, tuple[tuple[()], float, dict[str, str]]]:
    """Return the velocity factor at impact, if it is constant."""
    with simulation.start(pulse.resized(wall.alpha, 1 / wall.p, 0.0)) as run:
        e = run.summary().get("e")
    text = {"units": "1", "long_name": "velocity factor at impact"}
    return {} if e is None else {"e": ((), float(e), text)}


def _scan(
    pulse: Pulse, wall: Wall, levels: Sequence[float], tolerance: float, omega: float
) -> tuple[list[int], list[_Boundary]]:
    """Compute the outcomes at one frequency, and the boundaries between them."""
    outcome_at = partial(_outcome, pulse, wall, omega)
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
    frequencies: Sequence[float],
    levels: Sequence[float],
    outcomes: list[list[int]],
    boundaries: list[_Boundary],
) -> xr.Dataset:
    omega, at, below, above = np.array(boundaries, dtype=float).reshape(-1, 4).T
    over = ("omega_over_p", "amplitude")
    rows = (
        (over[0], over[0], frequencies, "frequency of the pulse over p"),
        (over[1], over[1], levels, "a_p/(alpha g)"),
        ("outcome", over, np.array(outcomes, dtype="i4"),
         "impacts before overturning, -1: the wall stays"),
        ("boundary_omega_over_p", "boundary", omega,
         "frequency of the pulse over p at the boundary"),
        ("boundary_amplitude", "boundary", at, "a_p/(alpha g) at the boundary"),
        ("boundary_amplitude_over_g_tan_alpha", "boundary", at * wall.alpha / math.tan(wall.alpha),
         "a_p/(g tan(alpha)) at the boundary"),
        ("below", "boundary", below.astype("i4"), "outcome below the boundary"),
        ("above", "boundary", above.astype("i4"), "outcome above the boundary"),
    )  # fmt: skip
    labelled: dict[str, tuple[Any, ...]] = {
        name: (dims, values, {"units": "1", "long_name": text}) for name, dims, values, text in rows
    }
    axes = {name: labelled.pop(name) for name in over}
    labelled["alpha"] = ((), wall.alpha, {"units": "rad", "long_name": "slenderness atan(b/h)"})
    labelled["p"] = ((), wall.p, {"units": "rad/s", "long_name": "frequency parameter of the wall"})
    return xr.Dataset(labelled, axes)


# ratio of successive amplitudes in the search
_GROWTH = 1.25
_LOWEST, _HIGHEST = 1e-4, 20.0
# a few periods of free vibration after the pulse contain the maximum
_PERIODS_AFTER = 10.0


@checked
def equal_response(
    case: CaseLike,
    T_p: Sequence[float],
    target: float,
    tolerance: float = 1e-6,
    threads: int = 0,
    progress: Reports = None,
    quantities: str | Sequence[str] | None = None,
) -> xr.Dataset:
    """Find the smallest pulse amplitude that reaches a response, for many periods.

    Parameters
    ----------
    case : Case or path
        A frame with or without a wall, or a free-standing wall, under a pulse whose amplitude and
        period are replaced.
    T_p : sequence of float
        Periods of the pulse [s].
    target : float
        The response [the quantity's unit].
    tolerance : float
        Relative width of the bisected amplitude interval [-].
    threads : int
        Threads, 0 for all.
    progress : callable or bool, optional
        True for a bar in a notebook or terminal, or a function that is called with the numbers of
        finished and of all periods.
    quantities : str, optional
        The response; otherwise ``u_s_max`` [m], or ``theta_max_over_alpha`` for a free-standing
        wall.

    Returns
    -------
    xarray.Dataset
        ``a_max_g`` [-] over ``T_p``; NaN where amplitudes up to 20 g miss the target.

    Raises
    ------
    InputError
        When the case is not acceptable.
    """
    case = case_of(case)
    period = case.kernel.axes().get("T_s")
    if period is None or period.value is None:
        raise InputError("equal response: the case needs &frame T_s, or a &wall that rocks alone")
    name = find_quantity(case, quantities, "equal response")
    response = ORDINATES[name]
    if name == "u_s_max" and case.frame is None:
        raise InputError(
            "equal response: u_s_max: a free-standing wall has no frame displacement; "
            "take its rotation, theta_max_over_alpha"
        )
    if response.asked_by:
        case = case.replace(output={response.asked_by: True})
    pulse = Pulse.of(case, "equal response")
    follow = _PERIODS_AFTER * period.value

    def find(T: float) -> float:
        return _climb(lambda size: _reaches(pulse.resized(size, T, follow), response, target),
                      tolerance)  # fmt: skip

    amplitudes = _in_threads(find, T_p, threads, progress, "period")
    unit = "" if response.unit == "1" else f" {response.unit}"
    text = f"amplitude over g for {name} = {target:g}{unit}"
    return xr.Dataset(
        {
            "a_max_g": ("T_p", amplitudes, {"units": "1", "long_name": text}),
            "target": ((), target, response.attributes),
            "T_s": ((), period.value, {"units": period.unit, "long_name": period.meaning}),
        },
        {"T_p": ("T_p", T_p, {"units": "s", "long_name": "period of the pulse"})},
        origin_of(case) | {"quantity": name},
    )


def _reaches(case: Case, quantity: Quantity, target: float) -> bool:
    """Run one pulse; a run that ended early exceeds every target."""
    with simulation.start(case) as run:
        summary = run.summary()
    if ending_of(summary) != "ok":
        return True
    if quantity.key not in summary:
        raise InputError(f"equal response: {quantity.key}: no run of the case reports it")
    return float(summary[quantity.key]) >= target


def _climb(is_reached: Callable[[float], bool], tolerance: float) -> float:
    """Increase the amplitude until it reaches the target, then bisect."""
    low, high = _LOWEST, _LOWEST
    while not is_reached(high):
        low, high = high, high * _GROWTH
        if high > _HIGHEST:
            return np.nan
    while high - low > tolerance * high:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if is_reached(middle):
            high = middle
        else:
            low = middle
    return high


@checked
def restitution(case: CaseLike, *, start: float = 0.5) -> xr.Dataset:
    """Compute the equivalent velocity factor of a wall on `&base` that is let go.

    The factor is that of impacts on rigid corners with the same ratio of two successive rotations
    (Housner 1963): ``e**2 = (1 - (1 - r_1)**2) / (1 - (1 - r_0)**2)`` with ``r = |theta|/alpha``.

    Parameters
    ----------
    case : Case or path
        Case with ``&wall`` and ``&base``. Its motion is not used.
    start : float, default 0.5
        First rotation over the slenderness, between 0 and 1 [-].

    Returns
    -------
    xarray.Dataset
        ``e``, ``e_housner`` (a free block), ``theta_max_over_alpha`` of the next swing [-] and
        ``half_period`` between the two rotations [s].

    Raises
    ------
    InputError
        The case has no base, the start is out of range, or the wall does not swing back.

    Examples
    --------
    >>> import rwmf
    >>> case = rwmf.Case.from_text('''
    ... &wall h=2.0, b=0.5 / &base k_t_over_m_w=2.0e4, xi=0.2 /
    ... &motion kind='none' / &solver t_end=1.0 /''')
    >>> round(float(rwmf.studies.restitution(case).e), 3)
    0.982
    """
    known = case_of(case)
    if known.base is None:
        raise InputError("restitution: the case must have the group &base")
    start = to_number("start", start, above=0.0, below=1.0)
    h, b, g = known.wall.h, known.wall.b, known.model.g
    pace = math.sqrt(3 * g / (4 * math.hypot(h, b)))
    free: Any = known.replace(
        motion={"kind": "none"},
        initial={"theta_over_alpha": start, "theta_dot": None},
        solver={"t_end": 20 / pace, "rtol": 1e-9, **simulation.NO_ACCURACY},
        output={"dt": 0.002 / pace, "reactions": False, "conditioning": False},
    )
    response = simulation.simulate(free)
    theta = response["theta"].values / math.atan2(b, h)
    swing = np.flatnonzero(theta < 0)
    back = np.flatnonzero(theta[swing[0] :] > 0) if swing.size else swing
    if not back.size:
        raise InputError("restitution: the wall does not swing back from theta < 0 within 20/p")
    last = int(swing[0] + np.argmin(theta[swing[0] : swing[0] + back[0]]))
    rotation = -float(theta[last])
    factor = math.sqrt((1 - (1 - rotation) ** 2) / (1 - (1 - start) ** 2))
    return xr.Dataset(
        {
            "e": factor,
            "e_housner": 1 - 1.5 * math.sin(math.atan2(b, h)) ** 2,
            "theta_max_over_alpha": rotation,
            "half_period": float(response["time"].values[last]),
        }
    )


# responses of storeys; the first one applies to any frame
_RESPONSES = ("u_s_max", "storey_drift_max", "floor_acceleration_max_g")


@checked
def wall_effect(
    case: CaseLike,
    grid: Mapping[str, object],
    records: Sequence[str | RecordFile] = (),
    quantities: str | Sequence[str] | None = None,
    **sweep_options: Unpack[SweepOptions],
) -> xr.Dataset:
    """Compare the responses of the frame with and without the wall.

    A wall may lower one response and raise another, so compare several responses.

    Parameters
    ----------
    case : Case or path
        Frame and wall.
    grid : mapping
        ``T_s`` [s], ``gamma`` [-] and others as for `rwmf.sweep`.
    records : sequence of str or RecordFile
        Ground motions, otherwise that of the case.
    quantities : str or sequence of str, optional
        The compared responses; otherwise ``u_s_max``, and for storeys also ``storey_drift_max`` and
        ``floor_acceleration_max_g``.
    **sweep_options
        Further arguments of `rwmf.sweep`.

    Returns
    -------
    xarray.Dataset
        For each response ``QUANTITY`` with the wall, ``QUANTITY_alone`` without it, and their ratio
        ``QUANTITY_ratio`` [-]; ``ratio`` is that of the first response. Responses are infinite
        after overturning or collapse: the ratio is 0 where the frame alone collapsed, NaN where
        both did. The frame is the same with and without the wall at each period. The
        first period of storeys therefore changes where the wall kept them on a straight line.

    Raises
    ------
    InputError
        When the case or the grid is not acceptable, or when there is no frame.
    """
    case = case_of(case)
    if case.frame is None:
        raise InputError(
            "wall effect: the case has no &frame whose displacement the wall could change. For the "
            "rotation of a free-standing wall use rwmf spectrum or rwmf sweep"
        )
    usual = _RESPONSES if case.storeys is not None else _RESPONSES[:1]
    names = tuple(find_quantities(tuple(quantities or usual)))
    of_wall = [name for name in names if ORDINATES[name].group in groups_of_wall()]
    if of_wall:
        raise InputError(f"wall effect: {of_wall[0]}: the frame alone has no such response")
    both = sweep(case, grid, records, quantities=names, **sweep_options)
    frame = case.without_wall()
    joined, free = (item.kernel.axes()["T_s"].value for item in (case, frame))
    # a period in the grid is that of the frame restrained by the wall
    factor = free / joined if free and joined else 1.0
    shared = _shared_axes(grid) | {"T_s": factor * both["T_s"].values}
    alone = sweep(frame, shared, records, quantities=names, **sweep_options)
    alone = alone.assign_coords(T_s=both["T_s"])
    found: dict[str, xr.DataArray] = {}
    for name in names:
        response, plain = with_overturning(both, name), with_overturning(alone, name)
        text = f"{ORDINATES[name].meaning}: with the wall over without it"
        ratio = (response / plain).assign_attrs(units="1", long_name=text)
        found |= {f"{name}_ratio": ratio, name: response, f"{name}_alone": plain}
    attributes = both.attrs | {"quantities": " ".join(names)}
    return xr.Dataset({"ratio": found[f"{names[0]}_ratio"]} | found, attrs=attributes)


def _shared_axes(grid: Mapping[str, object]) -> dict[str, object]:
    """Return the axes that affect the frame alone: ground motion, period, damping, and so on."""
    of_wall = groups_of_wall()
    return {
        name: values
        for name, values in name_axes(grid).items()
        if name != "gamma" and not any(group in of_wall for group, _ in keys_of_axis(name))
    }
