"""Runs of many cases into one table (``rwmf run`` with several files)."""

from __future__ import annotations

import argparse
import csv
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from rwmf.case import Case
from rwmf.cli.output import print_warnings, print_written
from rwmf.errors import InputError, Interrupted, RwmfError
from rwmf.kernel import files
from rwmf.kernel.names import shorten
from rwmf.kernel.numbers import to_json
from rwmf.kernel.progress import progress
from rwmf.run import simulation
from rwmf.run.quantities import ending_of, find

Row = dict[str, Any]

TABLES = (".csv", ".nc", ".jsonl")
# ending of the files of the batch program
_SUMMARY = ".summary.csv"
# exit status when a case has failed
_FAILED = 1


def run(options: argparse.Namespace) -> int:
    """Run all cases and write a row for each, those that fail included."""
    for name, word in (("plot", "--out FILE.png"), ("loops", "--loops"), ("checks", "--checks")):
        if getattr(options, name):
            raise InputError(f"{word}: needs one case without a table; {len(options.case)} given")
    if not (options.out or options.json):
        raise InputError("several cases need --out TABLE.csv, .nc or .jsonl, or --json")
    if options.out and Path(options.out).suffix not in TABLES:
        raise InputError(
            f"{options.out}: a table of several cases must end with {', '.join(TABLES)}; "
            "rwmf-batch writes the files of each case"
        )
    found = {path: _read(path) for path in options.case}
    records = [name for case in found.values() if isinstance(case, Case) for name in case.inputs]
    files.check_outputs([options.out], [*options.case, *records])
    rows: list[Row] = []
    with progress("case") as report:
        for path, case in found.items():
            row = _simulate(case) if isinstance(case, Case) else case
            rows.append({"case": path, "status": ending_of(row), "message": ""} | row)
            report(len(rows), len(found))
    for row in rows:
        failure = [f"failed: {row['message']}"] if row["status"] == "failed" else []
        print_warnings(row["case"], [*row.get("warnings", ()), *failure])
    if options.json:
        print(_lines(rows), end="")
    if options.out:
        _write(rows, Path(options.out))
    failed = sum(row["status"] == "failed" for row in rows)
    print(f"{len(rows) - failed} of {len(rows)} cases have a result", file=sys.stderr)
    print_written([options.out], is_json=options.json)
    return _FAILED if failed else 0


def _read(path: str) -> Case | Row:
    """Read a case, or the scalars in the batch program's summary of one."""
    try:
        return _read_summary(path) if path.endswith(_SUMMARY) else Case.from_namelist(path)
    except RwmfError as error:
        return {"status": "failed", "message": str(error)}


def _simulate(case: Case) -> Row:
    """Return the scalars of a run."""
    try:
        with simulation.start(case) as result:
            return result.summary()
    except Interrupted:
        raise
    except RwmfError as error:
        return {"status": "failed", "message": str(error)}


def _read_summary(path: str) -> Row:
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


def _lines(rows: list[Row]) -> str:
    return "".join(f"{json.dumps(to_json(row), allow_nan=False)}\n" for row in rows)


def _write(rows: list[Row], path: Path) -> None:
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


def _column(key: str, rows: list[Row]) -> tuple[np.ndarray[Any, Any], dict[str, str]]:
    """Return the values of all cases with their unit; NaN or an empty text without a value."""
    values = [row.get(key) for row in rows]
    if all(value is None or isinstance(value, bool | int | float) for value in values):
        numbers = [np.nan if value is None else float(value) for value in values]
        return np.array(numbers), {"units": find(key).unit}
    return np.array(["" if value is None else str(_cell(value)) for value in values]), {}
