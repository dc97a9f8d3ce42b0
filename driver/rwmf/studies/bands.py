"""Sensitivity bands: ranges of a spectrum for uncertain restitution and post-tension."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Unpack

import xarray as xr

from rwmf._arguments import case_of, checked
from rwmf._sweep.axes import keys_of_axis, name_axes
from rwmf._sweep.computation import SweepOptions, sweep
from rwmf._sweep.kept_quantities import find_quantity
from rwmf._sweep.record_sets import RecordFile
from rwmf.case import Case, CaseLike
from rwmf.errors import InputError
from rwmf.studies.statistics import with_overturning

__all__ = ["sensitivity_bands"]

# quantities of cable force over the weight of the wall
_TENSIONS = ("eta_0", "eta_alpha", "eta_y")


@checked
def sensitivity_bands(
    case: CaseLike,
    grid: Mapping[str, object],
    uncertain: Mapping[str, object],
    records: Sequence[str | RecordFile] = (),
    quantities: str | Sequence[str] | None = None,
    **sweep_options: Unpack[SweepOptions],
) -> xr.Dataset:
    """Compute the range of a response over uncertain parameters.

    Parameters
    ----------
    case : Case or path
        The structure with its nominal values.
    grid : mapping
        ``T_s`` [s], ``gamma`` [-] and others as for `rwmf.sweep`.
    uncertain : mapping
        Values of the uncertain parameters, for example ``e`` and ``eta``.
    records : sequence of str or RecordFile
        Ground motions, otherwise that of the case.
    quantities : str, optional
        The response; otherwise ``u_s_max``, or ``theta_max_over_alpha`` for a wall without a frame.
    **sweep_options
        Further arguments of `rwmf.sweep`.

    Returns
    -------
    xarray.Dataset
        ``lowest``, ``highest`` and ``nominal`` [the quantity's unit]; the highest is infinite where
        a wall overturned.

    Raises
    ------
    InputError
        When the case or the grid is not acceptable, or when no parameter is uncertain.
    """
    case = case_of(case)
    if not uncertain:
        raise InputError(
            "bands: nothing is uncertain: give values of a key that the scene has, such as e, eta "
            "(with a cable) or frame.xi_s"
        )
    quantity = find_quantity(case, quantities, "bands")
    clear, vague = name_axes(grid), name_axes(uncertain)
    both = [name for name in vague if name in clear]
    if both:
        raise InputError(f"bands: {both[0]}: is in the grid and uncertain")
    # an uncertain factor replaces the rule of the case
    own_loss = {"impact.e", "impact.r"} & set(vague) and "impact" in case.groups
    varied = case.without("impact") if own_loss else case
    if any(group == "cable" and key in _TENSIONS for name in vague
           for group, key in keys_of_axis(name)):  # fmt: skip
        varied = _with_tensions(varied)
    found = sweep(varied, vague | clear, records, quantities=(quantity,), **sweep_options)
    values = with_overturning(found, quantity)
    over = [name for name in values.dims if name in {name.split(".")[-1] for name in vague}]
    plain = sweep(case, grid, records, quantities=(quantity,), **sweep_options)
    bands = {
        "lowest": values.min(over),
        "highest": values.max(over),
        "nominal": with_overturning(plain, quantity),
    }
    labelled = {name: band.assign_attrs(found[quantity].attrs) for name, band in bands.items()}
    return xr.Dataset(labelled, attrs=found.attrs | {"quantity": quantity})


def _with_tensions(case: Case) -> Case:
    """Return the case with the ratios of its cable instead of strands and stresses."""
    cable = case.cable
    if cable is None or not cable.derived:
        return case
    changes: dict[str, object] = dict.fromkeys(cable.given - {"law", "hardening", "rupture_strain"})
    changes |= {key: cable[key] for key in _TENSIONS if key in cable}
    if "rupture_strain" in cable.given and "length" in cable.given:
        # the strain refers to the length of the strands, or without them to the wall's height
        changes["rupture_strain"] = cable.rupture_strain * cable.length / (2 * case.wall.h)
    return case.replace(cable=changes)
