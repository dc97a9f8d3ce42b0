"""Subcommand ``rwmf design``."""

from __future__ import annotations

import argparse
import math
import shlex

from rwmf._design.design import Design, design
from rwmf._files import files
from rwmf.case import Case
from rwmf.cli.output import print_json, print_written
from rwmf.plotting import design_page

__all__ = ["run"]


def run(options: argparse.Namespace) -> int:
    """Find and print a design (``rwmf design``).

    Parameters
    ----------
    options : argparse.Namespace
        As the parser of the command line makes them.

    Returns
    -------
    int
        Exit status.

    Raises
    ------
    InputError, NumericalError, OutputError, Interrupted
        As the computation and the writers of files.
    """
    case = Case.from_namelist(options.case)
    files.check_outputs([options.out, options.report], case.inputs)
    design_page.check_format_of_page(options.report)
    found = design(
        case,
        dict(options.vary) if options.vary else None,
        options.target,
        dict(options.cost) if options.cost else None,
        options.records,
        left_out=options.left_out,
        designs=options.designs,
        unit=options.unit,
        threads=options.threads,
    )
    if options.out:
        found.case.to_namelist(options.out)
    if options.report:
        design_page.write(found, options.report, _commands(options))
    if options.json:
        print_json(found.to_dict())
    else:
        _print(found)
    print_written([options.out, options.report], is_json=options.json)
    return 0


def _print(found: Design) -> None:
    print("meets all targets" if found.is_feasible else "NO DESIGN MEETS ALL TARGETS; nearest:")
    print(", ".join(f"{name} = {value:.8g}" for name, value in found.values.items()))
    print(f"cost {found.cost:.8g}, {found.designs} designs computed")
    for check in found.checks:
        judged = "" if math.isnan(check.value_left_out) else (
            f", left out {check.value_left_out:.5g}"
            f"{'' if check.utilisation_left_out <= 1 else ' (exceeded)'}"
        )  # fmt: skip
        print(f"  {check.target}: {check.value:.5g}{judged}")
    for text in found.missed:
        print(f"  missed: {text}")
    if found.left_out:
        print(f"judged on {len(found.left_out)} records left out: {', '.join(found.left_out)}")
    else:
        print("no record was left out: the design is judged on its own motions")


def _commands(options: argparse.Namespace) -> list[str]:
    """Return the commands that repeat the design."""
    words = ["rwmf", "design", options.case]
    bounds = [f"{key}={low!r}:{high!r}" for key, (low, high) in options.vary or ()]
    words += ["--vary", *bounds] if bounds else []
    words += ["--target"] if options.target else []
    for item in options.target or ():
        ends = f"@{item['percentile']!r}" if "percentile" in item else ""
        ends += f"x{item['scale']!r}" if "scale" in item else ""
        value = item.get("limit", item.get("probability"))
        words.append(f"{item['quantity']}{'' if value is None else f'={value!r}'}{ends}")
    weights = [f"{key}={weight!r}" for key, weight in options.cost or ()]
    words += ["--cost", *weights] if weights else []
    for name in ("records", "left_out"):
        given = getattr(options, name)
        words += [f"--{name.replace('_', '-')}", *given] if given else []
    words += ["--unit", options.unit] if options.unit else []
    words += ["--designs", str(options.designs)] if options.designs else []
    return [shlex.join([*words, "--out", options.out or "design.nml"])]
