"""Displacement spectra: from a case and a grid of parameters to labelled arrays."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import xarray as xr

from rwmf import _library
from rwmf._arguments import case_of, checked
from rwmf._labels import dataset
from rwmf.case import Case, CaseLike
from rwmf.case.grid import Values, with_grid
from rwmf.errors import InputError
from rwmf.quantities import AXES, QUANTITIES, find, keys_of

__all__ = ["spectrum", "start", "to_dataset"]

Progress = Callable[[int, int], None]


@checked
def spectrum(
    case: CaseLike,
    T_s: Values | None = None,
    gamma: Values | None = None,
    b: Values | None = None,
    threads: int = 0,
    progress: Progress | None = None,
    quantities: str | Sequence[str] | None = None,
) -> xr.Dataset:
    """Compute the largest displacement of the frame, or more, over periods.

    The period of storeys is their first one, all stiffnesses follow it; gamma scales all their
    masses and stiffnesses. The period of a wall without a frame is 2 pi/p of a block of its
    slenderness, p = sqrt(3 g/(4 R)): its size follows. The labels of the axes say so.

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
        a frame they set the slenderness at the height of the case, before the period the size.
    threads : int
        Threads of the kernel, 0 for all. The result does not depend on it. More than 256, and than
        16 for each processor, are refused.
    progress : callable, optional
        Called about 20 times a second with the number of finished ordinates and of all.
    quantities : str or sequence of str, optional
        What is reported of each ordinate, by names or keys of reference/outputs.md; otherwise what
        `&spectrum` asks for, which is ``u_s_max`` when it says nothing, without a frame
        ``theta_max_over_alpha``.

    Returns
    -------
    xarray.Dataset
        The quantities, ``u_s_max`` [m], and ``status`` over (b, gamma, T_s), for the bare frame
        over T_s, for a wall without a frame over (b, T_s). An ordinate that failed is NaN, its
        status the name of the reason. Counts and yes (1) or no (0) are numbers; what has not
        happened has no time, NaN. Its attribute ``warnings`` says what the case does not conserve.

    Raises
    ------
    InputError
        When the case, the grid or a quantity is not acceptable.
    Interrupted
        After Ctrl-C.
    """
    case = case_of(case)
    keys = [] if quantities is None else keys_of(_without_second_names(quantities))
    if quantities is not None and not (keys and _can_be_told_apart(keys)):
        _refuse(case, keys)
    try:
        with start(with_grid(case, T_s, gamma, b), threads, progress, keys) as sweep:
            return to_dataset(sweep)
    except InputError:
        if keys:
            _refuse(case, keys)
        raise


def _without_second_names(words: Sequence[str]) -> list[str]:
    """Leave out the second name of a quantity where both are requested: a dataset has both."""
    seen: dict[str, str] = {}
    first = []
    for word, key in zip(words, keys_of(words), strict=True):
        name = find(key).called(word) if key in QUANTITIES else word
        if seen.setdefault(key, name) == name or key not in QUANTITIES:
            first.append(word)
    return first


def _can_be_told_apart(keys: Sequence[str]) -> bool:
    """Tell whether these are different words, as long as keys may be."""
    words = [key.lower() for key in keys if re.fullmatch(r"\w{1,40}", key, re.ASCII)]
    return len(set(words)) == len(keys)


def _refuse(case: Case, keys: Sequence[str]) -> None:
    """Let the kernel read quantities as text, which says where and why one is not acceptable."""
    with start(with_grid(case, T_s=1.0, quantities=keys)):
        pass


@contextmanager
def start(
    case: Case,
    threads: int = 0,
    progress: Progress | None = None,
    quantities: Sequence[str] = (),
) -> Iterator[_library.Spectrum]:
    """Compute a case's spectrum and keep it in the kernel until the ``with`` block is left.

    Parameters
    ----------
    case : Case
        A case with `&spectrum`.
    threads : int
        Threads of the kernel, 0 for all.
    progress : callable, optional
        As in `spectrum`.
    quantities : sequence of str
        Keys of what is reported; none: what the case asks for.

    Yields
    ------
    Spectrum
        Values, facts, and the file of the batch program.

    Raises
    ------
    InputError, Interrupted
        As `spectrum`.
    """
    total = case.kernel.ordinates()
    report = None if progress is None else lambda done: progress(done, total)
    with _library.start_spectrum(case.kernel, case.label, threads, report, quantities) as sweep:
        yield sweep


def to_dataset(sweep: _library.Spectrum) -> xr.Dataset:
    """Label the kernel's spectrum.

    Parameters
    ----------
    sweep : Spectrum
        From `start`.

    Returns
    -------
    xarray.Dataset
        As `spectrum` returns it.
    """
    values = sweep.values()
    facts = sweep.facts()
    axes = sweep.axes()
    coordinates = {
        name: ((name,), values[name], {"units": item.unit, "long_name": item.meaning})
        for name, item in axes.items()
    }
    dims = tuple(axes)
    # an axis that the scene does not have has one position
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
            "version": _library.version(),
            "method": sweep.method(),
            "seconds": float(facts["seconds"]),
            "threads": int(facts["threads"]),
            "rhs_evaluations": int(facts["rhs_evaluations"]),
            "warnings": "\n".join(sweep.warnings()),
        },
    )
