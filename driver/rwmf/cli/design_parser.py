"""Options of ``rwmf design``."""

from __future__ import annotations

import argparse
import re

from rwmf._files.names import shorten
from rwmf.cli.subcommands import Subcommands, add_case, add_threads
from rwmf.cli.words import key_with_numbers, number, whole, written_file

__all__ = ["add_design"]

_TARGET = re.compile(r"(\w+)=([^@x]+)(?:@([^@x]+))?(?:x([^@x]+))?")
_LIMITS = re.compile(r"limits@([^@x]+)(?:x([^@x]+))?")


def add_design(commands: Subcommands) -> None:
    """Add the subcommand ``design``."""
    parser = commands.add(
        "design",
        "Find the cheapest design whose suite meets all targets; records left out judge it. Options"
        " replace the keys of &design.",
        "inputs/study_elcentro.nml --vary eta_0=0:3 --target u_s_max=0.1@84 --cost eta_0=1"
        " --records suite/*.csv",
        "design_command.run",
    )
    add_case(parser)
    parser.add_argument("--vary", metavar="KEY=LOW:HIGH", type=_bounds, nargs="+", help="bounds")
    parser.add_argument(
        "--target",
        metavar="KEY=LIMIT@PERCENTILE",
        type=_target,
        nargs="+",
        help="limits of percentiles, limits@PERCENTILE for those of &limits, collapse=PROBABILITY; "
        "xFACTOR at the end scales the motions",
    )
    parser.add_argument("--cost", metavar="KEY=WEIGHT", type=_weight, nargs="+", help="weights")
    parser.add_argument("--records", metavar="FILE", nargs="+", help="the suite")
    parser.add_argument(
        "--left-out", metavar="FILE", nargs="+", help="records that judge (every fourth)"
    )
    parser.add_argument("--unit", metavar="UNIT", help="unit of records: g, m/s2 or cm/s2")
    parser.add_argument(
        "--designs", metavar="N", type=whole(1, 10**6), help="of the first stage (300)"
    )
    parser.add_argument(
        "--out", metavar="FILE.nml", type=written_file, help="write the namelist of the design"
    )
    parser.add_argument(
        "--report", metavar="FILE", type=written_file, help="write one page (html, pdf, png, svg)"
    )
    add_threads(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def _bounds(word: str) -> tuple[str, tuple[float, float]]:
    key, _, ends = word.partition("=")
    low, _, high = ends.partition(":")
    try:
        return key, (number()(low), number()(high))
    except argparse.ArgumentTypeError:
        raise argparse.ArgumentTypeError(f"{shorten(word)}: must be KEY=LOW:HIGH") from None


def _weight(word: str) -> tuple[str, float]:
    key, values = key_with_numbers(word)
    if len(values) != 1:
        raise argparse.ArgumentTypeError(f"{shorten(word)}: must be KEY=WEIGHT")
    return key, values[0]


def _target(word: str) -> dict[str, object]:
    """Read a target: a percentile of a quantity, or a probability of collapse."""
    read = number()
    if limits := _LIMITS.fullmatch(word):
        scale = {"scale": read(limits[2])} if limits[2] else {}
        return {"quantity": "limits", "percentile": read(limits[1])} | scale
    parts = _TARGET.fullmatch(word)
    is_collapse = parts is not None and parts[1] == "collapse"
    if parts is None or (parts[3] is None) != is_collapse:
        wanted = "KEY=LIMIT@PERCENTILE, limits@PERCENTILE or collapse=PROBABILITY, and xFACTOR"
        raise argparse.ArgumentTypeError(f"{shorten(word)}: must be {wanted}")
    found: dict[str, object] = {"quantity": parts[1]}
    if is_collapse:
        found["probability"] = read(parts[2])
    else:
        found |= {"limit": read(parts[2]), "percentile": read(parts[3])}
    return found | ({"scale": read(parts[4])} if parts[4] else {})
