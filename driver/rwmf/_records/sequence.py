"""Main shock and aftershock as one motion."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from rwmf.case import Motion
from rwmf.errors import InputError

_IN_SI = {"m/s2": 1.0, "cm/s2": 0.01}
# rounding of times that still fit a common interval, over the interval [-]
_ROUNDING = 1e-6


def join(shocks: tuple[Motion, Motion], pause: float, factors: tuple[float, float]) -> Motion:
    """Join two motions with a pause without acceleration."""
    units = {shock.unit for shock in shocks}
    unit, scales = shocks[0].unit, [1.0, 1.0]
    if len(units) > 1:
        if "g" in units:
            raise InputError("sequence: one motion is in g, the other is not: convert one of them")
        unit, scales = "m/s2", [_IN_SI[shock.unit] for shock in shocks]
    values = [
        shock.values * (factor * scale)
        for shock, factor, scale in zip(shocks, factors, scales, strict=True)
    ]
    name = f"{shocks[0].name} + {shocks[1].name}"
    steps = [_step(shocks[0].times, -1), _step(shocks[1].times, 0)]
    if pause < sum(steps):
        raise InputError(f"pause = {pause:g}: must be at least {sum(steps):g} s, one step of each")
    dt = interval_of(shocks[0])
    if dt is not None and dt == interval_of(shocks[1]):
        count = round(pause / dt)
        if abs(count * dt - pause) <= _ROUNDING * dt:
            rest = np.zeros(count - 1)
            return Motion(np.concatenate([values[0], rest, values[1]]), dt=dt, unit=unit, name=name)
    end = float(shocks[0].times[-1])
    begin = end + pause
    quiet = np.unique([end + steps[0], begin - steps[1]])
    later = shocks[1].times - shocks[1].times[0] + begin
    times = np.concatenate([shocks[0].times, quiet, later])
    joined = np.concatenate([values[0], np.zeros(quiet.size), values[1]])
    return Motion(joined, times=times, unit=unit, name=name)


def _step(times: npt.NDArray[np.float64], i: int) -> float:
    return float(np.diff(times)[i])


def interval_of(motion: Motion) -> float | None:
    """Return the interval of the samples; None for uneven times."""
    times = motion.times
    dt = motion.dt or float(f"{(times[-1] - times[0]) / (times.size - 1):.12g}")
    even = times[0] + dt * np.arange(times.size)
    return dt if np.abs(times - even).max() <= _ROUNDING * dt else None
