"""Commands ``rwmf spectrum``, ``rwmf sweep`` and ``rwmf study``."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from rwmf.assess.studies import equal_response, overturning_map, wall_effect
from rwmf.case import Case
from rwmf.case.arguments import case_of
from rwmf.cli import output
from rwmf.cli.words import numbers
from rwmf.errors import InputError, Interrupted
from rwmf.figures import image_files as figures
from rwmf.figures import study_figures as plots
from rwmf.kernel import files
from rwmf.kernel.files import new_file
from rwmf.kernel.progress import progress, progress_bar
from rwmf.motion.record_sets import find_records
from rwmf.run.quantities import ENDINGS, names_by_key
from rwmf.run.spectrum import start as start_spectrum
from rwmf.run.spectrum import to_dataset, with_grid
from rwmf.sweeps.computation import merge, merge_csv, path_of_store, sweep
from rwmf.sweeps.executors import open_executor
from rwmf.sweeps.sweep_file import read_sweep_file


def run_spectrum(options: argparse.Namespace) -> list[str | None]:
    """Compute a spectrum (``rwmf spectrum``)."""
    case = Case.from_namelist(options.case)
    case = with_grid(case, quantities=options.quantities)
    outputs = output.check_files(options, case.inputs, case)
    with (
        progress_bar(case.kernel.ordinates()) as report,
        start_spectrum(case, options.threads, report) as sweep,
    ):
        dataset = to_dataset(sweep)
        if options.out:
            sweep.write(case.text, options.out)
    output.print_warnings(options.case, dataset.attrs["warnings"].splitlines())
    if options.plot:
        figures.save_spectrum(dataset, options.plot)
    checks = output.compare(case, dataset, options.checks)
    if options.json:
        output.print_json(_spectrum_object(dataset), checks)
    else:
        _print_spectrum(dataset, options)
        output.print_checks(checks)
    return outputs


def _spectrum_object(dataset: xr.Dataset) -> dict[str, Any]:
    """Return the keys of ``rwmf spectrum --json`` in their order."""
    found: dict[str, Any] = {"T_s_s": dataset["T_s"].values}
    for name, key in (("gamma", "gamma"), ("b", "b_m")):
        if name in dataset.dims:
            found[key] = dataset[name].values
    for key, name in names_by_key(dataset.data_vars).items():
        found[key] = dataset[name].values
    for key in ("method", "seconds", "threads", "rhs_evaluations"):
        found[key] = dataset.attrs[key]
    return found | {"warnings": dataset.attrs["warnings"].splitlines()}


def _print_spectrum(dataset: xr.Dataset, options: argparse.Namespace) -> None:
    status = dataset["status"].values
    failed = ~np.isin(status, ("ok", *ENDINGS))
    # a frame can collapse only with an effect that limits its drift
    ended = [name for name in ENDINGS if name == "overturned" or (status == name).any()]
    print(
        f"{status.size} simulations by {dataset.attrs['method']} "
        f"in {dataset.attrs['seconds']:.2f} s with {dataset.attrs['threads']} threads, "
        f"{failed.sum()} failed, " + ", ".join(f"{(status == name).sum()} {name}" for name in ended)
    )
    if not options.out and not options.plot:
        _print_ordinates(dataset)


def _print_ordinates(dataset: xr.Dataset) -> None:
    """Print one line per period, one column per mass ratio and half width."""
    outer = [name for name in ("b", "gamma") if name in dataset.dims]
    columns = dataset.stack(column=outer) if outer else dataset
    names = names_by_key(name for name in dataset.data_vars if name != "status")
    for key, name in names.items():
        heads = [key]
        if outer:
            if len(names) > 1:
                print(f"{key}:")
            heads = [
                ",".join(f"{axis}={at[i]:g}" for i, axis in reversed(list(enumerate(outer))))
                for at in columns["column"].values
            ]
        print(" ".join([f"{'T_s_s':>9s}", *(f"{head:>20s}" for head in heads)]))
        values = columns[name].values.reshape(dataset.sizes["T_s"], -1)
        for period, row in zip(dataset["T_s"].values, values, strict=True):
            print(" ".join([f"{period:9.4f}", *(f"{value:20.9g}" for value in row)]))


def run_sweep(options: argparse.Namespace) -> list[str] | None:
    """Run a sweep, or join its parts (``rwmf sweep``)."""
    if options.merge:
        return _merge(options)
    if options.sweep is None:
        raise InputError("sweep: needs SWEEP.nml, or --merge PART ...")
    request, path = read_sweep_file(options.sweep)
    if options.out:
        path = Path(options.out)
    part = _parse_part(options.part)
    files.check_outputs([path, *(options.checks or ())], [options.sweep, str(request.case)])
    case = case_of(request.case)
    output.check_words(case, options.checks)
    started = time.perf_counter()
    try:
        with open_executor(options.engine, options.workers) as executor, progress() as report:
            further = output.chosen(options, "threads", "restart") | {"part": part}
            further |= {"executor": executor, "progress": report}
            dataset = sweep(file=path, **vars(request), **further)
    except Interrupted as error:
        print(f"rwmf: {error}", file=sys.stderr)
        raise
    except InputError as error:
        raise InputError(f"{options.sweep}: {error}") from error
    seconds = time.perf_counter() - started
    output.print_warnings(options.sweep, dataset.attrs["warnings"].splitlines())
    if part[1] > 1:
        print(f"part {part[0]}/{part[1]} is done: {path_of_store(path, part)} ({seconds:.1f} s)")
    else:
        _print_counts(dataset, path, seconds)
        output.print_checks(output.compare(case, dataset, options.checks))
        return [*(options.checks or ())]
    return None


def _print_counts(dataset: xr.Dataset, path: Path, seconds: float) -> None:
    """Print a summary of a sweep."""
    codes = dataset["status"].values
    names = dataset["status"].attrs["flag_meanings"].split()
    parts = [f"{np.count_nonzero(codes == i)} {name}" for i, name in enumerate(names)]
    sizes = " x ".join(f"{size} {name}" for name, size in dataset.sizes.items())
    print(f"{codes.size} runs ({sizes}) in {seconds:.1f} s: {', '.join(parts)}")
    print(f"written: {path}")


def _merge(options: argparse.Namespace) -> list[str]:
    """Join parts into one file."""
    if options.out is None or options.sweep is not None:
        raise InputError("sweep: --merge needs --out FILE, and no SWEEP.nml")
    if Path(options.out).suffix.lower() == ".csv":
        merge_csv(options.merge, options.out)
    else:
        for part in options.merge:
            if not part.endswith(".journal"):
                raise InputError(
                    f"{part}: is no journal of rwmf sweep --part; for CSV give FILE.csv"
                )
        merge(options.merge, options.out).close()
    return [options.out]


def _parse_part(word: str) -> tuple[int, int]:
    try:
        k, n = (int(item) for item in word.split("/"))
    except ValueError:
        raise InputError(f"--part {word}: must be K/N, for example 3/16") from None
    return k, n


_PERIODS = "0.1:3:59"


def run_overturning(options: argparse.Namespace) -> None:
    """Map the pulses that overturn a wall (``rwmf study overturning``)."""
    case = Case.from_namelist(options.case)
    output.check_files(options, case.inputs)
    levels = (options.omega, options.amplitude, options.tolerance)
    found = overturning_map(case, *levels, options.threads, progress=True)
    _finish(options, found, plots.overturning_map)


def run_wall(options: argparse.Namespace) -> None:
    """Compare a frame with and without its wall (``rwmf study wall``)."""
    case = Case.from_namelist(options.case)
    with output.printed_warnings(options.case):
        records = (
            find_records(options.records, unit=options.unit, dt=options.dt)
            if options.records
            else ()
        )
    output.check_files(options, [*case.inputs, *(Path(record.path) for record in records)])
    grid: dict[str, object] = {} if options.gamma is None else {"gamma": options.gamma}
    if options.T_s is not None or "T_s" in case.kernel.axes():
        grid["T_s"] = options.T_s or numbers(_PERIODS)
    with progress() as report:
        further = output.chosen(options, "quantities", "unit", "dt", "threads")
        found = wall_effect(case, grid, records, progress=report, **further)
    _finish(options, found, plots.wall_effect)
    print("with the wall over without it:")
    for name in str(found.attrs["quantities"]).split():
        values = found[f"{name}_ratio"].values
        values = values[~np.isnan(values)]
        ends = f"{values.min():.3g} to {values.max():.3g}" if values.size else "no result"
        print(f"  {name}: {ends}, above 1 in {np.sum(values > 1)} of {values.size}")


def run_equal_response(options: argparse.Namespace) -> None:
    """Find pulses with the same response (``rwmf study equal-response``)."""
    case = Case.from_namelist(options.case)
    output.check_files(options, case.inputs)
    further = output.chosen(options, "T_p", "target", "threads", "quantities")
    found = equal_response(case, progress=True, **further)
    _finish(options, found, plots.equal_response)


def _finish(
    options: argparse.Namespace, found: xr.Dataset, draw: Callable[[xr.Dataset, Any], object]
) -> None:
    """Print warnings, write and draw the dataset; print it where there is no file."""
    output.print_warnings(options.case, found.attrs["warnings"].splitlines())
    if options.out:
        with new_file(Path(options.out)) as (file, _):
            found.dump_to_store(xr.backends.H5NetCDFStore(file))
    figures.draw_into(options.plot, 3.8, lambda figure: draw(found, figure.subplots()))
    output.print_written([options.out, options.plot])
    if not options.out and not options.plot:
        print(found)
