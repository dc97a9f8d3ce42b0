"""Commands of one case beyond its run: cost, design, gradient, pushover, animate, export."""

from __future__ import annotations

import argparse
import math
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np
import xarray as xr

from rwmf.assess.cost import Cost, Row, cost
from rwmf.assess.design import Design, design
from rwmf.assess.gradient import gradient
from rwmf.case import Case
from rwmf.cli import output
from rwmf.errors import InputError
from rwmf.explorer.server import explore
from rwmf.figures import design_page
from rwmf.figures import image_files as figures
from rwmf.figures import results as plot_cost
from rwmf.figures.film import animate, in_words
from rwmf.figures.results import OF_LIMIT, words_of_mark
from rwmf.figures.results import pushover as draw
from rwmf.hosts.fmu import export_fmu
from rwmf.hosts.opensees_script import compare_with_opensees, opensees_script, run_opensees
from rwmf.kernel import files
from rwmf.kernel.numbers import grouped
from rwmf.kernel.progress import progress
from rwmf.run.pushover import pushover
from rwmf.run.response import columns_by_key, marks_of
from rwmf.run.simulation import simulate

if TYPE_CHECKING:
    from rwmf.run.checks import Checks


def run_cost(options: argparse.Namespace) -> list[str | None]:
    """Print the cost of accuracy."""
    case = Case.from_namelist(options.case)
    output.check_files(options, case.inputs)
    found = cost(case, options.target, True, options.quantities)
    if options.plot:
        with figures.drawn(options.plot, 4.2) as figure:
            left, right = figure.subplots(1, 2, sharey=True)
            plot_cost.work_precision(found, left, legend=False)
            plot_cost.work_precision(found, right, over="rhs_evaluations")
            right.label_outer()
    if options.json:
        output.print_json(found.to_dict())
    else:
        _print_cost(found)
    output.print_warnings(options.case, filter(None, [found.note]))
    return [options.plot]


def _print_cost(found: Cost) -> None:
    reference = found.reference
    print(f"reference: {reference['method']}")
    print(
        f"           {reference['peak']} = {reference[reference['peak']]:.15g}, its own relative "
        f"error {reference['relative_error']:.1e} ({reference['error_estimate']})"
    )
    if not reference["good_enough"]:
        print("           NOT two digits better than the best row: errors near it mean little")
    print()
    print(f"{'':27s}{'errors of':>9s}")
    print(
        f"  {'method':15s} {'rtol':>7s} {'peak':>9s} {'rotation':>9s} {'impacts s':>9s} "
        f"{'end state':>9s} {'time ms':>9s} {'steps':>8s} {'rhs':>9s} {'impacts':>7s}"
    )
    for row in [*found.practices, *found.rows]:
        print(_line_of_cost(row, "*" if row is found.recommended else " "))
    print()
    print(_recommendation(found))


def _line_of_cost(row: Row, mark: str) -> str:
    if row.status != "ok":
        return f"{mark} {row.method:15s} {_number(row.rtol, '7.0e')} {row.status}"
    errors = (
        row.relative_error,
        row.theta_max_relative_error,
        row.impact_time_error_s,
        row.end_state_relative_error,
    )
    return (
        f"{mark} {row.method:15s} {_number(row.rtol, '7.0e')} "
        + " ".join(_number(error, "9.1e") for error in errors)
        + f" {1e3 * row.seconds:9.3f} {row.steps:8d} {row.rhs_evaluations:9d} {row.impacts:7d}"
    )


def _number(value: float, form: str) -> str:
    if math.isnan(value):
        return f"{'-':>{form.split('.')[0]}s}"
    return format(value, form)


def _recommendation(found: Cost) -> str:
    row = found.recommended
    if row is None:
        return f"no setting has errors of {found.target:.0e} or less in all columns"
    return (
        f"* cheapest for errors of {found.target:.0e} or less in all columns: "
        f"method = '{row.method}', rtol = {row.rtol:.0e} ({1e3 * row.seconds:.2f} ms)"
    )


_T = TypeVar("_T")


