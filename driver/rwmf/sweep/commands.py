"""The commands ``rwmf sweep`` and ``rwmf merge``."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
import xarray as xr

from rwmf import files
from rwmf.case import Case
from rwmf.commands import print_warnings, progress_bar
from rwmf.errors import InputError, Interrupted
from rwmf.sweep.csv_parts import merge_csv
from rwmf.sweep.engine import open_executor
from rwmf.sweep.run import journal_of, merge, sweep
from rwmf.sweep.sweep_file import SweepFile, read_sweep_file
from rwmf.words import thread_count, whole, written_file

__all__ = ["add_parsers", "merge_files", "print_counts", "progress", "sweep_file"]

Add = Callable[..., argparse.ArgumentParser]
# processes on one machine: beyond any, and what the system still starts
_MOST_WORKERS = 4096


def add_parsers(add: Add) -> None:
    """Add the commands to the parser of the command line.

    Parameters
    ----------
    add : callable
        Adds a subcommand of a name, a function, a text and an example.
    """
    parser = add(
        "sweep",
        sweep_file,
        "Run the product of records and parameters that a namelist asks for, into NetCDF.",
        "restitution.nml --file restitution.nc",
    )
    parser.add_argument("sweep", metavar="SWEEP.nml", help="namelist with &sweep and &grid")
    parser.add_argument(
        "--file", metavar="FILE.nc", type=written_file, help="NetCDF file (default: SWEEP.nc)"
    )
    parser.add_argument(
        "--threads", metavar="N", type=thread_count, default=0, help="threads (0: all)"
    )
    parser.add_argument(
        "--engine",
        metavar="NAME",
        default="threads",
        help="threads, processes, mpi (under mpiexec -n N python -m mpi4py.futures -m rwmf), dask "
        "or dask:ADDRESS",
    )
    parser.add_argument(
        "--workers", metavar="N", type=whole(0, _MOST_WORKERS), default=0, help="of the engine"
    )
    parser.add_argument("--part", metavar="K/N", default="1/1", help="only the K-th of N parts")
    parser.add_argument("--restart", action="store_true", help="discard what is there")
    parser = add(
        "merge",
        merge_files,
        "Join parts: the journals of rwmf sweep --part, or the CSV files of rwmf-batch --part.",
        "whole.nc whole.nc.part-*.journal",
    )
    parser.add_argument(
        "file", metavar="FILE", type=written_file, help="file to write, .nc or .csv"
    )
    parser.add_argument("parts", metavar="PART", nargs="+", help="all parts, in any order")


def sweep_file(options: argparse.Namespace) -> int:
    """Run a sweep (``rwmf sweep``)."""
    asked = read_sweep_file(options.sweep)
    path = Path(options.file) if options.file else asked.file
    part = _parse_part(options.part)
    files.check_outputs([path], [options.sweep, asked.case])
    started = time.perf_counter()
    try:
        with open_executor(options.engine, options.workers) as executor, progress() as report:
            dataset = _run(
                asked,
                path,
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
        print(f"part {part[0]}/{part[1]} is done: {journal_of(path, part)} ({seconds:.1f} s)")
    else:
        print_counts(dataset, path, seconds)
    return 0


@contextmanager
def progress() -> Iterator[Callable[[int, int], None]]:
    """Open the bar with the first report, which knows how many runs there are.

    Yields
    ------
    callable
        Takes the number of finished runs and of all.
    """
    with ExitStack() as stack:
        bars: list[Callable[[int, int], None] | None] = []

        def report(done: int, total: int) -> None:
            if not bars:
                bars.append(stack.enter_context(progress_bar(total)))
            if bars[0] is not None:
                bars[0](done, total)

        yield report


def _run(asked: SweepFile, path: Path, **how: object) -> xr.Dataset:
    case = Case.from_namelist(str(asked.case))
    if asked.quantities:
        how["quantities"] = asked.quantities
    return sweep(
        case,
        asked.grid,
        asked.records,
        path,
        unit=asked.unit,
        dt=asked.dt,
        chunk=asked.chunk,
        **how,
    )


def print_counts(dataset: xr.Dataset, path: Path, seconds: float) -> None:
    """Say what a sweep gave.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `sweep`.
    path : path
        Its file.
    seconds : float
        What it took [s].
    """
    codes = dataset["status"].values
    names = dataset["status"].attrs["flag_meanings"].split()
    parts = [f"{np.count_nonzero(codes == i)} {name}" for i, name in enumerate(names)]
    sizes = " x ".join(f"{size} {name}" for name, size in dataset.sizes.items())
    print(f"{codes.size} runs ({sizes}) in {seconds:.1f} s: {', '.join(parts)}")
    print(f"written: {path}")


def merge_files(options: argparse.Namespace) -> int:
    """Join parts (``rwmf merge``)."""
    if Path(options.file).suffix.lower() == ".csv":
        merge_csv(options.parts, options.file)
    else:
        merge(_journals(options.parts), options.file).close()
    print(f"written: {options.file}")
    return 0


def _journals(parts: Sequence[str]) -> list[str]:
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
