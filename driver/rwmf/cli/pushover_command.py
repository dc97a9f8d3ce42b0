"""Subcommand ``rwmf pushover``."""

from __future__ import annotations

import argparse
import csv
import io
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from rwmf._files import files
from rwmf._pushover import columns_by_key, pushover
from rwmf._simulation import simulate
from rwmf.case import Case
from rwmf.cli.output import (
    check_words,
    checks_if_limited,
    print_checks,
    print_json,
    print_warnings,
    print_written,
    write_checks,
)
from rwmf.errors import InputError
from rwmf.plotting import image_files as figures
from rwmf.plotting.result_figures import LIMIT, words_of_mark
from rwmf.plotting.result_figures import pushover as draw
from rwmf.plotting.style import new_figure

if TYPE_CHECKING:
    from rwmf._checks.checks import Checks


# points of a dynamic hysteresis
_POINTS = 8000
_KILO = 1e-3


def run(options: argparse.Namespace) -> int:
    """Compute a static curve (``rwmf pushover``)."""
    case = Case.from_namelist(options.case)
    written = [options.out, options.plot, *(options.checks or ())]
    files.check_outputs(written, case.inputs)
    figures.check_formats(options.plot)
    check_words(case, options.checks)
    if options.run_too and not options.plot:
        raise InputError("--run: needs --plot FILE, the figure with the hysteresis")
    pattern = options.pattern or ("floors" if options.forces else None)
    wanted = {} if options.drifts is None else {"drifts": options.drifts}
    curve = pushover(case, pattern=pattern, forces=options.forces, steps=options.steps, **wanted)
    if options.out:
        files.write_bytes(options.out, _table(curve).encode())
    if options.plot:
        history = _history(case) if options.run_too else None
        with new_figure(3.8) as figure:
            draw(curve, figure.subplots(), history=history)
            figures.save(figure, options.plot)
    print_warnings(options.case, curve.attrs["warnings"].splitlines())
    checks = _checks(case, curve, options)
    write_checks(checks, options.checks)
    if options.json:
        print_json(_plain(curve) | ({} if checks is None else {"checks": checks.to_dict()}))
    else:
        print("\n".join(_lines(curve)))
        print_checks(checks, is_all=options.all)
    print_written(written, is_json=options.json)
    return 0


def _checks(case: Case, curve: xr.Dataset, options: argparse.Namespace) -> Checks | None:
    """Compare with the limits. Only ``--checks`` requires that the curve has one of the demands."""
    try:
        return checks_if_limited(case, curve)
    except InputError as error:
        if options.checks:
            raise
        print_warnings(options.case, [str(error)])
        return None


def _history(case: Case) -> xr.Dataset:
    """Simulate the case with a history of its base shear."""
    dt = max(case.solver.t_end / _POINTS, np.finfo(float).tiny)
    return simulate(case.replace(output={"dt": dt, "reactions": True, "conditioning": False}))


def _table(curve: xr.Dataset) -> str:
    """Return the rows of the curve as CSV; the last column names the marks of a row."""
    columns = columns_by_key(curve)
    marks: dict[int, list[str]] = {}
    for name, step in zip(curve["mark"].values, curve["mark_step"].values, strict=True):
        marks.setdefault(int(step), []).append(str(name))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["step", *columns, "marks"])
    for i, row in enumerate(zip(*columns.values(), strict=True)):
        writer.writerow([i, *[repr(float(value)) for value in row], " ".join(marks.get(i, []))])
    return text.getvalue()


def _plain(curve: xr.Dataset) -> dict[str, object]:
    marks = [
        {"name": str(name), "step": int(step), "roof_drift": float(drift)}
        for name, step, drift in zip(
            curve["mark"].values, curve["mark_step"].values, curve["mark_roof_drift"].values,
            strict=True,
        )
    ]  # fmt: skip
    warnings = curve.attrs["warnings"].splitlines()
    return {**curve.attrs, "warnings": warnings, "marks": marks, **columns_by_key(curve)}


def _lines(curve: xr.Dataset) -> list[str]:
    """Return the table of marks, and the ends of the curve."""
    weight = float(curve.attrs.get("weight_N", 0.0))
    force = "base shear (kN)" if weight else "base shear/weight"
    moment = "moment (kN m)" if weight else "moment/weight (m)"
    unit = _KILO * weight or 1.0
    shear = unit * curve["base_shear_over_weight"].values
    turning = unit * curve["overturning_moment_over_weight"].values
    drift = curve["roof_drift"].values
    shares = ", ".join(f"{share:.4g}" for share in curve.attrs["pattern_shares"])
    lines = [
        f"load pattern {curve.attrs['pattern']}: {shares} of the base shear, ground to roof",
        f"ratios are over the {curve.attrs['weight']}",
        f"{'':34s}{'roof drift (%)':>15s}{force:>19s}{moment:>19s}",
    ]
    seen = set()
    rows = [("largest base shear", int(np.argmax(np.abs(shear)))), ("end", len(drift) - 1)]
    for name, step in zip(curve["mark"].values, curve["mark_step"].values, strict=True):
        # the table of checks has the drifts of limits
        if name not in seen and not str(name).startswith(LIMIT):
            rows.append((words_of_mark(str(name)), int(step)))
        seen.add(name)
    for words, i in sorted(rows, key=lambda row: row[1]):
        lines.append(f"{words:34s}{100 * drift[i]:15.6g}{shear[i]:19.6g}{turning[i]:19.6g}")
    return lines
