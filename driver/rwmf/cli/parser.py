"""Subcommands and options of the command line.

This module imports no computation, so that help and error messages appear at once.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from rwmf.cli.design_parser import add_design
from rwmf.cli.records_parser import add_records
from rwmf.cli.risk_parser import add_risk
from rwmf.cli.study_parser import add_study
from rwmf.cli.subcommands import (
    Subcommands,
    add_case,
    add_checks,
    add_engine,
    add_plot,
    add_threads,
)
from rwmf.cli.words import number, numbers, whole, written_file

__all__ = ["make_parser"]


def make_parser() -> argparse.ArgumentParser:
    """Build the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog="rwmf",
        description="Dynamic response of post-tensioned rocking wall-moment frames.",
        epilog="example: rwmf spectrum inputs/fig12_one_cosine.nml --plot cosine.png",
    )
    parser.add_argument(
        "--version",
        action=_ShowVersion,
        nargs=0,
        default=argparse.SUPPRESS,
        help="show program's version number and exit",
    )
    commands = Subcommands(parser, "COMMAND")
    for add in (
        _add_run,
        _add_spectrum,
        _add_cost,
        _add_gradient,
        _add_pushover,
        add_design,
        _add_check,
        add_records,
        _add_sweep,
        _add_merge,
        add_study,
        add_risk,
        _add_reproduce,
        _add_export,
        _add_animate,
        _add_explore,
    ):
        add(commands)
    return parser


