"""Subcommands and options of ``rwmf study``."""

from __future__ import annotations

import argparse

from rwmf.cli.subcommands import Subcommands, add_case, add_plot, add_threads
from rwmf.cli.words import key_with_numbers, number, numbers, written_file

__all__ = ["BLOCK_PERIODS", "FACTORS", "PERIODS", "STRESSES", "TENSIONS", "add_study"]

# default ranges of uncertain parameters: velocity factors, pairs of eta
FACTORS = "0.8:1:5"
TENSIONS = "0,0,1,5,5,50"
# fractions of the initial stress of strands
STRESSES = "0.7,0.85,1"
# periods of a frame [s]; 2 pi/p of blocks from half a metre to twenty metres high
PERIODS = "0.1:3:59"
BLOCK_PERIODS = "1:8:57"
_QUANTITY = (
    "u_s_max, theta_max_over_alpha, cable_force_increment_max_over_m_w_g and others "
    "(default u_s_max, of a wall without a frame theta_max_over_alpha)"
)


def add_study(commands: Subcommands) -> None:
    """Add the subcommand ``study`` and its studies."""
    parser = commands.add(
        "study",
        "A study from a case: overturning map, spectra of a suite, fragility and others.",
        "overturning inputs/study_block.nml --plot map.png",
        "study.run",
    )
    studies = Subcommands(parser, "NAME")
    for add in (
        _add_overturning,
        _add_spectra,
        _add_fragility,
        _add_wall,
        _add_friction,
        _add_bands,
        _add_equal_response,
    ):
        add(studies)


def _new(studies: Subcommands, name: str, text: str, example: str) -> argparse.ArgumentParser:
    parser = studies.add(name, text, example, study=name)
    add_case(parser)
    add_plot(parser, "the result")
    parser.add_argument(
        "--file", metavar="FILE.nc", type=written_file, help="write the result as NetCDF"
    )
    add_threads(parser)
    return parser


def _list(parser: argparse.ArgumentParser, name: str, default: str | None, text: str) -> None:
    shown = f" (default {default})" if default else ""
    # options match in upper and lower case
    words = dict.fromkeys((f"--{name}", f"--{name.lower()}"))
    parser.add_argument(*words, metavar="LIST", type=numbers, default=default, help=text + shown)


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


def _add_grid(parser: argparse.ArgumentParser) -> None:
    text = f"periods in s, of a wall without a frame 2 pi/p (default {PERIODS}, {BLOCK_PERIODS})"
    _list(parser, "T_s", None, text)
    _list(parser, "gamma", None, "mass ratios (default: those of the case)")


def _add_overturning(studies: Subcommands) -> None:
    parser = _new(
        studies,
        "overturning",
        "Which pulses overturn the wall, and after how many impacts; boundaries are bisected.",
        "inputs/study_block.nml --omega 1:8:71 --plot map.png",
    )
    _list(parser, "omega", "1:8:57", "frequencies of the pulse over p")
    _list(parser, "amplitude", "0.5:12:70", "amplitudes a_p/(alpha g) to scan")
    parser.add_argument(
        "--tolerance", type=number(above=0), default=1e-6, help="width of the bisection"
    )


def _add_spectra(studies: Subcommands) -> None:
    parser = _new(
        studies,
        "spectra",
        "Spectra over a suite of records: percentiles of displacement, rotation or cable force.",
        "inputs/study_elcentro.nml --records fema:far_field --plot suite.png",
    )
    _add_records(parser, required=True)
    _add_grid(parser)
    parser.add_argument("--quantity", help=_QUANTITY)


def _add_fragility(studies: Subcommands) -> None:
    parser = _new(
        studies,
        "fragility",
        "Old name of rwmf stripes and rwmf fragility: probability to exceed a limit.",
        "inputs/study_one_sine.nml --records fema:far_field --limit 0.2 --plot f.png",
    )
    _add_records(parser, required=True)
    _list(parser, "levels", "0.1:2:20", "intensities over g")
    parser.add_argument("--quantity", help=f"the demand: {_QUANTITY}")
    parser.add_argument(
        "--intensity",
        metavar="WORD",
        help="pseudo_acceleration (default with a frame), peak_acceleration (of a wall alone), "
        "average_acceleration, peak_velocity, peak_displacement, arias, cav or housner",
    )
    text = "period of the oscillator of pseudo_acceleration in s, with --damping (default: frame)"
    parser.add_argument("--period", type=number(above=0), help=text)
    text = "damping ratio of that oscillator (default: that of the frame)"
    parser.add_argument("--damping", type=number(above=0), help=text)
    text = "periods of average_acceleration in s"
    parser.add_argument("--periods", metavar="LIST", type=numbers, help=text)
    parser.add_argument("--limit", type=number(), required=True, help="limit of the demand")


def _add_wall(studies: Subcommands) -> None:
    parser = _new(
        studies,
        "wall",
        "Seismic effect of the wall: responses with it over those of the frame alone.",
        "inputs/study_elcentro.nml --gamma 5,10,100 --plot wall.png",
    )
    _add_records(parser, required=False)
    _add_grid(parser)
    text = (
        "compared responses (default u_s_max, of storeys storey_drift_max and "
        "floor_acceleration_max_g as well)"
    )
    parser.add_argument("--quantity", metavar="WORD", nargs="+", help=text)


def _add_friction(studies: Subcommands) -> None:
    parser = _new(
        studies,
        "friction",
        "Friction that the base needs, and cable force, over period and mass ratio of the frame.",
        "inputs/study_one_sine.nml --gamma 5,100,1000 --plot friction.png",
    )
    _add_records(parser, required=False)
    _add_grid(parser)


def _add_bands(studies: Subcommands) -> None:
    parser = _new(
        studies,
        "bands",
        "Range of the spectrum over uncertain restitution and post-tension.",
        "inputs/study_one_sine.nml --gamma 5,100 --e 0.8,0.9 --plot bands.png",
    )
    _add_records(parser, required=False)
    _add_grid(parser)
    texts = (
        f"velocity factors at impact (default {FACTORS}, unless a rule of the case gives it)",
        f"pairs eta_0, eta_alpha one after the other (default {TENSIONS}, with a cable; of strands "
        f"{STRESSES} of their initial stress)",
    )
    for name, text in zip(("e", "eta"), texts, strict=True):
        _list(parser, name, None, text)
    parser.add_argument(
        "--vary",
        metavar="KEY=LIST",
        type=key_with_numbers,
        action="append",
        help="another uncertain key, for example frame.xi_s=0.02,0.05; may be repeated",
    )
    parser.add_argument("--quantity", help=f"the response: {_QUANTITY}")


def _add_equal_response(studies: Subcommands) -> None:
    parser = _new(
        studies,
        "equal-response",
        "Which amplitude of each pulse gives the same response.",
        "inputs/study_one_sine.nml --target 0.2 --plot equal.png",
    )
    _list(parser, "T_p", "0.2:3:57", "periods of the pulse in s")
    text = "the response that is reached, a displacement in m"
    parser.add_argument("--target", type=number(above=0), required=True, help=text)
    parser.add_argument("--quantity", help=f"the response: {_QUANTITY}")
