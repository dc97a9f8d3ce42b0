"""``rwmf animate``: a film of one case."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from rwmf import files
from rwmf.animate import animate
from rwmf.case import Case
from rwmf.commands import progress_bar
from rwmf.errors import InputError
from rwmf.simulation import simulate

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
    parser.add_argument("--out", type=Path, metavar="FILE", help="gif or mp4; CASE.gif when absent")
    parser.add_argument("--fps", type=int, default=20, help="frames a second of the film")
    parser.add_argument("--speed", type=float, default=1.0, help="0.5 for half of the real speed")
    parser.add_argument("--until", type=float, metavar="T", help="end of the film [s]")


def run(options: argparse.Namespace) -> int:
    """Make the film and return exit status 0; errors as the simulation and `animate`."""
    case = Case.from_namelist(options.case)
    path = options.out or Path(f"{Path(options.case).stem}.gif")
    _check(case, options, path)
    response = simulate(case, dt=options.speed / options.fps)
    if options.until is not None:
        response = response.sel(time=slice(None, options.until))
    with progress_bar(response.sizes["time"]) as report:
        factor = animate(case, response, path, options.fps, report)
    print(f"written: {path}, {response.sizes['time']} frames, rotations drawn {factor:g} times")
    return 0


def _check(case: Case, options: argparse.Namespace, path: Path) -> None:
    """Complain before the computation, not after it."""
    if case.wall is None:
        raise InputError(f"{options.case}: without &wall nothing rocks")
    if not 1 <= options.fps <= 100:
        raise InputError(f"--fps {options.fps}: must be in [1, 100]")
    if not options.speed > 0:
        raise InputError(f"--speed {options.speed:g}: must be > 0")
    if options.until is not None and not options.until > 0:
        raise InputError(f"--until {options.until:g}: must be > 0")
    files.check_outputs([path], case.inputs)
