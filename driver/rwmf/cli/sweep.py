"""Subcommand ``rwmf sweep``."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from rwmf._arguments import case_of
from rwmf._files import files
from rwmf._progress import progress
from rwmf._sweep.computation import merge, merge_csv, path_of_store, sweep
from rwmf._sweep.executors import open_executor
from rwmf._sweep.sweep_file import read_sweep_file
from rwmf.cli.output import (
    check_words,
    checks_if_limited,
    print_checks,
    print_warnings,
    print_written,
    write_checks,
)
from rwmf.errors import InputError, Interrupted


def run(options: argparse.Namespace) -> int:
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
    check_words(case, options.checks)
    started = time.perf_counter()
    try:
        with open_executor(options.engine, options.workers) as executor, progress() as report:
            dataset = sweep(
                **vars(request),
                file=path,
                threads=options.threads,
                executor=executor,
                progress=report,
                restart=options.restart,
                part=part,
            )
    except Interrupted as error:
        print(f"rwmf: {error}", file=sys.stderr)
        raise
    except InputError as error:
        raise InputError(f"{options.sweep}: {error}") from error
    seconds = time.perf_counter() - started
    print_warnings(options.sweep, dataset.attrs["warnings"].splitlines())
    if part[1] > 1:
        print(f"part {part[0]}/{part[1]} is done: {path_of_store(path, part)} ({seconds:.1f} s)")
    else:
        _print_counts(dataset, path, seconds)
        checks = checks_if_limited(case, dataset)
        write_checks(checks, options.checks)
        print_checks(checks)
        print_written(options.checks or ())
    return 0


def _print_counts(dataset: xr.Dataset, path: Path, seconds: float) -> None:
    """Print a summary of a sweep."""
    codes = dataset["status"].values
    names = dataset["status"].attrs["flag_meanings"].split()
    parts = [f"{np.count_nonzero(codes == i)} {name}" for i, name in enumerate(names)]
    sizes = " x ".join(f"{size} {name}" for name, size in dataset.sizes.items())
    print(f"{codes.size} runs ({sizes}) in {seconds:.1f} s: {', '.join(parts)}")
    print(f"written: {path}")


def _merge(options: argparse.Namespace) -> int:
    """Join parts into one file."""
    if options.out is None or options.sweep is not None:
        raise InputError("sweep: --merge needs --out FILE, and no SWEEP.nml")
    if Path(options.out).suffix.lower() == ".csv":
        merge_csv(options.merge, options.out)
    else:
        merge(_stores(options.merge), options.out).close()
    print(f"written: {options.out}")
    return 0


def _stores(parts: Sequence[str]) -> list[str]:
    wrong = [part for part in parts if not part.endswith(".journal")]
    if wrong:
        raise InputError(f"{wrong[0]}: is no journal of rwmf sweep --part; for CSV give FILE.csv")
    return list(parts)


def _parse_part(word: str) -> tuple[int, int]:
    try:
        k, n = (int(item) for item in word.split("/"))
    except ValueError:
        raise InputError(f"--part {word}: must be K/N, for example 3/16") from None
    return k, n
