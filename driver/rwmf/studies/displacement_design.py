"""First guess of a post-tension by displacement-based design."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence

import numpy as np
import xarray as xr

from rwmf._arguments import case_of, checked
from rwmf._numbers import to_number
from rwmf._sweep.intensity import intensity
from rwmf._sweep.record_sets import RecordFile, find_records
from rwmf.case import CaseLike, Motion
from rwmf.errors import InputError

__all__ = ["displacement_based_prestress"]

_PERIODS = np.geomspace(0.05, 6.0, 60)


@checked
def displacement_based_prestress(
    case: CaseLike,
    displacement: float,
    records: Sequence[str | os.PathLike[str] | RecordFile | Motion],
    *,
    damping: float = 0.1,
    unit: str | None = None,
    dt: float | None = None,
) -> xr.Dataset:
    r"""Estimate the post-tension for which a suite has a given median displacement.

    Direct displacement-based design (Priestley, Calvi and Kowalsky 2007): the structure is replaced
    by a linear oscillator with its secant stiffness at the displacement u. Its period T_e is where
    the median displacement spectrum at the equivalent damping equals u, so the required force is
    m_e (2 pi/T_e)^2 u. The frame carries m_s omega_s^2 u of it. The rocking wall carries
    m_w g ((1 + eta_0) b - u/2)/(2h), and its stiffening tendon is left out. The effective mass is
    m_s + m_w/3.

    Parameters
    ----------
    case : Case or path
        Wall and frame, with a period and a mass ratio.
    displacement : float
        Displacement of the frame u [m].
    records : sequence of str, path or Motion
        The suite.
    damping : float
        Equivalent damping ratio [-].
    unit, dt
        As in `rwmf.sweep`.

    Returns
    -------
    xarray.Dataset
        ``eta_0`` [-], 0 or more; ``effective_period`` [s]; ``force_over_m_w_g`` required, and
        ``frame_force_over_m_w_g`` [-].

    Raises
    ------
    InputError
        When the case has no wall and frame, or the spectrum never has this displacement.
    """
    case = case_of(case)
    axes = case.kernel.axes()
    if case.wall is None or not {"T_s", "gamma"} <= axes.keys():
        raise InputError("displacement-based design: the case needs &wall and &frame or &storeys")
    period, gamma = axes["T_s"].value, axes["gamma"].value
    if period is None or gamma is None:
        raise InputError("displacement-based design: the case needs one period and one mass ratio")
    u = to_number("displacement", displacement, above=0.0)
    g, h, b = case.model.g if case.model is not None else 9.81, case.wall.h, case.wall.b
    suite = find_records(records, unit=unit, dt=dt)
    spectrum = np.array([_median(suite, float(T), damping, g) for T in _PERIODS])
    above = np.flatnonzero(spectrum >= u)
    if above.size == 0:
        raise InputError(
            f"displacement = {u:g}: the median spectrum has {spectrum.max():.4g} m at most, so no "
            "post-tension is needed"
        )
    effective = _crossing(spectrum, int(above[0]), u)
    force = (gamma + 1 / 3) * (2 * math.pi / effective) ** 2 * u / g
    frame = gamma * (2 * math.pi / period) ** 2 * u / g
    eta_0 = ((force - frame) * 2 * h + u / 2) / b - 1
    numbers = {
        "eta_0": (max(eta_0, 0.0), "1", "prestress over the weight of the wall"),
        "effective_period": (effective, "s", "period with the secant stiffness"),
        "force_over_m_w_g": (force, "1", "required force over the weight of the wall"),
        "frame_force_over_m_w_g": (frame, "1", "force of the frame over the weight of the wall"),
    }
    return xr.Dataset(
        {
            name: ((), value, {"units": units, "long_name": text})
            for name, (value, units, text) in numbers.items()
        }
    )


def _median(records: Sequence[RecordFile], period: float, damping: float, g: float) -> float:
    """Return the median displacement of the oscillator [m]."""
    kind = "pseudo_acceleration"
    levels = [intensity(item, kind, period=period, damping=damping, g=g) for item in records]
    return float(np.median(levels)) * (period / (2 * math.pi)) ** 2


def _crossing(spectrum: np.ndarray, i: int, u: float) -> float:
    """Return the period at which the spectrum reaches a displacement."""
    if i == 0:
        return float(_PERIODS[0])
    ends = slice(i - 1, i + 1)
    return float(np.interp(u, spectrum[ends], _PERIODS[ends]))
