"""Corrections of a record, each recorded in words; main shock and aftershock as one motion."""

from __future__ import annotations

from typing import NamedTuple

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


Array = npt.NDArray[np.float64]

# length of the zeros at both ends together, over poles and corner frequency [-]
_PADS = 1.5
_MOST = 2e7


class Processed(NamedTuple):
    """A corrected motion.

    Attributes
    ----------
    motion : Motion
        The samples at equal intervals.
    steps : tuple of str
        The steps in their order, with all numbers.
    """

    motion: Motion
    steps: tuple[str, ...]


def process(
    motion: Motion,
    *,
    resample: float | None,
    baseline: int | None,
    taper: float | None,
    band: tuple[float, float] | None,
    poles: int,
) -> Processed:
    """Apply the steps in their order; None for those that are left out."""
    done: list[str] = []
    values, dt = motion.values, interval_of(motion)
    if resample is not None:
        values, dt = _resample(motion, resample), resample
        done.append(f"resampled on straight lines to dt = {dt:g} s")
    if dt is None:
        raise InputError(f"{motion.name}: the times are uneven: resample is needed")
    if baseline is not None:
        values = _without_baseline(values, dt, baseline)
        done.append(
            f"baseline: polynomial of order {baseline} removed, fitted to the velocity by least "
            "squares"
        )
    if taper is not None:
        values = _tapered(values, dt, taper)
        done.append(f"taper: cosine over {taper:g} s at both ends")
    if band is not None:
        values, words = _filtered(values, dt, band, poles)
        done.append(words)
    if not done:
        raise InputError("process: no step is given: resample, baseline, taper or band")
    return Processed(Motion(values, dt=dt, unit=motion.unit, name=motion.name), tuple(done))


def _resample(motion: Motion, dt: float) -> Array:
    times = motion.times
    usual = float(np.median(np.diff(times)))
    if dt > usual * (1 + 1e-9):
        raise InputError(
            f"resample = {dt:g}: is above the interval of {usual:g} s: the record would lose its "
            "high frequencies without a filter"
        )
    n = _count("resample", (times[-1] - times[0]) / dt * (1 + 1e-12))
    taken: Array = np.interp(times[0] + dt * np.arange(n + 1), times, motion.values)
    return taken


def _count(name: str, samples: float) -> int:
    """Return a number of samples that fits into memory."""
    if not samples < _MOST:
        raise InputError(f"{name}: needs {samples:.3g} samples, more than {_MOST:.0e}")
    return int(samples)


def _without_baseline(a: Array, dt: float, order: int) -> Array:
    """Subtract the polynomial whose integral from zero fits the velocity."""
    # over the duration, for the condition of the fit
    s = np.linspace(0.0, 1.0, a.size)
    velocity = np.concatenate(([0.0], np.cumsum(0.5 * (a[1:] + a[:-1])))) * dt
    powers = np.arange(1, order + 2)
    found = np.linalg.lstsq(s[:, None] ** powers, velocity, rcond=None)[0]
    slope: Array = (s[:, None] ** (powers - 1)) @ (found * powers)
    corrected: Array = a - slope / (dt * (a.size - 1))
    return corrected


def _tapered(a: Array, dt: float, length: float) -> Array:
    n = round(length / dt)
    if not 1 <= n <= a.size // 2:
        raise InputError(f"taper = {length:g}: must be between a step and half of the record [s]")
    ramp = 0.5 * (1 - np.cos(np.pi * np.arange(n) / n))
    shape = np.ones(a.size)
    shape[:n], shape[a.size - n :] = ramp, ramp[::-1]
    tapered: Array = a * shape
    return tapered


def _filtered(a: Array, dt: float, band: tuple[float, float], poles: int) -> tuple[Array, str]:
    """Filter in both directions by Butterworth's filter, with zeros at both ends."""
    from scipy.signal import butter, sosfiltfilt

    low, high = band
    highest = 0.5 / dt
    if not 0 <= low < high or not (low > 0 or np.isfinite(high)):
        raise InputError(f"band = {low:g}, {high:g}: must be rising frequencies, one of them given")
    if low >= highest or (np.isfinite(high) and high >= highest):
        raise InputError(f"band: must be below half of the sampling frequency, {highest:g} Hz")
    kinds = {(True, True): "bandpass", (True, False): "highpass", (False, True): "lowpass"}
    kind = kinds[low > 0, bool(np.isfinite(high))]
    corners = [x for x in (low, high) if 0 < x < np.inf]
    filter_ = butter(poles, corners if len(corners) == 2 else corners[0], kind, fs=1 / dt,
                     output="sos")  # fmt: skip
    n = _count("band", np.ceil(0.5 * _PADS * poles / min(corners) / dt))
    padded = np.pad(a, n)
    found: Array = sosfiltfilt(filter_, padded, padtype=None)
    return found, (
        f"{kind} of Butterworth, {poles} poles, {' to '.join(f'{x:g}' for x in corners)} Hz, in "
        f"both directions (no shift of phase; half of the amplitude at a corner); {n} zeros = "
        f"{n * dt:g} s before and behind, which remain"
    )
