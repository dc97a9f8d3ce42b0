"""Response spectra of a suite of records: percentiles over the records."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Unpack

import xarray as xr

from rwmf._arguments import case_of, checked
from rwmf._sweep.computation import SweepOptions, sweep
from rwmf._sweep.kept_quantities import default_quantity, find_quantities
from rwmf._sweep.record_sets import RecordFile
from rwmf.case import CaseLike
from rwmf.studies.statistics import USUAL_PERCENTILES, percentiles, with_overturning

__all__ = ["suite_spectra"]


@checked
def suite_spectra(
    case: CaseLike,
    grid: Mapping[str, object],
    records: Sequence[str | RecordFile],
    quantities: str | Sequence[str] | None = None,
    q: Sequence[float] = USUAL_PERCENTILES,
    **sweep_options: Unpack[SweepOptions],
) -> xr.Dataset:
    """Compute spectra of every record and their percentiles.

    Parameters
    ----------
    case : Case or path
        The structure.
    grid : mapping
        ``T_s`` [s], ``gamma`` [-] and others as for `rwmf.sweep`.
    records : sequence of str or RecordFile
        The suite.
    quantities : str or sequence of str, optional
        'u_s_max' for displacement, 'theta_max_over_alpha' for rocking,
        'cable_force_increment_max_over_m_w_g' for cable force spectra, and others. The default is
        the displacement, or the rotation for a wall without a frame.
    q : sequence of float
        Percentages [%].
    **sweep_options
        Further arguments of `rwmf.sweep`.

    Returns
    -------
    xarray.Dataset
        The quantities over records, and ``QUANTITY_percentiles`` for each.

    Raises
    ------
    InputError
        When the case, the grid or a record is not acceptable.
    """
    case = case_of(case)
    names = list(find_quantities(tuple(quantities or (default_quantity(case),))))
    found = sweep(case, grid, records, quantities=names, **sweep_options)
    return found.assign(
        {f"{name}_percentiles": percentiles(with_overturning(found, name), q) for name in names}
    )
