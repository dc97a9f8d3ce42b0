"""Subcommand ``rwmf cost``."""

from __future__ import annotations

import argparse
import math

from rwmf._cost import Cost, Row, cost
from rwmf._files import files
from rwmf._progress import progress
from rwmf.case import Case
from rwmf.cli.output import print_json, print_warnings, print_written
from rwmf.plotting import image_files as figures
from rwmf.plotting import result_figures as plot_cost
from rwmf.plotting.style import new_figure


def run(options: argparse.Namespace) -> int:
    """Print the cost of accuracy."""
    case = Case.from_namelist(options.case)
    files.check_outputs([options.plot], case.inputs)
    figures.check_formats(options.plot)
    with progress() as report:
        found = cost(case, options.target, report, options.quantities)
    if options.plot:
        with new_figure(4.2) as figure:
            left, right = figure.subplots(1, 2, sharey=True)
            plot_cost.work_precision(found, left, legend=False)
            plot_cost.work_precision(found, right, over="rhs_evaluations")
            right.label_outer()
            figures.save(figure, options.plot)
    if options.json:
        print_json(found.to_dict())
    else:
        _print(found)
    print_warnings(options.case, filter(None, [found.note]))
    print_written([options.plot], is_json=options.json)
    return 0


def _print(found: Cost) -> None:
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
        print(_line(row, "*" if row is found.recommended else " "))
    print()
    print(_recommendation(found))


def _line(row: Row, mark: str) -> str:
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
