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
        Without wall, cable and impacts; a height that was the wall's unless given stays.

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
        **gone, **spectrum, **output, **_heights_of_wall(case, gone), frame={"gamma": None}
    )


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
        wall overturned.

    Raises
    ------
    InputError
        When the case or the grid is not acceptable.
    """
    both = sweep(case, grid, records, **how)
    alone = sweep(without_wall(case), _shared_axes(grid), records, **how)["u_s_max"]
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
