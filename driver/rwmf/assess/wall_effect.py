"""Effect of the wall: ratios of responses with and without it; restitution of a base."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Unpack

import numpy as np
import xarray as xr

from rwmf.assess.table import with_overturning
from rwmf.case import CaseLike
from rwmf.case.arguments import case_of, checked
from rwmf.case.case import groups_of_wall
from rwmf.errors import InputError
from rwmf.kernel.numbers import to_number
from rwmf.motion.record_sets import RecordFile
from rwmf.run.quantities import ORDINATES, find_quantities
from rwmf.run.simulation import NO_ACCURACY, simulate
from rwmf.sweeps.axes import keys_of_axis, name_axes
from rwmf.sweeps.computation import SweepOptions, sweep


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
    known = case_of(case)
    if known.base is None:
        raise InputError("restitution: the case must have the group &base")
    start = to_number("start", start, above=0.0, below=1.0)
    h, b, g = known.wall.h, known.wall.b, known.model.g
    pace = math.sqrt(3 * g / (4 * math.hypot(h, b)))
    free: Any = known.replace(
        motion={"kind": "none"},
        initial={"theta_over_alpha": start, "theta_dot": None},
        solver={"t_end": 20 / pace, "rtol": 1e-9, **NO_ACCURACY},
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


# responses of storeys; the first one applies to any frame
_RESPONSES = ("u_s_max", "storey_drift_max", "floor_acceleration_max_g")


@checked
def wall_effect(
    case: CaseLike,
    grid: Mapping[str, object],
    records: Sequence[str | RecordFile] = (),
    quantities: str | Sequence[str] | None = None,
    **sweep_options: Unpack[SweepOptions],
) -> xr.Dataset:
    """Compare the responses of the frame with and without the wall.

    A wall may lower one response and raise another, so compare several responses.

    Parameters
    ----------
    case : Case or path
        Frame and wall.
    grid : mapping
        ``T_s`` [s], ``gamma`` [-] and others as for `rwmf.sweep`.
    records : sequence of str or RecordFile
        Ground motions, otherwise that of the case.
    quantities : str or sequence of str, optional
        The compared responses; otherwise ``u_s_max``, and for storeys also ``storey_drift_max`` and
        ``floor_acceleration_max_g``.
    **sweep_options
        Further arguments of `rwmf.sweep`.

    Returns
    -------
    xarray.Dataset
        For each response ``QUANTITY`` with the wall, ``QUANTITY_alone`` without it, and their ratio
        ``QUANTITY_ratio`` [-]; ``ratio`` is that of the first response. Responses are infinite
        after overturning or collapse: the ratio is 0 where the frame alone collapsed, NaN where
        both did. The frame is the same with and without the wall at each period. The
        first period of storeys therefore changes where the wall kept them on a straight line.

    Raises
    ------
    InputError
        When the case or the grid is not acceptable, or when there is no frame.
    """
    case = case_of(case)
    if case.frame is None:
        raise InputError(
            "wall effect: the case has no &frame whose displacement the wall could change. For the "
            "rotation of a free-standing wall use rwmf spectrum or rwmf sweep"
        )
    usual = _RESPONSES if case.storeys is not None else _RESPONSES[:1]
    names = tuple(find_quantities(tuple(quantities or usual)))
    of_wall = [name for name in names if ORDINATES[name].group in groups_of_wall()]
    if of_wall:
        raise InputError(f"wall effect: {of_wall[0]}: the frame alone has no such response")
    both = sweep(case, grid, records, quantities=names, **sweep_options)
    frame = case.without_wall()
    joined, free = (item.kernel.axes()["T_s"].value for item in (case, frame))
    # a period in the grid is that of the frame restrained by the wall
    factor = free / joined if free and joined else 1.0
    shared = _shared_axes(grid) | {"T_s": factor * both["T_s"].values}
    alone = sweep(frame, shared, records, quantities=names, **sweep_options)
    alone = alone.assign_coords(T_s=both["T_s"])
    found: dict[str, xr.DataArray] = {}
    for name in names:
        response, plain = with_overturning(both, name), with_overturning(alone, name)
        text = f"{ORDINATES[name].meaning}: with the wall over without it"
        ratio = (response / plain).assign_attrs(units="1", long_name=text)
        found |= {f"{name}_ratio": ratio, name: response, f"{name}_alone": plain}
    attributes = both.attrs | {"quantities": " ".join(names)}
    return xr.Dataset({"ratio": found[f"{names[0]}_ratio"]} | found, attrs=attributes)


def _shared_axes(grid: Mapping[str, object]) -> dict[str, object]:
    """Return the axes that affect the frame alone: ground motion, period, damping, and so on."""
    of_wall = groups_of_wall()
    return {
        name: values
        for name, values in name_axes(grid).items()
        if name != "gamma" and not any(group in of_wall for group, _ in keys_of_axis(name))
    }
