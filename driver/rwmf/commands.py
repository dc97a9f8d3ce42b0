"""What each subcommand of ``rwmf`` does; every function returns an exit status."""

from __future__ import annotations

import argparse
import json
import math
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from rwmf import _library, figures, files, loops, records, simulation
from rwmf.case import Case
from rwmf.endings import ENDINGS
from rwmf.quantities import names_by_key
from rwmf.spectrum import count_ordinates, with_grid
from rwmf.spectrum import start as start_spectrum
from rwmf.spectrum import to_dataset as spectrum_dataset

__all__ = [
    "check",
    "check_plot",
    "export_record",
    "list_records",
    "print_warnings",
    "progress_bar",
    "run",
    "spectrum",
]

# lines of `rwmf check`: word of the kernel's inventory, how it is shown, and when there is none
_INVENTORY = (
    ("effects", "effects", "none"),
    ("absent", "not simulated", "nothing is left out"),
    ("states", "states", "none"),
    ("events", "events", "none"),
    ("scalars", "outputs", "none"),
    ("columns", "history", "none (&output dt)"),
)
# points of a plotted history when the case asks for none
_PLOT_POINTS = 4000
# and of its loops, whose corners a history of the response need not show
_LOOP_POINTS = 40000


def run(options: argparse.Namespace) -> int:
    """Simulate one case (``rwmf run``)."""
    case = Case.from_namelist(options.case)
    written = _library.result_names(options.case) if options.out else ()
    outputs = [options.plot, options.loops, *(Path(options.out, name) for name in written)]
    files.check_outputs(outputs, case.inputs)
    check_plot(options.plot)
    check_plot(options.loops)
    if options.loops:
        loops.check_springs(case)
    with simulation.start(case) as result:
        summary = result.summary()
        if options.out:
            result.write(options.case, options.out)
        if options.plot:
            _plot_history(case, result, options.plot)
        if options.loops:
            _plot_loops(case, result, options.loops)
    print_warnings(options.case, summary["warnings"])
    if options.json:
        _print_json(summary)
    else:
        _print_table(summary)
    return 0


def _plot_history(case: Case, result: _library.Run, path: str) -> None:
    dataset = simulation.to_dataset(result)
    if "time" not in dataset.coords:
        # the integration does not depend on the history: the same response, sampled
        dt = max(case.solver.t_end / _PLOT_POINTS, np.finfo(float).tiny)
        dataset = simulation.simulate(case, dt)
    figures.save_history(dataset, path)


def _plot_loops(case: Case, result: _library.Run, path: str) -> None:
    """Sample the corners of the loops finely, whatever interval the case asks for."""
    dataset = simulation.to_dataset(result)
    fine = max(case.solver.t_end / _LOOP_POINTS, np.finfo(float).tiny)
    if "time" not in dataset.coords or case.output.dt > fine:
        dataset = simulation.simulate(case, fine)
    figures.save_loops(dataset, case, path)


def spectrum(options: argparse.Namespace) -> int:
    """Compute a spectrum (``rwmf spectrum``)."""
    case = Case.from_namelist(options.case)
    case = with_grid(case, quantities=options.quantity)
    files.check_outputs([options.plot, options.csv], case.inputs)
    check_plot(options.plot)
    with (
        progress_bar(count_ordinates(case)) as report,
        start_spectrum(case, options.threads, report) as sweep,
    ):
        dataset = spectrum_dataset(sweep)
        if options.csv:
            sweep.write(options.csv)
    print_warnings(options.case, dataset.attrs["warnings"])
    if options.plot:
        figures.save_spectrum(dataset, options.plot)
    if options.json:
        _print_json(_spectrum_object(dataset))
    else:
        _print_spectrum(dataset, options)
    return 0


def check(options: argparse.Namespace) -> int:
    """Validate a case and say what it holds (``rwmf check``)."""
    case = Case.from_namelist(options.case)
    found = case.kernel.inventory()
    print(f"{options.case}: valid")
    for word, shown, nothing in _INVENTORY:
        print(f"{shown}: {', '.join(found.get(word, [])) or nothing}")
    n = count_ordinates(case)
    if n > 0:
        print(f"spectrum: {n} simulations")
    warning = _library.law_warning(case.kernel.broken_laws())
    for kind, lines in (("note", found["notes"]), ("warning", warning.splitlines())):
        print("".join(f"{kind}: {line}\n" for line in lines), end="")
    print("values, those that the case does not give in parentheses:")
    for name, group in case.groups.items():
        print(f"  {name:8s} {group!r}")
    return 0


