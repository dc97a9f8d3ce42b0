"""Subcommand ``rwmf run``: one case, or many into one table."""

from __future__ import annotations

import argparse
import contextlib
import csv
import json
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rwmf.case import Case
from rwmf.cli import output
from rwmf.errors import InputError, Interrupted, RwmfError, placed
from rwmf.figures import image_files as figures
from rwmf.figures import loops
from rwmf.kernel import files, results, tables
from rwmf.kernel.names import shorten
from rwmf.kernel.numbers import to_json
from rwmf.kernel.progress import progress
from rwmf.run import simulation
from rwmf.run.headline import grouped, headline, tendon_yield_of, value_text
from rwmf.run.quantities import SENSITIVITY, ending_of, find

if TYPE_CHECKING:
    import xarray as xr


# digits of a printed number without an estimate of its error
_MOST_DIGITS = 10
# points of a plotted history for a case without an interval
_PLOT_POINTS = 4000
# points of plotted loops, whose corners need finer sampling
_LOOP_POINTS = 40000


def run(options: argparse.Namespace) -> int | list[str | Path | None]:
    """Simulate one case, or several into a table (``rwmf run``)."""
    if len(options.case) > 1 or Path(options.out or "").suffix in _TABLES:
        return _run_all(options)
    (options.case,) = options.case
    case = Case.from_namelist(options.case)
    names = results.result_names(options.case) if options.out else ()
    found = [Path(options.out, name) for name in names]
    outputs = [options.plot, options.loops, *(options.checks or ()), *found]
    files.check_outputs(outputs, case.inputs)
    figures.check_formats(options.plot, options.loops)
    output.check_words(case, options.checks)
    if options.loops:
        loops.check_springs(case)
    before = {path: _place_of(path) for path in found}
    with simulation.start(case) as result:
        summary = result.summary()
        if options.out:
            result.write(case.text, options.case, options.out)
        if options.plot:
            _plot_history(case, result, options.plot)
        if options.loops:
            _plot_loops(case, result, options.loops)
    output.print_warnings(options.case, summary["warnings"])
    checks = output.compare(case, summary, options.checks)
    slopes = _derivatives(case, options.case)
    if options.json:
        if slopes is not None:
            summary |= output.derivatives_by_name(slopes)
        output.print_json(summary, checks)
    else:
        digits = _digits(summary, _tolerance_of(case, summary))
        _print_table(case, summary, digits, is_all=options.all)
        output.print_checks(checks, is_all=options.all)
        if slopes is not None:
            output.print_gradient(slopes)
    # a written file replaces an older one
    new = [path for path in found if _place_of(path) not in (None, before[path])]
    return [*new, options.plot, options.loops, *(options.checks or ())]


def _derivatives(case: Case, source: str) -> xr.Dataset | None:
    """Compute the derivatives of `&sensitivity`; None without the group."""
    if case.sensitivity is None:
        return None
    # imported here: a run without derivatives does not load xarray
    from rwmf.assess.gradient import gradient

    with placed(f"{source}, &sensitivity: "):
        return gradient(case)


def _place_of(path: Path) -> tuple[int, int] | None:
    """Identify an existing file by device and inode."""
    with contextlib.suppress(OSError):
        status = path.stat()
        return status.st_ino, status.st_mtime_ns
    return None


def _plot_history(case: Case, result: results.Run, path: str) -> None:
    """Draw the history with the demands of the frame, even when the case does not request them."""
    dataset = simulation.to_dataset(result, case)
    has_demands = case.output is not None and case.output.reactions
    lacks_demands = case.frame is not None and not has_demands
    if "time" not in dataset.coords or lacks_demands:
        # outputs do not affect the integration, so the response is the same
        wanted: dict[str, object] = {"conditioning": False}
        if lacks_demands:
            wanted["reactions"] = True
        if "time" not in dataset.coords:
            wanted["dt"] = max(case.solver.t_end / _PLOT_POINTS, np.finfo(float).tiny)
        dataset = simulation.simulate(case.replace(output=wanted))
    figures.save_history(dataset, path, case)


def _plot_loops(case: Case, result: results.Run, path: str) -> None:
    """Sample the corners of the loops finely, whatever the interval of the case."""
    dataset = simulation.to_dataset(result, case)
    fine = max(case.solver.t_end / _LOOP_POINTS, np.finfo(float).tiny)
    if "time" not in dataset.coords or case.output.dt > fine:
        # the shears of storeys are among the reactions
        wanted = {"dt": fine, "reactions": True, "conditioning": False}
        dataset = simulation.simulate(case.replace(output=wanted))
    figures.save_loops(dataset, case, path)


def _tolerance_of(case: Case, summary: dict[str, Any]) -> float:
    """Return the relative tolerance of a run: a large `atol` governs instead of `rtol`."""
    rtol = float(summary["rtol"])
    if "atol" not in case.solver:
        return rtol
    size = float(summary.get("u_s_max_m", 0.0))
    if case.wall is not None:
        size = float(summary["theta_max_over_alpha"]) * math.atan2(case.wall.b, case.wall.h)
    return max(rtol, float(case.solver.atol) / size) if size > 0 else rtol


def _digits(summary: dict[str, Any], tolerance: float) -> dict[str, int]:
    """Return the digits that hold of each value with an estimate of its error."""
    found = {
        key.removeprefix(SENSITIVITY): value
        for key, value in summary.items()
        if key.startswith(SENSITIVITY)
    }
    largest = max(found.values(), default=0.0)
    # instants and final values hold no more digits than the worst peak
    return {
        key: tables.digits_of(tolerance, found.get(key, largest))
        for key in summary
        if found and (key in found or find(key).found in ("time", "end"))
    }


