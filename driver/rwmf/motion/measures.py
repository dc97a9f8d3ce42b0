"""Kinds of intensity measures, their options, and their values for one motion or a pair."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np

from rwmf.errors import InputError, did_you_mean
from rwmf.kernel.numbers import show, to_array, to_number
from rwmf.motion.waveform import (
    Array,
    Waveform,
    aligned,
    pseudo_accelerations,
    rotated,
    rotated_pseudo_accelerations,
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
        found: dict[str, str | float] = {"intensity": self.kind}
        if self.period is not None:
            found["intensity_period_s"] = self.period
        if self.periods:
            found["intensity_periods_s"] = " ".join(map(repr, self.periods))
        if self.damping is not None:
            found["intensity_damping"] = self.damping
        return found

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
        """Compute a measure without oscillators, one number per row."""
        if self.kind == "arias":
            return wave.arias(g)
        return {
            "peak_acceleration": wave.peak_acceleration,
            "peak_velocity": wave.peak_velocity,
            "peak_displacement": wave.peak_displacement,
            "cav": wave.cumulative_absolute_velocity,
            "duration_5_95": wave.significant_duration,
        }[self.kind]()

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
    damping = to_number("damping", given.get("damping", DAMPING))
    if not 0 <= damping < 1:
        raise InputError(f"damping = {show(damping)}: must be at least 0 and below 1")
    period = to_number("period", given["period"], above=0.0) if "period" in given else None
    periods = tuple(map(float, to_array("periods", given.get("periods", ()), above=0.0)))
    if "periods" in given and not periods:
        raise InputError("periods: must be at least one number > 0 [s]")
    return Intensity(kind, period, damping, periods)


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
    rule: Array = width * (three[0] + 4 * three[1] + three[2]) / 6
    return rule
