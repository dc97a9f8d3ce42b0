"""``rwmf animate``: a film of one case."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np

from rwmf import files
from rwmf.animate import animate
from rwmf.case import Case
from rwmf.commands import progress_bar
from rwmf.errors import InputError
from rwmf.simulation import simulate
from rwmf.words import number, whole, written_file

__all__ = ["add_parser", "run"]


def add_parser(add: Callable[..., argparse.ArgumentParser]) -> None:
    """Add the subcommand: `add` makes a parser of name, function, text and example."""
    parser = add(
        "animate",
        run,
        "Draw a film of wall, frame and ground: rocking, impacts and lift-off.",
        "inputs/fig06_mild_frame_one_cosine.nml --out rocking.gif",
    )
    parser.add_argument("case", metavar="CASE.nml", help="namelist file")
    positive = number(above=0)
    parser.add_argument(
        "--out", type=written_file, metavar="FILE", help="gif or mp4; CASE.gif when absent"
    )
    parser.add_argument("--fps", type=whole(1, 100), default=20, help="frames a second of the film")
    parser.add_argument(
        "--speed", type=positive, default=1.0, help="0.5 for half of the real speed"
    )
    parser.add_argument("--until", type=positive, metavar="T", help="end of the film [s]")


def run(options: argparse.Namespace) -> int:
    """Make the film and return exit status 0; errors as the simulation and `animate`."""
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
