"""Target spectra by the shapes of ASCE 7 and Eurocode 8."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from rwmf.case.arguments import checked
from rwmf.errors import InputError
from rwmf.kernel.numbers import show, to_number, to_whole

Array = npt.NDArray[np.float64]
# first period, and number of periods besides the corners
_FIRST, _PERIODS = 0.01, 500
# last periods: no corner of ASCE 7 is beyond 16 s, Eurocode 8 ends at 4 s
_LAST_ASCE, _LAST_EUROCODE = 20.0, 4.0
# EN 1998-1:2004, tables 3.2 and 3.3: soil factor S and corners T_B, T_C and T_D [s]
_GROUNDS = (
    {
        "A": (1.0, 0.15, 0.4, 2.0),
        "B": (1.2, 0.15, 0.5, 2.0),
        "C": (1.15, 0.2, 0.6, 2.0),
        "D": (1.35, 0.2, 0.8, 2.0),
        "E": (1.4, 0.15, 0.5, 2.0),
    },
    {
        "A": (1.0, 0.05, 0.25, 1.2),
        "B": (1.35, 0.05, 0.25, 1.2),
        "C": (1.5, 0.1, 0.25, 1.2),
        "D": (1.8, 0.1, 0.3, 1.2),
        "E": (1.6, 0.05, 0.25, 1.2),
    },
)


@checked
def asce7(S_DS: float, S_D1: float, T_L: float = 8.0) -> Array:
    """Return the design spectrum of ASCE/SEI 7-16, section 11.4.6, as a target of `select`.

    With T_0 = 0.2 S_D1/S_DS and T_S = S_D1/S_DS, the pseudo-acceleration is
    S_DS (0.4 + 0.6 T/T_0) below T_0, S_DS up to T_S (11.4-5), S_D1/T up to T_L (11.4-6) and
    S_D1 T_L/T^2 beyond (11.4-7), for 5 % damping. For the MCE_R spectrum give S_MS and S_M1.

    Parameters
    ----------
    S_DS, S_D1 : float
        Design accelerations at short periods and at 1 s [g].
    T_L : float
        Long-period transition [s].

    Returns
    -------
    array, shape (2, n)
        Periods [s] and pseudo-accelerations [g].

    Raises
    ------
    InputError
        When a number is not positive, or T_L is below T_S.
    """
    short, one = to_number("S_DS", S_DS, above=0.0), to_number("S_D1", S_D1, above=0.0)
    T_S, last = one / short, to_number("T_L", T_L, above=0.0)
    if last < T_S:
        raise InputError(f"T_L = {last:g}: must be at least T_S = S_D1/S_DS = {T_S:g} s")
    T_0 = 0.2 * T_S
    periods = _periods(_LAST_ASCE, T_0, T_S, last)
    parts = [short * (0.4 + 0.6 * periods / T_0), np.full(periods.size, short), one / periods]
    regions = [periods < T_0, periods <= T_S, periods <= last]
    return np.stack([periods, np.select(regions, parts, one * last / periods**2)])


@checked
def eurocode8(
    a_g: float, ground_type: str = "A", spectrum_type: int = 1, damping: float = 0.05
) -> Array:
    """Return the elastic spectrum of EN 1998-1:2004, section 3.2.2.2, as a target of `select`.

    With eta = sqrt(0.10/(0.05 + damping)) >= 0.55 (3.6), the acceleration is
    a_g S (1 + T/T_B (2.5 eta - 1)) up to T_B (3.2), 2.5 a_g S eta up to T_C (3.3),
    2.5 a_g S eta T_C/T up to T_D (3.4) and 2.5 a_g S eta T_C T_D/T^2 up to 4 s (3.5). S and the
    corners are the recommended ones of tables 3.2 and 3.3; national annexes may differ.

    Parameters
    ----------
    a_g : float
        Design acceleration on ground A, with the importance factor [g].
    ground_type : {'A', 'B', 'C', 'D', 'E'}
        Ground type.
    spectrum_type : int
        Spectrum type, 1, or 2 where no earthquake of a surface-wave magnitude above 5.5 governs.
    damping : float
        Damping ratio [-].

    Returns
    -------
    array, shape (2, n)
        Periods [s] and pseudo-accelerations [g].

    Raises
    ------
    InputError
        When a number is outside its range, or the ground type is not known.
    """
    grounds = _GROUNDS[to_whole("spectrum_type", spectrum_type, 1, 2) - 1]
    if not isinstance(ground_type, str) or ground_type not in grounds:
        raise InputError(f"ground_type = {show(ground_type)}: must be one of {', '.join(grounds)}")
    S, T_B, T_C, T_D = grounds[ground_type]
    eta = max(math.sqrt(0.1 / (0.05 + to_number("damping", damping))), 0.55)
    peak = to_number("a_g", a_g, above=0.0) * S
    periods = _periods(_LAST_EUROCODE, T_B, T_C, T_D)
    top = 2.5 * peak * eta
    parts = [
        peak * (1 + periods / T_B * (2.5 * eta - 1)),
        np.full(periods.size, top),
        top * T_C / periods,
    ]
    regions = [periods < T_B, periods <= T_C, periods <= T_D]
    return np.stack([periods, np.select(regions, parts, top * T_C * T_D / periods**2)])


def _periods(last: float, *corners: float) -> Array:
    """Return periods even in their logarithm, with the corners of a spectrum between them."""
    inner = [corner for corner in corners if _FIRST < corner < last]
    return np.unique(np.concatenate([np.geomspace(_FIRST, last, _PERIODS), inner]))
