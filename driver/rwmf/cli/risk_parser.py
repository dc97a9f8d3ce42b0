"""Options of ``rwmf ida``, ``stripes``, ``cloud``, ``fragility`` and ``risk``."""

from __future__ import annotations

import argparse

from rwmf.cli.subcommands import Subcommands, add_engine, add_plot, add_threads
from rwmf.cli.words import key_with_numbers, number, numbers, whole, written_file

__all__ = ["add_risk"]

_MOST = 10**6
_LEVELS = "0.1:2:20"


def add_risk(commands: Subcommands) -> None:
    """Add the subcommands from records to annual frequencies."""
    suite = "inputs/study_one_sine.nml --records suite/*.csv"
    texts = {
        "ida": "Incremental dynamic analysis: common levels, then the capacity of each record.",
        "stripes": "Run all records at all levels of intensity.",
        "cloud": "Run records with their own intensities.",
    }
    for name, text in texts.items():
        example = f"{suite} --plot {name}.png"
        _add_analysis(commands.add(name, text, example, "risk.analyse", analysis=name), name)
    _add_fragility(commands)
    _add_frequency(commands)


def _add_analysis(parser: argparse.ArgumentParser, name: str) -> None:
    parser.add_argument("cases", metavar="CASE.nml", nargs="+", help="designs, one file each")
    text = "files, folders, lists, fema:far_field and others"
    parser.add_argument("--records", metavar="WORD", nargs="+", required=True, help=text)
    parser.add_argument("--unit", help="unit of records that do not give it: g, m/s2, cm/s2")
    text = "sampling interval of records of one column in s"
    parser.add_argument("--dt", type=number(above=0), help=text)
    if name == "cloud":
        _list(parser, "factors", "1", "factors on all records")
    else:
        _list(parser, "levels", _LEVELS, "intensities, accelerations over g")
    if name == "ida":
        parser.add_argument(
            "--limits",
            metavar="QUANTITY=VALUE",
            type=key_with_numbers,
            action="append",
            default=[],
            help="limit of a demand that counts as capacity besides collapse; may be repeated",
        )
        text = "relative width of the interval of each capacity (default 0.02)"
        parser.add_argument("--tolerance", type=number(above=0), default=0.02, help=text)
        text = "highest intensity of the search (default four times the highest level)"
        parser.add_argument("--highest", type=number(above=0), help=text)
    text = "stored demands (default those of storeys and floors, otherwise that of the scene)"
    parser.add_argument("--quantities", metavar="WORD", nargs="+", help=text)
    parser.add_argument("--intensity", metavar="WORD", help="measure, a kind of rwmf.intensity")
    for word, text in (
        ("period", "period of pseudo_acceleration in s, with --damping (default: frame)"),
        ("damping", "damping ratio of that oscillator"),
    ):
        parser.add_argument(f"--{word}", type=number(above=0), help=text)
    _list(parser, "periods", None, "periods of average_acceleration in s")
    text = "table of rows to write, CSV or NetCDF; the same command continues an interrupted one"
    parser.add_argument("--file", metavar="TABLE", type=written_file, help=text)
    parser.add_argument("--restart", action="store_true", help="discard an earlier table")
    parser.add_argument(
        "--pelicun", metavar="DIR", help="write the demands at each level for pelicun into DIR"
    )
    add_plot(parser, "the demand over the intensity")
    add_threads(parser)
    add_engine(parser)


def _add_fragility(commands: Subcommands) -> None:
    parser = commands.add(
        "fragility",
        "Fit lognormal fragility curves to tables of runs; bands, margins, given dispersions.",
        "ida.csv --mce 0.9 --dispersions 0.2,0.3 --file fragility.nc --plot fragility.png",
        "risk.fit",
    )
    parser.add_argument("tables", metavar="TABLE", nargs="+", help="CSV or NetCDF tables of runs")
    text = "limit of a demand in its unit (default: collapse or overturning)"
    parser.add_argument("--limit", type=number(), help=text)
    parser.add_argument("--quantity", metavar="WORD", help="the demand, where there are several")
    text = "counts, capacities or cloud (default: that of the analysis)"
    parser.add_argument("--method", metavar="WORD", help=text)
    _list(parser, "dispersions", None, "further dispersions, combined by squares")
    text = "intensity of the maximum considered earthquake, for the collapse margin ratio"
    parser.add_argument("--mce", type=number(above=0), help=text)
    parser.add_argument(
        "--shape-factor",
        metavar="FACTOR",
        help="spectral shape factor, or PERIOD,DUCTILITY,CATEGORY for that of FEMA P-695",
    )
    text = "bootstrap resamples (default 1000, 0: no bands)"
    parser.add_argument("--resamples", type=whole(0, _MOST), default=1000, help=text)
    text = "probability of the bands (default 0.95)"
    parser.add_argument("--confidence", type=number(0, 1), default=0.95, help=text)
    parser.add_argument("--seed", type=whole(0, _MOST), default=0, help="seed of the resamples")
    text = "write a fragility model of OpenQuake"
    parser.add_argument("--nrml", metavar="FILE.xml", type=written_file, help=text)
    _add_results(parser, "the curves with bands")


def _add_frequency(commands: Subcommands) -> None:
    parser = commands.add(
        "risk",
        "Mean annual frequency of exceedance from a fragility and a hazard curve.",
        "fragility.nc --hazard hazard.csv --plot risk.png",
        "risk.integrate",
    )
    text = "NetCDF file of rwmf fragility, or MEDIAN,DISPERSION"
    parser.add_argument("fragility", metavar="FRAGILITY", help=text)
    text = "CSV file of intensity and frequency, return_period or poe_50; or K0,K of a power law"
    parser.add_argument("--hazard", metavar="HAZARD", required=True, help=text)
    _list(parser, "levels", None, "intensities between the bins of the deaggregation")
    _add_results(parser, "hazard curve and deaggregation")


def _list(parser: argparse.ArgumentParser, name: str, default: str | None, text: str) -> None:
    shown = f" (default {default})" if default else ""
    parser.add_argument(
        f"--{name}", metavar="LIST", type=numbers, default=default, help=text + shown
    )


def _add_results(parser: argparse.ArgumentParser, content: str) -> None:
    text = "write the result as NetCDF"
    parser.add_argument("--file", metavar="FILE.nc", type=written_file, help=text)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_plot(parser, content)
