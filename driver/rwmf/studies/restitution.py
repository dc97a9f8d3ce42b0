"""Restitution that a base gives: a block let go on it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from rwmf._arguments import case_of, checked
from rwmf._numbers import to_number
from rwmf._simulation import simulate
from rwmf.case import CaseLike
from rwmf.errors import InputError

if TYPE_CHECKING:
    import xarray as xr


@checked
def restitution(case: CaseLike, *, start: float = 0.5) -> xr.Dataset:
    """Compute the equivalent velocity factor of a wall on `&base` that is let go.

    The factor is that of impacts on rigid corners with the same ratio of two successive rotations
    (Housner 1963): ``e**2 = (1 - (1 - r_1)**2) / (1 - (1 - r_0)**2)`` with ``r = |theta|/alpha``.

    Parameters
    ----------
    case : Case or path
        Case with ``&wall`` and ``&base``. Its motion is not used.
    start : float, default 0.5
        First rotation over the slenderness, between 0 and 1 [-].

    Returns
    -------
    xarray.Dataset
        ``e``, ``e_housner`` (a free block), ``theta_max_over_alpha`` of the next swing [-] and
        ``half_period`` between the two rotations [s].

    Raises
    ------
    InputError
        The case has no base, the start is out of range, or the wall does not swing back.

    Examples
    --------
    >>> import rwmf
    >>> case = rwmf.Case.from_text('''
    ... &wall h=2.0, b=0.5 / &base k_t_over_m_w=2.0e4, xi=0.2 /
    ... &motion kind='none' / &solver t_end=1.0 /''')
    >>> round(float(rwmf.studies.restitution(case).e), 3)
    0.982
    """
    import xarray as xr

    known = case_of(case)
    if known.base is None:
        raise InputError("restitution: the case must have the group &base")
    start = to_number("start", start, above=0.0, below=1.0)
    h, b, g = known.wall.h, known.wall.b, known.model.g
    pace = math.sqrt(3 * g / (4 * math.hypot(h, b)))
    free: Any = known.replace(
        motion={"kind": "none"},
        initial={"theta_over_alpha": start},
        solver={"t_end": 20 / pace, "rtol": 1e-9},
        output={"dt": 0.002 / pace, "reactions": False, "conditioning": False},
    )
    response = simulate(free)
    theta = response["theta"].values / math.atan2(b, h)
    swing = np.flatnonzero(theta < 0)
    back = np.flatnonzero(theta[swing[0] :] > 0) if swing.size else swing
    if not back.size:
        raise InputError("restitution: the wall does not swing back from theta < 0 within 20/p")
    last = int(swing[0] + np.argmin(theta[swing[0] : swing[0] + back[0]]))
    rotation = -float(theta[last])
    factor = math.sqrt((1 - (1 - rotation) ** 2) / (1 - (1 - start) ** 2))
    return xr.Dataset(
        {
            "e": factor,
            "e_housner": 1 - 1.5 * math.sin(math.atan2(b, h)) ** 2,
            "theta_max_over_alpha": rotation,
            "half_period": float(response["time"].values[last]),
        }
    )
