"""Facts about a record: peaks, integrals, durations, and doubts about its samples."""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import Any

import numpy as np

from rwmf._intensity import DAMPING, Array, Waveform, pseudo_accelerations, waveform_of
from rwmf._library import unusual_record
from rwmf._records.networks import Channel
from rwmf._records.reader import read_bytes, read_channels

# accepted rounding of printed times, over the interval [-]
_PRINTED = 1e-4
# an interval this many times the median is a gap
_GAP = 5.0
# final over largest value that points to an uncorrected baseline [-]
_DRIFT = {"velocity": 0.2, "displacement": 0.5}
# first and last period of a spectrum [s], and their number
_PERIODS = (0.02, 5.0, 200)
# length of a record below which it is doubtful [s]
_SHORT = 1.0

Described = tuple[dict[str, Any], Waveform]


def describe(path: Path, unit: str | None, dt: float | None, g: float) -> list[Described]:
    """Describe the channels of a file."""
    content = read_bytes(path)
    crc = f"{zlib.crc32(content):08x}"
    channels = read_channels(path, content, unit, dt)
    found = []
    for channel in channels:
        wave = waveform_of(channel.motion, g)
        found.append(({"file": str(path), "crc32": crc} | _facts(channel, wave, g), wave))
    return found


def _facts(channel: Channel, wave: Waveform, g: float) -> dict[str, Any]:
    peak = float(wave.peak_acceleration()[0])
    velocity = float(wave.peak_velocity()[0])
    displacement = float(wave.peak_displacement()[0])
    interval = _interval(wave)
    return {
        "name": channel.motion.name,
        "format": channel.dialect,
        "direction": channel.direction,
        "unit": channel.motion.unit,
        "samples": int(wave.t.size),
        "dt_s": interval,
        "duration_s": float(wave.t[-1] - wave.t[0]),
        "peak_acceleration_g": peak / g,
        "peak_acceleration_m_s2": peak,
        "t_peak_acceleration_s": float(wave.t[np.argmax(np.abs(wave.a))]),
        "peak_velocity_m_s": velocity,
        "peak_displacement_m": displacement,
        "arias_m_s": float(wave.arias(g)[0]),
        "duration_5_95_s": float(wave.significant_duration()[0]),
        "cav_m_s": float(wave.cumulative_absolute_velocity()[0]),
        "warnings": _doubts(wave, peak / g, velocity, displacement),
    }


def _interval(wave: Waveform) -> float | None:
    """Return the common interval [s]; None for uneven times."""
    h = float((wave.t[-1] - wave.t[0]) / (wave.t.size - 1))
    even = wave.t[0] + h * np.arange(wave.t.size)
    return float(f"{h:.12g}") if np.abs(wave.t - even).max() <= _PRINTED * h else None


def _doubts(wave: Waveform, peak: float, velocity: float, displacement: float) -> list[str]:
    """List reasons to doubt a record."""
    found = []
    h = wave.h
    i = int(np.argmax(h))
    if h[i] > _GAP * float(np.median(h)):
        found.append(
            f"gap of {h[i]:g} s behind t = {wave.t[i]:g} s, where the median interval is "
            f"{np.median(h):g} s"
        )
    duration = float(wave.t[-1] - wave.t[0])
    unusual = unusual_record(peak, duration / h.size, duration)
    if unusual:
        found.append(unusual)
    if duration < _SHORT:
        found.append(f"duration of {duration:g} s: check the interval")
    ends = {
        "velocity": (abs(float(wave.velocities()[0, -1])), velocity, "m/s"),
        "displacement": (abs(float(wave.displacements()[0, -1])), displacement, "m"),
    }
    for name, (last, largest, unit) in ends.items():
        if last > _DRIFT[name] * largest:
            found.append(
                f"{name} of {last:.3g} {unit} at the end: the baseline is not corrected, peak "
                "velocity and displacement contain its drift"
            )
            break
    return found


def curves(wave: Waveform, g: float) -> dict[str, Array]:
    """Return the curves of a figure of one record."""
    periods = np.geomspace(*_PERIODS)
    return {
        "t": wave.t,
        "a": wave.rows[0] / g,
        "v": wave.velocities()[0],
        "u": wave.displacements()[0],
        "energy": wave.husid()[0],
        "periods": periods,
        "Sa": pseudo_accelerations(wave, periods, DAMPING) / g,
    }
