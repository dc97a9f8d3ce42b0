"""Required friction and cable force over the frame's period, for the foundation design."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Unpack

import numpy as np
import xarray as xr

from rwmf._arguments import case_of, checked
from rwmf._sweep.axes import PAIRS, key_of_column, name_axes
from rwmf._sweep.computation import SweepOptions, sweep
from rwmf._sweep.record_sets import RecordFile
from rwmf.case import Case, CaseLike
from rwmf.errors import InputError
from rwmf.studies.statistics import with_overturning

__all__ = ["friction_spectra"]

DEMAND = "friction_demand_max"
CABLE = "cable_force_max_over_m_w_g"
_INCREMENT = "cable_force_increment_max_over_m_w_g"
# groups that a prestress in N depends on
_RATIO = ("wall", "cable", "model")
_IMPACT = "friction_demand_impact_max"
_FOUNDATION = (DEMAND, "pivot_normal_min_over_m_w_g", "base_shear_max_over_weight")


@checked
def friction_spectra(
    case: CaseLike,
    grid: Mapping[str, object],
    records: Sequence[str | RecordFile] = (),
    **sweep_options: Unpack[SweepOptions],
) -> xr.Dataset:
    """Compute required friction, pivot reaction, base shear and cable force for many frames.

    Parameters
    ----------
    case : Case or path
        A wall with or without a frame.
    grid : mapping
        ``T_s`` [s], ``gamma`` [-] and others as for `rwmf.sweep`.
    records : sequence of str or RecordFile
        Ground motions, otherwise that of the case.
    **sweep_options
        Further arguments of `rwmf.sweep`.

    Returns
    -------
    xarray.Dataset
        ``friction_demand_max`` [-], ``pivot_normal_min_over_m_w_g`` [-],
        ``base_shear_max_over_weight`` [-], for a wall that rocks ``friction_demand_impact_max``
        [-] and, with a cable, ``cable_force_max_over_m_w_g`` [-].
        Demand and cable force are infinite where the wall overturned; the demand is also infinite
        where the pivot loses its compression.

    Raises
    ------
    InputError
        When the case has no wall, or the grid or a record is not acceptable.
    """
    case = case_of(case)
    if case.wall is None:
        raise InputError("friction: the case has no &wall whose base could slide")
    wanted = list(_FOUNDATION)
    wanted += [] if case.impact is None else [_IMPACT]
    wanted += [] if case.cable is None else [_INCREMENT]
    found = sweep(case, grid, records, quantities=wanted, **sweep_options)
    found = found.assign({DEMAND: with_overturning(found, DEMAND)})
    if case.cable is None:
        return found
    force = with_overturning(found, _INCREMENT) + _prestress(case, found, grid)
    attributes = {"units": "1", "long_name": "largest cable force over weight of wall"}
    return found.drop_vars(_INCREMENT).assign({CABLE: force.assign_attrs(attributes)})


def _prestress(case: Case, found: xr.Dataset, grid: Mapping[str, object]) -> xr.DataArray | float:
    """Compute the prestress over the weight of the wall, along the axes that change it."""
    if "eta_0" in found.coords:
        return found["eta_0"]
    # for a prestress in N or Pa the weight may vary along an axis
    keys = [key_of_column(name) for name in ("b", *name_axes(grid)) if name not in PAIRS]
    axes = {key[1]: key for key in keys if key[0] in _RATIO and key[1] in found.dims}
    if not axes or "eta_0" not in case.cable.derived:
        return total(case.cable, case.cable.eta_0)
    values = np.empty([found.sizes[name] for name in axes])
    for place in np.ndindex(values.shape):
        changes: dict[str, dict[str, object]] = {}
        for (name, (group, key)), i in zip(axes.items(), place, strict=True):
            changes.setdefault(group, {})[key] = found[name].values[i].item()
        values[place] = case.replace(**changes).cable.eta_0
    return xr.DataArray(values, dims=[*axes])
