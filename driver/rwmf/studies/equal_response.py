"""Equal-response pulses: which amplitude of each pulse gives the same displacement."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import xarray as xr

from rwmf import _library
from rwmf._sweep.executors import count_threads
from rwmf._sweep.unsupported import refuse_storeys
from rwmf.case import Case
from rwmf.errors import InputError
from rwmf.quantities import AXES, ending_of
from rwmf.studies.origin import origin_of
from rwmf.studies.pulse import Pulse

__all__ = ["equal_response"]

_SUMMARY_KEY = "u_s_max_m"
# ratio of neighbouring amplitudes of the search
_GROWTH = 1.25
_LOWEST, _HIGHEST = 1e-4, 20.0
# after the pulse the frame swings on: a few periods hold the maximum
_PERIODS_AFTER = 10.0


def equal_response(
    case: Case,
    T_p: Sequence[float],
    target: float,
    tolerance: float = 1e-6,
    threads: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Find the smallest amplitude of a pulse that gives a displacement, for many periods.

    Parameters
    ----------
    case : Case
        A frame, with a wall or not, under a pulse whose amplitude and period are replaced.
    T_p : sequence of float
        Periods of the pulse [s].
    target : float
        Displacement u_s,max [m].
    tolerance : float
        Relative width to which the amplitude is bisected [-].
    threads : int
        Threads, 0 for all.
    progress : callable, optional
        Called with the number of finished periods and of all.

    Returns
    -------
    xarray.Dataset
        ``a_max_g`` [-] over ``T_p``; NaN where amplitudes up to 20 g do not reach the target.

    Raises
    ------
    InputError
        When the case is not acceptable.
    """
    refuse_storeys(case)
    if case.frame is None or case.frame.get("T_s") is None:
        raise InputError("equal response: the case needs &frame T_s")
    pulse = Pulse.of(case, "equal response")
    for name, value in (("target", target), ("tolerance", tolerance), *(("T_p", T) for T in T_p)):
        if not 0 < value < np.inf:
            raise InputError(f"equal response: {name} = {value:g}: must be finite and > 0")
    periods = [float(value) for value in T_p]
    amplitudes: list[float] = []
    with ThreadPoolExecutor(count_threads(threads)) as executor:
        try:
            for found in executor.map(lambda T: _search(pulse, T, target, tolerance), periods):
                amplitudes.append(found)
                if progress is not None:
                    progress(len(amplitudes), len(periods))
        except BaseException:
            executor.shutdown(wait=False, cancel_futures=True)
            raise
    text = f"amplitude over g for u_s,max = {target:g} m"
    return xr.Dataset(
        {
            "a_max_g": ("T_p", amplitudes, {"units": "1", "long_name": text}),
            "target": ((), target, {"units": "m", "long_name": "displacement that is reached"}),
            "T_s": ((), float(case.frame.T_s), AXES["T_s"].attributes),
        },
        {"T_p": ("T_p", periods, {"units": "s", "long_name": "period of the pulse"})},
        origin_of(case),
    )


def _search(pulse: Pulse, T_p: float, target: float, tolerance: float) -> float:
    """Climb to the first amplitude that reaches the target, then bisect below it."""

    def reaches(amplitude: float) -> bool:
        return _response(pulse, T_p, amplitude) >= target

    low, high = _LOWEST, _LOWEST
    while not reaches(high):
        low, high = high, high * _GROWTH
        if high > _HIGHEST:
            return np.nan
    while high - low > tolerance * high:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if reaches(middle):
            high = middle
        else:
            low = middle
    return high


def _response(pulse: Pulse, T_p: float, amplitude: float) -> float:
    changed = pulse.resized(amplitude, T_p, _PERIODS_AFTER * float(pulse.case.frame.T_s))
    with _library.start_simulation(changed.kernel, changed.label) as run:
        summary = run.summary()
    return float(summary[_SUMMARY_KEY]) if ending_of(summary) == "ok" else np.inf
