"""Seismic effect of the wall: displacement of the frame with the wall over that without it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Unpack

import numpy as np
import xarray as xr

from rwmf import _library
from rwmf._arguments import case_of, checked
from rwmf._sweep.axes import keys_of_axis, name_axes
from rwmf._sweep.computation import SweepOptions, sweep
from rwmf._sweep.kept_quantities import QUANTITIES, find_quantities
from rwmf._sweep.record_sets import RecordFile
from rwmf.case import Case, CaseLike
from rwmf.errors import InputError
from rwmf.studies.statistics import with_overturning

__all__ = ["wall_effect", "without_wall"]

# responses of storeys, the first one of any frame
_RESPONSES = ("u_s_max", "storey_drift_max", "floor_acceleration_max_g")


def without_wall(case: CaseLike) -> Case:
    """Return the frame alone, a linear oscillator.

    Parameters
    ----------
    case : Case or path
        A case with a frame.

    Returns
    -------
    Case
        Without wall, cable and impacts; a height that was the wall's unless given stays. Storeys
        that the wall kept on a straight line move in their first mode, or in all of them where
        they yield one by one.

    Raises
    ------
    InputError
        When the case has no frame.
    """
    case = case_of(case)
    if case.frame is None:
        raise InputError("the case has no &frame: nothing is left without the wall")
    gone = {name: None for name in case.groups if name in _groups_of_wall()}
    spectrum = {"spectrum": {"gamma": None, "b": None}} if "spectrum" in case.groups else {}
    output = {"output": {"friction_limit": None}} if "output" in case.groups else {}
    return case.replace(
        **gone,
        **spectrum,
        **output,
        **_free_floors(case),
        **_heights_of_wall(case, gone),
        frame={"gamma": None},
    )


def _free_floors(case: Case) -> dict[str, dict[str, str]]:
    """Choose how storeys move that no wall keeps on a straight line."""
    if case.storeys is None or case.storeys.coupling != "every_floor":
        return {}
    one_by_one = case.yielding is not None and "storey_u_y" in case.yielding
    return {"storeys": {"coupling": "full" if one_by_one else "reduced"}}


def _heights_of_wall(case: Case, gone: Mapping[str, object]) -> dict[str, dict[str, float]]:
    """Find the keys that are 2h unless given; storeys have heights of their own."""
    if case.wall is None or "storeys" in case.groups:
        return {}
    return {
        row.group: {row.key: 2 * case.wall.h}
        for row in _library.schema()
        if row.default == "2h" and row.group in case.groups and row.group not in gone
        if row.key not in case.groups[row.group].given
    }


@checked
def wall_effect(
    case: CaseLike,
    grid: Mapping[str, object],
    records: Sequence[str | RecordFile] = (),
    quantities: str | Sequence[str] | None = None,
    **how: Unpack[SweepOptions],
) -> xr.Dataset:
    """Compare the frame with the wall to the frame alone.

    A wall may lower one response and raise another: judge it by several.

    Parameters
    ----------
    case : Case or path
        Frame and wall.
    grid : mapping
        ``T_s`` [s], ``gamma`` [-] and others as for `rwmf.sweep`.
    records : sequence of str or RecordFile
        Ground motions, otherwise the case's own.
    quantities : str or sequence of str, optional
        The compared responses; otherwise ``u_s_max``, of storeys ``storey_drift_max`` and
        ``floor_acceleration_max_g`` as well.
    **how
        Further arguments of `rwmf.sweep`.

    Returns
    -------
    xarray.Dataset
        Of each response with the wall ``QUANTITY``, without it ``QUANTITY_alone`` and
        ``QUANTITY_ratio`` [-], the former over the latter; ``ratio`` is that of the first. The
        ratio is infinite where the wall overturned. The frame alone is the same frame at each
        period: the first period of storeys that the wall keeps on a straight line is another one
        without it.

    Raises
    ------
    InputError
        When the case or the grid is not acceptable, or when there is no frame.
    """
    case = case_of(case)
    if case.frame is None:
        raise InputError(
            "wall effect: the case has no &frame whose displacement the wall could change; the "
            "rotation of a wall that stands freely: rwmf spectrum, or rwmf study spectra"
        )
    names = tuple(find_quantities(tuple(quantities or _usual_responses(case))))
    of_wall = [name for name in names if QUANTITIES[name].group in _groups_of_wall()]
    if of_wall:
        raise InputError(f"wall effect: {of_wall[0]}: the frame alone has no such response")
    both = sweep(case, grid, records, quantities=names, **how)
    frame = without_wall(case)
    joined, free = (item.kernel.axes()["T_s"].value for item in (case, frame))
    # a period that the grid gives is that of the frame as the wall lets it move
    factor = free / joined if free and joined else 1.0
    shared = _shared_axes(grid) | {"T_s": factor * both["T_s"].values}
    alone = sweep(frame, shared, records, quantities=names, **how)
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
    """Take the axes that act on the frame alone: ground motion, period, damping, and so on."""
    of_wall = _groups_of_wall()
    return {
        name: values
        for name, values in name_axes(grid).items()
        if name != "gamma" and not any(group in of_wall for group, _ in keys_of_axis(name))
    }


def _groups_of_wall() -> set[str]:
    """Name the wall, and what is nothing without it."""
    return {name for name, needs in _library.needs_of_groups().items() if {name, *needs} & {"wall"}}
