"""Subcommand ``rwmf design``."""

from __future__ import annotations

import argparse
import math
import shlex
from pathlib import Path
from typing import TypeVar

from rwmf._design.design import Design, design
from rwmf._files import files
from rwmf.case import Case
from rwmf.cli.output import print_json, print_warnings, print_written
from rwmf.errors import InputError
from rwmf.plotting import design_page

_T = TypeVar("_T")


def run(options: argparse.Namespace) -> int:
    """Find and print a design (``rwmf design``)."""
    case = Case.from_namelist(options.case)
    files.check_outputs(options.out, case.inputs)
    namelists = [path for path in options.out if Path(path).suffix.lower() == ".nml"]
    pages = [path for path in options.out if path not in namelists]
    for path in pages:
        design_page.check_format_of_page(path)
    bounds, weights = _by_key("--vary", options.vary), _by_key("--cost", options.cost)
    try:
        found = design(
            case,
            bounds,
            options.target,
            weights,
            options.records,
            left_out=options.left_out,
            designs=options.designs,
            unit=options.unit,
            threads=options.threads,
        )
    except InputError as error:
        if bounds or options.target or weights or options.records or case.design is None:
            raise
        raise InputError(f"{options.case}, &design: {error}") from None
    for path in namelists:
        found.case.to_namelist(path)
    for path in pages:
        design_page.write(found, path, _commands(options, namelists))
    print_warnings(options.case, found.warnings)
    if options.json:
        print_json(found.to_dict())
    else:
        _print(found)
    print_written(options.out, is_json=options.json)
    return 0


def _by_key(option: str, items: list[tuple[str, _T]] | None) -> dict[str, _T] | None:
    """Return the words of an option by their keys; None without any."""
    found = dict(items or ())
    for key, _ in items or ():
        if [word for word, _ in items or ()].count(key) > 1:
            raise InputError(f"{option}: {key}: is given twice")
    return found or None


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
        names = ", ".join(found.left_out)
        plural = "" if len(found.left_out) == 1 else "s"
        print(f"judged on {len(found.left_out)} record{plural} left out: {names}")
    else:
        print("no record was left out: the design is judged on its own motions")


def _commands(options: argparse.Namespace, namelists: list[str]) -> list[str]:
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
    return [shlex.join([*words, "--out", *(namelists or ["design.nml"])])]
