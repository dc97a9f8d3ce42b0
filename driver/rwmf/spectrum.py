"""Displacement spectra: from a case and a grid of parameters to labelled arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
import numpy.typing as npt
import xarray as xr

from rwmf import _library
from rwmf.case import Case
from rwmf.quantities import AXES, find, keys_of

__all__ = ["count_ordinates", "spectrum", "start", "to_dataset", "with_grid"]

Values = Sequence[float] | npt.NDArray[np.float64] | float
Progress = Callable[[int, int], None]


def spectrum(
    case: Case,
    T_s: Values | None = None,
    gamma: Values | None = None,
    b: Values | None = None,
    threads: int = 0,
    progress: Progress | None = None,
    quantities: Sequence[str] | None = None,
) -> xr.Dataset:
    """Compute the largest displacement of the frame, or more, over frame periods.

    Parameters
    ----------
    case : Case
        The case.
    T_s : float or sequence of float, optional
        Frame periods [s]; otherwise those of the case's `&spectrum`.
    gamma : float or sequence of float, optional
        Mass ratios [-]; otherwise those of `&spectrum`, or the one of `&frame`.
    b : float or sequence of float, optional
        Half widths of the wall [m]; otherwise those of `&spectrum`, or the one of `&wall`.
    threads : int
        Threads of the kernel, 0 for all. The result does not depend on it. More than 256, and than
        16 for each processor, are refused.
    progress : callable, optional
        Called about 20 times a second with the number of finished ordinates and of all.
    quantities : sequence of str, optional
        What is reported of each ordinate, by names or keys of reference/outputs.md; otherwise what
        `&spectrum` asks for, which is ``u_s_max`` when it says nothing.

    Returns
    -------
    xarray.Dataset
        The quantities, ``u_s_max`` [m], and ``status`` over (b, gamma, T_s), for the bare frame
        over T_s. An ordinate that failed is NaN, its status the name of the reason. Counts and yes
        (1) or no (0) are numbers; what has not happened has no time, NaN.

    Raises
    ------
    InputError
        When the case, the grid or a quantity is not acceptable.
    Interrupted
        After Ctrl-C.
    """
    case = with_grid(case, T_s, gamma, b, quantities)
    with start(case, threads, progress) as sweep:
        return to_dataset(sweep)


def with_grid(
    case: Case,
    T_s: Values | None = None,
    gamma: Values | None = None,
    b: Values | None = None,
    quantities: Sequence[str] | None = None,
) -> Case:
    """Return the case with another grid, or other quantities, in its `&spectrum`.

    Parameters
    ----------
    case : Case
        The case.
    T_s, gamma, b : float or sequence of float, optional
        As in `spectrum`; None leaves what the case has.
    quantities : sequence of str, optional
        Likewise.

    Returns
    -------
    Case
        The edited case, or the same one when there is nothing to edit.

    Raises
    ------
    InputError
        When the grid is not acceptable.
    """
    grid: dict[str, list[float] | list[str] | None] = {}
    if T_s is not None:
        # the list takes the place of the whole uniform grid
        grid |= dict.fromkeys(("T_s_min", "T_s_max", "n", "spacing"))
        grid["T_s"] = _floats(T_s)
    if gamma is not None:
        grid["gamma"] = _floats(gamma)
    if b is not None:
        grid["b"] = _floats(b)
    if quantities is not None:
        grid["quantities"] = keys_of(quantities)
    return case.replace(spectrum=grid) if grid else case


@contextmanager
def start(
    case: Case, threads: int = 0, progress: Progress | None = None
) -> Iterator[_library.Sweep]:
    """Compute a case's spectrum and keep it in the kernel until the ``with`` block is left.

    Parameters
    ----------
    case : Case
        A case with `&spectrum`.
    threads : int
        Threads of the kernel, 0 for all.
    progress : callable, optional
        As in `spectrum`.

    Yields
    ------
    Sweep
        Values, facts, and the file of the batch program.

    Raises
    ------
    InputError, Interrupted
        As `spectrum`.
    """
    total = count_ordinates(case)
    report = None if progress is None else lambda done: progress(done, total)
    with _library.start_spectrum(case.kernel, case.kernel_source(), threads, report) as sweep:
        yield sweep


def count_ordinates(case: Case) -> int:
    """Count the simulations of a case's spectrum.

    Parameters
    ----------
    case : Case
        The case.

    Returns
    -------
    int
        Their number, 0 without `&spectrum`.
    """
    grid = case.groups.get("spectrum")
    if grid is None:
        return 0
    periods = len(grid["T_s"]) if "T_s" in grid else int(grid["n"])
    return periods * len(grid.get("gamma", (0,))) * len(grid.get("b", (0,)))


def to_dataset(sweep: _library.Sweep) -> xr.Dataset:
    """Label the kernel's spectrum.

    Parameters
    ----------
    sweep : Sweep
        From `start`.

    Returns
    -------
    xarray.Dataset
        As `spectrum` returns it.
    """
    values = sweep.values()
    facts = sweep.facts()
    dims: tuple[str, ...] = ("b", "gamma", "T_s")
    coordinates = {name: (name, values.pop(name), item.attributes) for name, item in AXES.items()}
    if facts["bare"]:
        dims = ("T_s",)
        values = {name: array[0, 0] for name, array in values.items()}
        coordinates = {"T_s": coordinates["T_s"]}
    status = values.pop("status")
    found = {key: find(key) for key in values}
    variables = {item.variable: (dims, values[key], item.attributes) for key, item in found.items()}
    return xr.Dataset(
        variables | {"status": (dims, status)},
        coords=coordinates,
        attrs={
            "version": _library.version(),
            "seconds": float(facts["seconds"]),
            "threads": int(facts["threads"]),
            "rhs_evaluations": int(facts["rhs_evaluations"]),
        },
    )


def _floats(values: Values) -> list[float]:
    return np.atleast_1d(np.asarray(values, dtype=np.float64)).ravel().tolist()
