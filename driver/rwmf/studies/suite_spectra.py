"""Response spectra of a suite of records: percentiles over the records."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Unpack

import xarray as xr

from rwmf._sweep.quantities import default_quantity, find_quantities
from rwmf._sweep.record_sets import RecordFile
from rwmf._sweep.run import SweepOptions, sweep
from rwmf.case import Case
from rwmf.studies.statistics import USUAL_PERCENTILES, percentiles, with_overturning

__all__ = ["suite_spectra"]


def suite_spectra(
    case: Case,
    grid: Mapping[str, object],
    records: Sequence[str | RecordFile],
    quantity: str | None = None,
    q: Sequence[float] = USUAL_PERCENTILES,
    **how: Unpack[SweepOptions],
) -> xr.Dataset:
    """Compute spectra of every record and their percentiles.

    Parameters
    ----------
    case : Case
        The structure.
    grid : mapping
        ``T_s`` [s], ``gamma`` [-] and others as for `rwmf.sweep`.
    records : sequence of str or RecordFile
        The suite.
    quantity : str, optional
        'u_s_max' for displacement, 'theta_max_over_alpha' for rocking,
        'cable_force_increment_max_over_m_w_g' for cable force spectra, and others; otherwise the
        displacement, of a wall without a frame its rotation.
    q : sequence of float
        Percentages [%].
    **how
        Further arguments of `rwmf.sweep`.

    Returns
    -------
    xarray.Dataset
        The quantity over records, and ``QUANTITY_percentiles``.

    Raises
    ------
    InputError
        When the case, the grid or a record is not acceptable.
    """
    (quantity,) = find_quantities((quantity or default_quantity(case),))
    found = sweep(case, grid, records, quantities=(quantity,), **how)
    values = with_overturning(found, quantity)
    return found.assign({f"{quantity}_percentiles": percentiles(values, q)})
