"""Required friction and cable force over the frame's period: what the foundation must provide."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Unpack

import xarray as xr

from rwmf._sweep.record_sets import RecordFile
from rwmf._sweep.run import SweepOptions, sweep
from rwmf.case import Case
from rwmf.errors import InputError
from rwmf.studies.statistics import with_overturning

__all__ = ["friction_spectra"]

DEMAND = "friction_demand_max"
CABLE = "cable_force_max_over_m_w_g"
_INCREMENT = "cable_force_increment_max_over_m_w_g"
_FOUNDATION = (DEMAND, "pivot_normal_min_over_m_w_g", "base_shear_max_over_weight")


def friction_spectra(
    case: Case,
    grid: Mapping[str, object],
    records: Sequence[str | RecordFile] = (),
    **how: Unpack[SweepOptions],
) -> xr.Dataset:
    """Compute required friction, pivot reaction, base shear and cable force for many frames.

    Parameters
    ----------
    case : Case
        A wall, with a frame or without.
    grid : mapping
        ``T_s`` [s], ``gamma`` [-] and others as for `rwmf.sweep`.
    records : sequence of str or RecordFile
        Ground motions, otherwise the case's own.
    **how
        Further arguments of `rwmf.sweep`.

    Returns
    -------
    xarray.Dataset
        ``friction_demand_max`` [-], ``pivot_normal_min_over_m_w_g`` [-],
        ``base_shear_max_over_weight`` [-] and, with a cable, ``cable_force_max_over_m_w_g`` [-].
        Demand and cable force are infinite where the wall overturned, the demand also where the
        pivot is not pressed on at some time.

    Raises
    ------
    InputError
        When the case has no wall, or the grid or a record is not acceptable.
    """
    if case.wall is None:
        raise InputError("friction: the case has no &wall whose base could slide")
    wanted = _FOUNDATION if case.cable is None else (*_FOUNDATION, _INCREMENT)
    found = sweep(case, grid, records, quantities=wanted, **how)
    found = found.assign({DEMAND: with_overturning(found, DEMAND)})
    if case.cable is None:
        return found
    force = with_overturning(found, _INCREMENT) + _prestress(case, found)
    attributes = {"units": "1", "long_name": "largest cable force over weight of wall"}
    return found.drop_vars(_INCREMENT).assign({CABLE: force.assign_attrs(attributes)})


def _prestress(case: Case, found: xr.Dataset) -> xr.DataArray | float:
    """Force at theta = 0 over the weight of the wall, which follows its width where it is in N."""
    if "eta_0" in found.coords:
        return found["eta_0"]
    if "b" in found.dims and "eta_0" in case.cable.derived:
        values = [float(case.replace(wall={"b": b}).cable.eta_0) for b in found["b"].values]
        return xr.DataArray(values, dims="b")
    return float(case.cable.eta_0)
