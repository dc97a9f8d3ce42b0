"""Intensity measures of records, and records scaled to equal intensity."""

from __future__ import annotations

import dataclasses
import math
import os
from collections.abc import Sequence
from pathlib import Path

from rwmf.case import Case, Motion
from rwmf.case.arguments import checked
from rwmf.errors import InputError
from rwmf.kernel.numbers import show, to_number
from rwmf.motion.measures import Intensity, choose_measure
from rwmf.motion.reader import read_bytes, read_channels
from rwmf.motion.record_sets import RecordFile, find_records
from rwmf.motion.waveform import Waveform, waveform_of

# default of `&model g` [m/s2]
G = 9.81
_PSEUDO, _PEAK = "pseudo_acceleration", "peak_acceleration"
# groups that can determine the period or the damping of a frame
_STRUCTURE = ("wall", "frame", "storeys")

_Record = str | os.PathLike[str] | Motion | RecordFile


@checked
def intensity(
    motion: _Record | tuple[_Record, _Record],
    kind: str,
    *,
    period: float | None = None,
    damping: float | None = None,
    periods: Sequence[float] | None = None,
    component: str | None = None,
    g: float = G,
    unit: str | None = None,
    dt: float | None = None,
) -> float:
    """Compute an intensity measure of a ground motion, or of two horizontal components.

    The motion is linear between its samples and zero outside them. All measures are exact for it.
    Extremes between samples count, and so does the free vibration of an oscillator after the
    motion. The Housner intensity has a relative error below 1e-4. Baselines are not corrected.

    Parameters
    ----------
    motion : Motion, RecordFile, str or path, or a tuple of two
        The motion; two are the horizontal components of one station.
    kind : str
        ``pseudo_acceleration`` (needs `period`), ``average_acceleration`` (geometric mean over
        `periods`), ``peak_acceleration`` [m/s2]; ``peak_velocity``, ``arias``, ``cav`` [m/s];
        ``peak_displacement``, ``housner`` (pseudo-velocity over 0.1 to 2.5 s) [m];
        ``duration_5_95`` [s].
    period : float, optional
        Period of the oscillator [s].
    damping : float, optional
        Damping ratio of oscillators, 0.05 when absent [-].
    periods : sequence of float, optional
        Periods of an average [s].
    component : str, optional
        For two components: ``geometric_mean``, ``rotd50``, ``rotd100`` or another percentile over
        all directions.
    g : float
        Acceleration of gravity for the unit 'g' and the Arias intensity [m/s2].
    unit : str, optional
        Unit of a file that does not give it: 'g', 'm/s2' or 'cm/s2'.
    dt : float, optional
        Sampling interval of a file of one column [s].

    Returns
    -------
    float
        The measure in SI units.

    Raises
    ------
    InputError
        When the kind is unknown, an option does not belong to it, or a record cannot be read.
    """
    measure = choose_measure(kind, period=period, damping=damping, periods=periods)
    g = to_number("g", g, above=0.0)
    words = list(motion) if isinstance(motion, tuple | list) else [motion]
    if len(words) not in (1, 2) or (len(words) == 2) != (component is not None):
        raise InputError("component: belongs to two components, given as a pair (first, second)")
    waves = [_wave_of(word, g, unit, dt) for word in words]
    if component is None:
        return measure.of(waves[0], g)
    return measure.of_pair((waves[0], waves[1]), component, g)


def _wave_of(word: _Record, g: float, unit: str | None, dt: float | None) -> Waveform:
    found = find_records([word], unit=unit, dt=dt)
    if len(found) > 1:
        names = ", ".join(record.name for record in found)
        raise InputError(f"motion = {show(str(word))}: has {len(found)} records: {names}: take one")
    return waveform_of_record(found[0], g)


def waveform_of_record(record: RecordFile, g: float) -> Waveform:
    """Return the samples of a record."""
    motion = record.array
    if motion is None:
        path = Path(record.path)
        motion = read_channels(path, read_bytes(path), record.unit, record.dt)[0].motion
    return waveform_of(motion, g, record.scale)


def choose_intensity(
    case: Case,
    kind: str | None = None,
    period: float | None = None,
    damping: float | None = None,
    varied: Sequence[tuple[str, str]] = (),
    periods: Sequence[float] | None = None,
) -> Intensity:
    """Choose the intensity measure for a scene, or check the given one."""
    if kind is None:
        kind = _PEAK if case.frame is None and period is None else _PSEUDO
    given = [
        name for name, value in (("period", period), ("damping", damping)) if value is not None
    ]
    if kind != _PSEUDO or len(given) == 2:
        measure = choose_measure(kind, period=period, damping=damping, periods=periods)
        if measure.power == 0:
            raise InputError(f"intensity = {kind!r}: does not change with a factor on the motion")
        return measure
    if given:
        raise InputError(
            f"intensity = {_PSEUDO!r}: has {given[0]} only: period and damping belong together"
        )
    structural = [f"{group}.{key}" for group, key in varied if group in _STRUCTURE]
    if structural:
        raise InputError(
            f"intensity = {_PSEUDO!r}: {', '.join(structural)} differs between the runs: give "
            "period and damping of one oscillator, so that each record has one factor for all"
        )
    own = None if case.frame is None else case.kernel.axes()["T_s"].value
    if own is None:
        raise InputError(
            f"intensity = {_PSEUDO!r}: the case needs &frame T_s, or give period and damping; or "
            f"take {_PEAK!r}"
        )
    return choose_measure(kind, period=float(own), damping=float(case.frame.xi_s), periods=periods)


def scale_to_one(
    case: Case, records: Sequence[RecordFile], measure: Intensity
) -> tuple[RecordFile, ...]:
    """Scale records to an intensity of one: 1 g for accelerations, otherwise one SI unit."""
    g = float(case.model.g)
    found = []
    for record in records:
        try:
            value = measure.of(waveform_of_record(record, g), g) / (g if measure.is_over_g else 1)
        except InputError as error:
            raise InputError(f"intensity: {error}") from error
        if not 0 < value < math.inf:
            raise InputError(f"{record.path or record.name}: has no intensity that could be scaled")
        scale = record.scale * value ** (-1 / measure.power)
        found.append(dataclasses.replace(record, scale=scale))
    return tuple(found)
