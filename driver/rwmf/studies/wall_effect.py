"""Seismic effect of the wall: ratio of the responses with and without it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Unpack

import numpy as np
import xarray as xr

from rwmf._arguments import case_of, checked
from rwmf._sweep.axes import keys_of_axis, name_axes
from rwmf._sweep.computation import SweepOptions, sweep
from rwmf._sweep.intensity import QUANTITIES, find_quantities
from rwmf._sweep.record_sets import RecordFile
from rwmf.case import Case, CaseLike
from rwmf.case.case import groups_of_wall
from rwmf.errors import InputError
from rwmf.studies.statistics import with_overturning

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
        ``QUANTITY_ratio`` [-]; ``ratio`` is that of the first response. The ratio is infinite where
        the wall overturned. The frame is the same with and without the wall at each period. The
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
    names = tuple(find_quantities(tuple(quantities or _usual_responses(case))))
    of_wall = [name for name in names if QUANTITIES[name].group in groups_of_wall()]
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
        response = with_overturning(both, name)
        plain = alone[name].astype(np.float64)
        text = f"{QUANTITIES[name].meaning}: with the wall over without it"
        ratio = (response / plain).assign_attrs(units="1", long_name=text)
        found |= {f"{name}_ratio": ratio, name: response, f"{name}_alone": plain}
    attributes = both.attrs | {"quantities": " ".join(names)}
    return xr.Dataset({"ratio": found[f"{names[0]}_ratio"]} | found, attrs=attributes)


def _usual_responses(case: Case) -> tuple[str, ...]:
    return _RESPONSES if case.storeys is not None else _RESPONSES[:1]


def _shared_axes(grid: Mapping[str, object]) -> dict[str, object]:
    """Return the axes that affect the frame alone: ground motion, period, damping, and so on."""
    of_wall = groups_of_wall()
    return {
        name: values
        for name, values in name_axes(grid).items()
        if name != "gamma" and not any(group in of_wall for group, _ in keys_of_axis(name))
    }
