"""Claims on Figs 4 to 11: histories and their maxima."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from reproduce import cable
from reproduce.claims import Claim, Etas, Measured
from reproduce.engines import compare, read
from reproduce.formulations import Formulation
from reproduce.histories import ENGINES, respond, stored
from reproduce.response_cache import ResponseCache

__all__ = ["CLAIMS"]

_STIFF, _MILD = "fig05_stiff_frame", "fig06_mild_frame"
_MARGINAL = 0.1  # bound of a small difference [-]
_SAME = 0.02  # bound of a negligible difference [-]
Measure = Callable[[ResponseCache, Formulation, Etas], Measured]


def _value(cache: ResponseCache, name: str, form: Formulation, etas: Etas, quantity: str) -> float:
    return float(cache.history(name, form, etas)[quantity])


def _engine(cache: ResponseCache, form: Formulation, _: Etas) -> Measured:
    response = respond(cache, "g1800", form)
    engines = stored(cache, "g1800")
    found = {name: compare(response, history).u_s_rms for name, history in engines.items()}
    history = engines["mujoco"]
    alone = cache.frame_alone("fig04_against_finite_elements")
    bare = np.interp(history["t_s"], alone["time"], alone["u_s"]) - history["u_s_m"]
    without = np.sqrt(np.mean(bare**2)) / np.abs(history["u_s_m"]).max()
    rms = ", ".join(f"{value:.2%} ({ENGINES[name]})" for name, value in found.items())
    text = f"u_s differs by {rms} rms; frame without wall: {without:.2%}"
    return Measured(text, max(found.values()) < 0.05)


def _tail(cache: ResponseCache, form: Formulation, _: Etas) -> Measured:
    history = read(cache.validation / "mujoco" / "g1800.csv")
    late = history["t_s"] >= 5.6
    response = respond(cache, "g1800", form)
    ours = np.interp(history["t_s"][late], response["time"], response["u_s"])
    ratio = np.abs(ours).max() / np.abs(history["u_s_m"][late]).max()
    return Measured(f"{ratio:.2f} of the engine's amplitude", abs(ratio - 1) < 0.05)


def _sine_over_cosine(stem: str, quantity: str, largest: float, smallest: float) -> Measure:
    """Make a measure: the value under the sine pulse over that under the cosine pulse."""

    def measure(cache: ResponseCache, form: Formulation, etas: Etas) -> Measured:
        sine = _value(cache, f"{stem}_one_sine", form, etas, quantity)
        cosine = _value(cache, f"{stem}_one_cosine", form, etas, quantity)
        ratio = sine / cosine
        return Measured(f"sine/cosine = {ratio:.3f}", smallest <= ratio <= largest)

    return measure


def _pulses() -> list[tuple[str, str]]:
    return [(stem, pulse) for stem in (_STIFF, _MILD) for pulse in ("one_sine", "one_cosine")]


def _damps(cache: ResponseCache, form: Formulation, etas: Etas) -> Measured:
    """Root-mean-square of u_s after the pulse, with wall over without."""
    ratios = []
    for stem, pulse in _pulses():
        with_wall = cache.history(f"{stem}_{pulse}", form, etas).sel(time=slice(1.0, None))
        alone = cache.frame_alone(f"{stem}_alone_{pulse}").sel(time=slice(1.0, None))
        ratios.append(float(np.sqrt((with_wall["u_s"] ** 2).mean() / (alone["u_s"] ** 2).mean())))
    text = f"rms of u_s after the pulse {min(ratios):.3f} to {max(ratios):.3f} of the frame's alone"
    return Measured(text, max(ratios) < 1 - _MARGINAL)


def _does_not_suppress(cache: ResponseCache, form: Formulation, etas: Etas) -> Measured:
    ratios = [
        _value(cache, f"{stem}_{pulse}", form, etas, "u_s_max")
        / float(cache.frame_alone(f"{stem}_alone_{pulse}")["u_s_max"])
        for stem, pulse in _pulses()
    ]
    text = f"u_s,max {min(ratios):.3f} to {max(ratios):.3f} of the frame's alone"
    return Measured(text, min(ratios) > 0.95)


def _less_often(cache: ResponseCache, form: Formulation, etas: Etas) -> Measured:
    counts = []
    for frame in ("mild", "stiff"):
        response = cache.history(f"fig07_rocking_with_{frame}_frame", form, etas)
        theta = response["theta"].values
        counts.append(int((theta[:-1] * theta[1:] < 0).sum()))
    return Measured(f"changes of side in 10 s: {counts[0]} against {counts[1]}",
                    counts[0] < counts[1])  # fmt: skip


def _more_strongly(cache: ResponseCache, form: Formulation, etas: Etas) -> Measured:
    mild, stiff = (
        _value(cache, f"fig07_rocking_with_{frame}_frame", form, etas, "theta_max_over_alpha")
        for frame in ("mild", "stiff")
    )
    return Measured(f"theta_max/alpha {mild:.3f} against {stiff:.3f}", mild > stiff)


def _mass_ratio(cache: ResponseCache, form: Formulation, etas: Etas) -> Measured:
    spreads = []
    for frame in ("stiff", "mild"):
        names = [f"fig08_{frame}_frame_mass_ratio_{n}" for n in (5, 100, 1800)]
        peaks = [_value(cache, name, form, etas, "theta_max_over_alpha") for name in names]
        spreads.append(max(peaks) / min(peaks) - 1 if min(peaks) > 0 else math.inf)
    text = f"theta_max differs by {spreads[0]:.1%} (T_s = 0.4 s), {spreads[1]:.1%} (1 s)"
    return Measured(text, max(spreads) <= _MARGINAL)


def _rotation(cache: ResponseCache, form: Formulation, etas: Etas, name: str) -> float:
    """Largest rotation [rad]: walls of different width have different alpha."""
    wall = cache.case(name, form, etas).wall
    peak = _value(cache, name, form, etas, "theta_max_over_alpha")
    return peak * math.atan2(wall.b, wall.h)


def _widths(cache: ResponseCache, form: Formulation, etas: Etas, stem: str) -> float:
    """Largest rotation of the slender wall over that of the squat one."""
    slender, squat = (
        _rotation(cache, form, etas, f"{stem}_{wall}_wall") for wall in ("slender", "squat")
    )
    return slender / squat if squat > 0 else math.inf


def _slender_more(cache: ResponseCache, form: Formulation, etas: Etas) -> Measured:
    ratio = _widths(cache, form, etas, "fig09_mild_frame")
    return Measured(f"theta_max slender/squat = {ratio:.3f}", ratio > 1)


def _insensitive(cache: ResponseCache, form: Formulation, etas: Etas) -> Measured:
    ratio = _widths(cache, form, etas, "fig09_stiff_frame")
    return Measured(f"theta_max slender/squat = {ratio:.3f}", abs(ratio - 1) <= _MARGINAL)


def _squat_loses_more(cache: ResponseCache, form: Formulation, etas: Etas) -> Measured:
    losses = []
    for wall in ("slender", "squat"):
        response = cache.history(f"fig09_mild_frame_{wall}_wall", form, etas)
        losses.append(1 - float(response["e"]) ** 2)
    text = f"{losses[0]:.2%} (slender), {losses[1]:.2%} (squat) of the kinetic energy an impact"
    return Measured(text, losses[1] > losses[0] * 1.01)


def _no_dependence(cache: ResponseCache, form: Formulation, etas: Etas) -> Measured:
    ratios = [_widths(cache, form, etas, f"fig10_{frame}_frame") for frame in ("stiff", "mild")]
    text = f"theta_max slender/squat = {ratios[0]:.4f} (T_s = 0.4 s), {ratios[1]:.4f} (1 s)"
    return Measured(text, max(abs(ratio - 1) for ratio in ratios) <= _SAME)


_NO_STIFFNESS = Measured("the cable has no stiffness", None)


def _cable_grows(cache: ResponseCache, form: Formulation, etas: Etas) -> Measured:
    if etas[0] == etas[1]:
        return _NO_STIFFNESS
    ends = []
    for gamma in (5.0, 1800.0):
        found = cable.increments(cache, form, gamma, etas)
        ends.append(cable.PERIODS[int(found.argmax())])
    grows = min(ends) >= cable.PERIODS[-1]
    text = f"largest at T_s = {ends[0]:g} s (gamma = 5), {ends[1]:g} s (1800); falls after that"
    return Measured("grows up to 3 s" if grows else text, grows)


def _cable_three_periods(cache: ResponseCache, form: Formulation, etas: Etas) -> Measured:
    if etas[0] == etas[1]:
        return _NO_STIFFNESS
    rows = [cable.increments(cache, form, gamma, etas) for gamma in (5.0, 1800.0)]
    at = [min(range(len(cable.PERIODS)), key=lambda i: abs(cable.PERIODS[i] - T_s))
          for T_s in (0.4, 1.0, 2.0)]  # fmt: skip
    texts = [", ".join(f"{row[i]:.3f}" for i in at) for row in rows]
    text = f"{texts[0]} (gamma = 5); {texts[1]} (1800) of m_w g"
    return Measured(text, all(np.all(np.diff(row[at]) > 0) for row in rows))


CLAIMS = (
    Claim("Sec. 3, Fig. 4", "Displacement agrees with finite elements: excellent match",
          "u_s within 5 % rms of both contact engines", _engine, has_cable=False),
    Claim("Sec. 3, Fig. 4", "Eq. (15) is a global approximation of the time history",
          "amplitude at 5.6 to 6 s within 5 % of the engine's", _tail, has_cable=False),
    Claim("Sec. 4, Fig. 5", "T_s = 0.4 s: smaller rotation under sine than under cosine",
          "ratio < 1", _sine_over_cosine(_STIFF, "theta_max_over_alpha", 1.0, 0.0)),
    Claim("Sec. 4, Fig. 5", "T_s = 0.4 s: smaller angular velocity under sine",
          "ratio < 1", _sine_over_cosine(_STIFF, "theta_dot_max", 1.0, 0.0)),
    Claim("Sec. 4, Fig. 5", "T_s = 0.4 s: smaller u_s,max under sine",
          "ratio < 1", _sine_over_cosine(_STIFF, "u_s_max", 1.0, 0.0)),
    Claim("Sec. 4, Fig. 6", "T_s = 1 s: largest rotations differ very little between pulses",
          "ratio within 1 +- 0.1", _sine_over_cosine(_MILD, "theta_max_over_alpha", 1.1, 0.9)),
    Claim("Sec. 4, Fig. 6", "T_s = 1 s: largest angular velocities differ very little",
          "ratio within 1 +- 0.1", _sine_over_cosine(_MILD, "theta_dot_max", 1.1, 0.9)),
    Claim("Sec. 4, Figs 5, 6", "The wall dissipates energy well (gamma = 1800)",
          "rms after the pulse < 0.9 of the frame's in all four cases", _damps),
    Claim("Sec. 4, Figs 5, 6", "The wall does not suppress u_s,max (gamma = 1800)",
          "u_s,max > 0.95 of the frame's in all four cases", _does_not_suppress),
    Claim("Sec. 4, Fig. 7", "With T_s = 1 s the wall rocks less often than with 0.4 s",
          "fewer changes of side", _less_often),
    Claim("Sec. 4, Fig. 7", "With T_s = 1 s the wall rocks more strongly than with 0.4 s",
          "larger rotation", _more_strongly),
    Claim("Sec. 4, Fig. 8", "The mass ratio has marginal influence on the rotation",
          "theta_max within 10 % for gamma = 5, 100, 1800", _mass_ratio),
    Claim("Sec. 4, Fig. 9", "gamma = 5, T_s = 1 s: a slenderer wall rotates more",
          "ratio > 1", _slender_more),
    Claim("Sec. 4, Fig. 9", "gamma = 5, T_s = 0.4 s: rotation is insensitive to slenderness",
          "ratio within 1 +- 0.1", _insensitive),
    Claim("Sec. 4, Fig. 9", "The squatter the wall, the more energy every impact takes",
          "larger loss for the squat wall", _squat_loses_more),
    Claim("Sec. 4, Fig. 10", "gamma = 1800: rotation does not depend on the width",
          "ratios within 1 +- 0.02", _no_dependence),
    Claim("Sec. 4, Fig. 11", "The cable force grows with T_s (0.4, 1, 2 s)",
          "increasing for gamma = 5 and 1800", _cable_three_periods),
    Claim("Sec. 4, Fig. 11", "The cable force grows with T_s (all of 0.2 to 3 s)",
          "largest at the longest period", _cable_grows),
)  # fmt: skip
