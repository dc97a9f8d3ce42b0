"""Subcommand ``rwmf export``."""

from __future__ import annotations

import argparse
from pathlib import Path

from rwmf._files import files
from rwmf.case import Case
from rwmf.errors import InputError
from rwmf.export.fmu import export_fmu
from rwmf.export.opensees import opensees_script
from rwmf.export.opensees_run import compare_with_opensees, run_opensees


def run(options: argparse.Namespace) -> int:
    """Write a case for another program, by the suffix of the file (``rwmf export``)."""
    case = Case.from_namelist(options.case)
    path = Path(options.out)
    files.check_outputs([path], case.inputs)
    if path.suffix == ".fmu":
        return _write_fmu(case, path, options)
    if path.suffix == ".py":
        return _write_opensees(case, path, options)
    raise InputError(f"{path}: must end with .fmu (functional mock-up unit) or .py (OpenSeesPy)")


def _write_fmu(case: Case, path: Path, options: argparse.Namespace) -> int:
    variables = export_fmu(case, path, link=options.input == "link")
    counts = [
        f"{sum(variable.kind in kinds for variable in variables)} {name}"
        for kinds, name in (("i", "inputs"), ("or", "outputs"), ("ps", "parameters"))
    ]
    print(f"written: {path}, FMI 3.0 co-simulation, {', '.join(counts)}")
    return 0


def _write_opensees(case: Case, path: Path, options: argparse.Namespace) -> int:
    script = opensees_script(case)
    files.write_bytes(path, script.encode())
    print(f"written: {path}, {len(script.splitlines())} lines")
    if not options.run_it:
        return 0
    print(f"{'demand':34s} {'rwmf':>12s} {'OpenSees':>12s}  difference")
    for demand in compare_with_opensees(case, run_opensees(path)):
        scale, unit = (1e3, "ms") if demand.name.startswith("impact") else (100, "%")
        difference = f"{scale * demand.difference:+8.3f} {unit}"
        print(f"{demand.name:34s} {demand.ours:12.6g} {demand.theirs:12.6g}  {difference}")
    return 0