def _print_table(
    case: Case, summary: dict[str, Any], digits: dict[str, int], *, is_all: bool
) -> None:
    """Print headline and grouped table, or every key with its sensitivity."""
    if not is_all:
        lines = headline(summary, tendon_yield_of(case))
        print("\n".join([*lines, *grouped(summary, digits=digits)]))
        return
    shown = [key for key in summary if not key.startswith(SENSITIVITY)]
    width = max(map(len, shown))
    for key in shown:
        text = value_text(key, summary[key], digits.get(key, _MOST_DIGITS))
        sensitivity = summary.get(SENSITIVITY + key)
        note = "" if sensitivity is None else f"  (sensitivity {sensitivity:.2g})"
        print(f"{key:{width}s}  {text}{note}")


_Row = dict[str, Any]

_TABLES = (".csv", ".nc", ".jsonl")
# ending of the files of the batch program
_SUMMARY = ".summary.csv"
# exit status when a case has failed
_FAILED = 1


def _run_all(options: argparse.Namespace) -> int:
    """Run all cases and write a row for each, those that fail included."""
    for name, word in (("plot", "--out FILE.png"), ("loops", "--loops"), ("checks", "--checks")):
        if getattr(options, name):
            raise InputError(f"{word}: needs one case without a table; {len(options.case)} given")
    if not (options.out or options.json):
        raise InputError("several cases need --out TABLE.csv, .nc or .jsonl, or --json")
    if options.out and Path(options.out).suffix not in _TABLES:
        raise InputError(
            f"{options.out}: a table of several cases must end with {', '.join(_TABLES)}; "
            "rwmf-batch writes the files of each case"
        )
    found = {path: _read(path) for path in options.case}
    records = [name for case in found.values() if isinstance(case, Case) for name in case.inputs]
    files.check_outputs([options.out], [*options.case, *records])
    rows: list[_Row] = []
    with progress("case") as report:
        for path, case in found.items():
            row = _simulate(case) if isinstance(case, Case) else case
            rows.append({"case": path, "status": ending_of(row), "message": ""} | row)
            report(len(rows), len(found))
    for row in rows:
        failure = [f"failed: {row['message']}"] if row["status"] == "failed" else []
        output.print_warnings(row["case"], [*row.get("warnings", ()), *failure])
    if options.json:
        print(_lines(rows), end="")
    if options.out:
        _write_rows(rows, Path(options.out))
    failed = sum(row["status"] == "failed" for row in rows)
    print(f"{len(rows) - failed} of {len(rows)} cases have a result", file=sys.stderr)
    output.print_written([options.out], is_json=options.json)
    return _FAILED if failed else 0


def _read(path: str) -> Case | _Row:
    """Read a case, or the scalars in the batch program's summary of one."""
    try:
        return _read_summary(path) if path.endswith(_SUMMARY) else Case.from_namelist(path)
    except RwmfError as error:
        return {"status": "failed", "message": str(error)}


def _simulate(case: Case) -> _Row:
    """Return the scalars of a run."""
    try:
        with simulation.start(case) as result:
            return result.summary()
    except Interrupted:
        raise
    except RwmfError as error:
        return {"status": "failed", "message": str(error)}


def _read_summary(path: str) -> _Row:
    """Read a summary that the batch program has written."""
    with files.reported(path):
        text = Path(path).read_text(encoding="utf-8")
    rows = list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))
    try:
        keys, cells = rows
        return {key: _value(key, cell) for key, cell in zip(keys, cells, strict=True) if cell}
    except (KeyError, ValueError):
        raise InputError(f"{shorten(path)}: is no summary of rwmf-batch") from None


def _value(key: str, cell: str) -> object:
    """Convert a cell by the kind of its quantity."""
    kind = find(key).kind
    if kind == "logical":
        return cell == "true"
    if kind == "list":
        return cell.split("; ")
    return {"real": float, "int": int}.get(kind, str)(cell)


def _lines(rows: list[_Row]) -> str:
    return "".join(f"{json.dumps(to_json(row), allow_nan=False)}\n" for row in rows)


def _write_rows(rows: list[_Row], path: Path) -> None:
    if path.suffix == ".jsonl":
        files.write_bytes(path, _lines(rows).encode())
        return
    keys = list(dict.fromkeys(key for row in rows for key in row))
    if path.suffix == ".csv":
        cells = ([_cell(row.get(key, "")) for key in keys] for row in rows)
        files.write_bytes(path, files.csv_text([keys, *cells]).encode())
        return
    # imported here: other tables do not need it
    import xarray as xr

    from rwmf.assess.table import write_dataset

    table = xr.Dataset({key: ("case", *_column(key, rows)) for key in keys if key != "case"})
    write_dataset(table.assign_coords(case=[row["case"] for row in rows]), path)


def _cell(value: object) -> object:
    """Write a value as the batch program does."""
    if isinstance(value, bool):
        return str(value).lower()
    return "; ".join(map(str, value)) if isinstance(value, list | tuple) else value


def _column(key: str, rows: list[_Row]) -> tuple[np.ndarray[Any, Any], dict[str, str]]:
    """Return the values of all cases with their unit; NaN or an empty text without a value."""
    values = [row.get(key) for row in rows]
    if all(value is None or isinstance(value, bool | int | float) for value in values):
        numbers = [np.nan if value is None else float(value) for value in values]
        return np.array(numbers), {"units": find(key).unit}
    return np.array(["" if value is None else str(_cell(value)) for value in values]), {}
