"""Subcommands ``rwmf ida``, ``stripes``, ``cloud``, ``fragility`` and ``risk``."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

import rwmf
from rwmf.assess.annual import hazard_of, unit_of
from rwmf.assess.loss import loss_quantities, nrml_text, write_pelicun
from rwmf.assess.table import quantities_of, write_dataset
from rwmf.cli.output import check_files, chosen, print_json, print_warnings, printed_warnings
from rwmf.cli.words import numbers
from rwmf.errors import InputError
from rwmf.figures import image_files as figures
from rwmf.figures import risk_figures as plots
from rwmf.kernel import files
from rwmf.kernel.progress import progress
from rwmf.motion.record_sets import find_records
from rwmf.run.quantities import fallen
from rwmf.sweeps.executors import open_executor
from rwmf.sweeps.netcdf import check_package
from rwmf.sweeps.points import is_netcdf, read_netcdf

Written = list[str | Path | None]
_SHARED = ("intensity", "period", "damping", "periods", "restart", "threads")
_NOT_IN_MODEL = (
    "runs cannot show sliding, crushed toes, cracked or yielding walls, failed joints or "
    "settlement; a rigid base with elastic springs recentres by construction"
)


def ida(options: argparse.Namespace) -> Written:
    """Run an incremental dynamic analysis (``rwmf ida``)."""
    search = chosen(options, "levels", "tolerance", "highest")
    run = partial(rwmf.ida, limits=dict(options.limits), **search)
    return _analyse("ida", options, run)


def stripes(options: argparse.Namespace) -> Written:
    """Run records at levels of intensity (``rwmf stripes``)."""
    return _analyse("stripes", options, partial(rwmf.stripes, levels=options.levels))


def cloud(options: argparse.Namespace) -> Written:
    """Run records with their intensities (``rwmf cloud``)."""
    return _analyse("cloud", options, partial(rwmf.cloud, factors=options.factors))


def _analyse(analysis: str, options: argparse.Namespace, run: Callable[..., xr.Dataset]) -> Written:
    """Run an analysis of a suite."""
    cases = [rwmf.Case.from_namelist(path) for path in options.cases]
    with printed_warnings(analysis):
        records = find_records(options.records, unit=options.unit, dt=options.dt)
    inputs = [path for case in cases for path in case.inputs]
    inputs += [Path(record.path) for record in records if record.path]
    check_files(options, inputs)
    further = chosen(options, *_SHARED) | {"file": options.out}
    names = options.quantities
    if names is None and options.pelicun:
        names = loss_quantities(cases[0])
    with open_executor(options.engine, options.workers) as executor, progress() as report:
        further |= {"executor": executor, "progress": report}
        table = run(cases, records, quantities=names, **further)
    print_warnings(analysis, str(table.attrs["warnings"]).splitlines())
    _print_table(table)
    written: Written = [options.out]
    if options.pelicun:
        written += [path for path, _ in write_pelicun(table, Path(options.pelicun))]
    draw = plots.cloud if analysis == "cloud" else plots.ida
    figures.draw_into(options.plot, 3.8, lambda figure: draw(table, figure.subplots()))
    return [*written, options.plot]


def fit(options: argparse.Namespace) -> Written:
    """Fit fragility curves (``rwmf fragility``)."""
    check_files(options, options.tables)
    factor = None if options.shape_factor is None else _shape_factor(options.shape_factor)
    curves = rwmf.fragility(
        options.tables,
        options.limit,
        options.quantities and [options.quantities],
        dispersions=options.dispersions or (),
        shape_factor=factor,
        **chosen(options, "method", "mce", "resamples", "confidence", "seed"),
    )
    names = [
        "median", "median_band", "dispersion", "dispersion_band", "dispersion_total",
        "exceeded", "runs", "margin_ratio", "probability_at_mce",
        "shape_factor", "margin_ratio_adjusted", "probability_at_mce_adjusted",
    ]  # fmt: skip
    print_warnings(options.tables[0], str(curves.attrs["warnings"]).splitlines())
    models = [path for path in options.out if Path(path).suffix.lower() == ".xml"]
    model = nrml_text(curves) if models else ""
    datasets = [path for path in options.out if path not in models]
    _print_results(curves, names, options, datasets)
    for path in models:
        files.write_bytes(path, model.encode())
    figures.draw_into(options.plot, 3.8, lambda figure: plots.fragility(curves, figure.subplots()))
    return [*options.out, options.plot]


def integrate(options: argparse.Namespace) -> Written:
    """Compute annual frequencies (``rwmf risk``)."""
    inputs = [word for word in (options.fragility, options.hazard) if Path(word).is_file()]
    check_files(options, inputs)
    fragility = _read_fragility(options.fragility)
    hazard = hazard_of(_pair("--hazard", options.hazard) or options.hazard, unit_of(fragility))
    found = rwmf.risk(fragility, hazard, levels=options.levels)
    names = ["annual_frequency", "annual_frequency_band", "closed_form", "return_period"]
    print_warnings(options.hazard, str(found.attrs["warnings"]).splitlines())
    _print_results(found, [*names, "probability_50_years", "extrapolated"], options, [options.out])
    if options.plot:
        edges = found["intensity_low"].values[1:]
        with figures.drawn(options.plot, 3.8) as figure:
            left, right = figure.subplots(1, 2)
            plots.hazard(hazard, left, edges)
            left.set_xlabel(plots.intensity_label(found.attrs))
            plots.deaggregation(found, right)
    return [options.out, options.plot]


def _pair(option: str, word: str) -> tuple[float, float] | None:
    """Read two numbers; None for the name of a file."""
    if Path(word).exists() or "," not in word:
        return None
    try:
        first, second = (float(item) for item in word.split(","))
    except ValueError:
        raise InputError(f"{option} {word}: must be a file, or two numbers") from None
    return first, second


def _shape_factor(word: str) -> float | tuple[float, float, str]:
    items = word.split(",")
    try:
        if len(items) == 3:
            return float(items[0]), float(items[1]), items[2].strip()
        (value,) = numbers(word)
    except (ValueError, argparse.ArgumentTypeError):
        raise InputError(
            f"--shape-factor {word}: must be a number, or PERIOD,DUCTILITY,CATEGORY"
        ) from None
    return value


def _read_fragility(word: str) -> xr.Dataset | tuple[float, float]:
    pair = _pair("FRAGILITY", word)
    if pair is not None:
        return pair
    path = Path(word)
    if not path.is_file():
        raise InputError(f"{word}: the file does not exist, or is no regular file")
    if not is_netcdf(path):
        raise InputError(f"{word}: must be a NetCDF file of rwmf fragility --out")
    check_package()
    return read_netcdf(path)


def _print_table(table: xr.Dataset) -> None:
    """Print the counts of runs, and percentiles of each demand over the runs that stand."""
    down, statuses = fallen(table), table["status"].values.astype(str)
    for design in dict.fromkeys(table["design"].values.tolist()):
        own = table["design"].values == design
        counts = {word: int(np.sum(statuses[own] == word)) for word in np.unique(statuses[own])}
        n = np.unique(table["record"].values[own].astype(str)).size
        listed = ", ".join(f"{number} {word}" for word, number in counts.items())
        print(f"{design}: {own.sum()} runs, {n} record{'' if n == 1 else 's'}: {listed}")
        for name in quantities_of(table):
            values = table[name].values[own & ~down]
            values = values[np.isfinite(values)]
            if values.size:
                low, middle, high = np.quantile(values, [0, 0.5, 1], method="inverted_cdf")
                numbers = f"{low:.4g} to {high:.4g}, median {middle:.4g}"
                print(f"  {name}: {numbers} of runs without collapse")


def _print_results(
    found: xr.Dataset, names: list[str], options: argparse.Namespace, paths: list[str | None]
) -> None:
    """Print numbers of all designs and the limits of the model, or JSON; write the dataset."""
    for path in filter(None, paths):
        write_dataset(found, path)
    shown = [name for name in names if name in found]
    if options.json:
        fields = {
            name: found[name].values for name in found.data_vars if "resampled" not in str(name)
        }
        fields |= {str(name): found[name].values for name in found.coords}
        print_json({str(key): np.asarray(value) for key, value in fields.items()} | {
            key: value for key, value in found.attrs.items() if isinstance(value, str | int | float)
        } | {"not_in_model": _NOT_IN_MODEL})  # fmt: skip
        return
    each = found if "design" in found.dims else found.expand_dims("design")
    designs = [str(name) for name in np.atleast_1d(each["design"].values)]
    wide = max([26, *(len(name) + 2 for name in designs)])
    if designs != [""]:
        print(" " * 30 + "".join(f"{name:>{wide}}" for name in designs))
    for name in shown:
        values = each[name]
        unit = str(values.attrs.get("units", "1"))
        label = name if unit == "1" else f"{name} [{unit}]"
        cells = [
            _cell(values.isel(design=i) if "design" in values.dims else values)
            for i in range(len(designs))
        ]
        print(f"{label:30}" + "".join(f"{cell:>{wide}}" for cell in cells))
    print(f"not in the model: {_NOT_IN_MODEL}")


def _cell(values: xr.DataArray) -> str:
    numbers = np.ravel(values.values)
    if "intensity" in values.dims:
        numbers = np.array([np.nansum(numbers)])
    return " to ".join(f"{value:.5g}" for value in numbers)
