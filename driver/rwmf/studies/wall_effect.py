"""Seismic effect of the wall: displacement of the frame with the wall over that without it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Unpack

import numpy as np
import xarray as xr

from rwmf import _library
from rwmf._sweep.axes import keys_of_axis, name_axes
from rwmf._sweep.record_sets import RecordFile
from rwmf._sweep.run import SweepOptions, sweep
from rwmf.case import Case
from rwmf.errors import InputError
from rwmf.studies.statistics import with_overturning

__all__ = ["wall_effect", "without_wall"]


def without_wall(case: Case) -> Case:
    """Return the frame alone, a linear oscillator.

    Parameters
    ----------
    case : Case
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
        group: {key: 2 * case.wall.h}
        for group, key, _, _, default, *_ in _library.schema()
        if default == "2h" and group in case.groups and group not in gone
        if key not in case.groups[group].given
    }


def wall_effect(
    case: Case,
    grid: Mapping[str, object],
    records: Sequence[str | RecordFile] = (),
    **how: Unpack[SweepOptions],
) -> xr.Dataset:
    """Compare the frame with the wall to the frame alone.

    Parameters
    ----------
    case : Case
        Frame and wall.
    grid : mapping
        ``T_s`` [s], ``gamma`` [-] and others as for `rwmf.sweep`.
    records : sequence of str or RecordFile
        Ground motions, otherwise the case's own.
    **how
        Further arguments of `rwmf.sweep`.

    Returns
    -------
    xarray.Dataset
        ``ratio`` [-], ``u_s_max`` [m] and ``u_s_max_alone`` [m]; the ratio is infinite where the
        wall overturned. The frame alone is the same frame at each period: the first period of
        storeys that the wall keeps on a straight line is another one without it.

    Raises
    ------
    InputError
        When the case or the grid is not acceptable, or when there is no frame.
    """
    if case.frame is None:
        raise InputError(
            "wall effect: the case has no &frame whose displacement the wall could change; the "
            "rotation of a wall that stands freely: rwmf spectrum, or rwmf study spectra"
        )
    both = sweep(case, grid, records, quantities=("u_s_max",), **how)
    frame = without_wall(case)
    joined, free = (item.kernel.axes()["T_s"].value for item in (case, frame))
    # a period that the grid gives is that of the frame as the wall lets it move
    factor = free / joined if free and joined else 1.0
    shared = _shared_axes(grid) | {"T_s": factor * both["T_s"].values}
    alone = sweep(frame, shared, records, quantities=("u_s_max",), **how)["u_s_max"]
    alone = alone.assign_coords(T_s=both["T_s"])
    response = with_overturning(both)
    ratio = (response / alone).assign_attrs(
        units="1", long_name="displacement with the wall over that without it"
    )
    return xr.Dataset(
        {"ratio": ratio, "u_s_max": response, "u_s_max_alone": alone.astype(np.float64)},
        attrs=both.attrs,
    )


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
