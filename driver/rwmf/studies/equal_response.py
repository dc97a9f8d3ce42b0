"""Equal-response pulses: amplitude of each pulse that gives a target response."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import xarray as xr

from rwmf import _library
from rwmf._arguments import case_of, checked
from rwmf._progress import Reports, reporting
from rwmf._sweep.executors import count_threads
from rwmf._sweep.intensity import QUANTITIES, find_quantity
from rwmf.case import CaseLike
from rwmf.errors import InputError
from rwmf.quantities import Quantity, ending_of
from rwmf.studies.pulse import Pulse, origin_of

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
    response = QUANTITIES[name]
    if name == "u_s_max" and case.frame is None:
        raise InputError(
            "equal response: u_s_max: a free-standing wall has no frame displacement; "
            "take its rotation, theta_max_over_alpha"
        )
    if response.asked_by:
        case = case.replace(output={response.asked_by: True})
    pulse = Pulse.of(case, "equal response")
    for word, value in (("target", target), ("tolerance", tolerance), *(("T_p", T) for T in T_p)):
        if not 0 < value < np.inf:
            raise InputError(f"equal response: {word} = {value:g}: must be finite and > 0")
    periods = [float(value) for value in T_p]
    search = _Search(pulse, _PERIODS_AFTER * period.value, response, target)
    amplitudes: list[float] = []
    with (
        reporting(progress, "period") as report,
        ThreadPoolExecutor(count_threads(threads)) as executor,
    ):
        try:
            for found in executor.map(lambda T: _climb(search, T, tolerance), periods):
                amplitudes.append(found)
                if report is not None:
                    report(len(amplitudes), len(periods))
        except BaseException:
            executor.shutdown(wait=False, cancel_futures=True)
            raise
    unit = "" if response.unit == "1" else f" {response.unit}"
    text = f"amplitude over g for {name} = {target:g}{unit}"
    return xr.Dataset(
        {
            "a_max_g": ("T_p", amplitudes, {"units": "1", "long_name": text}),
            "target": ((), target, response.attributes),
            "T_s": ((), period.value, {"units": period.unit, "long_name": period.meaning}),
        },
        {"T_p": ("T_p", periods, {"units": "s", "long_name": "period of the pulse"})},
        origin_of(case) | {"quantity": name},
    )


@dataclass(frozen=True)
class _Search:
    """Target and conditions of the search.

    Attributes
    ----------
    pulse : Pulse
        The pulse.
    follow : float
        Simulated time after the pulse [s].
    quantity : Quantity
        The response.
    target : float
        Target value [its unit].
    """

    pulse: Pulse
    follow: float
    quantity: Quantity
    target: float

    def is_reached(self, T_p: float, amplitude: float) -> bool:
        """Run one pulse; a run that ended early exceeds every target."""
        changed = self.pulse.resized(amplitude, T_p, self.follow)
        with _library.start_simulation(changed.kernel, changed.label) as run:
            summary = run.summary()
        if ending_of(summary) != "ok":
            return True
        if self.quantity.key not in summary:
            raise InputError(f"equal response: {self.quantity.key}: no run of the case reports it")
        return float(summary[self.quantity.key]) >= self.target


def _climb(search: _Search, T_p: float, tolerance: float) -> float:
    """Increase the amplitude until it reaches the target, then bisect."""
    low, high = _LOWEST, _LOWEST
    while not search.is_reached(T_p, high):
        low, high = high, high * _GROWTH
        if high > _HIGHEST:
            return np.nan
    while high - low > tolerance * high:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if search.is_reached(T_p, middle):
            high = middle
        else:
            low = middle
    return high
