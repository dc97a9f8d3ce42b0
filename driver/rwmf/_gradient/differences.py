"""Derivatives from differences: Richardson steps, error, kinks and range of validity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = [
    "FAR",
    "LANES",
    "NEAR",
    "Estimate",
    "derivative_at",
    "offsets_of",
    "resolution",
    "valid_range",
]

Array = npt.NDArray[np.float64]
# relative steps of the central differences; one-sided differences add half the smallest
NEAR = (2e-4, 1e-4, 5e-5)
# lanes of a central derivative
LANES = 2 * len(NEAR)
# relative changes at which the linear prediction is tried
FAR = (1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3)
# the error of a linear prediction over the change, up to which a derivative is valid
_VALID = 0.1
# part of a line between two lanes that is used, because the share may grow faster at first
_CAUTION = 0.9
# quotients of two lanes that follow one another are a kink above, a curvature at 1/2
_SAME = 0.8


@dataclass(frozen=True)
class Estimate:
    """A derivative from the lanes of one step.

    Attributes
    ----------
    derivative : float
        Derivative with respect to the relative change.
    spread : float
        Disagreement of the differences, which a smooth function without round-off does not have.
    jump : float
        Difference of the slopes on both sides; 0 for one-sided differences.
    is_kink : bool
        True when the slopes on both sides differ as much at half the step.
    """

    derivative: float
    spread: float
    jump: float
    is_kink: bool


def offsets_of(sides: tuple[bool, bool], factor: float = 1.0) -> Array:
    """Return the relative changes of the lanes for one derivative."""
    if all(sides):
        return factor * np.array([sign * step for step in NEAR for sign in (1.0, -1.0)])
    sign = 1.0 if sides[1] else -1.0
    return factor * sign * np.array([*NEAR, NEAR[-1] / 2])


def derivative_at(offsets: Array, values: Array, centre: float) -> Estimate:
    """Compute a derivative by Richardson steps."""
    with np.errstate(invalid="ignore"):
        # values may be infinite
        slopes = (values - centre) / offsets
    if offsets.size < LANES:
        linear = 2 * slopes[1:] - slopes[:-1]
        jump, twice = 0.0, 0.0
    else:
        jumps = slopes[::2] - slopes[1::2]
        jump, twice = float(jumps[2]), float(jumps[1])
        linear = (slopes[::2] + slopes[1::2]) / 2
    # two Richardson steps: the one with the larger steps has less round-off
    large, small = (4 * linear[1:] - linear[:-1]) / 3
    # curvature halves the jump with the step
    spread = max(abs(small - large), abs(jump - twice / 2))
    is_kink = _SAME * abs(twice) < abs(jump) < abs(twice) / _SAME
    return Estimate(float(large), float(spread), jump, is_kink)


def resolution(values: Array) -> float:
    """Return the smallest difference that values can have.

    A quantity that is a difference of larger numbers, such as the increment of a force, has fewer
    binary digits than its type.
    """
    kept = values[np.isfinite(values) & (values != 0)]
    if kept.size == 0 or (kept == kept[0]).all():
        return 0.0
    mantissas, exponents = np.frexp(kept)
    whole = (mantissas * 2.0**53).astype(np.int64)
    # the lowest bit of a whole number
    return float((np.ldexp(1.0, exponents - 53) * (whole & -whole)).min())


def valid_range(offsets: Array, changes: Array, derivative: float, floor: float) -> float:
    """Find the largest relative change up to which a linear prediction holds on every side."""
    if not np.isfinite(derivative):
        return 0.0
    predicted = derivative * offsets
    wrong = np.abs(changes - predicted)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(wrong <= floor, 0.0, wrong / np.minimum(abs(changes), abs(predicted)))
    share = np.where(np.isnan(share), np.inf, share)
    ends = []
    for side in (offsets > 0, offsets < 0):
        if side.any():
            order = np.argsort(abs(offsets[side]))
            ends.append(_first_end(abs(offsets[side])[order], share[side][order]))
    return min(ends)


def _first_end(steps: Array, share: Array) -> float:
    """Return the step at which the share first exceeds the limit, between two lanes by a line."""
    above = np.flatnonzero(share > _VALID)
    if above.size == 0:
        return float(steps[-1])
    i = int(above[0])
    if i == 0:
        return 0.0
    if not np.isfinite(share[i]):
        return float(steps[i - 1])
    part = _CAUTION * (_VALID - share[i - 1]) / (share[i] - share[i - 1])
    return float(steps[i - 1] + part * (steps[i] - steps[i - 1]))
