"""The command ``rwmf study``: one study, one command, one figure."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np
import xarray as xr

from rwmf import figures, files
from rwmf.case import Case
from rwmf.commands import print_warnings
from rwmf.errors import InputError
from rwmf.netcdf_file import new_file
from rwmf.studies import draw
from rwmf.studies.bands import sensitivity_bands
from rwmf.studies.equal_response import equal_response
from rwmf.studies.fragility import fragility, incremental_dynamic_analysis
from rwmf.studies.friction import friction_spectra
from rwmf.studies.overturning import overturning_map
from rwmf.studies.suite_spectra import suite_spectra
from rwmf.studies.wall_effect import wall_effect
from rwmf.sweep.commands import progress
from rwmf.sweep.quantities import find_quantities
from rwmf.sweep.suite import find_records
from rwmf.words import number, shorten, thread_count, whole, written_file

__all__ = ["add_parsers"]

Add = Callable[..., argparse.ArgumentParser]
Report = Callable[[int, int], None]
Compute = Callable[[argparse.Namespace, Case, Report], xr.Dataset]
_PERIODS = "0.1:3:59"
_FACTORS = "0.8:1:5"
_TENSIONS = "0,0,1,5,5,50"
_MOST_NUMBERS = 1_000_000


def add_parsers(add: Add) -> None:
    """Add the command to the parser of the command line.

    Parameters
    ----------
    add : callable
        Adds a subcommand of a name, a function, a text and an example.
    """
    parser = add(
        "study",
        _run,
        "A study from a case: overturning map, spectra of a suite, fragility and others.",
        "overturning inputs/study_block.nml --plot map.png",
    )
    studies = parser.add_subparsers(metavar="NAME", required=True)
    for adder in (
        _add_overturning,
        _add_spectra,
        _add_ida,
        _add_wall,
        _add_friction,
        _add_bands,
        _add_equal,
    ):
        adder(studies)


def _new(
    studies: argparse._SubParsersAction[argparse.ArgumentParser],
    name: str,
    text: str,
    compute: Compute,
    figure: Callable[..., object],
    example: str,
    panels: int = 1,
) -> argparse.ArgumentParser:
    parser = studies.add_parser(
        name, help=text, description=text, epilog=f"example: rwmf study {name} {example}"
    )
    parser.set_defaults(compute=compute, figure=figure, panels=panels)
    parser.add_argument("case", metavar="CASE.nml", help="namelist file")
    parser.add_argument(
        "--plot", metavar="FILE", type=written_file, help="draw the result (png, svg, pdf)"
    )
    parser.add_argument(
        "--file", metavar="FILE.nc", type=written_file, help="write the result as NetCDF"
    )
    parser.add_argument(
        "--threads", metavar="N", type=thread_count, default=0, help="threads (0: all)"
    )
    return parser


def _numbers(word: str) -> list[float]:
    """Read ``FIRST:LAST:N``, both ends included, or numbers with commas between them."""
    read = number()
    try:
        if ":" in word:
            first, last, n = word.split(":")
            return np.linspace(read(first), read(last), whole(1, _MOST_NUMBERS)(n)).tolist()
        return [read(item) for item in word.split(",")]
    except (ValueError, argparse.ArgumentTypeError):
        raise argparse.ArgumentTypeError(
            f"{shorten(word)}: must be FIRST:LAST:N or finite numbers with commas between them, "
            f"at most {_MOST_NUMBERS}"
        ) from None


def _list(parser: argparse.ArgumentParser, name: str, default: str | None, text: str) -> None:
    shown = f" (default {default})" if default else ""
    value = _numbers(default) if default else None
    # the same option without its capitals is the same option
    words = dict.fromkeys((f"--{name}", f"--{name.lower()}"))
    parser.add_argument(*words, metavar="LIST", type=_numbers, default=value, help=text + shown)


def _add_records(parser: argparse.ArgumentParser, required: bool) -> None:
    parser.add_argument(
        "--records",
        metavar="WORD",
        nargs="+",
        default=[],
        required=required,
        help="files, folders of AT2 files, fema:far_field and others",
    )
    parser.add_argument("--unit", help="unit of records that are not AT2: g, m/s2, cm/s2")


def _add_overturning(studies: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = _new(
        studies,
        "overturning",
        "Which pulses overturn the wall, and after how many impacts; boundaries are bisected.",
        lambda options, case, report: overturning_map(
            case, options.omega, options.amplitude, options.tolerance, options.threads, report
        ),
        draw.draw_overturning,
        "inputs/study_block.nml --omega 1:8:71 --plot map.png",
    )
    _list(parser, "omega", "1:8:57", "frequencies of the pulse over p")
    _list(parser, "amplitude", "0.5:12:70", "amplitudes a_p/(alpha g) to scan")
    parser.add_argument(
        "--tolerance", type=number(above=0), default=1e-6, help="width of the bisection"
    )


def _add_spectra(studies: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = _new(
        studies,
        "spectra",
        "Spectra over a suite of records: percentiles of displacement, rotation or cable force.",
        lambda options, case, report: suite_spectra(
            case,
            _grid(options),
            options.records,
            options.quantity,
            unit=options.unit,
            threads=options.threads,
            progress=report,
        ),
        draw.draw_suite,
        "inputs/study_elcentro.nml --records fema:far_field --plot suite.png",
    )
    _add_records(parser, required=True)
    _add_grid(parser)
    parser.add_argument(
        "--quantity",
        default="u_s_max",
        help="u_s_max, theta_max_over_alpha, cable_force_increment_max_over_m_w_g",
    )


def _add_grid(parser: argparse.ArgumentParser) -> None:
    _list(parser, "T_s", _PERIODS, "periods of the frame in s")
    _list(parser, "gamma", None, "mass ratios (default: those of the case)")


def _grid(options: argparse.Namespace) -> dict[str, object]:
    grid = {"T_s": options.T_s}
    return grid if options.gamma is None else grid | {"gamma": options.gamma}


def _add_ida(studies: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = _new(
        studies,
        "fragility",
        "Incremental dynamic analysis of a suite and the probability to exceed a limit.",
        _compute_fragility,
        draw.draw_fragility,
        "inputs/study_one_sine.nml --records fema:far_field --limit 0.2 --plot f.png",
    )
    _add_records(parser, required=True)
    _list(parser, "levels", "0.1:2:20", "pseudo-spectral accelerations over g")
    parser.add_argument("--quantity", default="u_s_max", help="the demand, see rwmf study spectra")
    parser.add_argument("--limit", type=number(), required=True, help="limit of the demand")


def _compute_fragility(options: argparse.Namespace, case: Case, report: Report) -> xr.Dataset:
    (quantity,) = find_quantities((options.quantity,))
    analysis = incremental_dynamic_analysis(
        case,
        options.levels,
        options.records,
        quantity,
        unit=options.unit,
        threads=options.threads,
        progress=report,
    )
    curve = fragility(analysis, options.limit, quantity)
    return curve.assign({quantity: analysis[quantity]})


def _add_wall(studies: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = _new(
        studies,
        "wall",
        "Seismic effect of the wall: displacement with it over that of the frame alone.",
        lambda options, case, report: wall_effect(
            case,
            _grid(options),
            options.records,
            unit=options.unit,
            threads=options.threads,
            progress=report,
        ),
        draw.draw_wall_effect,
        "inputs/study_elcentro.nml --gamma 5,10,100 --plot wall.png",
    )
    _add_records(parser, required=False)
    _add_grid(parser)


def _add_friction(studies: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = _new(
        studies,
        "friction",
        "Friction that the base needs, and cable force, over period and mass ratio of the frame.",
        lambda options, case, report: friction_spectra(
            case,
            _grid(options),
            options.records,
            unit=options.unit,
            threads=options.threads,
            progress=report,
        ),
        draw.draw_friction,
        "inputs/study_one_sine.nml --gamma 5,100,1000 --plot friction.png",
        panels=2,
    )
    _add_records(parser, required=False)
    _add_grid(parser)


def _add_bands(studies: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = _new(
        studies,
        "bands",
        "Range of the spectrum over uncertain restitution and post-tension.",
        _compute_bands,
        draw.draw_bands,
        "inputs/study_one_sine.nml --gamma 5,100 --e 0.8,0.9 --plot bands.png",
    )
    _add_records(parser, required=False)
    _add_grid(parser)
    texts = (
        f"velocity factors at impact (default {_FACTORS}, unless a rule of the case gives it)",
        f"pairs eta_0, eta_alpha one after the other (default {_TENSIONS}, with a cable)",
    )
    for name, text in zip(("e", "eta"), texts, strict=True):
        _list(parser, name, None, text)


def _compute_bands(options: argparse.Namespace, case: Case, report: Report) -> xr.Dataset:
    factors, tensions = options.e, options.eta
    if factors is None and case.impact is not None and case.impact.rule == "constant":
        factors = _numbers(_FACTORS)
    if tensions is None and case.cable is not None:
        tensions = _numbers(_TENSIONS)
    uncertain: dict[str, object] = {}
    if factors is not None:
        # a case that gives r takes its square
        squared = case.impact is not None and "r" in case.impact.given
        uncertain = {"r": [e**2 for e in factors]} if squared else {"e": factors}
    if tensions is not None:
        if len(tensions) % 2 > 0:
            raise InputError("--eta: needs pairs eta_0, eta_alpha")
        uncertain["eta"] = list(zip(tensions[::2], tensions[1::2], strict=True))
    if not uncertain:
        raise InputError(f"{options.case}: nothing is uncertain: give --e or --eta")
    return sensitivity_bands(
        case,
        _grid(options),
        uncertain,
        options.records,
        unit=options.unit,
        threads=options.threads,
        progress=report,
    )


def _add_equal(studies: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = _new(
        studies,
        "equal-response",
        "Which amplitude of each pulse gives the same displacement of the frame.",
        lambda options, case, report: equal_response(
            case, options.T_p, options.target, threads=options.threads, progress=report
        ),
        draw.draw_equal_response,
        "inputs/study_one_sine.nml --target 0.2 --plot equal.png",
    )
    _list(parser, "T_p", "0.2:3:57", "periods of the pulse in s")
    parser.add_argument("--target", type=number(above=0), required=True, help="displacement in m")


def _run(options: argparse.Namespace) -> int:
    """Compute a study, write it, draw it (``rwmf study``)."""
    case = Case.from_namelist(options.case)
    words = getattr(options, "records", None) or ()
    records = find_records(words, unit=options.unit) if words else ()
    inputs = [*case.inputs, *(record.path for record in records)]
    files.check_outputs([options.plot, options.file], inputs)
    if options.plot:
        figures.check_format(options.plot)
    with progress() as report:
        dataset = options.compute(options, case, report)
    print_warnings(options.case, dataset.attrs["warnings"].splitlines())
    if options.file:
        _write(dataset, Path(options.file))
    if options.plot:
        with figures.new_figure(6.4 * options.panels**0.5, 3.8) as figure:
            options.figure(dataset, figure.subplots(1, options.panels))
            figures.save(figure, options.plot)
    for path in (options.file, options.plot):
        if path:
            print(f"written: {path}")
    if "median" in dataset:
        print(_fit_in_words(dataset))
    if not options.file and not options.plot:
        print(dataset)
    return 0


def _fit_in_words(dataset: xr.Dataset) -> str:
    """Say what a fragility curve comes down to."""
    unit = dataset["limit"].attrs["units"]
    limit = f"{float(dataset['limit']):g}" + ("" if unit == "1" else f" {unit}")
    return (
        f"{dataset.attrs['quantity']} > {limit}: "
        f"median {float(dataset['median']):.6g} g, dispersion {float(dataset['dispersion']):.6g}"
    )


def _write(dataset: xr.Dataset, path: Path) -> None:
    with new_file(path) as (file, _):
        dataset.dump_to_store(xr.backends.H5NetCDFStore(file))