def run_design(options: argparse.Namespace) -> list[str]:
    """Find and print a design (``rwmf design``)."""
    case = Case.from_namelist(options.case)
    files.check_outputs(options.out, case.inputs)
    namelists = [path for path in options.out if Path(path).suffix.lower() == ".nml"]
    pages = [path for path in options.out if path not in namelists]
    figures.check_formats(*(path for path in pages if not design_page.is_html(path)))
    bounds, weights = _by_key("--vary", options.vary), _by_key("--cost", options.cost)
    try:
        found = design(
            case,
            bounds,
            options.target,
            weights,
            options.records,
            progress=True,
            **output.chosen(options, "left_out", "designs", "unit", "dt", "threads"),
        )
    except InputError as error:
        if bounds or options.target or weights or options.records or case.design is None:
            raise
        raise InputError(f"{options.case}, &design: {error}") from None
    for path in namelists:
        found.case.to_namelist(path)
    for path in pages:
        design_page.write(found, path, _commands(options, namelists))
    output.print_warnings(options.case, found.warnings)
    if options.json:
        output.print_json(found.to_dict())
    else:
        _print_design(found)
    written: list[str] = options.out
    return written


def _by_key(option: str, items: list[tuple[str, _T]] | None) -> dict[str, _T] | None:
    """Return the words of an option by their keys; None without any."""
    found = dict(items or ())
    for key, _ in items or ():
        if [word for word, _ in items or ()].count(key) > 1:
            raise InputError(f"{option}: {key}: is given twice")
    return found or None


def _print_design(found: Design) -> None:
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
    interval = "" if options.dt is None else f",{options.dt!r}"
    words += ["--unit", f"{options.unit or ''}{interval}"] if options.unit or interval else []
    words += ["--designs", str(options.designs)] if options.designs else []
    return [shlex.join([*words, "--out", *(namelists or ["design.nml"])])]


def run_gradient(options: argparse.Namespace) -> None:
    """Print derivatives (``rwmf gradient``)."""
    case = Case.from_namelist(options.case)
    found = gradient(
        case,
        _words(options.parameters) or None,
        _words(options.quantities) or None,
        progress=True,
        **output.chosen(options, "records", "statistic", "unit", "dt", "threads"),
    )
    if options.json:
        names = [*found.data_vars, "parameter_value", "parameter_scale"]
        output.print_json(
            {"quantity": found["quantity"].values.tolist()}
            | {"parameter": found["parameter"].values.tolist()}
            | {str(name): found[name].values for name in names}
            | ({"record": found["record"].values.tolist()} if "record" in found.dims else {})
            | {"runs": int(found.attrs["runs"])}
        )
    else:
        output.print_gradient(found)


def _words(items: list[str] | None) -> list[str]:
    return [word for item in items or [] for word in item.split(",") if word]


# points of a dynamic hysteresis
_POINTS = 8000
_KILO = 1e-3


def run_pushover(options: argparse.Namespace) -> list[str | None]:
    """Compute a static curve (``rwmf pushover``)."""
    case = Case.from_namelist(options.case)
    written = output.check_files(options, case.inputs, case)
    if options.run_too and not options.plot:
        raise InputError("--run: needs a figure for the hysteresis, --out FILE.png")
    wanted = output.chosen(options, "pattern", "forces", "steps")
    wanted |= {} if options.drifts is None else {"drifts": options.drifts}
    curve = pushover(case, **wanted)
    if options.out:
        files.write_bytes(options.out, _table(curve).encode())
    history = None
    if options.run_too:
        dt = max(case.solver.t_end / _POINTS, np.finfo(float).tiny)
        wanted_too = {"dt": dt, "reactions": True, "conditioning": False}
        history = simulate(case.replace(output=wanted_too))
    figures.draw_into(
        options.plot, 3.8, lambda figure: draw(curve, figure.subplots(), history=history)
    )
    output.print_warnings(options.case, curve.attrs["warnings"].splitlines())
    checks = _checks(case, curve, options)
    if options.json:
        output.print_json(_plain(curve), checks)
    else:
        print("\n".join(_lines(curve)))
        output.print_checks(checks, is_all=options.all)
    return written


