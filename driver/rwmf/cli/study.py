"""Subcommand ``rwmf study``: one study, one dataset, one figure."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from rwmf import studies
from rwmf._files import files
from rwmf._files.netcdf_file import new_file
from rwmf._progress import progress
from rwmf._sweep import RecordFile, find_records
from rwmf._sweep.kept_quantities import find_quantity
from rwmf.case import Case
from rwmf.cli.output import print_warnings, print_written, printed_warnings
from rwmf.cli.study_parser import BLOCK_PERIODS, FACTORS, PERIODS, STRESSES, TENSIONS
from rwmf.cli.words import numbers
from rwmf.errors import InputError
from rwmf.plotting import image_files as figures
from rwmf.plotting import studies as plots
from rwmf.plotting.overturning_map import draw_overturning
from rwmf.plotting.risk_figures import fragility as draw_fragility
from rwmf.plotting.style import new_figure

__all__ = ["run"]

Report = Callable[[int, int], None]


def run(options: argparse.Namespace) -> int:
    """Compute, save and draw a study (``rwmf study``)."""
    case = Case.from_namelist(options.case)
    words = getattr(options, "records", None) or ()
    records: Sequence[RecordFile] = ()
    if words:
        with printed_warnings(options.case):
            records = find_records(words, unit=options.unit)
    inputs = [*case.inputs, *(Path(record.path) for record in records)]
    files.check_outputs([options.plot, options.file], inputs)
    figures.check_formats(options.plot)
    study = _STUDIES[options.study]
    with progress() as report:
        dataset = study.compute(options, case, report)
    print_warnings(options.case, dataset.attrs["warnings"].splitlines())
    if options.file:
        _write(dataset, Path(options.file))
    if options.plot:
        with new_figure(3.8) as figure:
            study.draw(dataset, figure.subplots(1, study.panels))
            figures.save(figure, options.plot)
    print_written([options.file, options.plot])
    if "median" in dataset:
        print(_fit_in_words(dataset))
    if options.study == "wall":
        print(_effect_in_words(dataset))
    if not options.file and not options.plot:
        print(dataset)
    return 0


def _overturning(options: argparse.Namespace, case: Case, report: Report) -> xr.Dataset:
    return studies.overturning_map(
        case, options.omega, options.amplitude, options.tolerance, options.threads, report
    )


def _spectra(options: argparse.Namespace, case: Case, report: Report) -> xr.Dataset:
    grid, sweep_options = _grid(options, case), _sweep_options(options, report)
    return studies.suite_spectra(case, grid, options.records, options.quantity, **sweep_options)


def _fragility(options: argparse.Namespace, case: Case, report: Report) -> xr.Dataset:
    quantity = find_quantity(case, options.quantity and [options.quantity], "fragility")
    analysis = studies.incremental_dynamic_analysis(
        case,
        options.levels,
        options.records,
        quantity,
        intensity=options.intensity,
        period=options.period,
        damping=options.damping,
        periods=options.periods,
        **_sweep_options(options, report),
    )
    curve = studies.fragility(analysis, options.limit, quantity)
    return curve.assign({quantity: analysis[quantity]})


def _wall(options: argparse.Namespace, case: Case, report: Report) -> xr.Dataset:
    grid, sweep_options = _grid(options, case), _sweep_options(options, report)
    return studies.wall_effect(case, grid, options.records, options.quantity, **sweep_options)


def _friction(options: argparse.Namespace, case: Case, report: Report) -> xr.Dataset:
    grid, sweep_options = _grid(options, case), _sweep_options(options, report)
    return studies.friction_spectra(case, grid, options.records, **sweep_options)


def _bands(options: argparse.Namespace, case: Case, report: Report) -> xr.Dataset:
    factors, tensions = options.e, options.eta
    if factors is None and case.impact is not None and case.impact.rule == "constant":
        factors = numbers(FACTORS)
    uncertain: dict[str, Sequence[object]] = dict(options.vary or ())
    if tensions is None and case.cable is not None:
        if "initial_stress" in case.cable.given:
            stress = float(case.cable.initial_stress)
            uncertain |= {"cable.initial_stress": [share * stress for share in numbers(STRESSES)]}
        else:
            tensions = numbers(TENSIONS)
    if factors is not None:
        # for a case with r, the values are squared
        squared = case.impact is not None and "r" in case.impact.given
        uncertain |= {"r": [e**2 for e in factors]} if squared else {"e": factors}
    if tensions is not None:
        if len(tensions) % 2 > 0:
            raise InputError("--eta: needs pairs eta_0, eta_alpha")
        uncertain["eta"] = list(zip(tensions[::2], tensions[1::2], strict=True))
    if not uncertain:
        raise InputError(
            f"{options.case}: nothing is uncertain: give --e or --eta, or another key of the case "
            "by --vary KEY=LIST, for example --vary frame.xi_s=0.02,0.05"
        )
    return studies.sensitivity_bands(
        case,
        _grid(options, case),
        uncertain,
        options.records,
        options.quantity,
        **_sweep_options(options, report),
    )


def _equal_response(options: argparse.Namespace, case: Case, report: Report) -> xr.Dataset:
    return studies.equal_response(
        case,
        options.T_p,
        options.target,
        threads=options.threads,
        progress=report,
        quantities=options.quantity,
    )


class _Study(NamedTuple):
    """A study with its figure of one or more panels."""

    compute: Callable[[argparse.Namespace, Case, Report], xr.Dataset]
    draw: Callable[[xr.Dataset, Any], object]
    panels: int = 1


_STUDIES = {
    "overturning": _Study(_overturning, draw_overturning),
    "spectra": _Study(_spectra, plots.draw_suite),
    "fragility": _Study(_fragility, draw_fragility),
    "wall": _Study(_wall, plots.draw_wall_effect),
    "friction": _Study(_friction, plots.draw_friction, panels=2),
    "bands": _Study(_bands, plots.draw_bands),
    "equal-response": _Study(_equal_response, plots.draw_equal_response),
}


def _grid(options: argparse.Namespace, case: Case) -> dict[str, Sequence[object]]:
    periods = options.T_s
    if periods is None and "T_s" in case.kernel.axes():
        periods = numbers(PERIODS if case.frame is not None else BLOCK_PERIODS)
    grid = {} if periods is None else {"T_s": periods}
    return grid if options.gamma is None else grid | {"gamma": options.gamma}


def _sweep_options(options: argparse.Namespace, report: Report) -> dict[str, Any]:
    return {"unit": options.unit, "threads": options.threads, "progress": report}


def _fit_in_words(dataset: xr.Dataset) -> str:
    """Summarise a fragility curve."""
    unit = dataset["limit"].attrs["units"]
    limit = f"{float(dataset['limit']):g}" + ("" if unit == "1" else f" {unit}")
    level = dataset["scale"].attrs["units"].replace("1", "g")
    median, dispersion = float(dataset["median"]), float(dataset["dispersion"])
    return (
        f"{dataset.attrs['quantity']} > {limit}: "
        f"median {median:.6g} {level}, dispersion {dispersion:.6g}"
        f"\nintensity: {dataset['scale'].attrs['long_name']}"
    )


def _effect_in_words(dataset: xr.Dataset) -> str:
    """Summarise the effect of the wall, one line per response: reductions and increases."""
    lines = ["with the wall over without it:"]
    for name in str(dataset.attrs["quantities"]).split():
        values = dataset[f"{name}_ratio"].values
        values = values[~np.isnan(values)]
        ends = f"{values.min():.3g} to {values.max():.3g}" if values.size else "no result"
        lines.append(f"  {name}: {ends}, above 1 in {np.sum(values > 1)} of {values.size}")
    return "\n".join(lines)


def _write(dataset: xr.Dataset, path: Path) -> None:
    with new_file(path) as (file, _):
        dataset.dump_to_store(xr.backends.H5NetCDFStore(file))
