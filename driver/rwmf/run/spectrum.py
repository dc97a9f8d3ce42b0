"""Response spectra: from a case and a grid of parameters to labelled arrays."""

from __future__ import annotations

import re
from collections.abc import Sequence

import xarray as xr

from rwmf.case import Case, CaseLike
from rwmf.case.arguments import case_of, checked
from rwmf.errors import InputError
from rwmf.kernel import results, tables
from rwmf.kernel.numbers import Array, to_array
from rwmf.kernel.progress import Progress, Reports, reporting
from rwmf.run.quantities import AXES, QUANTITIES, find, keys_of
from rwmf.run.response import dataset

Values = Sequence[float] | Array | float


@checked
def spectrum(
    case: CaseLike,
    T_s: Values | None = None,
    gamma: Values | None = None,
    b: Values | None = None,
    threads: int = 0,
    progress: Reports = None,
    quantities: str | Sequence[str] | None = None,
) -> xr.Dataset:
    """Compute the largest displacement of the frame, or other quantities, over periods.

    For a frame of storeys T_s is the first period, and all stiffnesses scale with it; gamma scales
    all masses and stiffnesses. A wall without a frame has the period 2 pi/p of a block of the same
    slenderness, p = sqrt(3 g/(4 R)). T_s then sets the wall's size. The labels of the axes give
    these definitions.

    Parameters
    ----------
    case : Case or path
        The case.
    T_s : float or sequence of float, optional
        Periods [s]; otherwise those of the case's `&spectrum`.
    gamma : float or sequence of float, optional
        Mass ratios [-]; otherwise those of `&spectrum`, or the one of `&frame`.
    b : float or sequence of float, optional
        Half widths of the wall [m]; otherwise those of `&spectrum`, or the one of `&wall`. Without
        a frame b and the height of the case set the slenderness, and then the period sets the size.
    threads : int
        Threads of the kernel, 0 for all. The result does not depend on it. The limits are 256
        threads and 16 for each processor.
    progress : callable or bool, optional
        True for a bar in a notebook or terminal. A function is called about 20 times a second with
        the numbers of finished and of all ordinates.
    quantities : str or sequence of str, optional
        Requested quantities by names or keys of reference/outputs.md; otherwise those of
        `&spectrum`. The default is ``u_s_max``, and without a frame ``theta_max_over_alpha``.

    Returns
    -------
    xarray.Dataset
        The quantities, ``u_s_max`` [m], and ``status`` over (b, gamma, T_s), for the bare frame
        over T_s, for a wall without a frame over (b, T_s). A failed ordinate is NaN, and its status
        names the reason. Counts, and flags as 1 or 0, are numbers; the time of an event that did
        not occur is NaN. The attribute ``warnings`` lists the conservation laws that the case
        violates.

    Raises
    ------
    InputError
        When the case, the grid or a quantity is not acceptable.
    Interrupted
        After Ctrl-C.
    """
    case = case_of(case)
    keys = [] if quantities is None else keys_of(_without_second_names(quantities))
    # words that are distinct within the length of a key
    words = {key.lower() for key in keys if re.fullmatch(r"\w{1,52}", key, re.ASCII)}
    if quantities is not None and not 0 < len(keys) == len(words):
        _refuse(case, keys)
    if keys:
        keys += [key for key in case.kernel.limited_demands() if key not in keys]
    try:
        with (
            reporting(progress, "ordinate") as report,
            start(with_grid(case, T_s, gamma, b), threads, report, keys) as sweep,
        ):
            return to_dataset(sweep)
    except InputError:
        if keys:
            _refuse(case, keys)
        raise


def _without_second_names(words: Sequence[str]) -> list[str]:
    """Drop the second name of a quantity that is requested by both: a dataset has both."""
    seen: dict[str, str] = {}
    first = []
    for word, key in zip(words, keys_of(words), strict=True):
        name = find(key).called(word) if key in QUANTITIES else word
        if seen.setdefault(key, name) == name or key not in QUANTITIES:
            first.append(word)
    return first


def _refuse(case: Case, keys: Sequence[str]) -> None:
    """Have the kernel read the quantities as text, for a message with place and reason."""
    with start(with_grid(case, T_s=1.0, quantities=keys)):
        pass


def start(
    case: Case,
    threads: int = 0,
    progress: Progress | None = None,
    quantities: Sequence[str] = (),
) -> results.Spectrum:
    """Compute a case's spectrum and keep it in the kernel until the end of a ``with`` block."""
    total = case.kernel.ordinates()
    report = None if progress is None else lambda done: progress(done, total)
    return results.start_spectrum(case.kernel, case.label, threads, report, quantities)


def to_dataset(sweep: results.Spectrum) -> xr.Dataset:
    """Label the kernel's spectrum."""
    values = sweep.values()
    facts = sweep.facts()
    axes = sweep.case.axes()
    coordinates = {
        name: ((name,), values[name], {"units": item.unit, "long_name": item.meaning})
        for name, item in axes.items()
    }
    dims = tuple(axes)
    # an axis that the scene lacks has one position
    place = tuple(slice(None) if name in axes else 0 for name in AXES)
    values = {name: array[place] for name, array in values.items() if name not in AXES}
    status = values.pop("status")
    found = {key: find(key) for key in values}
    variables = {
        name: (dims, values[key], item.attributes)
        for key, item in found.items()
        for name in item.names("ordinate") or (key,)
    }
    return dataset(
        variables | {"status": (dims, status, {})},
        coordinates,
        {
            "version": tables.version(),
            "method": sweep.case.spectrum_method(),
            "seconds": float(facts["seconds"]),
            "threads": int(facts["threads"]),
            "rhs_evaluations": int(facts["rhs_evaluations"]),
            "warnings": "\n".join(sweep.warnings()),
        },
    )


def with_grid(
    case: Case,
    T_s: Values | None = None,
    gamma: Values | None = None,
    b: Values | None = None,
    quantities: Sequence[str] | None = None,
) -> Case:
    """Return the case with another grid, or other quantities, in its `&spectrum`."""
    # a list of periods replaces the uniform grid
    uniform = () if T_s is None else ("T_s_min", "T_s_max", "n", "spacing")
    grid: dict[str, Array | list[str] | None] = dict.fromkeys(uniform)
    for name, values in (("T_s", T_s), ("gamma", gamma), ("b", b)):
        if values is not None:
            grid[name] = to_array(name, values, least=1)
    if quantities is not None:
        grid["quantities"] = keys_of(quantities)
    return case.replace(spectrum=grid) if grid else case