def list_records(_: argparse.Namespace) -> int:
    """List the records (``rwmf records list``)."""
    print("\n".join(records.list_records()))
    return 0


def export_record(options: argparse.Namespace) -> int:
    """Write a record into a file (``rwmf records export``)."""
    print(records.export(options.name, options.file))
    return 0


def check_plot(path: str | None) -> None:
    """Complain about the name of a figure before the computation, not after it."""
    if path:
        figures.check_format(path)


def _find_bar() -> type | None:
    """Class of the progress bar; None when the optional package is not installed.

    It is tqdm: pure Python without dependencies, maintained since 2013, at home on narrow and
    dumb terminals. Imported here because only a terminal needs it.
    """
    try:
        from tqdm import tqdm
    except ModuleNotFoundError:
        return None
    return tqdm


@contextmanager
def progress_bar(total: int) -> Iterator[Callable[[int, int], None] | None]:
    """Show progress on a terminal; nothing where the output is kept."""
    bar_type = _find_bar() if sys.stderr.isatty() else None
    if bar_type is None:
        yield None
        return
    # a terminal that does not tell its size gets a usual one
    size = shutil.get_terminal_size()
    with bar_type(
        total=total,
        unit="run",
        leave=False,
        file=sys.stderr,
        ncols=size.columns,
        nrows=size.lines,
    ) as bar:

        def report(done: int, _: int) -> None:
            bar.update(done - bar.n)

        yield report


def print_warnings(path: str, warnings: Sequence[str]) -> None:
    """Tell on the error output what to keep in mind about the results of a file."""
    for warning in warnings:
        print(f"rwmf: {path}: warning: {warning}", file=sys.stderr)


def _print_table(summary: dict[str, Any]) -> None:
    width = max(len(key) for key in summary)
    for key, value in summary.items():
        if isinstance(value, list):
            # warnings stand on the error output already
            text = ", ".join(value) if key == "effects" else str(len(value))
        elif isinstance(value, bool):
            text = "yes" if value else "no"
        elif isinstance(value, float):
            text = f"{value:.10g}"
        else:
            text = str(value)
        print(f"{key:{width}s}  {text}")


def _spectrum_object(dataset: xr.Dataset) -> dict[str, Any]:
    """Keys of ``rwmf spectrum --json`` in their order."""
    found: dict[str, Any] = {"T_s_s": dataset["T_s"].values}
    if "gamma" in dataset.dims:
        found["gamma"] = dataset["gamma"].values
        found["b_m"] = dataset["b"].values
    for key, name in names_by_key(dataset.data_vars).items():
        found[key] = dataset[name].values
    for key in ("seconds", "threads", "rhs_evaluations", "warnings"):
        found[key] = dataset.attrs[key]
    return found


def _print_spectrum(dataset: xr.Dataset, options: argparse.Namespace) -> None:
    status = dataset["status"].values
    failed = ~np.isin(status, ("ok", *ENDINGS))
    # a frame collapses only where an effect limits its drift
    ended = [name for name in ENDINGS if name == "overturned" or (status == name).any()]
    print(
        f"{status.size} simulations in {dataset.attrs['seconds']:.2f} s "
        f"with {dataset.attrs['threads']} threads, {failed.sum()} failed, "
        + ", ".join(f"{(status == name).sum()} {name}" for name in ended)
    )
    for path in (options.csv, options.plot):
        if path:
            print(f"written: {path}")
    if not options.csv and not options.plot:
        _print_ordinates(dataset)


def _print_ordinates(dataset: xr.Dataset) -> None:
    """One line a period, one column a mass ratio and half width."""
    bare = "gamma" not in dataset.dims
    columns = dataset if bare else dataset.stack(column=("b", "gamma"))
    names = names_by_key(name for name in dataset.data_vars if name != "status")
    for key, name in names.items():
        heads = [key]
        if not bare:
            if len(names) > 1:
                print(f"{key}:")
            heads = [f"gamma={gamma:g},b={b:g}" for b, gamma in columns["column"].values]
        print(" ".join([f"{'T_s_s':>9s}", *(f"{head:>20s}" for head in heads)]))
        values = columns[name].values.reshape(dataset.sizes["T_s"], -1)
        for period, row in zip(dataset["T_s"].values, values, strict=True):
            print(" ".join([f"{period:9.4f}", *(f"{value:20.9g}" for value in row)]))


def _print_json(value: dict[str, Any]) -> None:
    print(json.dumps(_plain(value), indent=1, allow_nan=False))


def _plain(value: object) -> object:
    """JSON's own types; what is not finite becomes null."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