class _ShowVersion(argparse.Action):
    """Print the kernel's version; loading the kernel takes longer than everything else."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[object] | None,
        option_string: str | None = None,
    ) -> None:
        from rwmf import _library

        print(f"{parser.prog} {_library.version()} ({_library.instruction_set()})")
        parser.exit()


def _add_run(commands: Subcommands) -> None:
    parser = commands.add(
        "run",
        "Simulate one case and print its main results, maxima and counts (&spectrum is ignored).",
        "inputs/fig06_mild_frame_one_cosine.nml --plot history.png",
        "run.run",
    )
    add_case(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument(
        "--all", action="store_true", help="print every key instead of headline and groups"
    )
    add_plot(parser, "the history, and the demands of storeys over the height")
    parser.add_argument(
        "--loops",
        metavar="FILE",
        type=written_file,
        help="draw force over displacement of frame, cable and fuses",
    )
    parser.add_argument("--out", metavar="DIR", help="write the CSV files of rwmf-batch there")
    add_checks(parser)


def _add_spectrum(commands: Subcommands) -> None:
    parser = commands.add(
        "spectrum",
        "Compute the spectrum of the case's &spectrum: largest displacements of the frame, or "
        "other quantities.",
        "inputs/fig12_one_cosine.nml --csv cosine.csv --plot cosine.png",
        "spectrum.run",
    )
    add_case(parser)
    parser.add_argument(
        "--csv", metavar="FILE", type=written_file, help="write the spectrum as rwmf-batch does"
    )
    add_plot(parser, "the spectrum")
    add_checks(parser)
    add_threads(parser)
    parser.add_argument(
        "--quantity",
        metavar="KEY",
        nargs="+",
        help="quantities of each ordinate instead of &spectrum quantities (reference/outputs.md)",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def _add_cost(commands: Subcommands) -> None:
    parser = commands.add(
        "cost",
        "Measure the cost of accuracy: every method and tolerance, and usual procedures, against a "
        "reference in quadruple precision (less than 30 s).",
        "inputs/accuracy_elcentro_1s.nml --plot cost.png",
        "cost.run",
    )
    add_case(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_plot(parser, "error against time")
    parser.add_argument(
        "--target",
        metavar="ERROR",
        type=number(0, 1),
        default=1e-6,
        help="largest error of all columns for the recommended setting (1e-6)",
    )
    parser.add_argument(
        "--quantity",
        metavar="KEY",
        help="peak whose error is compared, such as storey_drift_max (u_s_max, without a frame "
        "theta_max)",
    )


def _add_gradient(commands: Subcommands) -> None:
    parser = commands.add(
        "gradient",
        "Compute derivatives of results with respect to numbers of the case, with their errors and "
        "ranges of validity (&spectrum is ignored).",
        "inputs/fig12_one_cosine.nml --parameters T_s eta_0 --quantities u_s_max",
        "gradient_command.run",
    )
    add_case(parser)
    parser.add_argument(
        "--parameters", metavar="KEY", nargs="+", help="keys with real numbers (&sensitivity)"
    )
    parser.add_argument(
        "--quantities", metavar="KEY", nargs="+", help="results (reference/outputs.md); u_s_max"
    )
    parser.add_argument(
        "--records", metavar="FILE", nargs="+", default=[], help="records instead of &motion"
    )
    parser.add_argument("--unit", metavar="UNIT", help="unit of records: g, m/s2 or cm/s2")
    parser.add_argument(
        "--statistic",
        metavar="SHARE",
        type=number(above=0, below=1),
        help="quantile over the records to differentiate, 0.5 for the median",
    )
    add_threads(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def _add_pushover(commands: Subcommands) -> None:
    parser = commands.add(
        "pushover",
        "Compute the static curve: base shear and overturning moment over the roof drift, with "
        "marks (&motion is ignored).",
        "inputs/storeys_full.nml --drifts 0.01,-0.01,0.02 --plot curve.png",
        "pushover_command.run",
    )
    add_case(parser)
    parser.add_argument(
        "--drifts",
        metavar="LIST",
        type=numbers,
        help="roof drifts at the ends of the legs, such as 0.01,-0.01,0.02 (0.04)",
    )
    parser.add_argument(
        "--pattern",
        choices=("first_mode", "floors", "roof"),
        help="load on the floors (with &storeys first_mode, otherwise roof)",
    )
    parser.add_argument(
        "--forces",
        metavar="LIST",
        type=numbers,
        help="forces on the floors from the ground up, for the pattern floors, in any unit",
    )
    parser.add_argument(
        "--steps", metavar="N", type=whole(1, 100000), default=100, help="steps of a leg (100)"
    )
    parser.add_argument("--csv", metavar="FILE", type=written_file, help="write the rows as CSV")
    add_plot(parser, "the curve with its marks")
    add_checks(parser)
    parser.add_argument(
        "--all", action="store_true", help="print the check of every floor and storey"
    )
    parser.add_argument(
        "--run",
        dest="run_too",
        action="store_true",
        help="simulate the case, and draw its hysteresis behind the curve of --plot",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def _add_check(commands: Subcommands) -> None:
    parser = commands.add(
        "check",
        "Read and validate a case; print effects, omitted effects, states, events, outputs and "
        "every value.",
        "inputs/fig12_one_cosine.nml",
        "check.run",
    )
    add_case(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def _add_sweep(commands: Subcommands) -> None:
    parser = commands.add(
        "sweep",
        "Run all combinations of records, table rows and parameters of a namelist, into NetCDF.",
        "restitution.nml --file restitution.nc",
        "sweep.run",
    )
    parser.add_argument("sweep", metavar="SWEEP.nml", help="namelist with &sweep and &grid")
    parser.add_argument(
        "--file", metavar="FILE.nc", type=written_file, help="NetCDF file (default: SWEEP.nc)"
    )
    add_threads(parser)
    add_engine(parser)
    parser.add_argument("--part", metavar="K/N", default="1/1", help="only the K-th of N parts")
    add_checks(parser)
    parser.add_argument("--restart", action="store_true", help="discard an earlier sweep")


def _add_merge(commands: Subcommands) -> None:
    parser = commands.add(
        "merge",
        "Join parts: the journals of rwmf sweep --part, or the CSV files of rwmf-batch --part.",
        "whole.nc whole.nc.part-*.journal",
        "sweep.merge_parts",
    )
    parser.add_argument(
        "file", metavar="FILE", type=written_file, help="file to write, .nc or .csv"
    )
    parser.add_argument("parts", metavar="PART", nargs="+", help="all parts, in any order")


def _add_reproduce(commands: Subcommands) -> None:
    parser = commands.add(
        "reproduce",
        "Reproduce the paper's figures, check its claims, compare with contact engines; needs the "
        "checkout of the project.",
        "4 12 --out figures",
        "reproduce.run",
    )
    parser.add_argument(
        "figures",
        nargs="*",
        metavar="FIGURE",
        help="4 to 13, benefit, band, free, block, g5, disc, six_storeys; all when absent",
    )
    parser.add_argument(
        "--docs", type=Path, metavar="DIR", help="write claims.md and validation.md there"
    )
    for name, content in (
        ("out", "of the results (default: build/plots"),
        ("inputs", "of the cases (default: inputs"),
        ("validation", "of the engines' cases (default: validation"),
    ):
        parser.add_argument(
            f"--{name}", type=Path, metavar="DIR", help=f"folder {content} of the checkout)"
        )


def _add_export(commands: Subcommands) -> None:
    parser = commands.add(
        "export",
        "Write the building of a case for another program.",
        "opensees inputs/storeys_full.nml storeys.py",
    )
    programs = Subcommands(parser, "PROGRAM")
    fmu = programs.add(
        "fmu",
        "Write a functional mock-up unit (FMI 3.0, co-simulation) with the records of the case.",
        "inputs/fig12_one_sine.nml wall.fmu",
        "export.write_fmu",
    )
    add_case(fmu)
    fmu.add_argument("file", metavar="FILE", type=written_file, help="unit to write, NAME.fmu")
    fmu.add_argument(
        "--input",
        choices=("ground", "link"),
        default="ground",
        help="ground: acceleration of the ground; link: motion of the link, for an importer that "
        "owns the frame (default: ground)",
    )
    opensees = programs.add(
        "opensees",
        "Write a script for OpenSeesPy: model, analysis, and the same demands.",
        "inputs/storeys_full.nml storeys.py --run",
        "export.write_opensees",
    )
    add_case(opensees)
    opensees.add_argument("file", metavar="FILE", type=written_file, help="script to write")
    opensees.add_argument(
        "--run",
        dest="run_it",
        action="store_true",
        help="run it where openseespy is installed, and print the demands of both programs",
    )


def _add_animate(commands: Subcommands) -> None:
    parser = commands.add(
        "animate",
        "Draw a film of wall, storeys and ground: rocking, impacts, yielding, collapse.",
        "inputs/does_a_wall_spread_the_yielding_of_storeys.nml --out storeys.gif",
        "animate.run",
    )
    add_case(parser)
    positive = number(above=0)
    parser.add_argument(
        "--out", type=written_file, metavar="FILE", help="gif, webp or mp4; CASE.gif when absent"
    )
    parser.add_argument("--fps", type=whole(1, 100), default=20, help="frames a second of the film")
    parser.add_argument(
        "--speed", type=positive, default=1.0, help="0.5 for half of the real speed"
    )
    parser.add_argument("--until", type=positive, metavar="T", help="end of the film [s]")


def _add_explore(commands: Subcommands) -> None:
    parser = commands.add(
        "explore",
        "Show a case in the browser: sliders for every key, spectrum, history, the wall in motion. "
        "Works without a network; Ctrl-C ends it.",
        "inputs/fig12_one_sine.nml",
        "explore.run",
    )
    parser.add_argument(
        "case", metavar="CASE.nml", nargs="?", help="namelist file (default: the case of Fig. 12)"
    )
    parser.add_argument(
        "--port",
        type=whole(0, 65535),
        default=0,
        metavar="N",
        help="of this machine (0: a free one)",
    )
    parser.add_argument(
        "--no-browser", action="store_true", help="print the address, open no browser"
    )
