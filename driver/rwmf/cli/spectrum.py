"""Subcommand ``rwmf spectrum``."""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
import xarray as xr

from rwmf import _spectrum
from rwmf._files import files
from rwmf._progress import progress_bar
from rwmf.case import Case
from rwmf.case.grid import with_grid
from rwmf.cli.output import (
    check_words,
    checks_if_limited,
    print_checks,
    print_json,
    print_warnings,
    print_written,
    write_checks,
)
from rwmf.plotting import image_files as figures
from rwmf.quantities import ENDINGS, names_by_key


def run(options: argparse.Namespace) -> int:
    """Compute a spectrum (``rwmf spectrum``)."""
    case = Case.from_namelist(options.case)
    case = with_grid(case, quantities=options.quantities)
    outputs = [options.out, options.plot, *(options.checks or ())]
    files.check_outputs(outputs, case.inputs)
    figures.check_formats(options.plot)
    check_words(case, options.checks)
    with (
        progress_bar(case.kernel.ordinates()) as report,
        _spectrum.start(case, options.threads, report) as sweep,
    ):
        dataset = _spectrum.to_dataset(sweep)
        if options.out:
            sweep.write(case.text, options.out)
    print_warnings(options.case, dataset.attrs["warnings"].splitlines())
    if options.plot:
        figures.save_spectrum(dataset, options.plot)
    checks = checks_if_limited(case, dataset)
    write_checks(checks, options.checks)
    if options.json:
        found = _spectrum_object(dataset)
        print_json(found if checks is None else found | {"checks": checks.to_dict()})
    else:
        _print_spectrum(dataset, options)
        print_checks(checks)
    print_written(outputs, is_json=options.json)
    return 0


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
