"""Deflected shape of a wall that bends: modes of the cantilever, as the kernel defines them."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from rwmf.case import Case

__all__ = ["mode_shapes"]

Array = npt.NDArray[np.float64]

# kappa of a rectangular section [-]
_SHEAR_FACTOR = 5 / 6


def mode_shapes(case: Case, share: npt.ArrayLike) -> Array:
    """Compute the deflections of the modes of a wall at heights."""
    x = np.asarray(share, dtype=float)
    modes = 0 if case.bending is None else int(case.bending.modes)
    columns = [_shape(number, _shear_flexibility(case), x) for number in range(1, modes + 1)]
    return np.stack(columns, axis=-1) if columns else np.empty((x.size, 0))


def _shear_flexibility(case: Case) -> float:
    """Return EI/(kappa G A L**2) [-], 0 without shear."""
    if "nu" not in case.bending:
        return 0.0
    # without E the stiffness contains the cracking; the kernel takes 1
    share = case.bending.cracking if "E" in case.bending.given else 1.0
    slenderness = float(case.wall.b / case.wall.h)
    return float(share) * slenderness**2 * (1 + float(case.bending.nu)) / (6 * _SHEAR_FACTOR)


def _shape(number: int, epsilon: float, x: Array) -> Array:
    """Compute one mode; growing exponentials are written from the tip."""
    c = _wave_number(number, epsilon)
    a = c / math.sqrt(1 + epsilon * c * c)
    decay = math.exp(-a)
    # bending moment and shear vanish at the tip
    cosine_end, sine_end = (a / c) ** 2 * math.cos(c), c / a * math.sin(c)

    def deflection(at: npt.ArrayLike) -> Array:
        z = np.asarray(at, dtype=float)
        found: Array = (
            (sine_end - cosine_end - decay) * np.exp(a * (z - 1))
            + (1 + decay * (sine_end + cosine_end)) * np.exp(-a * z)
            - (1 - decay**2 + 2 * decay * sine_end) * np.cos(c * z)
            + (c / a) ** 3 * (1 + decay**2 + 2 * decay * cosine_end) * np.sin(c * z)
        )
        return found

    shape: Array = deflection(x) / deflection(1.0)
    return shape


def _wave_number(number: int, epsilon: float) -> float:
    """Find the root of the frequency equation between (number - 1) pi and number pi [-]."""
    low, high = (number - 1) * math.pi, number * math.pi
    while low < (c := (low + high) / 2) < high:
        ratio = math.sqrt(1 + epsilon * c * c)
        decay = math.exp(-c / ratio)
        value = (
            2 * decay
            + (1 + decay**2) / 2 * math.cos(c) * (ratio**2 + 1 / ratio**2)
            - (1 - decay**2) / 2 * math.sin(c) * (ratio - 1 / ratio)
        )
        low, high = (c, high) if (value > 0) == (number % 2 == 1) else (low, c)
    return c