def _checks(case: Case, curve: xr.Dataset, options: argparse.Namespace) -> Checks | None:
    """Compare with the limits. Only ``--checks`` requires that the curve has one of the demands."""
    try:
        return output.compare(case, curve, options.checks)
    except InputError as error:
        if options.checks:
            raise
        output.print_warnings(options.case, [str(error)])
        return None


def _table(curve: xr.Dataset) -> str:
    """Return the rows of the curve as CSV; the last column names the marks of a row."""
    columns = columns_by_key(curve)
    marks = grouped(marks_of(curve), lambda mark: mark[1])
    rows = [
        [i, *map(float, row), " ".join(name for name, *_ in marks.get(i, []))]
        for i, row in enumerate(zip(*columns.values(), strict=True))
    ]
    return files.csv_text([["step", *columns, "marks"], *rows])


def _plain(curve: xr.Dataset) -> dict[str, object]:
    marks = [
        {"name": name, "step": step, "roof_drift": drift} for name, step, drift in marks_of(curve)
    ]
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
    for name, step, _ in marks_of(curve):
        # the table of checks has the drifts of limits
        if name not in seen and not name.startswith(OF_LIMIT):
            rows.append((words_of_mark(name), step))
        seen.add(name)
    for words, i in sorted(rows, key=lambda row: row[1]):
        lines.append(f"{words:34s}{100 * drift[i]:15.6g}{shear[i]:19.6g}{turning[i]:19.6g}")
    return lines


def run_animate(options: argparse.Namespace) -> None:
    """Make the film."""
    case = Case.from_namelist(options.case)
    path = Path(options.out or f"{Path(options.case).stem}.gif")
    files.check_outputs([path], case.inputs)
    wanted: dict[str, object] = {"conditioning": False, "dt": options.speed / options.fps}
    if case.storeys is not None:
        # the reactions include the drifts
        wanted["reactions"] = True
    response = simulate(case.replace(output=wanted))
    # the film ends with overturning or collapse
    shown = np.isfinite(response["theta" if case.wall is not None else "u_s"].values)
    if options.until is not None:
        shown &= response["time"].values <= options.until
    response = response.isel(time=shown)
    frames = response.sizes["time"]
    print(f"{path}: {frames} frames to draw", flush=True)
    with progress("frame") as report:
        scale = animate(case, response, path, options.fps, report)
    print(f"written: {path}, {response.sizes['time']} frames, {in_words(case, scale)}")


def run_export(options: argparse.Namespace) -> None:
    """Write a case for another program, by the suffix of the file (``rwmf export``)."""
    case = Case.from_namelist(options.case)
    path = Path(options.out)
    files.check_outputs([path], case.inputs)
    if path.suffix == ".fmu":
        _write_fmu(case, path, options)
    elif path.suffix == ".py":
        _write_opensees(case, path, options)
    else:
        raise InputError(
            f"{path}: must end with .fmu (functional mock-up unit) or .py (OpenSeesPy)"
        )


def _write_fmu(case: Case, path: Path, options: argparse.Namespace) -> None:
    variables = export_fmu(case, path, link=options.input == "link")
    counts = [
        f"{sum(variable.kind in kinds for variable in variables)} {name}"
        for kinds, name in (("i", "inputs"), ("or", "outputs"), ("ps", "parameters"))
    ]
    print(f"written: {path}, FMI 3.0 co-simulation, {', '.join(counts)}")


def _write_opensees(case: Case, path: Path, options: argparse.Namespace) -> None:
    script = opensees_script(case)
    files.write_bytes(path, script.encode())
    print(f"written: {path}, {len(script.splitlines())} lines")
    if not options.run_it:
        return
    print(f"{'demand':34s} {'rwmf':>12s} {'OpenSees':>12s}  difference")
    for demand in compare_with_opensees(case, run_opensees(path)):
        scale, unit = (1e3, "ms") if demand.name.startswith("impact") else (100, "%")
        difference = f"{scale * demand.difference:+8.3f} {unit}"
        print(f"{demand.name:34s} {demand.ours:12.6g} {demand.theirs:12.6g}  {difference}")


def run_explore(options: argparse.Namespace) -> None:
    """Show a case in the browser."""
    explore(options.case, options.port, not options.no_browser)
