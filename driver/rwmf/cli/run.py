"""Subcommand ``rwmf run``."""

from __future__ import annotations

import argparse
import contextlib
from pathlib import Path
from typing import Any

import numpy as np

from rwmf import _library, loops
from rwmf import _simulation as simulation
from rwmf._files import files
from rwmf._headline import grouped, headline_of_case, value_text
from rwmf.case import Case
from rwmf.cli.output import print_json, print_warnings, print_written
from rwmf.plotting import image_files as figures

__all__ = ["run"]

# points of a plotted history for a case without an interval
_PLOT_POINTS = 4000
# points of plotted loops, whose corners need finer sampling
_LOOP_POINTS = 40000


def run(options: argparse.Namespace) -> int:
    """Simulate one case (``rwmf run``).

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
    names = _library.result_names(options.case) if options.out else ()
    found = [Path(options.out, name) for name in names]
    outputs = [options.plot, options.loops, *found]
    files.check_outputs(outputs, case.inputs)
    figures.check_formats(options.plot, options.loops)
    if options.loops:
        loops.check_springs(case)
    before = {path: _place_of(path) for path in found}
    with simulation.start(case) as result:
        summary = result.summary()
        if options.out:
            result.write(case.text, options.case, options.out)
        if options.plot:
            _plot_history(case, result, options.plot)
        if options.loops:
            _plot_loops(case, result, options.loops)
    print_warnings(options.case, summary["warnings"])
    if options.json:
        print_json(summary)
    else:
        _print_table(case, summary, is_all=options.all)
    # a written file replaces an older one
    new = [path for path in found if _place_of(path) not in (None, before[path])]
    print_written([*new, options.plot, options.loops], is_json=options.json)
    return 0


def _place_of(path: Path) -> tuple[int, int] | None:
    """Identify an existing file by device and inode."""
    with contextlib.suppress(OSError):
        status = path.stat()
        return status.st_ino, status.st_mtime_ns
    return None


def _plot_history(case: Case, result: _library.Run, path: str) -> None:
    """Draw the history with the demands of the frame, even when the case does not request them."""
    dataset = simulation.to_dataset(result, case)
    has_demands = case.output is not None and case.output.reactions
    lacks_demands = case.frame is not None and not has_demands
    if "time" not in dataset.coords or lacks_demands:
        # outputs do not affect the integration, so the response is the same
        wanted: dict[str, object] = {"reactions": True} if lacks_demands else {}
        if "time" not in dataset.coords:
            wanted["dt"] = max(case.solver.t_end / _PLOT_POINTS, np.finfo(float).tiny)
        dataset = simulation.simulate(case.replace(output=wanted))
    figures.save_history(dataset, path, case)


def _plot_loops(case: Case, result: _library.Run, path: str) -> None:
    """Sample the corners of the loops finely, whatever the interval of the case."""
    dataset = simulation.to_dataset(result, case)
    fine = max(case.solver.t_end / _LOOP_POINTS, np.finfo(float).tiny)
    if "time" not in dataset.coords or case.output.dt > fine:
        # the shears of storeys are among the reactions
        dataset = simulation.simulate(case.replace(output={"dt": fine, "reactions": True}))
    figures.save_loops(dataset, case, path)


def _print_table(case: Case, summary: dict[str, Any], *, is_all: bool) -> None:
    if is_all:
        width = max(len(key) for key in summary)
        lines = [f"{key:{width}s}  {value_text(key, value)}" for key, value in summary.items()]
    else:
        lines = [*headline_of_case(summary, case), *grouped(summary)]
    print("\n".join(lines))
