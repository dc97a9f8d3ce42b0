"""Intensity measures of records, and records scaled to equal intensity."""

from __future__ import annotations

import dataclasses
import math
import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rwmf.case import Case, Motion
from rwmf.case.arguments import checked
from rwmf.errors import InputError, did_you_mean, placed
from rwmf.kernel.numbers import Array, show, to_number
from rwmf.motion.record_sets import RecordFile, find_records, read_bytes, read_channels
from rwmf.motion.waveform import (
    Waveform,
    aligned,
    pseudo_accelerations,
    rotated,
    rotated_pseudo_accelerations,
    waveform_of,
)

DAMPING = 0.05
# periods of the Housner intensity [s], and the relative tolerance of its quadrature
_HOUSNER = (0.1, 2.5)
_TOLERANCE = 1e-4
_FIRST_INTERVALS = 24
_MOST_HALVINGS = 12
# angles of a rotated pair over half a turn
_ANGLES = 720
# finer angles around the largest and the smallest direction
_ZOOM: Array = np.linspace(-1, 1, 65)
_ZOOMS = 3
# numbers of one array of rotated samples
_PART = 400_000
_BISECTIONS = 60
_GEOMETRIC_MEAN = "geometric_mean"
_ROTATED = re.compile(r"rotd(\d{1,2}|100)")


@dataclasses.dataclass(frozen=True)
class _Kind:
    """Definition of a kind: label, unit, power of the amplitude, options of its oscillators."""

    label: str
    unit: str
    power: int = 1
    options: tuple[str, ...] = ()


KINDS = {
    "pseudo_acceleration": _Kind("pseudo-spectral acceleration", "m/s2", 1, ("period", "damping")),
    "peak_acceleration": _Kind("peak ground acceleration", "m/s2"),
    "average_acceleration": _Kind(
        "average spectral acceleration", "m/s2", 1, ("periods", "damping")
    ),
    "peak_velocity": _Kind("peak ground velocity", "m/s"),
    "peak_displacement": _Kind("peak ground displacement", "m"),
    "arias": _Kind("Arias intensity", "m/s", 2),
    "cav": _Kind("cumulative absolute velocity", "m/s"),
    "housner": _Kind("Housner intensity", "m", 1, ("damping",)),
    "duration_5_95": _Kind("significant duration D5-95", "s", 0),
}


