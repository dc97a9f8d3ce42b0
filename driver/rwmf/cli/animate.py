"""What ``rwmf animate`` does: a film of one case."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from rwmf._files import files
from rwmf._simulation import simulate
from rwmf.case import Case
from rwmf.cli.progress import progress_bar
from rwmf.errors import InputError
from rwmf.plotting.animation import animate

__all__ = ["run"]


def run(options: argparse.Namespace) -> int:
    """Make the film.

    Parameters
    ----------
    options : argparse.Namespace
        As the parser of the command line makes them.

    Returns
    -------
    int
        Exit status.

    Raises
    ------
    InputError, NumericalError, OutputError, Interrupted
        As the computation and the writers of files.
    """
    case = Case.from_namelist(options.case)
    path = Path(options.out or f"{Path(options.case).stem}.gif")
    _check(case, options, path)
    response = simulate(case, dt=options.speed / options.fps)
    # the film ends where the wall has overturned
    shown = np.isfinite(response["theta"].values)
    if options.until is not None:
        shown &= response["time"].values <= options.until
    response = response.isel(time=shown)
    with progress_bar(response.sizes["time"]) as report:
        factor = animate(case, response, path, options.fps, report)
    print(f"written: {path}, {response.sizes['time']} frames, rotations drawn {factor:g} times")
    return 0


def _check(case: Case, options: argparse.Namespace, path: Path) -> None:
    """Complain before the computation, not after it."""
    if case.wall is None:
        raise InputError(f"{options.case}: without &wall nothing rocks")
    files.check_outputs([path], case.inputs)
