"""Subcommand ``rwmf study``: one study, one dataset, one figure."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from rwmf import studies
from rwmf._files import files
from rwmf._files.netcdf_file import new_file
from rwmf._progress import progress
from rwmf._sweep import find_records
from rwmf.case import Case
from rwmf.cli.output import print_warnings, print_written, printed_warnings
from rwmf.cli.words import numbers
from rwmf.plotting import image_files as figures
from rwmf.plotting import studies as plots
from rwmf.plotting.studies import overturning_map
from rwmf.plotting.style import new_figure

_PERIODS = "0.1:3:59"


def overturning(options: argparse.Namespace) -> int:
    """Map the pulses that overturn a wall (``rwmf study overturning``)."""
    case = Case.from_namelist(options.case)
    _check(options, case.inputs)
    with progress() as report:
        found = studies.overturning_map(
            case, options.omega, options.amplitude, options.tolerance, options.threads, report
        )
    return _finish(options, found, overturning_map)


def wall(options: argparse.Namespace) -> int:
    """Compare a frame with and without its wall (``rwmf study wall``)."""
    case = Case.from_namelist(options.case)
    with printed_warnings(options.case):
        records = find_records(options.records, unit=options.unit) if options.records else ()
    _check(options, [*case.inputs, *(Path(record.path) for record in records)])
    grid: dict[str, object] = {} if options.gamma is None else {"gamma": options.gamma}
    if options.T_s is not None or "T_s" in case.kernel.axes():
        grid["T_s"] = options.T_s or numbers(_PERIODS)
    with progress() as report:
        found = studies.wall_effect(
            case,
            grid,
            records,
            options.quantities,
            unit=options.unit,
            threads=options.threads,
            progress=report,
        )
    status = _finish(options, found, plots.wall_effect)
    print("with the wall over without it:")
    for name in str(found.attrs["quantities"]).split():
        values = found[f"{name}_ratio"].values
        values = values[~np.isnan(values)]
        ends = f"{values.min():.3g} to {values.max():.3g}" if values.size else "no result"
        print(f"  {name}: {ends}, above 1 in {np.sum(values > 1)} of {values.size}")
    return status


def equal_response(options: argparse.Namespace) -> int:
    """Find pulses with the same response (``rwmf study equal-response``)."""
    case = Case.from_namelist(options.case)
    _check(options, case.inputs)
    with progress() as report:
        found = studies.equal_response(
            case,
            options.T_p,
            options.target,
            threads=options.threads,
            progress=report,
            quantities=options.quantities,
        )
    return _finish(options, found, plots.equal_response)


def _check(options: argparse.Namespace, inputs: Any) -> None:  # noqa: ANN401 (several paths)
    files.check_outputs([options.plot, options.out], inputs)
    figures.check_formats(options.plot)


def _finish(
    options: argparse.Namespace, found: xr.Dataset, draw: Callable[[xr.Dataset, Any], object]
) -> int:
    """Print warnings, write and draw the dataset; print it where there is no file."""
    print_warnings(options.case, found.attrs["warnings"].splitlines())
    if options.out:
        with new_file(Path(options.out)) as (file, _):
            found.dump_to_store(xr.backends.H5NetCDFStore(file))
    if options.plot:
        with new_figure(3.8) as figure:
            draw(found, figure.subplots())
            figures.save(figure, options.plot)
    print_written([options.out, options.plot])
    if not options.out and not options.plot:
        print(found)
    return 0