@dataclasses.dataclass(frozen=True)
class Intensity:
    """Intensity measure of a ground motion.

    Attributes
    ----------
    kind : str
        A name in `KINDS`.
    period : float, optional
        Period of the oscillator [s].
    damping : float, optional
        Damping ratio of the oscillators [-].
    periods : tuple of float
        Periods of an average spectral acceleration [s].
    """

    kind: str
    period: float | None = None
    damping: float | None = None
    periods: tuple[float, ...] = ()

    @property
    def power(self) -> int:
        """Power of a factor on the motion in the measure."""
        return KINDS[self.kind].power

    @property
    def is_over_g(self) -> bool:
        """True for accelerations, whose levels are given over g."""
        return KINDS[self.kind].unit == "m/s2"

    @property
    def unit(self) -> str:
        """Unit of the levels."""
        return "1" if self.is_over_g else KINDS[self.kind].unit

    @property
    def label(self) -> str:
        """Label of an axis of levels."""
        kind = KINDS[self.kind]
        text = kind.label + (" over g" if self.is_over_g else "")
        if self.period is not None:
            text += f" of an oscillator with period {self.period:.6g} s and damping"
            return f"{text} {self.damping:.6g}"
        if self.periods:
            first, last = self.periods[0], self.periods[-1]
            text += f" over {len(self.periods)} periods from {first:.6g} to {last:.6g} s"
        return text if self.damping is None else f"{text} with damping {self.damping:.6g}"

    @property
    def attributes(self) -> dict[str, str | float]:
        """Attributes of a dataset whose records this measure scales."""
        found = {
            "intensity": self.kind,
            "intensity_period_s": self.period,
            "intensity_periods_s": " ".join(map(repr, self.periods)) or None,
            "intensity_damping": self.damping,
        }
        return {name: value for name, value in found.items() if value is not None}

    def of(self, wave: Waveform, g: float) -> float:
        """Compute the measure of one motion."""
        if KINDS[self.kind].options:
            return self._spectral(lambda T: pseudo_accelerations(wave, T, self.damping or 0.0))
        return float(self._elementary(wave, g)[0])

    def of_pair(self, pair: tuple[Waveform, Waveform], component: str, g: float) -> float:
        """Compute the measure of two horizontal components."""
        if component == _GEOMETRIC_MEAN:
            return math.sqrt(self.of(pair[0], g) * self.of(pair[1], g))
        match = _ROTATED.fullmatch(component)
        if match is None:
            raise InputError(
                f"component = {show(component)}: must be {_GEOMETRIC_MEAN}, rotd50, rotd100 or "
                "another percentile rotdNN"
            )
        if self.kind == "housner":
            raise InputError(f"component = {component!r}: not for housner, take {_GEOMETRIC_MEAN}")
        pair, share = aligned(pair), int(match[1]) / 100
        if KINDS[self.kind].options:
            return self._spectral(
                lambda T: np.array([self._rotated(pair, share, g, float(x)) for x in T])
            )
        return self._rotated(pair, share, g, 0.0)

    def _rotated(
        self, pair: tuple[Waveform, Waveform], share: float, g: float, period: float
    ) -> float:
        """Return a percentile over all directions, of the measure or at one period."""
        spacing = math.pi / _ANGLES
        angles: Array = np.arange(_ANGLES, dtype=np.float64) * spacing

        def values(angles: Array) -> Array:
            if period > 0:
                return rotated_pseudo_accelerations(pair, period, self.damping or 0.0, angles)
            rows = max(1, _PART // pair[0].t.size)
            parts = np.split(angles, range(rows, angles.size, rows))
            return np.concatenate([self._elementary(rotated(pair, part), g) for part in parts])

        found = values(angles)
        if 0 < share < 1:
            return _percentile(found, share)
        choose = np.argmax if share == 1 else np.argmin
        for _ in range(_ZOOMS):
            angles = _ZOOM * spacing + angles[choose(found)]
            found, spacing = values(angles), spacing * float(_ZOOM[1] - _ZOOM[0])
        return float(found[choose(found)])

    def _elementary(self, wave: Waveform, g: float) -> Array:
        """Compute a measure without oscillators, a method of its name, one number per row."""
        return np.asarray(wave.arias(g) if self.kind == "arias" else getattr(wave, self.kind)())

    def _spectral(self, spectrum: Callable[[Array], Array]) -> float:
        """Compute a measure from a function of pseudo-accelerations over periods."""
        if self.kind == "housner":
            return _integral(lambda T: spectrum(T) * T / (2 * math.pi), *_HOUSNER)
        periods = np.array(self.periods or (self.period,), dtype=np.float64)
        found = spectrum(periods)
        if found.size == 1:
            return float(found[0])
        return math.exp(float(np.log(found).mean())) if found.all() else 0.0


def choose_measure(kind: object, **options: Any) -> Intensity:  # noqa: ANN401 (checked here)
    """Check a kind and its options."""
    if not isinstance(kind, str) or kind not in KINDS:
        hint = did_you_mean(kind, KINDS) if isinstance(kind, str) else ""
        raise InputError(f"intensity = {show(kind)}: must be one of {', '.join(KINDS)}{hint}")
    known = KINDS[kind].options
    given = {name: value for name, value in options.items() if value is not None}
    for name in given:
        if name not in known:
            raise InputError(f"{name}: must not be given with intensity = {kind!r}")
    for name in known:
        if name not in given and name != "damping":
            raise InputError(f"intensity = {kind!r}: needs {name} [s]")
    if not known:
        return Intensity(kind)
    periods, damping = tuple(given.pop("periods", ())), given.setdefault("damping", DAMPING)
    if not 0 <= damping < 1:
        # the one of a case may be larger
        raise InputError(f"damping = {show(damping)}: must be at least 0 and below 1")
    return Intensity(kind, **given, periods=periods)


def _percentile(values: Array, share: float) -> float:
    """Return the value that a share of the directions does not exceed."""
    low, high = np.minimum(values, np.roll(values, -1)), np.maximum(values, np.roll(values, -1))
    below, above = float(low.min()), float(high.max())
    spans = np.where(high > low, high - low, 1.0)
    for _ in range(_BISECTIONS):
        middle = (below + above) / 2
        reached = np.where(high > low, np.clip((middle - low) / spans, 0, 1), middle >= low)
        if reached.mean() < share:
            below = middle
        else:
            above = middle
    return above


def _integral(function: Callable[[Array], Array], first: float, last: float) -> float:
    """Integrate by Simpson's rule on halved intervals, to a relative tolerance."""
    ends = np.linspace(first, last, 2 * _FIRST_INTERVALS + 1)
    values = function(ends)
    begin, width = ends[:-1:2], np.full(_FIRST_INTERVALS, (last - first) / _FIRST_INTERVALS)
    three = np.stack([values[:-1:2], values[1::2], values[2::2]])
    total = 0.0
    size = float(np.abs(values).mean()) * (last - first)
    for halving in range(_MOST_HALVINGS + 1):
        coarse = _simpson(three, width)
        quarter = function(np.concatenate([begin + width / 4, begin + 3 * width / 4]))
        left, right = quarter[: begin.size], quarter[begin.size :]
        halves = (np.stack([three[0], left, three[1]]), np.stack([three[1], right, three[2]]))
        fine = _simpson(halves[0], width / 2) + _simpson(halves[1], width / 2)
        done = np.abs(fine - coarse) <= _TOLERANCE * size * width / (last - first)
        if halving == _MOST_HALVINGS:
            done[:] = True
        total += float(fine[done].sum())
        begin, width = begin[~done], width[~done] / 2
        if begin.size == 0:
            break
        three = np.concatenate([half[:, ~done] for half in halves], axis=1)
        begin = np.concatenate([begin, begin + width])
        width = np.concatenate([width, width])
    return total


def _simpson(three: Array, width: Array) -> Array:
    return np.asarray(width * (three[0] + 4 * three[1] + three[2]) / 6)


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
        with placed("intensity: "):
            value = measure.of(waveform_of_record(record, g), g) / (g if measure.is_over_g else 1)
        if not 0 < value < math.inf:
            raise InputError(f"{record.path or record.name}: has no intensity that could be scaled")
        scale = record.scale * value ** (-1 / measure.power)
        found.append(dataclasses.replace(record, scale=scale))
    return tuple(found)
